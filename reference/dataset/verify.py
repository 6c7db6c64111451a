"""Verify a golden dataset: its files, what follows from its scene, each row's physics, and the motion as a whole."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from ..errors import BeyondDoublesError, DatasetError
from .checks import index, manifest_check, motion, physics, tables
from .files import Files, read_files

MAX_PROBLEMS = 20  # sentences returned at most
BEYOND = "a number of the scene or of a table, or what follows from it, is beyond the range of binary64"


@dataclass(frozen=True)
class Verification:
    """The outcome of checking a dataset.

    Attributes:
        problems: a sentence for each; none if the dataset passes.
        foreign: a note on each file in the folder that does not belong to the dataset.
        left_out: a sentence for each check that was not made, with its reason.
    """

    problems: list[str]
    foreign: list[str]
    left_out: list[str]

    @property
    def notes(self) -> list[str]:
        """All that a user should know besides problems: files that do not belong to it, and checks not made."""
        return [*self.foreign, *self.left_out]


def verify(folder: Path, report: motion.Progress | None = None) -> Verification:
    """Check a dataset, and integrate its scene again, which takes some seconds for a day of Paris.

    Args:
        folder: where it stands.
        report: called with the simulated time reached and the whole span, in s.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        files = read_files(folder)
    except DatasetError as error:
        return Verification(error.problems[:MAX_PROBLEMS], [], [])
    foreign = [f"{name}: not part of the dataset, ignored" for name in files.foreign[:MAX_PROBLEMS]]
    foreign += [f"and {more} more"] if (more := len(files.foreign) - MAX_PROBLEMS) > 0 else []
    problems = [*islice(index.problems(files), MAX_PROBLEMS), *_row_by_row(files)]
    left_out: list[str] = []
    if not problems:
        try:
            problems, left_out = motion.problems(files, report)
        except (ArithmeticError, BeyondDoublesError):
            problems = [BEYOND]
    return Verification(problems[:MAX_PROBLEMS], foreign, left_out)


def problems_of(folder: Path) -> list[str]:
    """Return a sentence for each problem of a dataset that shows without integrating.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        return _row_by_row(read_files(folder))
    except DatasetError as error:
        return error.problems[:MAX_PROBLEMS]


def _row_by_row(files: Files) -> list[str]:
    """Return what is wrong with the record and with each row by itself; later checks need what earlier ones passed."""
    for check in (tables, manifest_check, physics):
        try:
            problems = list(islice(check.problems(files), MAX_PROBLEMS))
        except (ArithmeticError, BeyondDoublesError):
            problems = [BEYOND]
        if problems:
            return problems
    return []
