"""The recurrence in limbs is the model of `formulations`, coefficient by coefficient."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from sampled import one_in
from small_scenes import make_scene
from taylor_of_model import Polynomial, taylor

from reference.engines.limbs.series import MOST_ORDER, empty_series
from reference.engines.registry import engines
from reference.model.force import tension
from reference.model.formulations import FORMULATIONS

BITS = 150
ORDER, SERIES_ORDER = 30, 73  # of the comparison; the series goes further
LAST_PLACES = 64  # units of the last limb: a coefficient is divided once an order


def first_step(scene, bits=BITS):
    return next(
        engines()["limbs"].taylor_steps(scene.exact, (Fraction(0),), bits, 2 * SERIES_ORDER)
    )


def assert_same_coefficients(scene, formulation="momentum", bits=BITS):
    step = first_step(scene, bits)
    ctx, k, rows = taylor(scene.exact, formulation, ORDER, 3 * bits)
    n, v = FORMULATIONS[formulation].cartesian([Polynomial(row) for row in rows], k, ctx)
    sin, cos = (k.sin, k.cos) if k.rate else (1, 0)
    expected = [n[0], sin * n[1] - cos * n[2], cos * n[1] + sin * n[2], tension(n, v, k)]
    h = ctx.mpf(step.h.numerator) / step.h.denominator
    for row, row_of_step, polynomial in zip(
        ("x", "m", "w", "pull"), step.coefficients, expected, strict=True
    ):
        for j, coefficient in enumerate(polynomial.coefficients):
            exact = coefficient * h ** (j + (2 if row == "pull" else 0)) * 2**step.bits
            assert abs(row_of_step[j] - exact) < LAST_PLACES, (row, j)


@pytest.mark.parametrize("formulation", one_in(3, ["space", "momentum", "spin"]))
def test_the_series_of_paris_is_that_of_every_polynomial_formulation(paris, formulation):
    assert_same_coefficients(paris, formulation)


# 4 to 18 limbs, the fewest and the most that are used
@pytest.mark.parametrize(
    ("bits", "drag"),
    one_in(3, product((66, 110, 220, 386), ("0", "0.7"))),
)
def test_the_series_is_that_of_the_model_for_few_limbs_and_for_many(bits, drag):
    scene = make_scene(
        pendulum={"length": "3.7", "drag": drag},
        release={"angle": "70", "azimuth": "20", "azimuth_rate": "30"},
    )
    assert_same_coefficients(scene, bits=bits)


degrees = st.decimals(min_value=-90, max_value=90, places=3).map(str)
angles = st.decimals(min_value=0, max_value=180, places=3).map(str)
rotations = st.sampled_from(["0", "7.292115e-5", "0.05", "-0.7"])
turns = st.decimals(min_value=-360, max_value=360, places=3).map(str)


def test_the_series_is_that_of_the_model_at_random_states(size):
    @settings(max_examples=size(3, 12))
    @given(degrees, angles, turns, turns, turns, rotations, st.sampled_from("01"))
    def at_random_states(latitude, angle, azimuth, rate, turn, rotation, drag):
        scene = make_scene(
            pendulum={"length": "3.7", "drag": drag},
            site={"latitude": latitude, "rotation_rate": rotation, "equatorial_radius": "5"},
            release={"angle": angle, "azimuth": azimuth, "angle_rate": rate, "azimuth_rate": turn},
        )
        assert_same_coefficients(scene)

    at_random_states()


@pytest.mark.parametrize(
    ("latitude", "rotation", "drag"),
    one_in(3, product(("0", "90", "-90"), ("0", "7.292115e-5"), ("0", "0.1"))),
)
def test_terms_that_vanish_are_not_missed(latitude, rotation, drag):
    assert_same_coefficients(
        make_scene(site={"latitude": latitude, "rotation_rate": rotation}, pendulum={"drag": drag})
    )


def test_a_series_of_too_high_an_order_is_refused():
    with pytest.raises(ValueError, match="order"):
        empty_series(MOST_ORDER + 1, 3)
