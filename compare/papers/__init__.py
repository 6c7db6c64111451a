"""The three documents that this project builds on, line by line: every formula and number recomputed and judged.

>>> from compare.papers import rows
>>> judged = {row.id: row for row in rows()}                   # doctest: +SKIP
>>> judged["mathar_45"].verdict, judged["mathar_45"].correction  # doctest: +SKIP
('misprint', 'the left side is y')

`rows()` gives a `Row` for each line; `build(out)` also draws the first paper's figures again and writes one page.
How a line is judged stands in `judge.py`; the lines stand in one module a section (`catalogue.SECTIONS`).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .checks import Row

__all__ = ["build", "rows"]

Report = Callable[[str, int, int], None]


def rows(report: Report | None = None) -> list[Row]:
    """Judge every line; `report` gets a line's place, how many are done, and how many there are."""
    from .catalogue import rows as judged

    return judged(report)


def build(out: Path, report: Report | None = None) -> list[Row]:
    """Write `index.html`, `figure_N.svg`, `rows.csv` and `rows.json` into a folder, all or none.

    Raises:
        InputError: matplotlib or numba is not installed, the folder is somebody else's, or it cannot be written.
    """
    from ..report.folder import PAGE, check_folder, write_files
    from ..report.plotting import pyplot
    from .figure_runs import check_methods
    from .figures import FIGURES, svg
    from .page import files_of

    pyplot("--out")  # before the work, not after it
    check_folder(out, [PAGE])
    check_methods()
    judged = rows(report)
    figures = {}
    for done, number in enumerate(FIGURES, 1):
        figures[number] = svg(number)
        if report is not None:
            report(f"figure {number}", done, len(FIGURES))
    write_files(out, files_of(judged, figures))
    return judged
