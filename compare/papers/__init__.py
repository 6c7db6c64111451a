"""The three source papers: every formula and printed number recomputed, judged, and shown on a page.

The papers are Mathar's (`mathar/`), Gastebois's (`gastebois/`) and a third one, which solves the
linear pendulum by three methods (`three_methods.py`). A module of theirs holds a few sections; its
function `checks` declares one row for every printed formula, number or sentence, with the
computation to compare it with. Verdicts are computed from these.

- `checks.py`: the kinds of rows, and how each is judged (exact, reproduced, an approximation, or a
  misprint);
- `points.py`: random points at which formulas are evaluated, the Paris pendulum, and runs of the
  reference;
- `first_principles.py`: the yardstick of formulas, from the Lagrangian and its linear limit;
- `digits.py`: arithmetic with 60 decimal digits: numbers, vectors, derivatives;
- `figures.py`: the first paper's figures, drawn again, and their captions;
- `papers_page.py`: the rows and the figures as a page, and the rows as CSV and JSON.

>>> from compare.papers import rows
>>> judged = {row.id: row for row in rows()}                   # doctest: +SKIP
>>> judged["mathar_45"].verdict, judged["mathar_45"].correction  # doctest: +SKIP
('misprint', 'the left side is y')

`rows()` gives a `JudgedRow` for each declared row; `build(out)` also draws the figures and writes
the page.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .checks import Check, JudgedRow

MATHAR = ("kinematics", "lagrangian", "rest", "paris", "appendix_a")
GASTEBOIS = ("rotation", "small", "swings", "lagrangian")
SECTIONS = (
    *(f"mathar.{name}" for name in MATHAR),
    *(f"gastebois.{name}" for name in GASTEBOIS),
    "three_methods",
)
Report = Callable[[int, int, str], None]


def declared() -> list[Check]:
    """Return every declared row, in the order in which they are printed."""
    return [check for name in SECTIONS for check in import_module(f".{name}", __name__).checks()]


def rows(report: Report = lambda *_: None) -> list[JudgedRow]:
    """Judge every declared row.

    Args:
        report: called with the number of rows judged so far, that of all rows, and a row's place.

    Raises:
        UnexplainedError: a printed line does not hold, and no declared correction does.
    """
    lines = declared()
    judged = []
    for count, line in enumerate(lines, 1):
        judged.append(line.row())
        report(count, len(lines), line.place)
    return judged


def build(out: Path, report: Report = lambda *_: None) -> list[JudgedRow]:
    """Write `index.html`, `figure_N.svg`, `rows.csv` and `rows.json` into a folder.

    Raises:
        InputError: matplotlib or numba is not installed, or the folder holds another page or cannot
            be written.
    """
    from ..report.drawing import check_matplotlib
    from ..report.folder import PAGE, check_folder, write_files
    from .figures import FIGURES, check_methods, svg
    from .papers_page import files_of

    check_matplotlib("--out")  # so that a missing package is reported before the work
    check_folder(out, [PAGE])
    check_methods()
    judged = rows(report)
    figures = {}
    for count, number in enumerate(FIGURES, 1):
        figures[number] = svg(number)
        report(count, len(FIGURES), f"figure {number}")
    write_files(out, files_of(judged, figures))
    return judged
