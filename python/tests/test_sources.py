"""Cities without points."""
import numpy as np
import pytest

import tetropolis as tp

shapely = pytest.importorskip("shapely")
geopandas = pytest.importorskip("geopandas")


@pytest.fixture
def houses():
    boxes = [shapely.box(500000 + x, 5000000, 500020 + x, 5000020) for x in (0, 60, 120)]
    return geopandas.GeoDataFrame({"height": [12.0, np.nan, 7.5]}, geometry=boxes, crs="EPSG:32631")


def heights(city):
    return sorted(np.round(city.h_roof - city.h_ground, 3))


def test_stated_heights_on_level_ground(houses):
    with pytest.warns(UserWarning):
        city = tp.build_city(houses, height_attribute="height", default_height=5, ground_level=30)
    assert heights(city) == [5, 7.5, 12]
    assert set(city.h_ground) == {30}


def test_several_files_and_a_terrain(houses, tmp_path):
    for name in ("a", "b"):
        houses.iloc[[0]].translate(yoff=0 if name == "a" else 80).to_file(tmp_path / f"{name}.geojson")
    (tmp_path / "dtm.asc").write_text("ncols 30\nnrows 30\nxllcorner 499900\nyllcorner 4999900\ncellsize 10\n"
                                      + "\n".join(" ".join(["42.5"] * 30) for _ in range(30)))
    with pytest.warns(UserWarning):
        city = tp.build_city([tmp_path / "a.geojson", tmp_path / "b.geojson"], dtm=tmp_path / "dtm.asc",
                             raster_crs="EPSG:32631")
    assert {s for ids in city.source_ids for s in ids} == {"a:0", "b:0"}
    assert set(city.h_ground) == {42.5}


def test_attributes_mean_what_they_mean_in_files(houses, tmp_path):
    houses["building"] = "yes"
    houses["building:levels"] = [4, 2, 3]
    houses["location"] = ["underground", None, None]
    houses["listed"] = [True, False, True]
    houses.to_file(tmp_path / "houses.gpkg")
    for settings in ({}, {"where": "\"building:levels\" > 2"}, {"floors_attribute": "building:levels"}):
        with pytest.warns(UserWarning):
            frame, file = (tp.build_city(of, **settings) for of in (houses, tmp_path / "houses.gpkg"))
        assert heights(frame) == heights(file) and len(frame.dropped) == len(file.dropped), settings
        assert list(frame.dropped["reason"]) == list(file.dropped["reason"])


def test_lists_of_files_and_systems_of_arrays(houses, tmp_path):
    houses.to_file(tmp_path / "houses.geojson")
    with pytest.raises(tp.UsageError, match="points: is an empty list"):
        tp.build_city(houses, sorted(tmp_path.glob("*.laz")))
    with pytest.warns(UserWarning):
        assert len(tp.build_city(tmp_path.glob("*.geojson"))) == len(tp.build_city(houses.geometry.values)) == 3
        assert tp.build_city(houses.geometry.values).crs == "EPSG:32631"
        assert len(tp.build_city(houses.iloc[:0], terrain_only=np.bool_(True), bounds=houses.total_bounds)) == 0
