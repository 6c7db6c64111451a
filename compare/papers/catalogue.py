"""The list of all sections of the three source papers, in the order of print, and their rows."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from .checks import Check, JudgedRow

Report = Callable[[str, int, int], None]

SECTIONS = (
    "mathar.axes",
    "mathar.velocity",
    "mathar.lagrangian",
    "mathar.cartesian",
    "mathar.rest",
    "mathar.triangle",
    "mathar.slow",
    "mathar.motion",
    "mathar.frequency",
    "mathar.program",
    "gastebois.frames",
    "gastebois.rotation",
    "gastebois.gravity",
    "gastebois.small",
    "gastebois.solution",
    "gastebois.thrown",
    "gastebois.let_go",
    "gastebois.pantheon",
    "gastebois.lagrangian",
    "gastebois.general",
    "gastebois.flat",
    "three_methods.setting",
    "three_methods.method_1",
    "three_methods.method_2",
    "three_methods.method_3",
)


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
