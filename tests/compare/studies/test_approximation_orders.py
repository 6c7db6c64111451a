"""The error of every approximation against the reference has the slope that its theory says."""

from __future__ import annotations

import math

import pytest

from compare.approximations import APPROXIMATIONS, Motion
from compare.studies.approximation_orders import BASE, error, measure
from compare.studies.variation import varied

STATED = [(word, i) for word, one in APPROXIMATIONS.items() for i in range(len(one.orders))]
EXACT_M, EXACT_RELATIVE = 2e-12, 1e-13  # rounding of a metre-sized motion, and of a measured frequency


@pytest.mark.parametrize(("word", "which"), STATED)
def test_the_error_has_the_slope_of_its_theory(word, which):
    one = APPROXIMATIONS[word]
    measured = measure(one, one.orders[which])
    if measured.order.power is None:
        assert max(measured.errors) < (EXACT_M if isinstance(one, Motion) else EXACT_RELATIVE)
    else:
        assert min(measured.errors) > 0
        assert abs(measured.slope - measured.order.power) < 0.25, measured


def test_every_approximation_states_an_order():
    assert all(one.orders for one in APPROXIMATIONS.values())


def test_the_slope_tells_a_wrong_order():
    wrong = APPROXIMATIONS["mathar_item_4"].orders[0]
    measured = measure(APPROXIMATIONS["mathar_item_2"], wrong)
    assert abs(measured.slope - wrong.power) > 0.25


def test_one_value_has_no_slope():
    conical = APPROXIMATIONS["conical"]
    assert math.isnan(measure(conical, conical.orders[0]).slope)


@pytest.mark.parametrize("word", ["mathar_item_1", "mathar_item_1_variant", "linear_g", "method_2"])
def test_without_the_centrifugal_force_the_tilt_costs_as_many_metres_as_the_rest_position_is_off(word):
    # The bob swings about a wrong point d = 0.115 m away: it is 2 d off after half a swing.
    small = varied(BASE.with_values(["release.x=0.003", "release.y=0"]), "amplitude", 0.001)
    assert error(APPROXIMATIONS[word], small) == pytest.approx(0, abs=0.24)
    assert error(APPROXIMATIONS[word], small) > 0.22


def test_the_variant_of_item_1_is_exact_to_the_cord_at_the_equator():
    equator = BASE.with_values(["site.latitude=0"])
    assert (
        error(APPROXIMATIONS["mathar_item_1_variant"], equator)
        < 1e-6
        < 1e-2
        < error(APPROXIMATIONS["mathar_item_1"], equator)
    )
