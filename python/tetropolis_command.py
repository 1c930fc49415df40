"""The script ``tetropolis``. Outside the package, whose import of NumPy takes longer than the program starts."""
import os
import sys


def main() -> None:
    program = os.path.join(os.path.dirname(__file__), "tetropolis", "bin", "tetropolis")
    os.execv(program, [program, *sys.argv[1:]])
