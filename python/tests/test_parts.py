"""Roofs in parts: tables, edits, files."""
import json

import numpy as np
import pytest

import tetropolis as tp

pytest.importorskip("geopandas")


@pytest.fixture(scope="module")
def houses(shared_city, tmp_path_factory):
    """Folder with a city of two houses with a gable each, as another program might write it, and terrain."""
    folder = tmp_path_factory.mktemp("parts")
    shared_city.save(folder / "dtm.tif")
    vertices, objects = [], {}

    def house(name, x, height):
        first = len(vertices)
        corners = [(x, 40), (x + 12, 40), (x + 12, 48), (x, 48)]
        vertices.extend([(u, v, 20) for u, v in corners] + [(u, v, height) for u, v in corners] +
                        [(x, 44, height + 2), (x + 12, 44, height + 2)])
        faces = [[0, 3, 2, 1], [4, 5, 9, 8], [6, 7, 8, 9], [0, 1, 5, 4], [1, 2, 6, 9, 5], [2, 3, 7, 6],
                 [3, 0, 4, 8, 7]]
        objects[name] = {"type": "Building", "geometry": [{
            "type": "Solid", "lod": "2.2", "boundaries": [[[[first + v for v in face]] for face in faces]],
            "semantics": {"surfaces": [{"type": "GroundSurface"}, {"type": "RoofSurface"}, {"type": "WallSurface"}],
                          "values": [[0, 1, 1, 2, 2, 2, 2]]}}]}

    house("east", 60, 26)
    house("west", 20, 29)
    (folder / "houses.city.json").write_text(json.dumps({
        "type": "CityJSON", "version": "2.0",
        "transform": {"scale": [1, 1, 1], "translate": [*shared_city.origin, 0]},
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/3006"},
        "CityObjects": objects, "vertices": vertices}))
    return folder


@pytest.fixture
def city(houses):
    return tp.read_city(houses / "houses.city.json", houses / "dtm.tif")


def test_tables(city):
    parts = city.parts
    assert parts["id"].tolist() == ["b1", "b1", "b2", "b2"] and parts["building"].tolist() == [0, 0, 1, 1]
    assert parts["source_id"].tolist() == ["east", "east", "west", "west"] and set(parts["lod"]) == {"2.2"}
    assert np.allclose(parts["slope"], np.degrees(np.arctan(0.5)), atol=0.01)
    assert parts["azimuth"].tolist() == [180, 0, 180, 0] and np.isnan(parts["rmse"]).all()
    assert np.allclose(parts["h_min"], [26, 26, 29, 29]) and np.allclose(parts["h_max"], [28, 28, 31, 31])
    frame = city.to_geopandas(parts=True)
    assert np.allclose(frame.area, 48) and np.allclose(frame.area, parts["area"]) and frame.crs == "EPSG:3006"
    x, y = city.origin
    assert frame.geometry.iloc[0].bounds == (x + 60, y + 40, x + 72, y + 44)
    assert len(city.to_geopandas()) == 2


def test_roofs_rise_with_their_height(houses, city, tmp_path):
    city.h_roof[1] += 10
    assert np.allclose(city.parts["h_max"], [28, 28, 41, 41])
    city.save(tmp_path / "edited.city.json")
    again = tp.read_city(tmp_path / "edited.city.json", houses / "dtm.tif")
    assert again.parts.drop(columns="rmse").equals(city.parts.drop(columns="rmse"))
    city.h_roof[0] = city.h_ground[0]
    with pytest.raises(tp.InputError, match="b1"):
        tp.build_mesh(city)


def test_roofs_of_a_model_survive_the_merge(houses, tmp_path):
    """Without terrain, and with walls closer than cells allow, a model is simplified as footprints are."""
    model = json.loads((houses / "houses.city.json").read_text())
    (tmp_path / "apart.city.json").write_text(json.dumps(model))
    apart = tp.read_city(tmp_path / "apart.city.json")
    for vertex in model["vertices"]:
        if vertex[0] >= 60:  # east of the other house's wall
            vertex[0] -= 28
    (tmp_path / "row.city.json").write_text(json.dumps(model))
    row = tp.read_city(tmp_path / "row.city.json")
    assert len(apart) == 2 and len(row) == 1
    for city in apart, row:
        parts = city.parts.groupby("source_id")
        assert np.allclose(city.parts["slope"], np.degrees(np.arctan(0.5)), atol=1)
        for name, ridge in ("east", 28), ("west", 31):
            part = parts.get_group(name)
            assert len(part) == 2 and np.isclose(part["area"].sum(), 96, atol=1)
            assert np.allclose(part["h_max"], ridge, atol=0.1) and np.allclose(part["h_min"], ridge - 2, atol=0.1)
        assert "roof_from_attribute" in city.flags[0]
        tp.build_mesh(city, mesh_size=20)


def edges_of_solids(path):
    """How many faces have each edge of each solid."""
    for key, building in json.loads(path.read_text())["CityObjects"].items():
        for geometry in building["geometry"]:
            count = {}
            for face in geometry["boundaries"][0]:
                for ring in face:
                    for edge in zip(ring, ring[1:] + ring[:1]):
                        count[frozenset(edge)] = count.get(frozenset(edge), 0) + 1
            yield key, geometry["lod"], set(count.values())


def test_stated_heights_make_manifold_solids(tmp_path):
    """Four footprints around a corner, two high and two low ones: walls must not share a line."""
    geopandas = pytest.importorskip("geopandas")
    shapely = pytest.importorskip("shapely")
    boxes = [shapely.box(x, y, x + 20, y + 20) for y in (447000, 447020) for x in (85000, 85020)]
    frame = geopandas.GeoDataFrame({"h": [10.0, 5.0, 5.0, 10.0]}, geometry=boxes, crs=28992)
    city = tp.build_city(frame, height_attribute="h")
    assert sorted(set(city.parts["h_max"])) == [5, 10]
    city.save(tmp_path / "city.city.json")
    for key, lod, counts in edges_of_solids(tmp_path / "city.city.json"):
        assert counts == {2}, (key, lod, counts)
    assert tp.build_mesh(city).quality["roofs_lifted"] == 0


def test_a_column_named_height_has_heights():
    geopandas = pytest.importorskip("geopandas")
    shapely = pytest.importorskip("shapely")
    boxes = [shapely.box(x, 447000, x + 20, 447020) for x in (85000, 85050)]
    city = tp.build_city(geopandas.GeoDataFrame({"Height": [12.0, 7.5]}, geometry=boxes, crs=28992))
    frame = city.to_geopandas()
    assert frame["height"].tolist() == [12, 7.5]
    assert "height_assumed" in [warning.code for warning in city.warnings]
    assert tp.build_city(frame).to_geopandas()["height"].tolist() == [12, 7.5]


def test_roofs_can_be_lowered(city):
    for share in 0.5, 0.2:
        lower = city.copy()
        lower.h_roof[:] = city.h_ground + share * (city.h_roof - city.h_ground)
        mesh = tp.build_mesh(lower, mesh_size=20)
        assert (lower.parts["h_min"] >= np.minimum(2.5, (lower.h_roof - lower.h_ground).min()) - 1e-3 + 20).all()
        assert len(mesh.cells) > 0
