"""Other packages take the results."""
import meshio
import numpy as np
import pytest
import pyvista

import tetropolis as tp


def test_pyvista(mesh):
    grid = mesh.to_pyvista()
    assert grid.n_cells == mesh.n_cells and grid.n_points == mesh.n_points
    assert grid.volume == pytest.approx(mesh.quality["volume"])
    assert tuple(grid.field_data["origin"]) == mesh.origin
    assert np.array_equal(grid["region"], mesh.region)
    absolute = mesh.to_pyvista("absolute")
    assert np.allclose(absolute.points, mesh.points + mesh.origin)
    surface = mesh.boundary.to_pyvista()
    assert surface.is_manifold and surface.n_open_edges == 0
    assert surface.volume == pytest.approx(mesh.quality["volume"])
    # What PyVista is told to change is its own.
    patches, regions = set(mesh.boundary.patch), set(mesh.region)
    grid["region"][:] = 5
    surface["patch"][:] = surface["building"][:] = 1
    assert set(mesh.boundary.patch) == patches and set(mesh.region) == regions and min(mesh.boundary.building) == -1
    with pytest.raises(ValueError, match="local, absolute"):
        mesh.to_pyvista("global")


def test_meshio(mesh, tmp_path):
    ours = mesh.to_meshio()
    mesh.save(tmp_path / "city.xdmf")
    read = meshio.read(tmp_path / "city.xdmf")
    assert np.array_equal(read.points, ours.points)
    assert np.array_equal(read.cells_dict["tetra"], ours.cells_dict["tetra"])
    assert np.array_equal(read.cell_data["region"][0], ours.cell_data["region"][0])
    ours.write(tmp_path / "again.vtk")
    assert len(meshio.read(tmp_path / "again.vtk").cells_dict["tetra"]) == mesh.n_cells
    assert len(mesh.boundary.to_meshio().cells_dict["triangle"]) == len(mesh.boundary.triangles)


@pytest.mark.parametrize("settings", [{"boundary_layers": 3}, {"cells": "prisms"}])
def test_prisms_are_those_of_the_file(shared_city, settings, tmp_path):
    mesh = tp.build_mesh(shared_city, **settings)
    mesh.save(tmp_path / "city.xdmf")
    read, ours = meshio.read(tmp_path / "city.xdmf"), mesh.to_meshio()
    assert [block.type for block in read.cells] == [block.type for block in ours.cells]
    for theirs, own in zip(read.cell_data["region"], ours.cell_data["region"]):
        assert np.array_equal(theirs, own)
    assert np.array_equal(mesh.to_pyvista()["region"], np.concatenate(read.cell_data["region"]))
    volumes = mesh.to_pyvista().compute_cell_sizes()["Volume"]
    assert volumes.min() > 0 and volumes.sum() == pytest.approx(mesh.quality["volume"])
    # Layers lie on open ground; where all cells are prisms some stand over roofs.
    over_roofs = (mesh.region[len(mesh.cells):] >= 0).any()
    assert len(mesh.wedges) > 0 and over_roofs == ("cells" in settings)


def test_coordinates_and_compression_of_files(mesh, tmp_path):
    mesh.save(tmp_path / "local.vtu")
    mesh.save(tmp_path / "crs.vtu", coordinates="absolute", compression="zlib")
    local, absolute = pyvista.read(tmp_path / "local.vtu"), pyvista.read(tmp_path / "crs.vtu")
    assert np.allclose(absolute.points, local.points + mesh.origin)
    assert (tmp_path / "crs.vtu").stat().st_size < 0.7 * (tmp_path / "local.vtu").stat().st_size
    with pytest.raises(ValueError, match="end it in .vtu"):
        mesh.save(tmp_path / "city.doc")
    with pytest.raises(ValueError, match="coordinates: 'global' is not one of local, absolute"):
        mesh.save(tmp_path / "city.xdmf", coordinates="global")


def test_explore(shared_city):
    page = shared_city.to_geopandas().explore("h_roof").get_root().render()
    assert "h_roof" in page and shared_city.ids[0] in page
