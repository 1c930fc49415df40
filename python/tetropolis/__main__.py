"""The command line: ``python -m tetropolis``, and the script ``tetropolis``."""
import os
import sys
from pathlib import Path

PROGRAM = Path(__file__).parent / "bin" / "tetropolis"


def main() -> None:
    os.execv(PROGRAM, [str(PROGRAM), *sys.argv[1:]])


if __name__ == "__main__":
    main()
