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
    city.h_roof[0] = city.h_ground[0] + 0.5
    with pytest.raises(tp.InputError, match="building b1 has a roof that goes down to"):
        tp.build_mesh(city)
