"""What a call tells beside its result: the report, warnings, progress."""
from __future__ import annotations

import contextlib
import json
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Union

from ._errors import DataWarning

Progress = Union[bool, Callable[[str, float], object], None]


@dataclass(frozen=True)
class Notice:
    """One kind of oddity of the input, or of what was made of it."""

    code: str  #: Stable, such as "stray_points".
    count: int  #: How many points, features or cells it concerns.
    message: str


class Reported:
    """Has a report, as the command line writes it."""

    _text: str

    @cached_property
    def report(self) -> dict[str, Any]:
        """What happened, with the keys of ``report.json`` (docs/report.md)."""
        report: dict[str, Any] = json.loads(self._text)
        return report

    @property
    def warnings(self) -> list[Notice]:
        """What was odd; each was a Python warning (`DataWarning`) too, when this was made."""
        return [Notice(w["code"], w["count"], w["message"]) for w in self.report["warnings"]]

    def _warn(self) -> None:
        """At the line of user code that called the function that calls this."""
        for notice in self.warnings:
            warnings.warn(f"{notice.message} ({notice.code})", DataWarning, stacklevel=3)


@contextlib.contextmanager
def following(progress: Progress) -> Iterator[Callable[[str, float], object] | None]:
    """The callable that the core takes for an argument `progress`."""
    if progress is not True:
        yield progress or None
        return
    from tqdm.auto import tqdm

    with tqdm(total=100, bar_format="{desc:<28}{percentage:3.0f}% |{bar}| {elapsed}") as bar:
        def update(step: str, share: float) -> None:
            bar.set_description_str(step, refresh=False)
            bar.n = round(100 * share)
            bar.refresh()
        yield update
