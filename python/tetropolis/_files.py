"""Commands on files: synthetic cities, checks."""
from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core
from ._report import Progress, following
from ._settings import takes_settings

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._settings import Synth


@takes_settings("synth")
def synth(out: str | os.PathLike[str], *, progress: Progress = None, **settings: Unpack[Synth]) -> dict[str, Any]:
    """Invents a city: writes ``footprints.shp`` and ``points.laz`` into the folder `out`.

    Parameters
    ----------
    out : path
        Folder, made if it is not there.
    progress : bool or callable, optional
        As for `build_city`.

    Returns
    -------
    dict
        The report (docs/report.md).
    """
    with following(progress) as follow:
        report: dict[str, Any] = json.loads(_core.synth(dict(settings), os.fspath(out), follow))
    return report


@dataclass(frozen=True)
class CheckedFile:
    """What `check` found in one file."""

    name: str
    facts: list[str]  #: Lines to read.
    violations: list[tuple[str, int, str]]  #: What is broken, how often, and where first.
    not_checked: list[str]  #: What it takes other files to see.

    @property
    def ok(self) -> bool:
        """Whether no guarantee is broken."""
        return not self.violations


def check(path: str | os.PathLike[str], *, min_building_distance: float | None = None,
          progress: Progress = None) -> list[CheckedFile]:
    """Holds written files against the guarantees, with code of its own.

    Parameters
    ----------
    path : path
        A folder of results, a city model (.json), a volume (.vtu), a boundary (.vtp), or both (.xdmf).
    min_building_distance : float, optional
        Clearance to ask of a city model, metres; by default what the report beside it says, else 1.
    progress : bool or callable, optional
        As for `build_city`.

    Raises
    ------
    InputError
        Files that cannot be read, or of no known kind.
    """
    with following(progress) as follow:
        return [CheckedFile(*found) for found in _core.check(Path(path), min_building_distance, follow)]
