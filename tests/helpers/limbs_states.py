"""States of a run in limbs at many times, as unevaluated sums of two doubles: a finer truth for arrays."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import numpy.typing as npt

from reference.engines.limbs.run import Integration
from reference.engines.limbs.size import LIMB_BITS
from reference.engines.plan import Plan
from reference.engines.simd.lanes import LANES
from reference.errors import InputError
from reference.numbers.precision import Array, NumberType
from reference.scenes.inputs import Inputs

STATES_BITS = 93  # the precision that five limbs hold of a swing of half a metre below 67 m


def states(inputs: Inputs, times: npt.ArrayLike, bits: int = STATES_BITS) -> tuple[Array, Array]:
    """Return positions and velocities at many times, as unevaluated sums of two doubles.

    Args:
        inputs: exact numbers of a scene (`Scene.exact`).
        times: in s, not negative, increasing, shape (rows,); each double is taken exactly.
        bits: of the run.

    Returns:
        High and low parts, each of shape (rows, 6): x, y, z in m, vx, vy, vz in m/s. For a day of the Paris scene
        they are off by less than 1e-28 m; an estimate, not a bound.

    Raises:
        InputError: times are negative, not finite or not increasing.
        IntegrationError: no step is short enough.
    """
    moments = np.ascontiguousarray(times, dtype=np.float64)
    if moments.ndim != 1 or not len(moments) or not np.isfinite(moments).all():
        raise InputError("times", moments.shape, "a list of finite numbers, at least one")
    if moments[0] < 0 or (np.diff(moments) <= 0).any():
        raise InputError(
            "times", "a list that decreases or is negative", "increasing numbers from 0 on"
        )
    exact_times = tuple(map(Fraction, moments.tolist()))
    integration = Integration(Plan(inputs, "inertial", NumberType("limbs", bits), exact_times))
    integration.finish(None)
    problem = integration.problem
    limb_count = problem.model.limb_count
    rows = integration.out.states.reshape(len(moments), limb_count, LANES)[:, :, :6]
    high, low = _two_doubles(rows, limb_count)
    length = inputs.length
    factors = [length / problem.unit**power for power in (0, 1)]
    parts = [(float(f), float(f - Fraction(float(f)))) for f in factors]
    top = np.array([parts[i // 3][0] for i in range(6)])
    bottom = np.array([parts[i // 3][1] for i in range(6)])
    return _product(high, low, top, bottom)


def _two_doubles(rows: Array, limb_count: int) -> tuple[Array, Array]:
    """Return limbs of shape (rows, limb_count, columns) as double-doubles."""
    weight = 2.0 ** (1 - LIMB_BITS * np.arange(1, limb_count + 1))
    high, low = np.zeros_like(rows[:, 0]), np.zeros_like(rows[:, 0])
    for q in range(0, limb_count, 2):  # two limbs are one exact double
        pair = rows[:, q] * weight[q] + (
            rows[:, q + 1] * weight[q + 1] if q + 1 < limb_count else 0.0
        )
        high, error = _sum(high, pair)
        low = low + error
    return _sum(high, low)


def _sum(a: Array, b: Array) -> tuple[Array, Array]:
    total = a + b
    other = total - a
    return total, (a - (total - other)) + (b - other)


def _product(high: Array, low: Array, top: Array, bottom: Array) -> tuple[Array, Array]:
    """Return the product of double-doubles, by Dekker's splitting."""
    product = high * top
    a, b = _halves(high), _halves(top)
    error = ((a[0] * b[0] - product) + a[0] * b[1] + a[1] * b[0]) + a[1] * b[1]
    return _sum(product, error + (high * bottom + low * top))


def _halves(a: Array) -> tuple[Array, Array]:
    large = a * 134217729.0
    high = large - (large - a)
    return high, a - high
