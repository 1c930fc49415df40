"""Footprints and points in the forms in which Python has them, as the core takes them."""
from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import UsageError


def is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def crs_text(crs: Any) -> str:
    """A CRS of GeoPandas or laspy as text: its code where it is nothing but that."""
    if crs is None:
        return ""
    if isinstance(crs, str):
        return crs
    return str(crs.srs) if getattr(crs, "srs", "").upper().startswith("EPSG:") else str(crs.to_wkt())


def _texts(column: Any) -> list[str]:
    kind = getattr(column.dtype, "kind", "O")
    text = (lambda value: str(int(value))) if kind in "biu" else str
    return ["" if missing else text(value) for value, missing in zip(column, column.isna())]


def _columns(frame: Any) -> list[tuple[str, str, list[str]]]:
    """Name, kind of NumPy and values of all attributes."""
    columns = ((str(name), frame.iloc[:, k]) for k, name in enumerate(frame.columns))
    return [(name, getattr(column.dtype, "kind", "O"), _texts(column)) for name, column in columns
            if str(column.dtype) != "geometry"]


def footprint_table(footprints: Any, id_attribute: str | None) -> _core.FootprintTable:
    """Of a GeoDataFrame, a GeoSeries, a geometry of shapely or several of these."""
    import shapely

    if hasattr(footprints, "xyz") and hasattr(footprints, "header"):  # laspy.LasData
        raise UsageError("footprints: are a point cloud; swap footprints and points")
    ids: list[str] = []
    columns: list[tuple[str, str, list[str]]] = []
    if hasattr(footprints, "geometry") and hasattr(footprints, "crs"):
        geometries = np.asarray(footprints.geometry.array)
        if hasattr(footprints, "columns"):
            columns = _columns(footprints)
        if not id_attribute:
            ids = [str(label) for label in footprints.index]
    else:
        geometries = np.atleast_1d(np.asarray(footprints, dtype=object))
    crs = crs_text(getattr(footprints, "crs", None))
    try:
        wkb = shapely.to_wkb(geometries)
    except TypeError:
        raise UsageError("footprints: give a file, a GeoDataFrame, or geometries of shapely, not "
                         f"{type(footprints).__name__}") from None
    return _core.FootprintTable([bytes(b) if b is not None else b"" for b in wkb], ids, columns, crs)


def _codes(codes: Any, name: str, count: int) -> npt.NDArray[np.uint8] | None:
    if codes is None:
        return None
    array = np.asarray(codes)
    if array.shape != (count,):
        raise UsageError(f"{name}: has the shape {array.shape}; give one value for each of {count} points")
    if array.dtype != np.uint8 and array.size and not (0 <= array.min() and array.max() <= 255):
        raise UsageError(f"{name}: holds values that are no class; give 0 to 255")
    return np.ascontiguousarray(array, dtype=np.uint8)


def points_in_memory(points: Any, classification: Any) -> _core.Points:
    """Of an array (N, 3), or of what laspy reads."""
    withheld, crs = None, ""
    if hasattr(points, "xyz") and hasattr(points, "header"):  # laspy.LasData
        las, points = points, points.xyz
        classification = las.classification if classification is None else classification
        withheld = las.withheld
        crs = crs_text(las.header.parse_crs())
    try:
        xyz = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise UsageError("points: give files, an array (N, 3), or what laspy.read() returns, not "
                         f"{type(points).__name__}") from None
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise UsageError(f"points: has the shape {xyz.shape}; give (N, 3): x, y, z of each point")
    count = len(xyz)
    return _core.Points(xyz, _codes(classification, "classification", count), _codes(withheld, "withheld", count), crs)


def paths_of(name: str, value: Any) -> list[str] | None:
    """The files that an argument names; None if it is data itself."""
    if is_path(value):
        return [os.fspath(value)]
    if isinstance(value, (list, tuple, set, frozenset, Iterator)):
        values = sorted(value, key=str) if isinstance(value, (set, frozenset)) else list(value)
        if not values:
            raise UsageError(f"{name}: is an empty list; give files, or None for none")
        if all(is_path(path) for path in values):
            return [os.fspath(path) for path in values]
        if isinstance(value, Iterator):
            raise UsageError(f"{name}: give files or arrays, not {type(value).__name__}")
    return None
