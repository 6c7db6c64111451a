"""The series of eight rows is that of limbs and of heyoka, coefficient by coefficient, at random states."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest

pytest.importorskip("numba")

import numba
from random_rows import KINDS, random_inputs, rows_of
from sampled import one_in

from reference.engines.batch_interface import RunOptions
from reference.engines.octet.march import empty_march
from reference.engines.octet.rows import UNIT, packed
from reference.engines.octet.series import taylor_coefficients
from reference.engines.registry import engines
from reference.engines.simd.lanes import LANES
from reference.model.start import Start
from reference.numbers.precision import to_fraction
from reference.numbers.taylor_step import EARTH

ORDER = 24
BITS = 150


@pytest.fixture(scope="module")
def coefficients():
    """Return a function from rows to coefficients of x, m, w: shape (3, ORDER + 1, rows), in the unit of each row."""

    @numba.njit(error_model="numpy")
    def fill(m, order):
        taylor_coefficients(m.series, m.state, order)

    def of(many):
        rows, m = rows_of(many), empty_march()
        numbers = packed(rows, RunOptions()).T
        m.state.reshape(-1, LANES)[:, : len(many)] = numbers
        fill(m, ORDER)
        x, p, u = (
            array.reshape(-1, LANES)[: ORDER + 1, : len(many)]
            for array in (m.series.x, m.series.p, m.series.u)
        )
        return x, p, u, numbers[UNIT], rows

    return of


def exact_series(engine, inputs):
    """The first step's coefficients of n east, north, up, shape (3, ORDER + 1), and its length, as fractions."""
    step = next(engines()[engine].taylor_steps(inputs, (Fraction(0),), BITS, 2 * BITS))
    rows = [
        [Fraction(int(row[k]), 2**step.bits) for k in range(ORDER + 1)]
        for row in list(step.coefficients)[:3]
    ]
    rows = np.array(rows, dtype=object)
    if step.columns == EARTH:
        k = Start.of(inputs, BITS).k
        sin, cos = (
            to_fraction(value) if value else Fraction(0)
            for value in ((k.sin, k.cos) if k.rate else (1, 0))
        )
        rows = np.array([rows[0], sin * rows[1] + cos * rows[2], sin * rows[2] - cos * rows[1]])
    return rows, step.h


@pytest.mark.parametrize(
    ("engine", "kind"),
    [*(("limbs", kind) for kind in KINDS), *one_in(3, (("heyoka", kind) for kind in KINDS))],
)
def test_the_series_is_that_of_other_engines_at_random_states(coefficients, engine, kind, size):
    generator = random.Random(f"{engine} {kind}")
    for _ in range(size(1, 4)):
        many = [random_inputs(kind, generator) for _ in range(size(4, 8))]
        x, p, u, unit, rows = coefficients(many)
        for i, inputs in enumerate(many):
            exact, h = exact_series(engine, inputs)
            pull = rows.pull[i, :, 0]
            lean, upright = -pull[1:] / np.linalg.norm(pull)
            up = u[:, i].copy()
            up[0] -= 1.0
            ours = x[:, i], upright * p[:, i] + lean * up, upright * up - lean * p[:, i]
            scale = [Fraction(unit[i] ** order) / h**order for order in range(ORDER + 1)]
            theirs = np.array(exact * np.array(scale), dtype=float)
            largest = np.abs(theirs).max(axis=0)
            # the rounding of a coefficient goes into all that follow; at rest every second order is next to nothing
            near = np.maximum(
                largest, np.maximum(np.append(0.0, largest[:-1]), np.append(largest[1:], 0.0))
            )
            allowed = 2.0**-50 * (4 + np.arange(ORDER + 1)) * near
            assert (np.abs(np.array(ours) - theirs) <= allowed).all(), inputs
