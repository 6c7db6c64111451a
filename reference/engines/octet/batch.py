"""The kernel as an engine that solves many undamped scenes side by side; numba is imported when it runs."""

from __future__ import annotations

import time
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ..batch import Batch, Outcomes, Rows, Wanted
from .rows import COLUMNS, RESULTS, outcomes, packed

ORDER, MOVED_ORDER = 24, 22  # of a run, and of the run that tells the error
TOLERANCE = 2.0**-54
COMPILE_S, READ_S = 15.0, 1.2  # CPU seconds of numba and the kernel: cold, and kept on disk
SWING_S = 2.4e-6  # of a default row over the period of a small swing
STEPS_PER_CALL = 20_000  # then an interrupt is heard
ROOM = 1 << 16  # times that one call may find


class OctetBatch(Batch):
    """Taylor series of fixed order and adaptive step, eight rows at a time in machine code."""

    name = "octet"
    requires = ("numba",)
    extra = "methods"
    drag = False

    @property
    def identity(self) -> str:
        """Return orders, tolerance and the compiler."""
        return f"octet, orders {ORDER} and {MOVED_ORDER}, tolerance {TOLERANCE!r}, numba {version('numba')}"

    def prepare(self, wanted: Wanted, drag: bool) -> float:
        """Compile the kernel, or read it from the disk, once a process."""
        return 0.0 if _prepared.cache_info().currsize else _prepared()

    def solve(self, rows: Rows, wanted: Wanted) -> Outcomes:
        """Solve rows without drag."""
        from .found import empty_moments
        from .march import empty_march, march

        if rows.drag.any():
            raise ValueError("rows with drag are not for this kernel")
        numbers, results = packed(rows, wanted.moved), np.zeros((len(rows), RESULTS))
        lanes, moments = empty_march(), empty_moments(ROOM if wanted.times else 0)
        done, parts = len(rows) == 0, [(moments.row[:0], moments.time[:0], moments.direction[:0])]
        while not done:
            moments.number[0] = 0
            done = march(lanes, _settings(wanted), numbers.ravel(), results.ravel(), moments, STEPS_PER_CALL)
            n = int(moments.number[0])
            parts.append((moments.row[:n].copy(), moments.time[:n].copy(), moments.direction[:n].copy()))
        row, t, direction = (np.concatenate(part) for part in zip(*parts, strict=True))
        order = np.argsort(row, kind="stable")  # a row's own are in order of time
        return outcomes(rows, numbers, results, (row[order], t[order], direction[order].astype(np.int8)))

    def expected_s(self, swings: float) -> float:
        """Return the expected CPU seconds."""
        return COMPILE_S + swings * SWING_S

    @property
    def saved_s(self) -> float:
        """Return what is saved where the kernel, as its sources are now, is kept on disk beside them."""
        folder = Path(__file__).parent
        sources = [*folder.glob("*.py"), *(folder.parent / "limbs").glob("*.py")]
        newest = max(path.stat().st_mtime for path in sources)
        kept = any(path.stat().st_mtime > newest for path in (folder / "__pycache__").glob("march.*.nbi"))
        return COMPILE_S - READ_S if kept else 0.0


def _settings(wanted: Wanted) -> Any:
    from .march import Settings

    order = MOVED_ORDER if wanted.moved else ORDER
    return Settings(order, TOLERANCE, wanted.transits or wanted.times, wanted.apsides)


@cache
def _prepared() -> float:
    """Return the CPU seconds that compiling took, or reading what is kept on disk."""
    started = time.thread_time()
    from .found import empty_moments
    from .march import empty_march, march

    march(empty_march(), _settings(Wanted()), np.zeros(COLUMNS), np.zeros(RESULTS), empty_moments(0), 0)
    return time.thread_time() - started


BATCH = OctetBatch()
