"""Arrays: what is shared, what is owned, and that they say the same as the library's report."""
import gc
import json
import re
import weakref

import numpy as np
import pytest

import tetropolis as tp


def volumes(points, cells):
    p0, p1, p2, p3 = (points[cells[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(p1 - p0, p2 - p0), p3 - p0) / 6


def test_cells_are_positive_and_fill_the_domain(mesh):
    sizes = volumes(mesh.points, mesh.cells)
    assert sizes.min() > 0
    assert sizes.sum() == pytest.approx(mesh.quality["volume"], rel=1e-12)
    assert mesh.points.shape == (mesh.n_points, 3) and mesh.points.dtype == np.float64
    assert mesh.cells.shape == (mesh.n_cells, 4) and mesh.cells.dtype == np.int64
    assert mesh.region.shape == (mesh.n_cells,) and mesh.region.dtype == np.int32
    assert mesh.points is mesh.points  # made once


def test_blocks_are_the_whole(mesh):
    for size in (1, 1000, 10**9):
        numbers = [(first, len(cells)) for first, cells, _ in mesh.cell_blocks(size)]
        assert numbers[0][0] == 0
        assert all(a + n == b for (a, n), (b, _) in zip(numbers, numbers[1:]))
        assert sum(numbers[-1]) == mesh.n_cells
    blocks = list(mesh.cell_blocks(1000))
    assert np.array_equal(np.vstack([cells for _, cells, _ in blocks]), mesh.cells)
    assert np.array_equal(np.concatenate([region for *_, region in blocks]), mesh.region)
    assert max(len(cells) for _, cells, _ in blocks) <= 1000
    with pytest.raises(tp.UsageError, match="size: 0"):
        next(mesh.cell_blocks(0))


def test_boundary(mesh):
    surface = mesh.boundary
    faces = np.sort(surface.node[surface.triangles], axis=1)
    cells = np.sort(mesh.cells[surface.cell], axis=1)
    assert all(np.isin(face, cell).all() for face, cell in zip(faces[::97], cells[::97]))
    assert np.array_equal(mesh.points[surface.node], surface.points)
    solid = np.isin(surface.patch, [2, 3])
    assert (surface.building[solid] >= 0).all() and (surface.building[~solid] == -1).all()
    names = {name: int((surface.patch == number).sum()) for number, name in surface.patches.items()}
    assert names == mesh.report["surface_mesh"]["faces_by_patch"]
    a, b, c = (surface.points[surface.triangles[:, i]] for i in range(3))
    enclosed = np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6
    assert enclosed == pytest.approx(mesh.quality["volume"], rel=1e-9)  # outward normals
    assert set(np.unique(mesh.surface.patch)) == {1, 2, 3}
    turned = mesh.surface.points[mesh.surface.triangles[mesh.surface.patch == 1]]
    assert (np.cross(turned[:, 1] - turned[:, 0], turned[:, 2] - turned[:, 0])[:, 2] > 0).all()  # into the air


def test_ground_and_columns(mesh):
    ground = mesh.ground
    n = len(ground.column_z)  # points above the lid come after those of columns
    assert n == ground.column_first[-1] < mesh.n_points
    assert np.array_equal(ground.column_z, mesh.points[:n, 2])
    repeated = np.repeat(ground.vertices, np.diff(ground.column_first), axis=0)
    assert np.array_equal(repeated, mesh.points[:n, :2])
    assert ground.building.max() == mesh.region.max()
    a, b, c = (ground.vertices[ground.triangles[:, i]] for i in range(3))
    assert ((b - a)[:, 0] * (c - a)[:, 1] > (b - a)[:, 1] * (c - a)[:, 0]).all()


def test_core_memory_is_shared_and_read_only(mesh, city):
    for owner, name in [(mesh.boundary, "points"), (mesh.boundary, "triangles"), (mesh.boundary, "patch"),
                        (mesh.boundary, "building"), (mesh.boundary, "node"), (mesh.boundary, "cell"),
                        (mesh.ground, "vertices"), (mesh.ground, "triangles"), (mesh.ground, "column_z"),
                        (mesh.ground, "column_first")]:
        assert np.shares_memory(getattr(owner, name), getattr(owner, name)), name
        assert not getattr(owner, name).flags.writeable, name
    for owner, name in [(city, "h_roof"), (city, "h_ground"), (city.terrain, "values")]:
        assert np.shares_memory(getattr(owner, name), getattr(owner, name)), name
        assert getattr(owner, name).flags.writeable, name


def test_arrays_outlive_their_objects(data):
    city = tp.build_city(data / "footprints.shp", data)
    mesh = tp.build_mesh(city, mesh_size=30)
    roofs, values, cells, points = city.h_roof, city.terrain.values, mesh.cells, mesh.boundary.points
    copies = [array.copy() for array in (roofs, values, cells, points)]
    del city, mesh
    gc.collect()
    junk = [np.full(10**6, 7.0) for _ in range(20)]  # over memory that was freed, if any was
    assert junk and all(np.array_equal(a, b) for a, b in zip((roofs, values, cells, points), copies))


def test_objects_are_freed(data):
    city = tp.build_city(data / "footprints.shp", data)
    mesh = tp.build_mesh(city, mesh_size=30)
    _ = mesh.cells, mesh.boundary.points, city.h_roof, mesh.surface.points
    dead = [weakref.ref(city), weakref.ref(mesh), weakref.ref(city.terrain)]
    del city, mesh, _
    gc.collect()
    assert [reference() for reference in dead] == [None, None, None]


def test_terrain_is_georeferenced(city):
    terrain = city.terrain
    a, b, c, d, e, f = terrain.transform
    row, column = 30, 40
    x, y = a * (column + 0.5) + b * (row + 0.5) + c, d * (column + 0.5) + e * (row + 0.5) + f
    assert terrain.sample(x, y) == terrain.values[row, column]
    assert terrain.sample([x, x + terrain.step / 2], y)[1] == pytest.approx(terrain.values[row, column:column + 2].mean())
    assert np.array_equal(np.isnan(terrain.sample([x, np.nan, x], [y, y, np.nan])), [False, True, True])
    xmin, ymin, xmax, ymax = city.domain
    assert c < xmin and f > ymax
    assert (a, e) == (terrain.step, -terrain.step)


def test_geopandas(city):
    frame = city.to_geopandas()
    assert len(frame) == len(city) and frame.crs == city.crs
    assert frame.is_valid.all() and frame.exterior.is_ccw.all()
    xmin, ymin, xmax, ymax = city.domain
    assert frame.total_bounds[0] >= xmin and frame.total_bounds[3] <= ymax
    assert np.array_equal(frame["h_roof"], city.h_roof)
    assert frame["source_ids"].tolist() == [",".join(ids) for ids in city.source_ids]
    assert len(city.raw) >= len(city)
    merged = sum(len(ids) for ids in city.source_ids) + len(city.dropped)
    assert merged == city.report["input"]["footprint_parts"]


def test_prisms_alone_are_improved(tmp_path):
    """On this relief prisms as they are laid have a skewness above 1.9."""
    tp.synth(tmp_path, kind="blocks", size=300, roofs="sloped", seed=8, relief=60)
    city = tp.build_city(tmp_path / "footprints.shp", tmp_path)
    mesh = tp.build_mesh(city, cells="prisms", boundary_layers=5)
    assert mesh.quality["columns_improved"] > 0
    assert mesh.quality["prisms"]["skewness"]["max"] < 1.9
    # Tets above layers keep the columns that were improved for them.
    layered, plain = (tp.build_mesh(city, boundary_layers=n).quality["columns_improved"] for n in (5, 0))
    assert (layered > 0) == (plain > 0)


def test_canopies(shared_city, tmp_path):
    """Trees of the whole domain, by the vegetation that the points measure, and of a stated height."""
    x, y = shared_city.origin
    polygon = [[[x - 1e3, y - 1e3], [x + 2e3, y - 1e3], [x + 2e3, y + 2e3], [x - 1e3, y + 2e3], [x - 1e3, y - 1e3]]]
    trees = tmp_path / "trees.geojson"
    trees.write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3006"}},
        "features": [{"type": "Feature", "properties": {"h": 6}, "geometry": {"type": "Polygon", "coordinates": polygon}}]}))
    for canopies in (f"{trees}:h", str(trees)):
        mesh = tp.build_mesh(shared_city, canopies=[canopies], boundary_layers=2)
        zones = mesh.report["canopies"]
        assert mesh.zones == ["canopy_1"] == [zone["name"] for zone in zones]
        height = zones[0]["height"]
        assert height == 6 if canopies.endswith(":h") else 2 < height < 30
        assert mesh.zone.shape == (mesh.n_cells,) and (mesh.zone == 1).sum() == zones[0]["cells"] > 0
        # Over open ground all cells are in it that are below its top.
        middles = mesh.points[mesh.wedges].mean(axis=1)
        assert (mesh.zone[len(mesh.cells):] == 1).all() and len(middles) > 0
        assert not mesh.zone[mesh.region >= 0].any()
    bare = tp.build_mesh(shared_city)
    assert not bare.zone.any()
    # Zones over buildings have the cells of `region`.
    bare.save(tmp_path / "constant/polyMesh", building_zones=True)
    over = dict(re.findall(r"over_(\w+)\s*\{[^}]*List<label>\s*\d+\s*\(([^)]*)\)",
                           (tmp_path / "constant/polyMesh/cellZones").read_text()))
    for b, building in enumerate(shared_city.ids):
        assert list(map(int, over[building].split())) == np.flatnonzero(bare.region == b).tolist()
