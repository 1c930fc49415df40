"""Runs the blocks of a page that follow the comment `<!-- run -->`, as a reader would, one after another:

snippets_test.py PROGRAM SOURCE PAGE

in a folder with `build/tetropolis`, `examples`, and the data of examples/data/delft as `footprints.gpkg` and
`points/`. `<!-- run if COMMAND -->` runs a block where the command succeeds; `; first COMMAND` before it makes
something shorter. A block `text` after it is what it prints; a line `...` in it stands for any lines, and numbers of
seconds and megabytes may differ. Exit code 77: nothing could be run.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"<!-- run(?: if (?P<condition>.*?))?(?:; first (?P<first>.*?))? -->\n\s*```(?P<language>sh|python)\n"
                   r"(?P<code>.*?)\n\s*```(?:\n\s*```text\n(?P<output>.*?)\n\s*```)?", re.DOTALL)
VARYING = re.compile(r"\d+(\.\d+)? (s|MB)\b")


def without_indent(text):
    indent = len(text) - len(text.lstrip(" "))
    return "\n".join(line[indent:] if line[:indent].isspace() else line for line in text.split("\n"))


def matches(expected, printed):
    pattern = "".join(r"(?:.*\n)*" if line.strip() == "..." else re.escape(line) + r"\s*\n"
                      for line in VARYING.sub("N", expected).split("\n"))
    return re.fullmatch(pattern, VARYING.sub("N", printed)) is not None


def main():
    program, source, page = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    text = page.read_text()
    blocks = list(BLOCK.finditer(text))
    if len(blocks) != len(re.findall(r"^ *<!-- run", text, re.MULTILINE)):
        sys.exit(f"{page}: a comment `<!-- run -->` is not followed by a block `sh` or `python`")
    build = program.parent
    environment = dict(os.environ, PATH=f"/usr/bin:{os.environ['PATH']}", PYTHONPATH=f"{build}/python", NO_COLOR="1")
    if os.path.isdir("/usr/share/openfoam"):
        environment.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    ran = 0
    with tempfile.TemporaryDirectory(prefix="tetropolis-snippets-") as name:
        folder = pathlib.Path(name)
        (folder / "build").mkdir()
        (folder / "build/tetropolis").symlink_to(program)
        (folder / "build/venv").symlink_to(build / "venv")
        (folder / "examples").symlink_to(source / "examples")
        (folder / "points").mkdir()
        (folder / "points/ahn3.laz").symlink_to(source / "examples/data/delft/ahn3.laz")
        (folder / "footprints.gpkg").symlink_to(source / "examples/data/delft/footprints.gpkg")

        def run(command, check=True):
            result = subprocess.run(command, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT)
            if check and result.returncode != 0:
                sys.exit(f"{page}: exit code {result.returncode} of\n{command[-1]}\n{result.stdout}")
            return result

        for block in blocks:
            condition = ["bash", "-c", block["condition"] or "true"]
            if run(condition, check=False).returncode != 0:
                print(f"not run, as `{block['condition']}` fails")
                continue
            if block["first"]:
                run(["bash", "-ec", block["first"]])
            code = without_indent(block["code"])
            interpreter = ["bash", "-ec"] if block["language"] == "sh" else [f"{build}/venv/bin/python", "-c"]
            printed = run(interpreter + [code]).stdout
            ran += 1
            if block["output"] and not matches(without_indent(block["output"]), printed):
                sys.exit(f"{page}: prints other lines than the page has:\n{code}\n{printed}")
    print(f"{page.name}: {ran} of {len(blocks)} blocks")
    sys.exit(0 if ran else 77)


if __name__ == "__main__":
    main()
