"""Cases for solvers."""
from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from . import _core
from ._errors import UsageError


def case_openfoam(folder: str | os.PathLike[str], *, wind_speed: float = 5,
                  wind_from: float | Iterable[float] = 270,
                  wind_profile: Iterable[tuple[float, float, float]] = (), wind_height: float = 10,
                  roughness: float = 0.5, ground_roughness: float = 0.03,
                  patch_roughness: Mapping[str, float] | None = None, building_roughness: float = 0.01,
                  leaf_drag: float = 0.2, leaf_turbulence: bool = True, sample_height: float = 1.75,
                  sample_spacing: float = 2, iterations: int = 500,
                  dialect: Literal["com", "org"] = "com", overwrite: bool = False) -> dict[str, Any] | list[dict[str, Any]]:
    """Makes a folder with a mesh for OpenFOAM a case of wind that its `Allrun` solves.

    Parameters
    ----------
    folder : path
        With `constant/polyMesh`: of `mesh.save(folder / "constant/polyMesh")`, or of a build with that format.
    wind_speed, wind_height : float
        m/s, at so many metres above the ground.
    wind_from : float or several
        Where the wind comes from, degrees clockwise from the grid's north. Several: a case for each, in folders
        w000, w045, ... that share the mesh, one `Allrun` for all, and `rose.py` for their table.
    wind_profile : iterable of (height, speed, k), optional
        What was measured, upwards, instead of `wind_speed`: m, m/s, m2/s2.
    roughness : float
        Roughness length of the land upwind, metres.
    ground_roughness : float
        That of the ground among the buildings and one height around them; 0: as upwind.
    patch_roughness : mapping, optional
        That of patches of the ground by name, instead of water 0.0002, road 0.005 and vegetation 0.1.
    building_roughness : float
        That of roofs and walls; 0: smooth.
    leaf_drag : float
        Drag coefficient of the leaves in canopies.
    leaf_turbulence : bool
        Whether they make and destroy turbulence, too; for dialect 'com'.
    sample_height, sample_spacing : float
        Where people feel the wind, above the ground, and the spacing of points there, metres.
    iterations : int
        At most; residuals below 1e-4 (p: 2e-4, U: 1e-3) end the run before.
    dialect : {'com', 'org'}
        OpenFOAM of openfoam.com or openfoam.org.
    overwrite : bool
        Whether a case that is there is replaced, with what it has solved.

    Returns
    -------
    dict
        'sides', what the wind does at each; 'canopies', how many zones of 'canopy_cells' slow the wind; 'first_cell', the median
        height of cells on the 'ground_faces', and 'layers_top', of where layers end above them; 'open_layers_top' and
        'open_width', the same and the width of cells on the open land; 'samples' and 'sample_spacing'. A list of them for several winds.

    Raises
    ------
    UsageError
        An option out of range, or a case that is there.
    InputError
        No mesh, or files that cannot be written.
    """
    try:
        angles = np.asarray(list(wind_from) if isinstance(wind_from, Iterator) else wind_from, dtype=float)
    except (TypeError, ValueError):
        raise UsageError(f"wind_from: {wind_from!r}: give degrees, or several of them") from None
    several = angles.ndim > 0
    winds = [float(wind) for wind in angles.ravel()]
    cases = _core.case_openfoam(Path(folder), wind_speed, winds, several,
                                [(float(z), float(u), float(k)) for z, u, k in wind_profile], wind_height,
                                roughness, ground_roughness, dict(patch_roughness or {}), building_roughness,
                                leaf_drag, leaf_turbulence, sample_height, sample_spacing, iterations, dialect,
                                overwrite)
    return cases if several else cases[0]


def case_fenicsx(folder: str | os.PathLike[str], *, wind_speed: float = 5, wind_from: float = 270,
                 overwrite: bool = False) -> None:
    """Writes `smoke.py` beside `volume.xdmf` and `boundary.xdmf`: wind and smoke over the city with DOLFINx.

    Parameters
    ----------
    folder : path
        Of a build with the format 'xdmf'.
    wind_speed, wind_from : float
        m/s, and where the wind comes from, degrees clockwise from the grid's north.
    overwrite : bool
        Whether a program that is there is replaced.

    Raises
    ------
    UsageError
        A wind without speed, or a program that is there.
    InputError
        No mesh, or files that cannot be written.
    """
    _core.case_fenicsx(Path(folder), wind_speed, wind_from, overwrite)
