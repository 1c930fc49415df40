"""What Python makes is what the command line writes, byte for byte."""
import json

import pytest

import tetropolis as tp


@pytest.mark.parametrize("name", ["volume.vtu", "boundary.vtp", "volume.xdmf", "volume.h5", "boundary.xdmf", "boundary.h5",
                                  "volume.msh", "surface.vtp", "surface.stl",
                                  "surface.obj", "surface.ply", "surface.glb", "constant/polyMesh/faces",
                                  "constant/polyMesh/points"])
def test_mesh_files(mesh, written, tmp_path, name):
    path = tmp_path / name
    if name == "surface.vtp":
        mesh.surface.save(path)
    elif path.suffix == ".h5" or name == "boundary.xdmf":
        mesh.save(tmp_path / "volume.xdmf")
    else:
        mesh.save(path.parent if "polyMesh" in name else path)
    assert path.read_bytes() == (written / name).read_bytes()


def test_city_files(shared_city, written, tmp_path):
    shared_city.save(tmp_path / "dtm.tif")
    assert (tmp_path / "dtm.tif").read_bytes() == (written / "dtm.tif").read_bytes()
    shared_city.save(tmp_path / "city.json")
    shared_city.save(tmp_path / "buildings.gpkg")
    assert (tmp_path / "buildings.gpkg").read_bytes() == (written / "buildings.gpkg").read_bytes()
    ours, theirs = (json.loads(path.read_text()) for path in (tmp_path / "city.json", written / "city.city.json"))
    assert ours["metadata"].pop("title", None) != theirs["metadata"].pop("title")
    assert ours == theirs


def test_reports_are_those_of_the_command(shared_city, mesh, written):
    report = json.loads((written / "report.json").read_text())
    for key in ("input", "city", "origin", "crs", "domain"):
        assert shared_city.report[key] == report[key]
    for key in ("ground_mesh", "volume_mesh", "surface_mesh", "origin", "crs"):
        assert mesh.report[key] == report[key]
    codes = [warning["code"] for warning in report["warnings"]]
    assert [notice.code for notice in shared_city.warnings + mesh.warnings] == codes


@pytest.mark.parametrize("settings", [{"mesh_size": 20}, {"threads": 1}, {"layering": "uniform", "layer_height": 15},
                                      {"top": "free"}])
def test_settings_arrive(shared_city, written, program, tmp_path, settings):
    import subprocess

    options = [text for key, value in settings.items() for text in (f"--{key.replace('_', '-')}", str(value))]
    subprocess.run([program, "mesh", "--city", written / "city.city.json", "--dtm", written / "dtm.tif", "--out",
                    tmp_path / "out", "--quiet", *options], check=True)
    tp.build_mesh(shared_city, **settings).save(tmp_path / "volume.vtu")
    assert (tmp_path / "volume.vtu").read_bytes() == (tmp_path / "out/volume.vtu").read_bytes()


def test_read_city_meshes_alike(written, tmp_path):
    tp.build_mesh(tp.read_city(written)).save(tmp_path / "volume.vtu")
    assert (tmp_path / "volume.vtu").read_bytes() == (written / "volume.vtu").read_bytes()


def test_check_finds_nothing(written):
    files = tp.check(written)
    assert {"volume.vtu", "boundary.vtp", "city.city.json"} <= {file.name for file in files}
    assert all(file.ok for file in files)
