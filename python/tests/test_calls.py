"""Long calls: progress, Ctrl-C, other threads, warnings."""
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from urllib.request import url2pathname

import pytest

import tetropolis as tp


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """A city whose mesh of 3 m takes a second or so."""
    folder = tmp_path_factory.mktemp("large")
    tp.synth(folder, buildings=150, size=500, seed=3, point_density=1)
    return tp.build_city(folder / "footprints.shp", folder)


def test_progress_comes_on_the_calling_thread(large):
    calls = []
    tp.build_mesh(large, mesh_size=3, progress=lambda *news: calls.append((threading.get_ident(), *news)))
    assert {thread for thread, *_ in calls} == {threading.get_ident()}
    assert len(calls) > 1 and calls[-1][2] == 1
    assert all(isinstance(step, str) and 0 <= share <= 1 for _, step, share in calls)
    assert [share for *_, share in calls] == sorted(share for *_, share in calls)


def test_what_progress_raises_ends_the_call(large):
    def stop(step, fraction):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        tp.build_mesh(large, mesh_size=3, progress=stop)
    with pytest.raises(TypeError):
        tp.build_mesh(large, mesh_size=3, progress=lambda: None)
    assert tp.build_mesh(large, mesh_size=50).n_cells > 0


def test_tqdm(data, capsys):
    tp.build_mesh(tp.build_city(data / "footprints.shp", data, progress=True), progress=True)
    assert "100%" in capsys.readouterr().err


def test_interrupt(large):
    began = time.monotonic()
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            tp.build_mesh(large, mesh_size=0.8, max_memory="100G")
    finally:
        timer.cancel()
    assert time.monotonic() - began < 20
    assert tp.build_mesh(large, mesh_size=50).n_cells > 0


def test_other_threads_run_meanwhile(large):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    tp.build_mesh(large, mesh_size=3)
    during = counted - before
    done.set()
    thread.join()
    assert during > 20


def test_calls_from_several_threads(data):
    cities = {}

    def build(number):
        cities[number] = tp.build_city(data / "footprints.shp", data)

    threads = [threading.Thread(target=build, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({city.h_roof.tobytes() for city in cities.values()}) == 1 and len(cities) == 4


def test_warnings_point_at_the_caller(data):
    import laspy

    las = laspy.read(data / "points.laz")
    with pytest.warns(tp.DataWarning, match="ground_filtered") as caught:
        city = tp.build_city(data / "footprints.shp", las.xyz)
    assert all(warning.filename == __file__ for warning in caught)
    assert [notice.code for notice in city.warnings] == [str(w.message).split("(")[-1][:-1] for w in caught]


def test_page(mesh, shared_city, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    for shown in (mesh, shared_city):
        assert shown.show() is None
        page = Path(url2pathname(opened[-1].removeprefix("file:")))
        assert page.read_text() == shown.to_html()
        page.unlink()
    assert mesh.to_html().startswith("<!doctype html>")
    assert len(mesh.to_html()) > len(shared_city.to_html())  # it has the cells


def test_command_line(program, tmp_path):
    ran = subprocess.run([sys.executable, "-m", "tetropolis", "--version"], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == f"tetropolis {tp.__version__}"
    ran = subprocess.run([sys.executable, "-m", "tetropolis", "build"], capture_output=True, text=True)
    assert ran.returncode == 2 and ran.stderr.startswith("tetropolis: ")


def test_numpy_is_all_that_is_needed(data, tmp_path):
    """Without the packages that results are handed to, city and mesh are made, printed, saved and looked at."""
    code = f"""
import sys
for name in ("pandas", "geopandas", "shapely", "pyvista", "meshio", "laspy", "tqdm", "matplotlib"):
    sys.modules[name] = None  # importing it fails
import numpy as np
import tetropolis as tp
city = tp.build_city({str(data / "footprints.shp")!r}, {str(data)!r})
mesh = tp.build_mesh(city, mesh_size=30)
assert repr(city) and repr(city.terrain) and repr(mesh) and repr(mesh.boundary)
mesh.save({str(tmp_path / "a.vtu")!r})
assert mesh.points[mesh.cells].shape[1:] == (4, 3) and mesh.to_html() and city.flags and city.source_ids
"""
    subprocess.run([sys.executable, "-c", code], check=True)
