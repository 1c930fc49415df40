"""Pictures of results."""
from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypedDict, Union

from . import _core

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Picture(TypedDict, total=False):
    """Keyword arguments of pictures, all optional."""

    view: Literal["city", "plan", "section"]  #: From the air, from above, or a vertical plane through the volume.
    colour: Literal["class", "height", "building", "quality"]  #: What colours say; quality is that of a section's cells.
    edges: bool  #: Whether the edges of triangles are drawn.
    width: int  #: Pixels, by default 1600.
    height: int  #: Pixels, by default 1000.
    azimuth: float  #: Compass direction one looks in, degrees, by default 30.
    elevation: float  #: How far one looks down, degrees, by default 35.
    cut: Union[str, float]  #: Plane of a section: "x", "y", "x=120.5", or the compass direction of its line in degrees.


def render(path: str | os.PathLike[str], picture: str | os.PathLike[str], **options: Unpack[Picture]) -> None:
    """Draws results as a PNG picture, without a display.

    Parameters
    ----------
    path : path
        A folder of results, or one file: .vtp, .vtu, .xdmf, .stl, .city.json.
    picture : path
        PNG to write; of what is there, only a PNG is replaced.

    Other Parameters
    ----------------
    view : {'city', 'plan', 'section'}
        From the air, from above with north up, or a vertical plane through the volume.
    colour : {'class', 'height', 'building', 'quality'}
        What colours say; quality is that of the cells of a section.
    edges : bool, default False
        Whether the edges of triangles are drawn; those of a section's cells always are.
    width, height : int, default 1600 and 1000
        Pixels.
    azimuth, elevation : float, default 30 and 35
        Of 'city': the compass direction one looks in, and how far down, degrees.
    cut : str or float, optional
        Plane of a section: 'x', 'y', 'x=METRES', 'y=METRES', or the compass direction of its line in degrees; by
        default the one with most walls.

    Raises
    ------
    UsageError
        An option that does not exist or has no such value.
    InputError
        Files that cannot be read, or a picture that cannot be written.
    """
    _core.render(Path(path), Path(picture), dict(options))
