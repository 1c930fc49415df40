"""The notebooks of examples/notebooks run from top to bottom."""
import shutil
import os
import subprocess
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.mark.parametrize("name", sorted(path.stem for path in (EXAMPLES / "notebooks").glob("*.ipynb")))
def test_notebook(name, tmp_path, monkeypatch):
    notebook = nbformat.read(EXAMPLES / "notebooks" / f"{name}.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs do not belong into the repository"
    needs = notebook.metadata.get("needs")
    if needs and subprocess.run(["bash", "-c", needs], capture_output=True).returncode != 0:
        pytest.skip(f"`{needs}` fails")
    for folder in ("data", "fenicsx", "openfoam"):
        (tmp_path / folder).symlink_to(EXAMPLES / folder)
    (tmp_path / "notebooks").mkdir()
    # Debian's OpenFOAM is told where it is by what its own shell profile sets.
    if Path("/usr/share/openfoam").is_dir() and "WM_PROJECT_DIR" not in os.environ:
        monkeypatch.setenv("WM_PROJECT_DIR", "/usr/share/openfoam")
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": tmp_path / "notebooks"}}).execute()
    shutil.rmtree(tmp_path / "notebooks")
