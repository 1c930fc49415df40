"""Cities: buildings on a terrain."""
from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import numpy as np
import numpy.typing as npt

from . import _core
from ._areas import areas_as_files
from ._errors import UsageError
from ._input import crs_text, footprint_table, is_path, paths_of, points_in_memory
from ._report import Progress, Reported, following
from ._settings import takes_settings
from ._show import show

if TYPE_CHECKING:
    import geopandas
    import pandas
    from typing_extensions import Unpack

    from ._render import Picture
    from ._settings import BuildCity, ReadCity

Floats = npt.NDArray[np.float64]


def _polygons(ragged: tuple[Any, Any, Any]) -> npt.NDArray[np.object_]:
    import shapely

    coordinates, rings, polygons = ragged
    result: npt.NDArray[np.object_] = shapely.from_ragged_array(
        shapely.GeometryType.POLYGON, coordinates, (rings, polygons))
    return result


class Terrain:
    """Heights of the ground at the nodes of a regular grid, as `city.terrain`."""

    def __init__(self, core: _core.Raster, origin: tuple[float, float], crs: str) -> None:
        self._core = core
        self.origin = origin  #: Of the local frame, CRS coordinates.
        self.crs = crs  #: "EPSG:28992", or WKT, or "" if unknown.

    @property
    def values(self) -> Floats:
        """Elevations in metres, shape (rows, columns), the northernmost row first; the library's own memory: edit it,
        then `build_mesh` again."""
        return self._core.values[::-1]

    @values.setter
    def values(self, values: npt.ArrayLike) -> None:
        self._core.values[::-1] = values

    @property
    def step(self) -> float:
        """Metres between neighbouring nodes."""
        return self._core.step

    @property
    def transform(self) -> tuple[float, float, float, float, float, float]:
        """From (column, row) of pixels centred on the nodes to CRS coordinates: the first six numbers of
        ``rasterio.Affine``."""
        step, rows = self.step, len(self._core.values)
        return (step, 0.0, self.origin[0] + self._core.x0 - step / 2,
                0.0, -step, self.origin[1] + self._core.y0 + (rows - 0.5) * step)

    def sample(self, x: npt.ArrayLike, y: npt.ArrayLike) -> Floats:
        """Elevations at CRS coordinates, bilinear between the nodes; the nearest of the rim outside; NaN at NaN."""
        xs, ys = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        at = np.stack([xs.ravel() - self.origin[0], ys.ravel() - self.origin[1]], axis=1)
        return self._core.sample(np.ascontiguousarray(at)).reshape(xs.shape)

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        return f"<tetropolis.Terrain: {rows} x {columns} nodes, step {self.step:g} m, {self.crs or 'no CRS'}>"


class CityModel:
    """Buildings, each a prism over its footprint, or several below their roofs (`parts`). Arrays have one element per
    building, in one order."""

    def __init__(self, core: _core.CityModel, settle: Callable[[], None]) -> None:
        self._model = core
        self._settle = settle  # lets parts follow edits of h_roof

    def __len__(self) -> int:
        return len(self._model)

    @property
    def h_roof(self) -> Floats:
        """Elevations of the roofs, metres, shape (n,); the library's own memory: edit it, then `build_mesh` again. Roofs
        of parts rise or fall as much, but not to less than 2.5 m above the ground (or `h_roof`)."""
        return self._model.h_roof

    @h_roof.setter
    def h_roof(self, values: npt.ArrayLike) -> None:
        self._model.h_roof[:] = values

    @property
    def h_ground(self) -> Floats:
        """Elevations of the ground at the buildings, metres, shape (n,); may be edited like `h_roof`."""
        return self._model.h_ground

    @h_ground.setter
    def h_ground(self, values: npt.ArrayLike) -> None:
        self._model.h_ground[:] = values

    @property
    def n_ground_points(self) -> npt.NDArray[np.int64]:
        """Points that `h_ground` was computed from, shape (n,)."""
        return self._model.n_ground_points

    @property
    def n_roof_points(self) -> npt.NDArray[np.int64]:
        """Points that `h_roof` was computed from, shape (n,)."""
        return self._model.n_roof_points

    @property
    def ids(self) -> list[str]:
        """Names of the buildings, unique in the city."""
        return self._model.ids

    @property
    def source_ids(self) -> list[list[str]]:
        """The input features that each building is made of."""
        return self._model.source_ids

    @property
    def flags(self) -> list[list[str]]:
        """What each building's numbers rest on where the data had gaps ("merged", "no_roof_points", ...)."""
        return self._model.flag_names

    @property
    def footprints(self) -> npt.NDArray[np.object_]:
        """Polygons of shapely, CRS coordinates, shape (n,). A copy: editing it changes nothing."""
        return _polygons(self._model.footprints)

    @property
    def dropped(self) -> pandas.DataFrame:
        """The input features that became no building: `source_id` and `reason`."""
        import pandas

        return pandas.DataFrame(self._model.dropped, columns=["source_id", "reason"])

    @property
    def origin(self) -> tuple[float, float]:
        """Zero of the local frame in CRS coordinates."""
        return self._model.origin

    @property
    def crs(self) -> str:
        """ "EPSG:28992", or WKT where there is no code, or "" if unknown."""
        return self._model.crs

    @property
    def domain(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax in CRS coordinates."""
        return self._model.domain

    @property
    def domain_outline(self) -> list[tuple[float, float]]:
        """Corners of the domain in CRS coordinates, counter-clockwise: four of a box, more of a cylinder or polygon."""
        return self._model.domain_outline

    @property
    def parts(self) -> pandas.DataFrame:
        """A copy, one row per part of a building, if it has some: `building` (position), `id`, `part` (from 0), `source_id`,
        `lod` ("1.2", "1.3", "2.2" or "block"), `slope` and `azimuth` (degrees; where the roof looks, clockwise from
        north, NaN if level), `area` (m2, in plan), `rmse` (m, NaN without points), `n_points`, `h_min`, `h_max` (m of
        elevation)."""
        import pandas

        self._settle()
        return pandas.DataFrame(self._model.parts)

    def to_geopandas(self, parts: bool = False) -> geopandas.GeoDataFrame:
        """One row per building, by position (`mesh.boundary.building`), or per part.

        Parameters
        ----------
        parts : bool
            True: `parts` with their outlines; buildings without parts have no row.

        Returns
        -------
        geopandas.GeoDataFrame
            Footprints in CRS coordinates with `id`, `h_ground`, `h_roof` (metres of elevation), `height` (their
            difference), `n_ground_points`, `n_roof_points`, and as texts with commas `source_ids` and `flags`.
        """
        import geopandas

        if parts:
            return geopandas.GeoDataFrame(self.parts, geometry=_polygons(self._model.part_outlines),
                                          crs=self.crs or None)
        return geopandas.GeoDataFrame({
            "id": self.ids,
            "h_ground": self.h_ground.copy(),
            "h_roof": self.h_roof.copy(),
            "height": self.h_roof - self.h_ground,
            "n_ground_points": self.n_ground_points.copy(),
            "n_roof_points": self.n_roof_points.copy(),
            "source_ids": [",".join(ids) for ids in self.source_ids],
            "flags": [",".join(names) for names in self.flags],
        }, geometry=self.footprints, crs=self.crs or None)


class City(Reported, CityModel):
    """Buildings as they are meshed, on their terrain; made by `build_city` and `read_city`.

    Attributes
    ----------
    terrain : Terrain
        Ground heights under all of the domain.
    raw : CityModel
        The buildings before merging: one per input feature.
    """

    def __init__(self, core: _core.City) -> None:
        super().__init__(core.model, core.settle)
        self._core = core
        self._text = core.report
        self.terrain = Terrain(core.terrain, self.origin, self.crs)
        self.raw = CityModel(core.raw, core.settle)

    def copy(self) -> City:
        """A city of its own with the same buildings and terrain, to edit: what is done to one does not reach the other.
        ``copy.copy`` and ``copy.deepcopy`` make the same."""
        return City(self._core.copy())

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, Any]) -> City:
        return self.copy()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the city model (``.city.json``, CityJSON 2.0), its layers for GIS (``.gpkg``: footprints with what
        became of them, buildings, parts, dropped), or the terrain (``.tif``, GeoTIFF).

        `read_city` reads model and terrain back. Other formats: ``city.to_geopandas().to_file(...)``.

        Raises
        ------
        UsageError
            The name ends in none of these.
        InputError
            The file cannot be written.
        """
        path = Path(path)
        self._settle()
        if path.suffix.lower() == ".json":
            self._model.save(path)
        elif path.suffix.lower() == ".gpkg":
            self._core.save_layers(path)
        elif path.suffix.lower() in (".tif", ".tiff"):
            self._core.save_terrain(path)
        else:
            raise UsageError(f"{path}: no format has this name; end it in .city.json (buildings), .gpkg (layers) "
                             "or .tif (terrain)")

    def render(self, picture: str | os.PathLike[str], **options: Unpack[Picture]) -> None:
        """Draws the buildings on their terrain as a PNG picture, as `tetropolis.render` does files."""
        with tempfile.TemporaryDirectory(prefix="tetropolis-") as folder:
            self.save(Path(folder) / "city.city.json")
            self.save(Path(folder) / "dtm.tif")
            _core.render(Path(folder), Path(picture), dict(options))

    def to_html(self) -> str:
        """The page that shows the city: one HTML text that works offline."""
        return self._core.page

    def show(self) -> object:
        """Shows the page: in a notebook below the cell, else in the browser."""
        return show(self.to_html())

    def __repr__(self) -> str:
        return f"<tetropolis.City: {len(self)} buildings, {self.crs or 'no CRS'}, {len(self._model.dropped)} dropped>"


@takes_settings("build_city")
def build_city(footprints: Any, points: Any = None, *, classification: npt.ArrayLike | None = None,
               progress: Progress = None, **settings: Unpack[BuildCity]) -> City:
    """Builds terrain and buildings from footprints and points.

    Parameters
    ----------
    footprints : path, list of paths, GeoDataFrame, GeoSeries, or geometries of shapely
        Files in any vector format that GDAL reads, or features in memory; None with ``terrain_only=True``. Features
        in memory are called by their index.
    points : path, list of paths, array_like of shape (N, 3), or laspy.LasData, optional
        LAS or LAZ files, folders, patterns; or x, y, z in metres of the CRS (laspy's ``las.xyz``). Without, heights
        are those of ``dsm``, or what the footprints state, and the ground is ``dtm``, or level.
    classification : array_like of shape (N,), optional
        ASPRS classes of points in memory; without, the ground is found by a filter.
    domain : also a GeoDataFrame, GeoSeries or polygon of shapely
        The area to be meshed; without a CRS in that of the city.
    planned : also a GeoDataFrame, or areas with their height
        Planned buildings, in place of those that stand there: ``planned=[(polygon, 25.0)]``, ``[(frame, "column")]``.
    progress : bool or callable, optional
        True: a bar of tqdm. A callable gets the name of the step and the share of the whole that is done, in
        [0, 1].

    Returns
    -------
    City

    Raises
    ------
    UsageError
        A keyword that does not exist or has no such value, arguments that do not go together.
    InputError
        Input that cannot be used. The message names file and feature.
    GuaranteeError
        The account of the features does not add up.
    """
    table = arrays = None
    files = [] if footprints is None else paths_of("footprints", footprints)
    if files is None:
        table = footprint_table(footprints, settings.get("id_attribute"))
    paths = [] if points is None else paths_of("points", points)
    if paths is None:
        arrays = points_in_memory(points, classification)
    elif classification is not None:
        raise UsageError("classification: files have their own; give it with points in memory only")
    own_crs = settings.get("footprints_crs") or crs_text(getattr(footprints, "crs", None))
    with areas_as_files(settings, planned_crs=own_crs) as given, following(progress) as follow:
        city = City(_core.build_city(given, files or [], paths or [], table, arrays, follow))
    city._warn()
    return city


@takes_settings("read_city")
def read_city(path: str | os.PathLike[str], dtm: str | os.PathLike[str] | None = None, *,
              progress: Progress = None, **settings: Unpack[ReadCity]) -> City:
    """Reads a city model and its terrain, of this program or others.

    Parameters
    ----------
    path : path
        CityJSON file, or a folder of results.
    dtm : path, optional
        Terrain raster; by default ``dtm.tif`` beside the city model. Without it the ground is at the buildings' bases.
    progress : bool or callable, optional
        As for `build_city`.

    Returns
    -------
    City
        `raw` has no buildings.

    Raises
    ------
    UsageError
        A keyword that does not exist or has no such value.
    InputError
        Files that cannot be read, or buildings that cannot be meshed.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "city.city.json"
    beside = path.with_name("dtm.tif")
    dtm = (beside if beside.is_file() else "") if dtm is None else dtm
    with following(progress) as follow:
        city = City(_core.read_city(dict(settings), os.fspath(path), os.fspath(dtm), follow))
    city._warn()
    return city
