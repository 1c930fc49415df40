"""Areas in memory for settings that take files of polygons."""
from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from ._errors import UsageError
from ._input import is_path

TAKE_AREAS = {"refine": "[(areas, 2.5)]", "surface_layers": '[(areas, "water")] or [(areas, "column")]',
              "canopies": '[areas], [(areas, 8.0)] or [(areas, "column")]', "planned": '[(areas, 25.0)] or [(areas, "column")]',
              "domain": "areas"}
# Columns that mean something by their name, beside the one that a setting names.
OF_CANOPIES = ("crown_base", "leaf_area_density")


def _is_pair(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], (str, int, float, np.number))


def _heights(areas: Any, column: Any, columns: list[Any]) -> dict[str, Any]:
    """Columns of planned buildings: their height if it is given or named, or else all numbers and texts."""
    if column is None:
        values = {str(one): areas[one].map(str, na_action="ignore").array for one in columns
                  if str(areas[one].dtype) != "geometry"}
        if not values:
            raise UsageError(f"planned: the areas have no heights; give {TAKE_AREAS['planned']}, or a column height")
        return values
    if not isinstance(column, str):
        if not float(column) >= 0:
            raise UsageError(f"planned: {column} is no height; give metres above ground, 0 for what is to be torn down")
        return {"height": np.full(len(areas), float(column))}
    if column not in columns:
        raise UsageError(f"planned: the areas have no column {column!r}; they have: {', '.join(map(str, columns))}")
    return {"height": areas[column].array}


def _write(areas: Any, column: Any, path: str, name: str, crs: str) -> None:
    try:
        import geopandas
    except ImportError:
        raise UsageError(f"{name}: areas in memory need geopandas; give a file, or pip install geopandas") from None
    if not hasattr(areas, "geometry"):
        try:
            areas = geopandas.GeoSeries(np.atleast_1d(np.asarray(areas, dtype=object)), crs=getattr(areas, "crs", None))
        except (TypeError, ValueError):
            raise UsageError(f"{name}: give files, or {TAKE_AREAS[name]} of a GeoDataFrame or geometries of shapely, "
                             f"not {type(areas).__name__}") from None
    if name in ("refine", "surface_layers") and column is None:
        raise UsageError(f"{name}: give {TAKE_AREAS[name]}: areas alone do not say what they mean")
    columns = list(getattr(areas, "columns", ()))
    has_height = name == "canopies" and isinstance(column, (int, float, np.number))
    if name in ("surface_layers", "canopies") and not has_height and \
            column not in (None, "water", "road", "vegetation", *columns):
        raise UsageError(f"{name}: the areas have no column {column!r}; they have: {', '.join(map(str, columns))}")
    kept = [one for one in (column, *OF_CANOPIES) if isinstance(one, str) and one in columns]
    values = {one: areas[one].array for one in kept}
    if name == "planned":
        values = _heights(areas, column, columns)
    if has_height:
        values["height"] = np.full(len(areas), float(column))
    frame = geopandas.GeoDataFrame(values, geometry=areas.geometry.array, crs=areas.crs or crs or None)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*crs.*not provided")
        frame.to_file(path, driver="FlatGeobuf", engine="pyogrio", index=False, SPATIAL_INDEX="NO")


@contextmanager
def areas_as_files(settings: Mapping[str, Any], crs: str = "", planned_crs: str = "") -> Iterator[dict[str, Any]]:
    """The settings; areas in memory are files in a folder that lasts as long, those without a CRS in `crs`, or
    `planned_crs`."""
    with tempfile.TemporaryDirectory(prefix="tetropolis-") as folder:
        def text(name: str, number: int, value: Any) -> str:
            areas, means = value if _is_pair(value) and not is_path(value[0]) else (value, None)
            path = os.path.join(folder, f"{name}_{number}.fgb")
            _write(areas, means, path, name, planned_crs if name == "planned" else crs)
            if name == "canopies" and means is not None and not isinstance(means, str):
                means = "height"
            return path if means is None or name == "planned" else f"{path}:{means}"

        changed = dict(settings)
        for name in TAKE_AREAS:
            value = settings.get(name)
            if value is None or is_path(value):
                continue
            single = name == "domain" or hasattr(value, "geometry") or (_is_pair(value) and not is_path(value[0]))
            values = [value] if single or not isinstance(value, (list, tuple, set, Iterator)) else list(value)
            texts = [one if is_path(one) else text(name, i, one) for i, one in enumerate(values, 1)]
            changed[name] = texts[0] if name == "domain" else texts
        yield changed
