"""The truth between the grid times of a golden dataset: integrated from each golden state to the next.

Between two grid times a run has no time to lose digits, and where it arrives, the next golden state says
how many it has lost: the bound is measured interval by interval, not assumed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from .constants import Constants, constants
from .errors import InputError
from .golden import Golden
from .mechanics import FORMULATIONS
from .precision import GUARD_BITS, LONG_DOUBLE, NumberType, context, real
from .solution import GRID_COLUMNS, Array

TYPES = (LONG_DOUBLE, real(128), real(192))  # the next is tried where the one before loses too much
WITHIN = 2.0**-58  # of the cord length: enough to judge programs in double
SAFETY = 4  # a run is better in the middle of an interval than at its end, where it is measured


@dataclass(frozen=True)
class Dense:
    """A trajectory at chosen times, finer than binary64.

    Attributes:
        t: times in s, shape (rows,), increasing, without repeats.
        states: nearest doubles of x, y, z (m), vx, vy, vz (m/s), shape (rows, 6).
        rest: what the doubles lack, shape (rows, 6): the values are states + rest.
        bound_m: how far any position may be from the truth.
        number: the type that was enough.
    """

    t: Array
    states: Array = field(repr=False)
    rest: Array = field(repr=False)
    bound_m: float
    number: str


def dense(golden: Golden, times: npt.ArrayLike, within: float = WITHIN) -> Dense:
    """Evaluate the truth of a golden dataset at any times within it.

    Args:
        golden: its grid states are where every interval starts.
        times: in s, in any order; repeated ones are merged.
        within: how near to the truth to come, relative to the cord length; what was reached is in `bound_m`.

    Raises:
        InputError: a time is not finite, or outside of the dataset and more than a grid step beyond its end.
    """
    wanted = np.unique(np.asarray(times, dtype=np.float64).ravel())
    grid = [Fraction(text) for text in golden.decimals("t")]
    _check(wanted, 2 * grid[-1] - grid[-2])
    scale = float(golden.scene.exact.length)
    for number in TYPES:
        states, rest, missed = _marched(golden, grid, wanted, number)
        if missed <= within * scale:
            break
    bound = SAFETY * missed + float(golden.manifest.bounds.position_m)
    return Dense(wanted, states, rest, bound, str(number))


def _check(times: Array, end: Fraction) -> None:
    if not len(times):
        raise InputError("t", "no times", "at least one time in s")
    if not np.isfinite(times).all() or times[0] < 0 or Fraction(times[-1]) > end:
        strange = times[~np.isfinite(times)][:1] if not np.isfinite(times).all() else times[[0, -1]]
        raise InputError(
            "t", ", ".join(f"{t:.17g}" for t in strange), f"times from 0 to {float(end):.17g} s", "Change run.t_end."
        )


def _marched(golden: Golden, grid: list[Fraction], wanted: Array, number: NumberType) -> tuple[Array, Array, float]:
    """States, what their doubles lack, and the largest distance in m from a golden state on arrival."""
    from . import taylor

    numbers = taylor.Numbers(number)
    k = constants(golden.scene.exact, context(number.prec + GUARD_BITS)).converted(numbers.of)
    model = FORMULATIONS["momentum"]
    flow = taylor.Flow(model.variables, taylor.rates(model, k), number)
    anchors = _anchors(golden, numbers, k)
    moments = np.array([numbers.of(t) for t in grid], dtype=numbers.dtype)
    exact = np.array([float(t) for t in grid])
    edges = np.searchsorted(wanted, exact)  # where each anchor would stand among the times wanted
    taken: list[Any] = []
    missed: Any = 0.0
    for i in range(len(grid)):
        last = i + 1 == len(grid)
        inside = wanted[edges[i] : len(wanted) if last else edges[i + 1]]
        if not len(inside):
            continue
        offsets = inside.astype(numbers.dtype) - moments[i]
        on_anchor = bool(inside[0] == exact[i]) and grid[i] == Fraction(inside[0])
        if on_anchor:
            taken.append(anchors[i][None, :])
            offsets = offsets[1:]
        if not len(offsets):
            continue
        legs = [numbers.of(0), *offsets, *([] if last else [moments[i + 1] - moments[i]])]
        states = flow.from_zero(anchors[i], legs)
        taken.append(states[1 : 1 + len(offsets)])
        if not last:
            missed = max(missed, np.abs((states[-1, :3] - anchors[i + 1][:3]).astype(float)).max())
    columns = tuple(np.ascontiguousarray(np.concatenate(taken).T))
    position, velocity = model.cartesian(columns, k, np)
    rows = np.array([np.asarray(part * k.length) for part in (*position, *velocity)]).T
    near = rows.astype(np.float64)
    rest = (rows - near.astype(numbers.dtype)).astype(np.float64)
    return near, rest, float(missed) * float(k.length)


def _anchors(golden: Golden, numbers: Any, k: Constants) -> Any:
    """Golden states in the variables of `momentum`, shape (grid times, 6), rounded once."""
    ctx = context(numbers.number.prec + GUARD_BITS)
    exact = constants(golden.scene.exact, ctx)
    model = FORMULATIONS["momentum"]
    texts = zip(*(golden.decimals(name) for name in GRID_COLUMNS), strict=True)
    anchors = []
    for row in texts:
        x, y, z, vx, vy, vz = (ctx.mpf(text) / exact.length for text in row)
        anchors.append([numbers.of(part) for part in model.start((x, y, z), (vx, vy, vz), exact, ctx)])
    return np.array(anchors, dtype=numbers.dtype)
