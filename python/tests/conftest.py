"""One small synthetic city for all tests, as files and as made from them."""
import os
import subprocess

import pytest

import tetropolis as tp


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    """Folder with footprints.shp and points.laz."""
    folder = tmp_path_factory.mktemp("data")
    tp.synth(folder, kind="blocks", size=300, seed=7, relief=8)
    return folder


@pytest.fixture(scope="session")
def program():
    """The command line."""
    return os.environ["TETROPOLIS_PROGRAM"]


@pytest.fixture(scope="session")
def written(data, program, tmp_path_factory):
    """Folder of what the command makes of the data."""
    out = tmp_path_factory.mktemp("written") / "out"
    subprocess.run([program, "build", "--footprints", data / "footprints.shp", "--points", data, "--out", out,
                    "--id-attribute", "id", "--formats", "vtu,xdmf,msh,openfoam,obj,ply,glb", "--quiet"], check=True)
    return out


@pytest.fixture
def city(data):
    """A city of one's own, to edit."""
    return tp.build_city(data / "footprints.shp", data, id_attribute="id")


@pytest.fixture(scope="session")
def shared_city(data):
    return tp.build_city(data / "footprints.shp", data, id_attribute="id")


@pytest.fixture(scope="session")
def mesh(shared_city):
    return tp.build_mesh(shared_city)
