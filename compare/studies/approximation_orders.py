"""Order of an approximation: does its error against the reference grow with the power that its theory says?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference import Scene, parse_scene, trajectory

from ..approximations.approximation import Approximation, Motion, Order, Quantity
from ..observed.position_error import difference, distance
from ..observed.power_law import LEAST_POINTS, power_law
from .variation import released, varied

BASE = parse_scene(
    {"id": "order", "title": "Paris, against which orders are measured", "release": {"x": "0.3", "y": "0.4"}}
)
OBSERVED_S = 60.0
_SAMPLES = 121  # times at which a motion is compared


@dataclass(frozen=True)
class Measured:
    """Errors of an approximation at the values that an order declares, and the slope of their logarithms.

    Attributes:
        errors: of a motion the largest distance in m within OBSERVED_S seconds, of a quantity as it declares.
        slope: least squares fit of log(error) against log(value); NaN from fewer than three values.
    """

    order: Order
    errors: tuple[float, ...]
    slope: float


def error(approximation: Approximation, scene: Scene) -> float:
    """Return the largest distance from the reference in m over OBSERVED_S seconds, or the error of a quantity."""
    if isinstance(approximation, Motion):
        times = np.linspace(0.0, OBSERVED_S, _SAMPLES)
        approximate, true = (rows.T[:3] for rows in (approximation.trajectory(scene, times), trajectory(scene, times)))
        return float(distance(map(difference, approximate, true)).max())
    assert isinstance(approximation, Quantity)
    truth = approximation.truth(scene)
    gap = approximation.value(scene) - truth
    return float(abs(gap / truth if approximation.relative else gap))


def measure(approximation: Approximation, order: Order, base: Scene = BASE) -> Measured:
    """Measure the errors at an order's values, in its setting."""
    setting = base.with_values(order.setting)
    scenes = [varied(setting, order.against, value) for value in order.values]
    if order.amplitude is not None:
        scenes = [released(scene, 0.6 * order.amplitude, 0.8 * order.amplitude) for scene in scenes]
    errors = tuple(error(approximation, scene) for scene in scenes)
    slope = float("nan")
    if len(errors) >= LEAST_POINTS and min(errors) > 0:
        slope = power_law(order.values, errors).exponent
    return Measured(order, errors, slope)
