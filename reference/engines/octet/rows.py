"""The kernel's input and results, a flat array of numbers for each row: made of `Rows`, turned into `Outcomes`.

States are in the axes of the plumb line, and in each row's unit of time.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...numbers.precision import Array
from ..batch_interface import (
    CLOSE_PAIR,
    LEAST_BEND,
    OK,
    Outcomes,
    PlumbAxes,
    Rows,
    RunOptions,
    moved,
    plumb_line,
    turned,
)

# Columns of a row's numbers. The state, and the constants Ω and |c|, in its unit of time:
X, P, U, W, V, S = range(6)
TURN_P, TURN_U, PULL = range(6, 9)
# the unit of time, and the span as a sum of two doubles, in s:
UNIT, END, END_LOW = range(9, 12)
# at the release the multiplicity of the form's zero, and the sign of u':
ZEROS_X, RISING = range(12, 14)
# the time in s below which two transits are a close pair:
CLOSE_S = 14
# 1 where transits, or highest points, are sought:
SEEKS_X, SEEKS_U = range(15, 17)
# the first of seven columns for a, b and d of a section's form:
FORM = 17
COLUMNS = 24

# Columns of a row's results. The state comes first, as above; then how the row ended:
STEPS, FATE = range(6, 8)
# transits: number, first and last time in s, close pairs, smallest rate of the form:
COUNT, T_FIRST, T_LAST, CLOSE, SMALLEST_SLOPE = range(8, 13)
# highest points: number, first and last time in s, half turns of the direction, largest u:
APSIDES, A_FIRST, A_LAST, HALF_TURNS, HIGHEST = range(13, 18)
# the directions of the first and of the last one, up to a half turn:
X_FIRST, P_FIRST, X_LAST, P_LAST = range(18, 22)
# least_bend and least_fall of `Outcomes`, in units of time:
SMALLEST_BEND, SMALLEST_FALL = range(22, 24)
# the side of the plumb line that the last one is on, and how many are on the side of the one
# before:
SIDE_LAST, SAME_SIDE = range(24, 26)
RESULTS = 26

TOLERANCE = 2.0**-54  # the size that a step's last coefficients have, against the motion

_ENGINES = Path(__file__).parents[1]
# the files that the kernel's machine code is made of
SOURCES = [
    _ENGINES / "batch_interface.py",
    *_ENGINES.glob("simd/*.py"),
    *_ENGINES.glob("octet/*.py"),
]


def packed(rows: Rows, options: RunOptions) -> Array:
    """Return the numbers of rows, shape (rows, COLUMNS).

    Constants and state are moved by an ulp as `options.moved` says.
    """
    axes = PlumbAxes.of(rows)
    numbers = np.zeros((len(rows), COLUMNS))
    _put_motion(numbers, axes, options.moved)
    unit = _unit_of_time(axes, rows)
    numbers[:, [TURN_P, TURN_U, W, V, S]] *= unit[:, None]
    numbers[:, PULL] *= unit * unit
    if options.form:
        numbers[:, FORM:] = axes.forms(rows).T
        numbers[:, [FORM, FORM + 1, FORM + 2, FORM + 6]] *= unit[:, None]

    numbers[:, UNIT] = unit
    numbers[:, END : END + 2] = rows.t_end
    numbers[:, ZEROS_X] = rows.zeros_at_release
    numbers[:, RISING] = rows.rising
    with np.errstate(divide="ignore"):
        numbers[:, CLOSE_S] = CLOSE_PAIR * 2.0 * np.pi / np.sqrt(axes.size.high)
    numbers[:, SEEKS_X] = (options.transits or options.times) & ~rows.still
    numbers[:, SEEKS_U] = options.apsides & (axes.size.high > 0)
    return numbers


def _put_motion(numbers: Array, axes: PlumbAxes, ulps: int) -> None:
    """Write the states and the constants in seconds, each moved by this many ulps away from zero."""
    x, p, down = axes.n
    east, v, s = axes.V
    turn_p, turn_u = axes.turn
    # u = 1 + down, without cancellation near the lowest point
    u = ((x * x + p * p) / (1.0 - down)).where(down.high < 0, 1.0 + down)
    columns = {
        X: x,
        P: p,
        U: u,
        W: east + turn_p,
        V: v,
        S: s,
        TURN_P: turn_p,
        TURN_U: turn_u,
        PULL: axes.size,
    }
    for column, value in columns.items():
        numbers[:, column] = moved(value.high, ulps)


def _unit_of_time(axes: PlumbAxes, rows: Rows) -> Array:
    """Return each row's unit of time in s: a power of two, at most the reciprocal of the fastest rate."""
    rate = np.sqrt(axes.size.high) + axes.speed
    mantissa, exponent = np.frexp(np.where(rate > 0, rate, 1.0 / rows.t_end[:, 0]))
    return np.asarray(np.ldexp(1.0, (mantissa == 0.5) - exponent))


def outcomes(
    rows: Rows, numbers: Array, results: Array, moments: tuple[Any, Array, Any]
) -> Outcomes:
    """Return what became of rows in SI units; `moments` are row, time and direction of transits."""
    outcome = Outcomes.empty(len(rows))
    outcome.fate[:] = results[:, FATE]
    outcome.steps[:] = results[:, STEPS]
    outcome.state[:] = _si_state(rows, numbers, results)
    outcome.state[outcome.fate != OK] = np.nan
    _put_transits(outcome, rows, numbers, results)
    _put_highest_points(outcome, numbers, results)
    transit_row, transit_t, transit_direction = moments
    return replace(
        outcome,
        transit_row=transit_row,
        transit_t=transit_t,
        transit_direction=transit_direction,
    )


def _si_state(rows: Rows, numbers: Array, results: Array) -> Array:
    """Return x, y, z in m and vx, vy, vz in m/s at the end, shape (rows, 6)."""
    # many names, as each is a quantity of one formula
    length = rows.length[:, 0]
    unit = numbers[:, UNIT]
    turn_p = numbers[:, TURN_P]
    turn_u = numbers[:, TURN_U]
    x, p, u, w, v, s = results[:, : S + 1].T
    xdot = w - turn_p * u + turn_u * p
    pdot = v - turn_u * x
    udot = s + turn_p * x

    north = rows.pull[:, 1, 0]
    up = rows.pull[:, 2, 0]
    size = np.sqrt(north * north + up * up)  # not hypot, which differs from libm to libm
    sin, cos = plumb_line(north, up, size, np.where(size == 0, 1.0, 0.0))
    n = (x, *turned(p, u - 1.0, -sin, cos))
    rate = (xdot, *turned(pdot, udot, -sin, cos))
    return np.stack([*n, *(part / unit for part in rate)], axis=1) * length[:, None]


def _put_transits(outcome: Outcomes, rows: Rows, numbers: Array, results: Array) -> None:
    """Write what was found of transits."""
    unit = numbers[:, UNIT]
    least_ax = results[:, SMALLEST_SLOPE] * rows.length[:, 0] / (unit * unit)
    outcome.transits[:] = results[:, COUNT]
    outcome.close_pairs[:] = results[:, CLOSE]
    has_transits = outcome.transits > 0
    outcome.t_first[:] = np.where(has_transits, results[:, T_FIRST], np.nan)
    outcome.t_last[:] = np.where(has_transits, results[:, T_LAST], np.nan)
    outcome.least_ax[:] = np.where(has_transits, least_ax, np.nan)


def _put_highest_points(outcome: Outcomes, numbers: Array, results: Array) -> None:
    """Write what was found of highest points; there are none to speak of in conical orbits."""
    unit = numbers[:, UNIT]
    first = np.arctan2(results[:, P_FIRST], results[:, X_FIRST])
    last = np.arctan2(results[:, P_LAST], results[:, X_LAST])
    turn = last - first + np.pi * results[:, HALF_TURNS]
    fall = results[:, SMALLEST_FALL] / (unit * unit)

    bend = np.where(results[:, APSIDES] > 0, results[:, SMALLEST_BEND], np.nan)
    outcome.least_bend[:] = bend
    outcome.apsides[:] = np.where(bend >= LEAST_BEND, results[:, APSIDES], 0)
    has_apsides = outcome.apsides > 0
    outcome.same_side[:] = np.where(has_apsides, results[:, SAME_SIDE], 0)
    outcome.apsis_first[:] = np.where(has_apsides, results[:, A_FIRST], np.nan)
    outcome.apsis_last[:] = np.where(has_apsides, results[:, A_LAST], np.nan)
    outcome.turn[:] = np.where(has_apsides, turn, np.nan)
    outcome.least_fall[:] = np.where(has_apsides, fall, np.nan)
    sine_of_half_squared = np.clip(0.5 * results[:, HIGHEST], 0.0, 1.0)
    outcome.largest_angle[:] = 2.0 * np.arcsin(np.sqrt(sine_of_half_squared))
