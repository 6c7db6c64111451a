"""What a row's transits and highest points amount to, written as they are found."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..limbs.lanes import compiled
from ..limbs.limb import Array
from .rows import (
    A_FIRST,
    A_LAST,
    APSIDES,
    CLOSE,
    COUNT,
    HALF_TURNS,
    HIGHEST,
    LEAST_BEND,
    LEAST_SLOPE,
    P_FIRST,
    P_LAST,
    T_FIRST,
    T_LAST,
    X_FIRST,
    X_LAST,
)


class Moments(NamedTuple):
    """Times of transits: their number so far, and of each its row, time and direction."""

    count: npt.NDArray[np.int64]
    row: npt.NDArray[np.int64]
    time: Array
    direction: Array


def empty_moments(room: int) -> Moments:
    """Return room for times; none for none."""
    return Moments(np.zeros(1, dtype=np.int64), np.zeros(room, dtype=np.int64), np.zeros(room), np.zeros(room))


@compiled
def note_transit(out: Array, at: int, row: int, moments: Moments, time: float, slope: float, close: float) -> None:
    """Note a transit of a row whose results begin at `at`; `close` is what makes two of them a close pair, in s."""
    if out[at + COUNT] == 0.0:
        out[at + T_FIRST], out[at + LEAST_SLOPE] = time, abs(slope)
    elif time - out[at + T_LAST] < close:
        out[at + CLOSE] += 1.0
    out[at + COUNT] += 1.0
    out[at + T_LAST] = time
    out[at + LEAST_SLOPE] = min(out[at + LEAST_SLOPE], abs(slope))
    n = moments.count[0]
    if n < len(moments.row):
        moments.row[n], moments.time[n], moments.direction[n] = row, time, 1.0 if slope > 0.0 else -1.0
        moments.count[0] = n + 1


@compiled
def note_highest(out: Array, at: int, time: float, x: float, p: float, u: float, bend: float) -> None:
    """Note a highest point (x, p, u); half turns are counted where the direction, less a half turn, passes east."""
    if p < 0.0 or (p == 0.0 and x < 0.0):
        x, p = -x, -p
    if out[at + APSIDES] == 0.0:
        out[at + A_FIRST], out[at + X_FIRST], out[at + P_FIRST], out[at + LEAST_BEND] = time, x, p, bend
    elif out[at + X_LAST] * x + out[at + P_LAST] * p < 0.0:
        out[at + HALF_TURNS] += 1.0 if out[at + X_LAST] * p - out[at + P_LAST] * x < 0.0 else -1.0
    out[at + APSIDES] += 1.0
    out[at + A_LAST], out[at + X_LAST], out[at + P_LAST] = time, x, p
    out[at + LEAST_BEND] = min(out[at + LEAST_BEND], bend)
    out[at + HIGHEST] = max(out[at + HIGHEST], u)
