"""All rows of the three documents, in the order of print."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from .checks import Check, Row

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
    """Every declared row."""
    return [check for section in SECTIONS for check in import_module(f".{section}", __package__).checks()]


def rows(report: Report | None = None) -> list[Row]:
    """Judge every declared row.

    Args:
        report: called with a row's place, how many are done, and how many there are.

    Raises:
        UnexplainedError: a print does not hold and nothing that is declared explains it.
    """
    declared = checks()
    judged = []
    for done, check in enumerate(declared, 1):
        judged.append(check.row())
        if report is not None:
            report(judged[-1].place, done, len(declared))
    return judged
