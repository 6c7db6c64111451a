"""Rows for the kernel and what it makes of them: in the axes of the plumb line, in units of time, as flat arrays."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ...numbers.precision import Array
from ..batch_interface import (
    CLOSE_PAIR,
    OK,
    Outcomes,
    PlumbAxes,
    Rows,
    RunOptions,
    moved,
    plumb_line,
    turned,
)
from ..batch_interface import LEAST_BEND as LEAST

# of a row's numbers: state and constants in its unit of time, unit and span in s, what the release says of zeros
(
    X,
    P,
    U,
    W,
    V,
    S,
    TURN_P,
    TURN_U,
    PULL,
    UNIT,
    END,
    END_LOW,
    ZEROS_X,
    RISING,
    CLOSE_S,
    SEEKS_X,
    SEEKS_U,
) = range(17)
FORM, COLUMNS = 17, 24  # the form of a section: a, b and d
# of what comes out: the state, and what was found on the way
STEPS, FATE, COUNT, T_FIRST, T_LAST, CLOSE, LEAST_SLOPE = range(6, 13)
(
    APSIDES,
    A_FIRST,
    A_LAST,
    HALF_TURNS,
    HIGHEST,
    X_FIRST,
    P_FIRST,
    X_LAST,
    P_LAST,
    LEAST_BEND,
    LEAST_FALL,
) = range(13, 24)
SIDE_LAST, SAME_SIDE, RESULTS = 24, 25, 26
TOLERANCE = 2.0**-54  # the size that a step's last coefficients have, against the motion
_ENGINES = Path(__file__).parents[1]
# of the kernel
SOURCES = [*_ENGINES.glob("*.py"), *_ENGINES.glob("limbs/*.py"), *_ENGINES.glob("octet/*.py")]


def packed(rows: Rows, options: RunOptions) -> Array:
    """Return the numbers of rows, shape (rows, COLUMNS).

    Constants and state are moved by an ulp as `options.moved` says.
    """
    axes = PlumbAxes.of(rows)
    (x, p, down), (east, v, s), (turn_p, turn_u) = axes.n, axes.V, axes.turn
    u = ((x * x + p * p) / (1.0 - down)).where(down.high < 0, 1.0 + down)
    w = east + turn_p
    size, speed = axes.size, axes.speed
    numbers = np.zeros((len(rows), COLUMNS))
    for column, value in enumerate((x, p, u, w, v, s, turn_p, turn_u, size)):
        numbers[:, column] = moved(value.high, options.moved)
    rate = np.sqrt(size.high) + speed
    mantissa, exponent = np.frexp(np.where(rate > 0, rate, 1.0 / rows.t_end[:, 0]))
    unit = np.ldexp(1.0, (mantissa == 0.5) - exponent)  # a power of two: times the rate at most 1
    numbers[:, [TURN_P, TURN_U, W, V, S]] *= unit[:, None]
    numbers[:, PULL] *= unit * unit
    numbers[:, UNIT], numbers[:, END : END + 2] = unit, rows.t_end
    numbers[:, ZEROS_X], numbers[:, RISING] = rows.zeros_at_release, rows.rising
    numbers[:, SEEKS_X] = (options.transits or options.times) & ~rows.still
    numbers[:, SEEKS_U] = options.apsides & (size.high > 0)
    if options.form:
        numbers[:, FORM:] = axes.forms(rows).T
        numbers[:, [FORM, FORM + 1, FORM + 2, FORM + 6]] *= unit[:, None]
    with np.errstate(divide="ignore"):
        numbers[:, CLOSE_S] = CLOSE_PAIR * 2.0 * np.pi / np.sqrt(size.high)
    return numbers


def outcomes(
    rows: Rows, numbers: Array, results: Array, moments: tuple[Array, Array, Array]
) -> Outcomes:
    """Return what became of rows in SI units; `moments` are row, time and direction of transits."""
    r, length, unit = results.T, rows.length[:, 0], numbers[:, UNIT]
    turn_p, turn_u = numbers[:, TURN_P], numbers[:, TURN_U]
    x, p, u, w, v, s = r[:6]
    north, up = rows.pull[:, 1, 0], rows.pull[:, 2, 0]
    size = np.sqrt(north * north + up * up)  # not hypot, which differs from libm to libm
    sin, cos = plumb_line(north, up, size, np.where(size == 0, 1.0, 0.0))
    n = (x, *turned(p, u - 1.0, -sin, cos))
    velocity = (w - turn_p * u + turn_u * p, *turned(v - turn_u * x, s + turn_p * x, -sin, cos))
    result = Outcomes.empty(len(rows))
    result.fate[:] = r[FATE]
    result.steps[:] = r[STEPS]
    result.state[:] = np.stack([*n, *(part / unit for part in velocity)], axis=1) * length[:, None]
    result.transits[:], result.close_pairs[:] = r[COUNT], r[CLOSE]
    crossed = result.transits > 0
    result.t_first[:], result.t_last[:] = np.where(crossed, r[T_FIRST : T_LAST + 1], np.nan)
    result.least_ax[:] = np.where(crossed, r[LEAST_SLOPE] * length / (unit * unit), np.nan)
    result.least_bend[:] = np.where(r[APSIDES] > 0, r[LEAST_BEND], np.nan)
    result.apsides[:] = np.where(result.least_bend >= LEAST, r[APSIDES], 0)
    has_apsides = result.apsides > 0
    result.same_side[:] = np.where(has_apsides, r[SAME_SIDE], 0)
    result.least_fall[:] = np.where(has_apsides, r[LEAST_FALL] / (unit * unit), np.nan)
    result.apsis_first[:], result.apsis_last[:] = np.where(
        has_apsides, r[A_FIRST : A_LAST + 1], np.nan
    )
    first, last = np.arctan2(r[P_FIRST], r[X_FIRST]), np.arctan2(r[P_LAST], r[X_LAST])
    result.turn[:] = np.where(has_apsides, last - first + np.pi * r[HALF_TURNS], np.nan)
    result.largest_angle[:] = 2.0 * np.arcsin(np.sqrt(np.clip(0.5 * r[HIGHEST], 0.0, 1.0)))
    result.state[result.fate != OK] = np.nan
    return replace(
        result, transit_row=moments[0], transit_t=moments[1], transit_direction=moments[2]
    )
