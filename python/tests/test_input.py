"""Footprints and points in every form give the city of the files."""
import pathlib

import geopandas
import laspy
import numpy as np
import pytest
import shapely

import tetropolis as tp


def same(a, b):
    return (a.source_ids == b.source_ids and np.array_equal(a.h_roof, b.h_roof) and
            np.array_equal(a.terrain.values, b.terrain.values) and a.crs == b.crs and
            [f.wkb for f in a.footprints] == [f.wkb for f in b.footprints])


@pytest.fixture(scope="module")
def frame(data):
    return geopandas.read_file(data / "footprints.shp")


@pytest.fixture(scope="module")
def las(data):
    return laspy.read(data / "points.laz")


def test_paths(data, shared_city):
    for footprints, points in [(str(data / "footprints.shp"), str(data)),
                               (data / "footprints.shp", [data / "points.laz"]),
                               (pathlib.Path(data), str(data / "*.laz"))]:
        assert same(tp.build_city(footprints, points, id_attribute="id"), shared_city)


def test_geodataframe(frame, data, shared_city):
    assert same(tp.build_city(frame, data, id_attribute="id"), shared_city)


def test_geodataframe_in_degrees(frame, data, shared_city):
    city = tp.build_city(frame.to_crs(4326), data, id_attribute="id")
    assert city.crs == shared_city.crs
    assert city.source_ids == shared_city.source_ids
    assert np.allclose(city.h_roof, shared_city.h_roof, atol=0.05)


def test_index_names_features(frame, data, shared_city):
    renamed = frame.set_index("h" + frame["id"].astype(str))
    city = tp.build_city(renamed, data)
    assert city.source_ids == [["h" + name for name in names] for names in shared_city.source_ids]


def test_series_and_geometries(frame, data, shared_city):
    numbers = [[str(frame.index[frame["id"] == name][0]) for name in names] for names in shared_city.source_ids]
    for footprints in (frame.geometry, list(frame.geometry), frame.geometry.to_numpy(),
                       shapely.GeometryCollection(list(frame.geometry))):
        city = tp.build_city(footprints, data, footprints_crs=shared_city.crs)
        assert np.array_equal(city.h_roof, shared_city.h_roof)
        if not isinstance(footprints, shapely.GeometryCollection):
            assert city.source_ids == numbers


def test_heights_of_a_column(frame, data):
    frame = frame.assign(tall="40 m")
    frame.loc[0, "tall"] = None
    heights = tp.build_city(frame, data, height_attribute="tall").raw._model.attribute_height
    assert set(heights[1:]) == {40} and np.isnan(heights[0])


def test_missing_and_empty_geometries_are_dropped(frame, data):
    frame = frame.copy()
    frame.loc[0, "geometry"] = None
    frame.loc[1, "geometry"] = shapely.Polygon()
    dropped = tp.build_city(frame, data).dropped.set_index("source_id")["reason"]
    assert {"0", "1"} <= set(dropped.index)


def test_las_data(las, data, shared_city):
    assert same(tp.build_city(data / "footprints.shp", las, id_attribute="id"), shared_city)


def test_arrays(las, data, shared_city):
    for xyz in (las.xyz, np.asfortranarray(las.xyz), las.xyz.tolist()):
        city = tp.build_city(data / "footprints.shp", xyz, classification=las.classification, id_attribute="id")
        assert same(city, shared_city)


def test_unclassified_arrays_find_their_ground(las, data, shared_city):
    city = tp.build_city(data / "footprints.shp", las.xyz, id_attribute="id")
    assert "ground_filtered" in [notice.code for notice in city.warnings]
    assert city.source_ids == shared_city.source_ids
    assert np.allclose(city.h_roof, shared_city.h_roof, atol=0.5)


def test_withheld_noise_and_nan_are_left_out(las, data, shared_city):
    extra = np.array([[*las.xyz[0, :2], 500.0], [*las.xyz[1, :2], -50.0], [np.nan, 0, 0]])
    classes = np.concatenate([np.asarray(las.classification), [18, 7, 2]]).astype(np.uint8)
    city = tp.build_city(data / "footprints.shp", np.vstack([las.xyz, extra]), classification=classes,
                         id_attribute="id")
    assert same(city, shared_city)
    assert ("points_not_finite", 1) in [(notice.code, notice.count) for notice in city.warnings]


def test_terrain_only(data):
    city = tp.build_city(None, data, terrain_only=True)
    assert len(city) == 0
    assert tp.build_mesh(city, mesh_size=50).n_cells > 0


@pytest.mark.parametrize("footprints, points, settings, kind, words", [
    ("nothing.shp", "points", {}, tp.InputError, "nothing.shp"),
    ("frame", "nothing", {}, tp.InputError, "nothing"),
    ("frame", "points", {"id_attribute": "idd"}, tp.InputError, "has no attribute 'idd'; it has: id"),
    ("frame", "points", {"classification": [1]}, tp.UsageError, "classification"),
    ("frame", np.zeros((5, 2)), {}, tp.UsageError, "(5, 2)"),
    ("frame", np.zeros((5, 3)), {"classification": [1, 2]}, tp.UsageError, "classification"),
    ("frame", np.zeros((2, 3)), {"classification": [1, 300]}, tp.UsageError, "0 to 255"),
    ("frame", "abc".split, {}, tp.UsageError, "points"),
    (17, "points", {}, tp.UsageError, "footprints"),
    (None, "points", {}, tp.UsageError, "missing: footprints="),
    ("frame", "points", {"id_atribute": "id"}, tp.UsageError, "did you mean 'id_attribute'?"),
    ("frame", "points", {"dtm_step": -1}, tp.UsageError, "dtm_step: -1 is less than 0.01"),
    ("frame", "points", {"bounds": (0, 0, 1)}, tp.UsageError, "bounds: four numbers expected"),
    ("frame", "points", {"points_crs": "EPSG:4326"}, tp.InputError, "degrees"),
    ("frame", np.zeros((0, 3)), {}, tp.InputError, "no points"),
])
def test_mistakes(frame, data, footprints, points, settings, kind, words):
    footprints = frame if isinstance(footprints, str) and footprints == "frame" else footprints
    points = data if isinstance(points, str) and points == "points" else points
    with pytest.raises(kind) as error:
        tp.build_city(footprints, points, **settings)
    assert words in str(error.value)
    assert "\n" not in str(error.value)
    assert isinstance(error.value, ValueError) == (kind is tp.UsageError)


def test_mistakes_with_data_in_memory(frame, las, data):
    """What is wrong with files is wrong beside data in memory, too."""
    with pytest.raises(tp.UsageError, match="points.*dsm"):
        tp.build_city(frame, las, dsm=data / "points.laz")
    with pytest.raises(tp.UsageError, match="swap"):
        tp.build_city(las, frame)
    with pytest.raises(tp.UsageError, match="point cloud"):
        tp.build_city(data / "points.laz", las)


def test_areas_in_memory(shared_city, tmp_path):
    """Areas make the mesh that files of them make, whatever system they are in."""
    x, y = shared_city.origin
    boxes = [shapely.box(x + a, y + b, x + a + 90, y + b + 60) for a, b in ((20, 20), (150, 180))]
    frame = geopandas.GeoDataFrame({"what": ["water", "road"], "tall": [6.5, 9]}, geometry=boxes, crs=shared_city.crs)
    file = tmp_path / "areas.gpkg"
    frame.to_file(file)
    from_files = tp.build_mesh(shared_city, refine=[f"{file}:4"], surface_layers=f"{file}:what", canopies=[f"{file}:tall"])
    assert from_files.zones == ["canopy_1", "canopy_2"]
    pairs = {"refine": (frame, 4), "surface_layers": (frame, "what"), "canopies": (frame, "tall")}
    for given in (pairs, {name: [pair] for name, pair in pairs.items()}, pairs | {"refine": (boxes, np.float64(4))}):
        mesh = tp.build_mesh(shared_city, **given)
        assert mesh.boundary.patches == from_files.boundary.patches and mesh.zones == from_files.zones
        assert np.array_equal(mesh.points, from_files.points) and np.array_equal(mesh.zone, from_files.zone)
    trees = tp.build_mesh(shared_city, canopies=[(frame.geometry[:1], 6.5), (boxes[1], 9)])
    assert [(zone["name"], zone["height"]) for zone in trees.report["canopies"]] == [("canopy_1", 6.5), ("canopy_2", 9)]
    degrees = tp.build_mesh(shared_city, refine=(frame.to_crs("EPSG:4326"), 4), surface_layers=(frame.to_crs(4326), "what"))
    assert degrees.boundary.patches == from_files.boundary.patches
    assert abs(degrees.n_cells / from_files.n_cells - 1) < 0.1
    for wrong in ({"surface_layers": (frame, "which")}, {"refine": 4}, {"refine": [(4, 4)]}, {"canopies": [frame, 3]}):
        with pytest.raises((tp.UsageError, tp.InputError), match="|".join(wrong)):
            tp.build_mesh(shared_city, **wrong)


def test_planned_in_memory(data, shared_city, tmp_path):
    """A plan in memory makes the city that a file of it makes."""
    x, y = shared_city.footprints[0].exterior.coords[0]
    shapes = [shapely.box(x - 30, y - 30, x - 5, y - 5), shapely.box(x + 8, y + 8, x + 30, y + 20)]
    frame = geopandas.GeoDataFrame({"tall": [25.0, 25.0], "name": ["a", "b"]}, geometry=shapes, crs=shared_city.crs)
    file = tmp_path / "plan.gpkg"
    frame.rename(columns={"tall": "height"}).to_file(file)
    build = lambda planned, **more: tp.build_city(data / "footprints.shp", data, id_attribute="id", planned=planned, **more)
    expected = build(file)
    planned = [i for i, flags in enumerate(expected.raw.flags) if "planned" in flags]
    assert np.allclose((expected.raw.h_roof - expected.raw.h_ground)[planned], 25, atol=0.01)
    assert np.isclose(sum(expected.raw.footprints[i].area for i in planned), 625 + 264, atol=0.1)
    for given in ((shapes, 25), [(one, np.float32(25)) for one in shapes], (frame, "tall"), frame.rename(columns={"tall": "height"}),
                  frame.to_crs(4326).rename(columns={"tall": "height"}), str(file), [file]):
        city = build(given)
        assert np.allclose(city.h_roof, expected.h_roof, atol=0.02) and len(city) == len(expected)
        assert len(city.dropped) == len(expected.dropped)
    frame.to_file(file)
    assert np.array_equal(build(f"{file}:tall").h_roof, expected.h_roof)
    for wrong in ((frame, "size"), frame, shapes, 4, (shapes, -3)):
        with pytest.raises((tp.UsageError, tp.InputError), match="planned|no height"):
            build(wrong)


def test_domain_in_memory(data):
    x, y = tp.build_city(data / "footprints.shp", data).origin
    area = shapely.Polygon([(x + 40, y + 30), (x + 250, y + 60), (x + 230, y + 240), (x + 60, y + 200)])
    for given in (area, geopandas.GeoSeries([area], crs="EPSG:3006"), geopandas.GeoSeries([area], crs="EPSG:3006").to_crs(4326)):
        city = tp.build_city(data / "footprints.shp", data, domain=given)
        found = shapely.Polygon(city.domain_outline)
        assert found.symmetric_difference(area).area < 0.01 * area.area
        assert not any("crs" in notice.code for notice in city.warnings), city.warnings
