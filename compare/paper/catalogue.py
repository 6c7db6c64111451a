"""All rows of the three documents, in the order of print."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from .judge import Check, Row

Report = Callable[[str, int, int], None]

SECTIONS = (
    "mathar_axes",
    "mathar_velocity",
    "mathar_lagrangian",
    "mathar_cartesian",
    "mathar_rest",
    "mathar_triangle",
    "mathar_slow",
    "mathar_motion",
    "mathar_frequency",
    "mathar_program",
    "gastebois_frames",
    "gastebois_rotation",
    "gastebois_gravity",
    "gastebois_small",
    "gastebois_solution",
    "gastebois_thrown",
    "gastebois_let_go",
    "gastebois_pantheon",
    "gastebois_lagrangian",
    "gastebois_general",
    "gastebois_flat",
    "three_setting",
    "three_method_1",
    "three_method_2",
    "three_method_3",
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
