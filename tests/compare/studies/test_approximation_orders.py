"""The error of every approximation against the reference has the slope that its theory says."""

from __future__ import annotations

import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS, Motion
from compare.approximations.case import Case
from compare.observed.least_squares import power_law
from compare.studies.approximation_limits import varied
from reference import parse_scene, trajectory

BASE = parse_scene(
    {"id": "order", "title": "Paris, against which orders are measured", "release": {"x": "0.3", "y": "0.4"}}
)
TIMES = np.linspace(0.0, 60.0, 121)  # s, at which a motion is compared
STATED = [(word, i) for word, one in APPROXIMATIONS.items() for i in range(len(one.orders))]
EXACT_M, EXACT_RELATIVE = 2e-12, 1e-13  # rounding of a metre-sized motion, and of a measured frequency


def error(word, scene):
    """Return the largest distance from the reference in m over TIMES, or the error of a quantity as it declares."""
    approximation = APPROXIMATIONS[word]
    if isinstance(approximation, Motion):
        approximate, true = (rows.T[:3] for rows in (approximation.trajectory(scene, TIMES), trajectory(scene, TIMES)))
        return float(np.linalg.norm(approximate - true, axis=0).max())
    truth = approximation.truth(scene)
    gap = approximation.value(scene) - truth
    return float(abs(gap / truth if approximation.relative else gap))


def errors_of(word, order):
    """Return the errors of an approximation at the values of an order, in its setting."""
    setting = BASE.with_values(order.setting)
    scenes = [varied(setting, order.against, value) for value in order.values]
    if order.amplitude is not None:
        scenes = [released(scene, order.amplitude) for scene in scenes]
    return [error(word, scene) for scene in scenes]


def released(scene, amplitude):
    """Return the scene released without velocity so many metres from its rest position, between east and north."""
    case = Case.of_scene(scene)
    y = case.rest[1] * case.length + 0.8 * amplitude
    place = [f"release.x={0.6 * amplitude}", f"release.y={case.ctx.nstr(y, 40)}"]
    return scene.with_values([*place, "release.vx=0", "release.vy=0"])


def slope(order, errors):
    """Return the power with which the errors grow with the values of an order."""
    return power_law(order.values, errors).exponent


@pytest.mark.parametrize(("word", "which"), STATED)
def test_the_error_has_the_slope_of_its_theory(word, which):
    order = APPROXIMATIONS[word].orders[which]
    errors = errors_of(word, order)
    if order.power is None:
        assert max(errors) < (EXACT_M if isinstance(APPROXIMATIONS[word], Motion) else EXACT_RELATIVE)
    else:
        assert min(errors) > 0
        assert abs(slope(order, errors) - order.power) < 0.25, errors


def test_every_approximation_states_an_order():
    assert all(one.orders for one in APPROXIMATIONS.values())


def test_the_slope_tells_a_wrong_order():
    wrong = APPROXIMATIONS["mathar_item_4"].orders[0]
    assert abs(slope(wrong, errors_of("mathar_item_2", wrong)) - wrong.power) > 0.25


@pytest.mark.parametrize("word", ["mathar_item_1", "mathar_item_1_variant", "linear_g", "method_2"])
def test_without_the_centrifugal_force_the_tilt_costs_as_many_metres_as_the_rest_position_is_off(word):
    # The bob swings about a wrong point d = 0.115 m away: it is 2 d off after half a swing.
    small = varied(BASE.with_values(["release.x=0.003", "release.y=0"]), "amplitude", 0.001)
    assert error(word, small) == pytest.approx(0, abs=0.24)
    assert error(word, small) > 0.22


def test_the_variant_of_item_1_is_exact_to_the_cord_at_the_equator():
    equator = BASE.with_values(["site.latitude=0"])
    assert error("mathar_item_1_variant", equator) < 1e-6 < 1e-2 < error("mathar_item_1", equator)
