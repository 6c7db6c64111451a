"""Solve rows with the kernel, call by call, so that an interrupt is heard and times find room."""

from __future__ import annotations

import time
from functools import cache

import numpy as np

from ..batch import Outcomes, Rows, Wanted
from .batch import MOVED_ORDER, ORDER, TOLERANCE
from .found import Moments, empty_moments
from .march import Settings, empty_march, march
from .rows import COLUMNS, RESULTS, outcomes, packed

STEPS_PER_CALL = 20_000
ROOM = 1 << 16  # times that one call may find


@cache
def _prepared() -> float:
    """Compile the kernel; return the CPU seconds that it took."""
    started = time.thread_time()
    march(empty_march(), _settings(Wanted()), np.zeros(COLUMNS), np.zeros(RESULTS), empty_moments(0), 0)
    return time.thread_time() - started


def prepare() -> float:
    """Compile the kernel if that is not done yet; return the CPU seconds that it took."""
    done = _prepared.cache_info().currsize
    return 0.0 if done else _prepared()


def _settings(wanted: Wanted) -> Settings:
    order = MOVED_ORDER if wanted.moved else ORDER
    return Settings(order, TOLERANCE, wanted.transits or wanted.times, wanted.apsides)


def solve(rows: Rows, wanted: Wanted) -> Outcomes:
    """Solve rows without drag; see `Batch.solve`."""
    if rows.drag.any():
        raise ValueError("rows with drag are not for this kernel")
    if not len(rows):
        return Outcomes.empty(0)
    numbers, results = packed(rows, wanted.moved), np.zeros((len(rows), RESULTS))
    lanes, settings, moments = empty_march(), _settings(wanted), empty_moments(ROOM if wanted.times else 0)
    kept: list[tuple[np.ndarray, ...]] = []
    while True:
        done = march(lanes, settings, numbers.ravel(), results.ravel(), moments, STEPS_PER_CALL)
        kept.append(_drained(moments))
        if done:
            break
    row, t, direction = (np.concatenate(parts) for parts in zip(*kept, strict=True))
    order = np.argsort(row, kind="stable")  # a row's own are in order of time
    return outcomes(rows, numbers, results, (row[order], t[order], direction[order].astype(np.int8)))


def _drained(moments: Moments) -> tuple[np.ndarray, ...]:
    n = int(moments.count[0])
    moments.count[0] = 0
    return moments.row[:n].copy(), moments.time[:n].copy(), moments.direction[:n].copy()
