"""The recurrence in limbs is the model of `formulations`, coefficient by coefficient; its unrolled sums are exact."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

import numba
from small_scenes import make_scene
from taylor_of_model import Polynomial, taylor

from reference.engines.limbs.lanes import LANES
from reference.engines.limbs.series import MOST_ORDER, MOST_ROWS, PLANES, WIDTH, add_convolved, empty_series
from reference.engines.limbs.size import LIMB_BITS
from reference.engines.registry import engines
from reference.model.force import tension
from reference.model.formulations import FORMULATIONS

BITS = 150
ORDER, SERIES_ORDER = 30, 73  # of the comparison; the series goes further
LAST_PLACES = 64  # units of the last limb: a coefficient is divided once an order


def first_step(scene):
    return next(engines()["limbs"].taylor_steps(scene.exact, (Fraction(0),), BITS, 2 * SERIES_ORDER))


def assert_same_coefficients(scene, formulation="momentum"):
    step = first_step(scene)
    ctx, k, rows = taylor(scene.exact, formulation, ORDER, 3 * BITS)
    n, v = FORMULATIONS[formulation].cartesian([Polynomial(row) for row in rows], k, ctx)
    sin, cos = (k.sin, k.cos) if k.rate else (1, 0)
    expected = [n[0], sin * n[1] - cos * n[2], cos * n[1] + sin * n[2], tension(n, v, k)]
    h = ctx.mpf(step.h.numerator) / step.h.denominator
    for row, row_of_step, polynomial in zip(("x", "m", "w", "pull"), step.coefficients, expected, strict=True):
        for j, coefficient in enumerate(polynomial.coefficients):
            exact = coefficient * h ** (j + (2 if row == "pull" else 0)) * 2**step.bits
            assert abs(row_of_step[j] - exact) < LAST_PLACES, (row, j)


@pytest.mark.parametrize("formulation", ["momentum", "space", "spin"])
def test_the_series_of_paris_is_that_of_every_polynomial_formulation(paris, formulation):
    assert_same_coefficients(paris, formulation)


degrees = st.decimals(min_value=-90, max_value=90, places=3).map(str)
angles = st.decimals(min_value=0, max_value=180, places=3).map(str)
rotations = st.sampled_from(["0", "7.292115e-5", "0.05", "-0.7"])
turns = st.decimals(min_value=-360, max_value=360, places=3).map(str)


@settings(max_examples=12)
@given(degrees, angles, turns, turns, turns, rotations, st.sampled_from("01"))
def test_the_series_is_that_of_the_model_at_random_states(latitude, angle, azimuth, rate, turn, rotation, drag):
    scene = make_scene(
        pendulum={"length": "3.7", "drag": drag},
        site={"latitude": latitude, "rotation_rate": rotation, "equatorial_radius": "5"},
        release={"angle": angle, "azimuth": azimuth, "angle_rate": rate, "azimuth_rate": turn},
    )
    assert_same_coefficients(scene)


@pytest.mark.parametrize("latitude", ["0", "90", "-90"])
@pytest.mark.parametrize("rotation", ["0", "7.292115e-5"])
@pytest.mark.parametrize("drag", ["0", "0.1"])
def test_terms_that_vanish_are_not_missed(latitude, rotation, drag):
    assert_same_coefficients(
        make_scene(site={"latitude": latitude, "rotation_rate": rotation}, pendulum={"drag": drag})
    )


LARGEST = 2 ** (LIMB_BITS - 1)


def random_limbs(shape, seed):
    limbs = np.random.default_rng(seed).integers(-LARGEST, LARGEST + 1, size=shape)
    limbs.flat[::7] = LARGEST
    return limbs


@cache
def compiled_with(fastmath):
    @numba.njit(fastmath=fastmath, error_model="numpy")
    def run(rows, planes, factors, sums):
        add_convolved(rows, planes, 0, factors, 0, sums, 3)

    return run


@pytest.mark.parametrize("fastmath", [False, True])
@pytest.mark.parametrize("rows", range(MOST_ROWS + 1))
def test_convolved_rows_are_exact_sums_of_all_pairs_of_limbs(rows, fastmath):
    planes, sums = random_limbs((MOST_ROWS, PLANES, WIDTH), 1), random_limbs((MOST_ROWS, PLANES, WIDTH), 2)
    factors = np.repeat(2 * random_limbs((MOST_ROWS, PLANES, 1), 3), LANES, axis=2)
    expected, order = sums.copy(), slice(3, 3 + LANES)
    for r in range(rows):
        for p in range(r + 1):
            for lane in range(3):
                expected[r, lane, order] += factors[p, 3] * planes[r - p, lane, :LANES]
                expected[r, lane, order] += factors[p, lane] * planes[r - p, 3, :LANES]
    got = sums.astype(float)
    compiled_with(fastmath)(rows, planes.astype(float).ravel(), factors.astype(float).ravel(), got.reshape(-1))
    assert (got == expected).all()


def test_a_series_of_too_high_an_order_is_refused():
    with pytest.raises(ValueError, match="order"):
        empty_series(MOST_ORDER + 1, 3)
