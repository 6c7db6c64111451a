"""A row's transits and highest points, noted as they are found: numbers, first and last, the least sharp."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..limbs.compiling import compiled
from ..limbs.limb import Array
from . import rows


class Moments(NamedTuple):
    """Times of transits: their number so far, and of each its row, time and direction."""

    number: npt.NDArray[np.int64]
    row: npt.NDArray[np.int64]
    time: Array
    direction: Array


def empty_moments(room: int) -> Moments:
    """Return room for times; none for none."""
    return Moments(np.zeros(1, dtype=np.int64), np.zeros(room, dtype=np.int64), np.zeros(room), np.zeros(room))


@compiled
def note_transit(out: Array, at: int, row: int, moments: Moments, time: float, slope: float, close: float) -> None:
    """Note a transit of a row whose results begin at `at`; `close` is what makes two of them a close pair, in s."""
    if out[at + rows.COUNT] == 0.0:
        out[at + rows.T_FIRST], out[at + rows.LEAST_SLOPE] = time, abs(slope)
    elif time - out[at + rows.T_LAST] < close:
        out[at + rows.CLOSE] += 1.0
    out[at + rows.COUNT] += 1.0
    out[at + rows.T_LAST] = time
    out[at + rows.LEAST_SLOPE] = min(out[at + rows.LEAST_SLOPE], abs(slope))
    n = moments.number[0]
    if n < len(moments.row):
        moments.row[n], moments.time[n], moments.direction[n] = row, time, 1.0 if slope > 0.0 else -1.0
        moments.number[0] = n + 1


@compiled
def note_highest(out: Array, at: int, time: float, x: float, p: float, u: float, bend: float) -> None:
    """Note a highest point (x, p, u); half turns are counted where the direction, less a half turn, passes east."""
    if p < 0.0 or (p == 0.0 and x < 0.0):
        x, p = -x, -p
    if out[at + rows.APSIDES] == 0.0:
        out[at + rows.A_FIRST], out[at + rows.LEAST_BEND] = time, bend
        out[at + rows.X_FIRST], out[at + rows.P_FIRST] = x, p
    elif out[at + rows.X_LAST] * x + out[at + rows.P_LAST] * p < 0.0:
        out[at + rows.HALF_TURNS] += 1.0 if out[at + rows.X_LAST] * p - out[at + rows.P_LAST] * x < 0.0 else -1.0
    out[at + rows.APSIDES] += 1.0
    out[at + rows.A_LAST], out[at + rows.X_LAST], out[at + rows.P_LAST] = time, x, p
    out[at + rows.LEAST_BEND] = min(out[at + rows.LEAST_BEND], bend)
    out[at + rows.HIGHEST] = max(out[at + rows.HIGHEST], u)
