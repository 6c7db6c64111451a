"""The kernel as an engine that solves many undamped scenes side by side; numba is imported when it runs."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, cast

import numpy as np

from ...system.machine_code import folder_of, kept_variants, prepare
from ..batch_interface import Batch, Outcomes, Rows, RunOptions
from .rows import COLUMNS, RESULTS, SOURCES, TOLERANCE, outcomes, packed

_ORDER = 24
_MOVED_ORDER = 22  # of a run that serves to estimate the error
_STEPS_PER_CALL = 20_000  # between two calls an interrupt is noticed
_ROOM = 1 << 16  # times that one call may find


class OctetBatch(Batch):
    """Taylor series of fixed order and adaptive step, eight rows at a time in machine code."""

    name = "octet"
    requires = ("numba",)
    extra = "methods"
    drag = False
    swing_s = 0.8e-6
    section_work = (1.2, 6.0)
    load_s = 1.2
    compile_s = (8.0, 2.0)

    @property
    def identity(self) -> str:
        """Return orders, tolerance and the compiler."""
        return f"octet, orders {_ORDER} and {_MOVED_ORDER}, tolerance {TOLERANCE!r}, numba {version('numba')}"

    def prepare(self, options: RunOptions) -> None:
        """Compile the kernel, or read it from the disk, once a process: later calls find it done."""
        from .march import RowData, empty_march, empty_moments, march

        kernel = cast("Any", march)
        data = RowData(np.zeros(COLUMNS), np.zeros(RESULTS), empty_moments(0))
        title = "steps of eight rows at once"
        if options.form:
            title += " with sections"
        seconds = round(self.compile_s[bool(kernel.stats.cache_misses)])
        prepare(kernel, title, seconds, empty_march(), _ORDER, options.form or None, data, 0)

    def solve(self, rows: Rows, options: RunOptions) -> Outcomes:
        """Solve rows without drag."""
        from .march import RowData, empty_march, empty_moments, march

        if rows.drag.any():
            raise ValueError("this kernel cannot solve rows with drag")
        numbers = packed(rows, options)
        results = np.zeros((len(rows), RESULTS))
        moments = empty_moments(_ROOM if options.times else 0)
        data = RowData(numbers.ravel(), results.ravel(), moments)
        lanes = empty_march()
        order = _MOVED_ORDER if options.moved else _ORDER

        # of each call: row, time and direction of its transits
        pieces = [[column[:0] for column in moments[1:]]]
        done = len(rows) == 0
        while not done:
            moments.number[0] = 0
            done = march(lanes, order, options.form or None, data, _STEPS_PER_CALL)
            pieces.append([column[: moments.number[0]].copy() for column in moments[1:]])

        row, t, direction = (np.concatenate(column) for column in zip(*pieces, strict=True))
        by_row = np.argsort(row, kind="stable")  # those of a row are in order of time
        found = row[by_row], t[by_row], direction[by_row].astype(np.int8)
        return outcomes(rows, numbers, results, found)

    def compiling_s(self, sections: bool) -> float:
        """Return what compiling takes here.

        The variant for sections is kept beside that of all rows.
        """
        missing = 1 + sections - kept_variants("march", folder_of(SOURCES))
        return sum(self.compile_s[: max(missing, 0)])


BATCH = OctetBatch()
