"""Keyword arguments are the program's settings: names, defaults, help, errors."""
import inspect
import json
import re
import subprocess

import pytest

import tetropolis as tp
from tetropolis import _core


@pytest.fixture(scope="module")
def table(program):
    """default and meaning of each setting, as the program documents them."""
    text = subprocess.run([program, "settings"], capture_output=True, text=True, check=True).stdout
    rows = re.findall(r"^\| `(\w+)` \| `--[\w-]+` \| `(.*?)` \| .*? \| .*? \| .*? \| (.*) \|$", text, re.MULTILINE)
    return {name: (default, meaning) for name, default, meaning in rows}


FUNCTIONS = {"build_city": tp.build_city, "build_mesh": tp.build_mesh, "read_city": tp.read_city, "save": tp.Mesh.save,
             "synth": tp.synth}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_signature_and_docstring(table, name):
    function = FUNCTIONS[name]
    keywords = [p for p in inspect.signature(function).parameters.values() if p.name in table and p.name != "out"]
    assert {p.name for p in keywords} - {"footprints", "points", "city"} - ({"dtm"} if name == "read_city" else set()) == \
        {row[0] for row in _core.settings_of(name)}
    for parameter in keywords:
        if parameter.kind is not inspect.Parameter.KEYWORD_ONLY:
            continue
        default, meaning = table[parameter.name]
        value = parameter.default
        if value is None:
            assert default in ('""', "[]") or parameter.name == "domain"
        elif isinstance(value, (str, bool)):
            assert default == (f'"{value}"' if isinstance(value, str) else str(value).lower())
        else:
            assert float(default) == value
        flat = " ".join(function.__doc__.split())
        assert f"{parameter.name} : " in flat
        assert " ".join(meaning.split(" (")[0].split()) in flat


def test_every_setting_of_the_steps_is_a_keyword(table):
    ours = {row[0] for name in FUNCTIONS for row in _core.settings_of(name)}
    # Files and terminals; `check` and the reader of cities have arguments of their own.
    others = {"footprints", "points", "city", "dtm", "out", "overwrite", "formats", "no_html", "quiet", "verbose", "log"}
    assert set(table) - ours - others == set()


def test_none_is_the_default(shared_city, mesh):
    assert tp.build_mesh(shared_city, mesh_size=None, layering=None).n_cells == mesh.n_cells


def test_numbers_of_numpy(shared_city):
    import numpy as np

    a = tp.build_mesh(shared_city, mesh_size=np.float32(20), threads=np.int64(1))
    assert a.n_cells == tp.build_mesh(shared_city, mesh_size=20).n_cells
    xmin, ymin, xmax, ymax = shared_city.domain
    assert a.report["config"]["mesh_size"] == 20


@pytest.mark.parametrize("settings, words", [
    ({"mesh_szie": 4}, r"build_mesh\(\) has no keyword 'mesh_szie'; did you mean 'mesh_size'\?"),
    ({"qqqqqqqq": 4}, r"build_mesh\(\) has no keyword 'qqqqqqqq'; see help\(tetropolis.build_mesh\)"),
    ({"dtm_step": 2}, "has no keyword 'dtm_step'"),
    ({"mesh_size": 0}, "mesh_size: 0 is less than 0.05"),
    ({"mesh_size": "five"}, "mesh_size: 'five' is not a number"),
    ({"mesh_size": True}, "mesh_size: 'true' is not a number"),
    ({"mesh_size": [1, 2]}, "mesh_size: one value expected"),
    ({"mesh_size": float("nan")}, "mesh_size"),
    ({"solver_iterations": 1.5}, "solver_iterations: '1.5' is not a whole number"),
    ({"layering": "evenly"}, "layering: 'evenly' is not one of graded, uniform"),
    ({"max_memory": "much"}, "max_memory: 'much' is not a size"),
    ({"mesh_size": 0.06}, r"with mesh_size=0\.\d"),
    ({"max_memory": "1M"}, "raise max_memory= or layer_height="),
])
def test_mistakes(shared_city, settings, words):
    with pytest.raises(tp.UsageError, match=words) as error:
        tp.build_mesh(shared_city, **settings)
    assert "`" not in str(error.value) and "--" not in str(error.value)


def test_messages_name_keywords():
    for message, ours in [("raise `mesh_size`", "raise mesh_size="), ("with `layering` = uniform", "with layering=uniform"),
                          ("add terrain_only for a mesh", "add terrain_only=True for a mesh"),
                          ("a/mesh_size.las: cut", "a/mesh_size.las: cut"), ("the top", "the top"),
                          ("lower min_building_area or give `bounds`", "lower min_building_area= or give bounds=")]:
        assert _core.with_keywords(message) == ours


def test_domain_along_the_wind(data):
    city = tp.build_city(data / "footprints.shp", data, domain="auto", wind_from=240)
    assert len(city.domain_outline) == 4
    x, y = zip(*city.domain_outline)
    assert city.domain == pytest.approx((min(x), min(y), max(x), max(y)), abs=1e-6)
    mesh = tp.build_mesh(city, mesh_size=10, far_size=40)
    numbers = {name: number for number, name in mesh.boundary.patches.items()}
    assert all((mesh.boundary.patch == numbers[name]).any() for name in ("inlet", "outlet", "side_left", "side_right"))
    assert not (mesh.boundary.patch == numbers["xmin"]).any()


def test_the_top_follows_raised_roofs(data):
    city = tp.build_city(data / "footprints.shp", data, domain="auto", lod="block")
    before = tp.build_mesh(city, mesh_size=20, far_size=80).quality["top"]
    city.h_roof[0] += 40
    height = city.h_roof[0] - city.h_ground[0]
    after = tp.build_mesh(city, mesh_size=20, far_size=80).quality["top"]
    assert after == pytest.approx(city.h_roof.max() + 5 * height, abs=0.01) and after > before + 100


def test_a_polygon_domain_counts_what_it_holds(data, tmp_path):
    whole = tp.build_city(data / "footprints.shp", data)
    xmin, ymin, xmax, ymax = whole.domain
    middle = (xmin + xmax) / 2
    ring = [[xmin, ymin], [middle - 30, ymin], [middle + 30, ymax], [xmin, ymax], [xmin, ymin]]
    polygon = tmp_path / "domain.geojson"
    polygon.write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": whole.crs}},
        "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]}))
    city = tp.build_city(data / "footprints.shp", data, domain=str(polygon))
    report = city.report["city"]
    assert 0 < len(city) < len(whole)
    assert report["roofs"]["parts"] == len(city.parts) < len(whole.parts)
    # Buildings too close to the sides are left out late; most are not read at all.
    assert report["volume_after"] == pytest.approx(report["volume_before"], rel=0.1)
    reasons = [dropped["reason"] for dropped in report["dropped"]]
    assert report["account"]["outside"] == reasons.count("outside the domain") > 0
