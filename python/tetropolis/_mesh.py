"""Volume meshes and their boundary."""
from __future__ import annotations

import os
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from . import _core
from ._areas import areas_as_files
from ._city import City
from ._errors import UsageError
from ._report import Progress, Reported, following
from ._settings import takes_settings
from ._show import show

if TYPE_CHECKING:
    import meshio
    import pyvista
    from typing_extensions import Unpack

    from ._render import Picture
    from ._settings import BuildMesh, Save

Coordinates = Literal["local", "absolute"]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Longs = npt.NDArray[np.int64]


def _shift(origin: tuple[float, float, float], coordinates: str) -> Floats:
    if coordinates not in ("local", "absolute"):
        raise UsageError(f"coordinates: '{coordinates}' is not one of local, absolute")
    return np.array(origin if coordinates == "absolute" else (0.0, 0.0, 0.0))


_Array = TypeVar("_Array", bound=npt.NDArray[Any])


def _read_only(array: _Array) -> _Array:
    """What is saved is the mesh itself: changes of a copy would be lost."""
    array.flags.writeable = False
    return array


class Surface:
    """Tagged triangles of a mesh. All arrays are the library's own memory, read-only."""

    def __init__(self, core: _core.Surface, mesh: _core.Mesh, crs: str) -> None:
        self._core = core
        self._mesh = mesh
        self.origin = mesh.origin  #: Zero of `points` in the CRS: x, y, elevation.
        self.crs = crs  #: "EPSG:28992", or WKT, or "" if unknown.

    @property
    def points(self) -> Floats:
        """Metres in the local frame, shape (n, 3)."""
        return self._core.points

    @property
    def triangles(self) -> Ints:
        """Positions in `points`, shape (m, 3). Normals of `mesh.boundary` leave the meshed air, those of
        `mesh.surface` point into it."""
        return self._core.triangles

    @property
    def quads(self) -> Ints:
        """Positions of triangles that are, with the next one, the halves of one quadrilateral, ascending: sides of
        prisms, in `mesh.boundary`. Triangles (a, b, c) and (a, c, d) are the face (a, b, c, d)."""
        return self._core.quads

    @property
    def patch(self) -> Ints:
        """Number of each triangle's patch, shape (m,), ascending; `patches` has the names."""
        return self._core.patch

    @property
    def building(self) -> Ints:
        """For roofs and walls the building, by position in the city, else -1; shape (m,)."""
        return self._core.building

    @property
    def node(self) -> Longs:
        """Position of each point in the volume's `points`, shape (n,)."""
        return self._core.node

    @property
    def cell(self) -> Longs:
        """The volume's cell behind each triangle, shape (m,)."""
        return self._core.cell

    @property
    def patches(self) -> dict[int, str]:
        """Names of the patches by number: 1 "ground", 2 "roof", 3 "wall", 4 "top", ..."""
        return self._core.patches

    @takes_settings("save")
    def save(self, path: str | os.PathLike[str], **settings: Unpack[Save]) -> None:
        """Writes a file; the name's end says which: ``.vtp``, ``.stl``, ``.obj``, ``.ply`` or ``.glb``.

        Parameters
        ----------
        path : path
            File.

        Raises
        ------
        UsageError
            No format has this name.
        InputError
            The file cannot be written.
        """
        self._mesh.save_surface(self._core, Path(path), dict(settings))

    def to_pyvista(self, coordinates: Coordinates = "local") -> pyvista.PolyData:
        """With the cell data `patch` and `building`, and the field data `origin`."""
        import pyvista

        mesh = pyvista.PolyData.from_regular_faces(self.points + _shift(self.origin, coordinates), self.triangles)
        # PyVista writes to arrays whatever their flags say, and these are the library's own.
        mesh.cell_data["patch"] = self.patch.copy()
        mesh.cell_data["building"] = self.building.copy()
        mesh.field_data["origin"] = self.origin if coordinates == "local" else (0.0, 0.0, 0.0)
        return mesh

    def to_meshio(self, coordinates: Coordinates = "local") -> meshio.Mesh:
        """With the cell data `patch` and `building`."""
        import meshio

        return meshio.Mesh(self.points + _shift(self.origin, coordinates), [("triangle", self.triangles)],
                           cell_data={"patch": [self.patch.copy()], "building": [self.building.copy()]})

    def __repr__(self) -> str:
        return f"<tetropolis.Surface: {len(self.triangles)} triangles, {len(self.points)} points>"


class GroundMesh:
    """The triangles over which the volume is built. Arrays are the library's own memory, read-only."""

    def __init__(self, core: _core.Mesh) -> None:
        self._core = core

    @property
    def vertices(self) -> Floats:
        """x, y in the local frame, metres, shape (v, 2)."""
        return self._core.ground_vertices

    @property
    def triangles(self) -> Ints:
        """Positions in `vertices`, counter-clockwise, shape (t, 3)."""
        return self._core.ground_triangles

    @property
    def building(self) -> Ints:
        """The building that each triangle lies in, by position in the city, or -1; shape (t,). A copy."""
        return self._core.region_building[self._core.ground_region]

    @property
    def column_first(self) -> Longs:
        """Column v has the nodes from column_first[v] to column_first[v + 1] - 1; shape (v + 1,)."""
        return self._core.column_first

    @property
    def column_z(self) -> Floats:
        """Elevation of the nodes of columns, column by column and upwards, metres; shape (column_first[-1],).

        They are the first of `mesh.points`; nodes above the lid over the city and of prisms follow there.
        """
        return self._core.column_z


class Mesh(Reported):
    """Tetrahedra of the air over a city, and prisms with `boundary_layers`; made by `build_mesh`.

    The library keeps columns of nodes, about 8 bytes a node. `points`, `cells` and `region` are made of them when
    they are first asked for, and kept: some 40 bytes a cell. `cell_blocks` hands out large meshes part by part.

    Attributes
    ----------
    boundary : Surface
        The whole boundary of the volume.
    ground : GroundMesh
        The triangles and columns that the volume is made of.
    crs : str
        "EPSG:28992", or WKT, or "" if unknown.
    """

    def __init__(self, core: _core.Mesh, city: City) -> None:
        self._core = core
        self._text = core.report
        self._city = city._core
        self.crs = city.crs
        self.boundary = Surface(core.boundary, core, city.crs)
        self.ground = GroundMesh(core)

    @property
    def origin(self) -> tuple[float, float, float]:
        """Zero of `points` in the CRS: x, y, elevation."""
        return self._core.origin

    @property
    def n_points(self) -> int:
        return self._core.n_points

    @property
    def n_cells(self) -> int:
        """Tetrahedra and prisms."""
        return self._core.n_cells

    @cached_property
    def points(self) -> Floats:
        """Nodes, metres in the local frame, shape (n_points, 3): those of columns, column by column and upwards, then
        those above the lid over the city and of prisms. Read-only, as all arrays of meshes: copy them to change them."""
        return _read_only(self._core.points())

    @cached_property
    def cells(self) -> Longs:
        """Tetrahedra: positions in `points`, shape (n, 4): (p1 - p0) x (p2 - p0) . (p3 - p0) > 0. All cells, unless
        there are `wedges`, too."""
        return _read_only(self._core.cells(0, self._core.n_rows))

    @cached_property
    def wedges(self) -> Longs:
        """Prisms of `boundary_layers`, numbered after all tetrahedra: positions in `points`, shape (m, 6), a triangle
        and the one above it: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0."""
        return _read_only(self._core.wedges())

    @cached_property
    def region(self) -> Ints:
        """The building whose footprint each cell below the lid over the city stands over, tetrahedra first: by position
        in the city; else -1; shape (n_cells,)."""
        tets: Ints = self._core.regions(0, self._core.n_rows)
        return _read_only(np.concatenate([tets, self._core.regions_of_wedges()]) if len(self.wedges) else tets)

    @cached_property
    def zone(self) -> Ints:
        """The canopy that each cell is in, tetrahedra first: 0 for none, else 1 + its position in `zones`; shape
        (n_cells,)."""
        return self._core.zone if self.zones else np.zeros(self.n_cells, np.int32)

    @property
    def zones(self) -> list[str]:
        """Names of the canopies: "canopy_1", ...; the report has their heights."""
        return self._core.zones

    def cell_blocks(self, size: int = 1_000_000) -> Iterator[tuple[int, Longs, Ints]]:
        """`cells` and `region` (of the tetrahedra) in consecutive parts, for meshes that are too large as a whole.

        Parameters
        ----------
        size : int
            Cells in a part, at most (but all cells over one triangle at least).

        Yields
        ------
        first : int
            Number of the part's first cell.
        cells : ndarray of shape (k, 4)
        region : ndarray of shape (k,)
        """
        if size < 1:
            raise UsageError(f"size: {size} is no number of cells; give 1 or more")
        begin = first = 0
        while begin < self._core.n_rows:
            end = self._core.end_of_block(begin, size)
            cells = self._core.cells(begin, end)
            yield first, cells, self._core.regions(begin, end)
            begin, first = end, first + len(cells)

    @cached_property
    def surface(self) -> Surface:
        """Ground, roofs and walls, to look at: without the domain's top and sides, normals into the air."""
        return Surface(self._core.boundary.city_surface(), self._core, self.crs)

    @property
    def quality(self) -> dict[str, Any]:
        """Angles, aspect ratios, the worst cells: `volume_mesh` of the report."""
        quality: dict[str, Any] = self.report["volume_mesh"]
        return quality

    def to_pyvista(self, coordinates: Coordinates = "local") -> pyvista.UnstructuredGrid:
        """With the cell data `region`, `zone` if there are canopies, and the field data `origin`.

        Parameters
        ----------
        coordinates : {'local', 'absolute'}
            Relative to `origin`, or of the CRS.
        """
        import pyvista

        # Of VTK's prisms the base, seen from the other triangle, runs clockwise.
        prisms = self.wedges[:, [0, 2, 1, 3, 5, 4]]
        kinds = {pyvista.CellType.TETRA: self.cells, pyvista.CellType.WEDGE: prisms}
        cells = {kind: cells for kind, cells in kinds.items() if len(cells)}
        grid = pyvista.UnstructuredGrid(cells, self.points + _shift(self.origin, coordinates))
        grid.cell_data["region"] = self.region.copy()
        if self.zones:
            grid.cell_data["zone"] = self.zone.copy()
        grid.field_data["origin"] = self.origin if coordinates == "local" else (0.0, 0.0, 0.0)
        return grid

    def to_meshio(self, coordinates: Coordinates = "local") -> meshio.Mesh:
        """With the cell data `region`, and `zone` if there are canopies. `coordinates` as for `to_pyvista`."""
        import meshio

        def by_kind(values: Ints) -> list[Ints]:
            return [part for part in np.split(values, [len(self.cells)]) if len(part)]

        cells = [(name, cells) for name, cells in (("tetra", self.cells), ("wedge", self.wedges)) if len(cells)]
        data = {"region": by_kind(self.region)}
        if self.zones:
            data["zone"] = by_kind(self.zone)
        return meshio.Mesh(self.points + _shift(self.origin, coordinates), cells, cell_data=data)

    @takes_settings("save")
    def save(self, path: str | os.PathLike[str], *, progress: Progress = None, **settings: Unpack[Save]) -> None:
        """Writes a file, as the command line does; the name's end says which.

        ``.vtu``, ``.vtkhdf``, ``.xdmf``, ``.msh``, ``_msh2.msh`` (Gmsh 2.2), ``_fluent.msh``, ``.cgns``, ``.su2`` and a
        folder ``constant/polyMesh`` hold the volume, ``.vtp`` its boundary;
        ``.stl``, ``.obj``, ``.ply`` and ``.glb`` ground, roofs and walls. ``volume.xdmf`` comes with
        ``boundary.xdmf``, and ``NAME.xdmf`` with ``NAME_boundary.xdmf``, each with an HDF5 file beside it.

        Parameters
        ----------
        path : path
            File, or OpenFOAM's folder.
        progress : bool or callable, optional
            As for `build_city`.

        Raises
        ------
        UsageError
            No format has this name.
        InputError
            The file cannot be written.
        """
        with following(progress) as follow:
            self._core.save(Path(path), dict(settings), follow)

    def render(self, picture: str | os.PathLike[str], **options: Unpack[Picture]) -> None:
        """Draws the mesh as a PNG picture, as `tetropolis.render` does files."""
        self._core.render(Path(picture), dict(options))

    def to_html(self) -> str:
        """The page that shows city and mesh: one HTML text that works offline."""
        return self._core.page(self._city)

    def show(self) -> object:
        """Shows the page: in a notebook below the cell, else in the browser."""
        return show(self.to_html())

    def __repr__(self) -> str:
        kind = "tetrahedra and prisms" if self.quality["prisms"]["cells"] else "tetrahedra"
        return f"<tetropolis.Mesh: {self.n_cells} {kind}, {self.n_points} points, {self.crs or 'no CRS'}>"


@takes_settings("build_mesh")
def build_mesh(city: City, *, progress: Progress = None, **settings: Unpack[BuildMesh]) -> Mesh:
    """Meshes the air over a city.

    Parameters
    ----------
    city : City
        Its heights and terrain may have been edited.
    refine, surface_layers, canopies : also areas in memory
        A GeoDataFrame, GeoSeries or geometries of shapely (without a CRS: in that of the city) in place of a file:
        ``refine=[(areas, 2.5)]``, ``surface_layers=[(lakes, "water"), (land, "kind")]``, with what they are or the
        column that says it, ``canopies=[(trees, "height")]``.
    progress : bool or callable, optional
        As for `build_city`.

    Returns
    -------
    Mesh
        What is edited in the city afterwards does not change it.

    Raises
    ------
    UsageError
        A keyword that does not exist or has no such value; a mesh of more than `max_memory`.
    InputError
        An edited height that is no elevation, or a roof that is not above its ground.
    GuaranteeError
        A guarantee cannot be met.
    """
    if not isinstance(city, City):
        raise UsageError(f"city: give what build_city() or read_city() returns, not {type(city).__name__}")
    with areas_as_files(settings, city.crs) as given, following(progress) as follow:
        mesh = Mesh(_core.build_mesh(given, city._core, follow), city)
    mesh._warn()
    return mesh
