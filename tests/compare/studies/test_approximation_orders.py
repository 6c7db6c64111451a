"""The error of every approximation against the reference has the slope that its theory says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS, Motion
from compare.approximations.case import PaperCase
from compare.studies.approximation_limits import varied
from reference import parse_scene, trajectory

BASE = parse_scene(
    {
        "id": "order",
        "title": "Paris, against which orders are measured",
        "release": {"x": "0.3", "y": "0.4"},
    }
)
TIMES = np.linspace(0.0, 60.0, 121)  # s, at which a motion is compared
# rounding of a metre-sized motion, and of a measured frequency
EXACT_M, EXACT_RELATIVE = 2e-12, 1e-13


@dataclass(frozen=True)
class Order:
    """A statement of theory: the error is proportional to `against` ** `power`.

    Attributes:
        against: quantity that is varied: the displacement from the rest position in m, Ω in rad/s, or the length in m.
        power: the exponent; None where the approximation is exact and only rounding errors remain.
        values: values of `against` at which the error is measured.
        setting: `section.key=value` replacements that make this error the largest one.
        amplitude: fixed displacement from the rest position in m, released at rest; None: as the scene says.
    """

    against: str
    power: int | None
    values: tuple[float, ...]
    setting: tuple[str, ...] = ()
    amplitude: float | None = None


STILL = ("site.rotation_rate=0",)
ON_AXIS = ("site.equatorial_radius=0",)  # R = 0: the rest position stays below the suspension
AT_POLE = ("site.latitude=90", "site.rotation_rate=2e-3")
SMALL_BODY = ("site.equatorial_radius=300",)  # where l is a large part of N + h
CIRCLE = (  # cos φ = 0.8, angular velocity 1 rad/s
    "pendulum.length=12.25",
    "site.gravity=9.8",
    "release.x=7.35",
    "release.y=0",
    "release.vy=7.35",
)

CUBE_IN_AMPLITUDE = Order("amplitude", 3, (0.5, 1.0, 2.0, 4.0), STILL)
SQUARE_IN_RATE = Order(
    "rotation_rate", 2, (1e-5, 2e-5, 4e-5, 8e-5), ("release.x=3e-3", "release.y=4e-3")
)
LINEAR = (SQUARE_IN_RATE, CUBE_IN_AMPLITUDE)
ABOUT_REST = (Order("rotation_rate", 2, (1e-3, 2e-3, 4e-3), ON_AXIS, 1e-3), CUBE_IN_AMPLITUDE)
SMALL_ANGLES = (Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4, 4e-4), (), 1e-3), CUBE_IN_AMPLITUDE)
IN_RATE = Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4))
IN_LENGTH = Order("length", 1, (10, 20, 40, 80))
FREQUENCY_IN_AMPLITUDE = Order("amplitude", 2, (1.0, 2.0, 4.0, 8.0), STILL)
FREQUENCY_EXACT = Order("amplitude", None, (1.0, 8.0, 40.0), STILL)
FREQUENCY_IN_RATE = Order("rotation_rate", 2, (1e-3, 2e-3, 4e-3), ON_AXIS, 1e-2)
CENTRIFUGAL = Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4), (), 1e-2)
SQUARE_AT_POLE = Order("amplitude", 2, (2.0, 4.0, 8.0), AT_POLE)

ORDERS = {
    "conical": (
        Order("amplitude", None, (7.35,), (*STILL, *CIRCLE)),
        Order("rotation_rate", 1, (1e-5, 2e-5, 4e-5, 8e-5), (*ON_AXIS, *CIRCLE)),
    ),
    "gastebois_general": (
        Order("amplitude", None, (0.5, 8.0, 66.0), STILL),
        Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4, 4e-4), (), 0.5),
    ),
    "gastebois_6_1": SMALL_ANGLES,
    "gastebois_6_2": (Order("rotation_rate", 1, (1e-4, 2e-4, 4e-4), ON_AXIS), CUBE_IN_AMPLITUDE),
    "gastebois_6_3": SMALL_ANGLES,
    "linear_3d": (
        Order("amplitude", 2, (0.1, 0.2, 0.4, 0.8), (*ON_AXIS, "site.rotation_rate=0.02")),
        CUBE_IN_AMPLITUDE,
    ),
    "mathar_item_1": (SQUARE_IN_RATE,),
    "mathar_item_1_variant": (SQUARE_IN_RATE,),
    "mathar_item_2": (CUBE_IN_AMPLITUDE,),
    "mathar_item_3": (CUBE_IN_AMPLITUDE,),
    "mathar_item_4": (
        Order("amplitude", 2, (0.5, 1.0, 2.0, 4.0), (*ON_AXIS, "site.rotation_rate=1e-3")),
        Order("rotation_rate", 1, (1e-4, 2e-4, 4e-4, 8e-4), ON_AXIS),
    ),
    "mathar_item_5": (CUBE_IN_AMPLITUDE,),
    "mathar_items_1_2": LINEAR,
    "mathar_items_1_to_5": LINEAR,
    "linear_g": LINEAR,
    "linear_apparent": LINEAR,
    "linear_recentred": ABOUT_REST,
    "linear_anharmonic": ABOUT_REST,
    "planar": (
        Order("amplitude", None, (0.5, 8.0, 66.0), STILL),
        Order("rotation_rate", 1, (1e-5, 2e-5, 4e-5, 8e-5), ON_AXIS),
    ),
    "method_1": LINEAR,
    "method_2": LINEAR,
    "method_3": LINEAR,
    "apparent_gravity": (IN_RATE, IN_LENGTH),
    "frequency_harmonic": (FREQUENCY_IN_AMPLITUDE, CENTRIFUGAL),
    "frequency_planar": (FREQUENCY_EXACT, CENTRIFUGAL),
    "frequency_turntable": (FREQUENCY_IN_AMPLITUDE, CENTRIFUGAL),
    "frequency_apparent": (FREQUENCY_IN_AMPLITUDE, FREQUENCY_IN_RATE),
    "frequency_anharmonic": (FREQUENCY_EXACT, FREQUENCY_IN_RATE),
    "precession_sine": (Order("rotation_rate", 2, (1e-4, 2e-4, 4e-4), (), 1e-2), SQUARE_AT_POLE),
    "precession_tilted": (
        Order("rotation_rate", 2, (2e-3, 4e-3, 8e-3), ON_AXIS, 1e-2),
        SQUARE_AT_POLE,
    ),
    "precession_spherical": (Order("amplitude", 4, (4.0, 8.0, 16.0), AT_POLE),),
    "rest_equation": (replace(IN_RATE, power=None), Order("length", None, (1, 67, 10000))),
    **{
        f"rest_series_{terms}": (
            replace(IN_RATE, power=2 * terms + 2),
            Order("rotation_rate", 2 * terms + 2, (4e-3, 8e-3, 1.6e-2), SMALL_BODY),
        )
        for terms in (1, 2, 3)
    },
    "rest_triangle": (IN_RATE, IN_LENGTH),
}
ABSOLUTE = "rad"  # the unit of quantities whose error is meant, not the relative one


TRUTHS = {}


def truth(scene):
    """Return the reference's positions at TIMES, computed once for all approximations that are held against them."""
    key = scene.model_dump_json()
    if key not in TRUTHS:
        TRUTHS[key] = trajectory(scene, TIMES)[:, :3]
    return TRUTHS[key]


def error(word, scene):
    """Return the largest distance in m over TIMES, or the error of a quantity: relative, but of an angle in rad."""
    approximation = APPROXIMATIONS[word]
    if isinstance(approximation, Motion):
        off = approximation.trajectory(scene, TIMES)[:, :3] - truth(scene)
        return float(np.linalg.norm(off, axis=1).max())
    true = approximation.truth(scene)
    gap = approximation.value(scene) - true
    return float(abs(gap if approximation.unit == ABSOLUTE else gap / true))


def errors_of(word, order):
    """Return the errors of an approximation at the values of an order, in its setting."""
    setting = BASE.with_values(order.setting)
    scenes = [
        setting.with_values([f"site.rotation_rate={value}"])
        if order.against == "rotation_rate"
        else varied(setting, order.against, value)
        for value in order.values
    ]
    if order.amplitude is not None:
        scenes = [released(scene, order.amplitude) for scene in scenes]
    return [error(word, scene) for scene in scenes]


def released(scene, amplitude):
    """Return the scene released without velocity so many metres from its rest position, between east and north."""
    case = PaperCase.of_scene(scene)
    y = case.rest[1] * case.length + 0.8 * amplitude
    place = [f"release.x={0.6 * amplitude}", f"release.y={case.ctx.nstr(y, 40)}"]
    return scene.with_values([*place, "release.vx=0", "release.vy=0"])


def whole(order):
    return order


def of_ends(order):
    """Return the order with the first and the last of its values: two make a slope."""
    values = order.values if len(order.values) == 1 else (order.values[0], order.values[-1])
    return replace(order, values=values)


def slope(order, errors):
    """Return the power with which the errors grow with the values of an order."""
    return np.polyfit(np.log(order.values), np.log(errors), 1)[0]


@pytest.mark.parametrize(
    ("word", "which"), [(word, i) for word, orders in ORDERS.items() for i in range(len(orders))]
)
def test_the_error_has_the_slope_of_its_theory(word, which, size):
    order = size(of_ends, whole)(ORDERS[word][which])
    errors = errors_of(word, order)
    if order.power is None:
        assert max(errors) < (
            EXACT_M if isinstance(APPROXIMATIONS[word], Motion) else EXACT_RELATIVE
        )
    else:
        assert min(errors) > 0
        assert abs(slope(order, errors) - order.power) < 0.25, errors


def test_every_approximation_has_an_order():
    assert set(ORDERS) == set(APPROXIMATIONS)


def test_the_slope_tells_a_wrong_order(size):
    wrong = size(of_ends, whole)(ORDERS["mathar_item_4"][0])
    assert abs(slope(wrong, errors_of("mathar_item_2", wrong)) - wrong.power) > 0.25


@pytest.mark.parametrize("word", ["mathar_item_1", "mathar_item_1_variant", "linear_g", "method_2"])
def test_without_the_centrifugal_force_the_tilt_costs_as_many_metres_as_the_rest_position_is_off(
    word,
):
    # The bob swings about a wrong point d = 0.115 m away: it is 2 d off after half a swing.
    small = varied(BASE.with_values(["release.x=0.003", "release.y=0"]), "amplitude", 0.001)
    assert error(word, small) == pytest.approx(0, abs=0.24)
    assert error(word, small) > 0.22


def test_the_variant_of_item_1_is_exact_to_the_cord_at_the_equator():
    equator = BASE.with_values(["site.latitude=0"])
    assert error("mathar_item_1_variant", equator) < 1e-6 < 1e-2 < error("mathar_item_1", equator)
