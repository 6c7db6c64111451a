"""The kernel as an engine that solves many undamped scenes side by side; numba is imported when it runs."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, cast

import numpy as np

from ...numbers.precision import Array
from ...system.machine_code import folder_of, kept_variants, prepare
from ..batch_interface import Batch, Outcomes, Rows, RunOptions
from .rows import COLUMNS, RESULTS, SOURCES, TOLERANCE, outcomes, packed

ORDER, MOVED_ORDER = 24, 22  # of a run, and of the run that tells the error
STEPS_PER_CALL = 20_000  # then an interrupt is heard
ROOM = 1 << 16  # times that one call may find


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
        return f"octet, orders {ORDER} and {MOVED_ORDER}, tolerance {TOLERANCE!r}, numba {version('numba')}"

    def prepare(self, options: RunOptions) -> None:
        """Compile the kernel, or read it from the disk, once a process: later calls find it done."""
        from .march import empty_march, empty_moments, march

        arguments = _arguments(
            empty_march(), options, np.zeros(COLUMNS), np.zeros(RESULTS), empty_moments(0), 0
        )
        what, kernel = (
            "steps of eight rows at once" + " with sections" * options.form,
            cast("Any", march),
        )
        prepare(kernel, what, round(self.compile_s[bool(kernel.stats.cache_misses)]), *arguments)

    def solve(self, rows: Rows, options: RunOptions) -> Outcomes:
        """Solve rows without drag."""
        from .march import empty_march, empty_moments, march

        if rows.drag.any():
            raise ValueError("rows with drag are not for this kernel")
        numbers, results = packed(rows, options), np.zeros((len(rows), RESULTS))
        lanes, moments = empty_march(), empty_moments(ROOM if options.times else 0)
        done, pieces = len(rows) == 0, [[column[:0] for column in moments[1:]]]
        while not done:
            moments.number[0] = 0
            done = march(*_arguments(lanes, options, numbers, results, moments, STEPS_PER_CALL))
            pieces.append([column[: moments.number[0]].copy() for column in moments[1:]])
        row, t, direction = (np.concatenate(column) for column in zip(*pieces, strict=True))
        order = np.argsort(row, kind="stable")  # a row's own are in order of time
        return outcomes(
            rows, numbers, results, (row[order], t[order], direction[order].astype(np.int8))
        )

    def compiling_s(self, sections: bool) -> float:
        """Return what compiling takes here; the variant for sections is kept beside that of all rows."""
        left = 1 + sections - kept_variants("march", folder_of(SOURCES))
        return sum(self.compile_s[: max(left, 0)])


def _arguments(
    lanes: Any, options: RunOptions, numbers: Array, results: Array, moments: Any, steps: int
) -> tuple[Any, ...]:
    """Return the arguments of `march`."""
    order = MOVED_ORDER if options.moved else ORDER
    return lanes, order, options.form or None, numbers.ravel(), results.ravel(), moments, steps


BATCH = OctetBatch()
