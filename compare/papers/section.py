"""A section of a paper: its rows carry its name in their ids and places; and the list of all sections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any, cast

from .checks import Check, JudgedRow

Report = Callable[[str, int, int], None]

SECTIONS = (
    *("mathar.kinematics", "mathar.lagrangian", "mathar.cartesian", "mathar.rest", "mathar.slow", "mathar.paris"),
    *("mathar.program", "gastebois.rotation", "gastebois.small", "gastebois.swings", "gastebois.lagrangian"),
    *("gastebois.flat", "three_methods.setting", "three_methods.methods"),
)  # in the order of print


@dataclass(frozen=True)
class Section:
    """A section: what the ids of its rows begin with, and the place in print."""

    prefix: str
    place: str

    def rows(self, *declared: Check) -> list[Check]:
        """Return rows with their whole ids and places, declared with the end of each: "13" at "(13)", or at ""."""
        return [self._whole(row) for row in declared]

    def _whole(self, row: Check) -> Check:
        place = self.place + ("" if row.place[:1] in ("", ",") else " ") + row.place
        return cast(Check, replace(cast(Any, row), id=self.prefix + row.id, place=place))


def checks() -> list[Check]:
    """Return every declared row."""
    return [check for section in SECTIONS for check in import_module(f".{section}", __package__).checks()]


def rows(report: Report | None = None) -> list[JudgedRow]:
    """Judge every declared row.

    Args:
        report: called with a row's place, the number of rows judged so far, and of all rows.

    Raises:
        UnexplainedError: a printed line does not hold, and no declared correction does.
    """
    declared = checks()
    judged = []
    for count, check in enumerate(declared, 1):
        judged.append(check.row())
        if report is not None:
            report(judged[-1].place, count, len(declared))
    return judged
