"""Types: the package passes mypy, its stubs are those of the extension, and editors know the keywords."""
import ast
import os
import subprocess
import sys
from pathlib import Path

from tetropolis import _core

PACKAGE = Path(os.environ["PYTHONPATH"].split(os.pathsep)[0])
CONFIG = ("--config-file", Path(__file__).resolve().parents[2] / "pyproject.toml")

USER = '''
import tetropolis as tp

city = tp.build_city("footprints.gpkg", ["a.laz"], dtm_step=2, boundary_buildings="clip", progress=True)
mesh = tp.build_mesh(city, mesh_size=5, layering="graded")
mesh.save("x.vtu", coordinates="absolute")
city.h_roof[3] += 10
reveal_type(mesh.cells)
tp.build_mesh(city, mesh_size="five")
tp.build_mesh(city, layering="evenly")
tp.build_mesh(city, mesh_szie=5)
'''


def mypy(*arguments):
    environment = dict(os.environ, MYPYPATH=str(PACKAGE))
    # mypy asks the terminal for its colours, and would be stopped in the background.
    return subprocess.run([sys.executable, "-m", "mypy", *arguments], env=environment, text=True,
                          start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def test_users_are_told_of_wrong_keywords(tmp_path):
    (tmp_path / "user.py").write_text(USER)
    lines = mypy(*CONFIG, "--cache-dir", tmp_path / "cache", tmp_path / "user.py").stdout.splitlines()
    errors = [line.split(":")[1] for line in lines if ": error:" in line]
    assert errors == ["9", "10", "11"], lines
    told = "\n".join(lines)
    assert "ndarray[" in told and "mesh_szie" in told


def test_the_package_passes(tmp_path):
    ran = mypy(*CONFIG, "--cache-dir", tmp_path, "-p", "tetropolis")
    assert ran.returncode == 0, ran.stdout


def names(nodes):
    """What a stub declares: names, and those of classes with their members."""
    found = {}
    for node in nodes:
        if isinstance(node, ast.ClassDef):
            found[node.name] = set(names(node.body))
        elif isinstance(node, ast.FunctionDef):
            found[node.name] = None
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = None
    return found


def test_stub_of_the_extension_names_all_of_it():
    declared = names(ast.parse((PACKAGE / "tetropolis/_core.pyi").read_text()).body)
    assert set(declared) == {name for name in dir(_core) if not name.startswith("_")}
    for name, members in declared.items():
        if members is not None:
            there = {member for member in dir(getattr(_core, name)) if not member.startswith("_")}
            assert {member for member in members if not member.startswith("_")} == there, name


def test_stub_of_the_settings_has_their_keywords():
    declared = names(ast.parse((PACKAGE / "tetropolis/_settings.pyi").read_text()).body)
    for name, function in [("BuildCity", "build_city"), ("ReadCity", "read_city"), ("BuildMesh", "build_mesh"),
                           ("Save", "save"), ("Synth", "synth")]:
        assert declared[name] == {row[0] for row in _core.settings_of(function)}
