"""The input floor: how far rounding the inputs of a scene to binary64 moves the bob, whatever a candidate does."""

from __future__ import annotations

import hashlib
import json
from fractions import Fraction

import numpy as np

from reference import Scene
from reference.numbers.precision import Array
from reference.system.cache import arrays

from ..truth import by_function, shipping, with_function

# in a span, at least half of them up to the end asked for: some in every swing, or hundreds of
# swings
_TIMES = 577
# changes with the content of the cached entries, so that older ones are computed again
_FORMAT = "floor 3"
_STEEP = 0.25  # of the length: where z is less, it does not follow well from x and y


def input_floor(scene: Scene, until: float) -> float:
    """Return how far, in m, rounding the decimal inputs to binary64 moves the bob up to a time in s.

    It depends on the scene alone and is the same for every candidate. If both motions ship it is
    their distance; otherwise it is an estimate, and one cached run serves all ends within a factor
    of two.
    """
    ships = floor_of_what_ships(scene, until)
    if ships is not None:
        return ships
    from reference.solver.sensitivity import Sensitivity

    decimal = scene.with_values(["inputs=decimal"])
    times = np.zeros(1)
    if until > 0:
        times = np.linspace(0.0, _span(float(scene.exact.t_end), until), _TIMES)

    def make() -> dict[str, Array]:
        moved = Sensitivity(decimal, times).rounding()[:, :3]
        distances = np.sqrt((moved**2).sum(axis=1))
        return {"largest": np.maximum.accumulate(distances)}

    largest = arrays("floor", _entry_name(decimal, float(times[-1])), make)["largest"]
    return float(largest[np.searchsorted(times, until)])


def _entry_name(decimal: Scene, end_s: float) -> str:
    """Return the name of the cached run of a scene up to a time."""
    document = decimal.model_dump(mode="json")
    inputs = [document[key] for key in ("pendulum", "site", "release")]
    recipe = json.dumps([_FORMAT, inputs, end_s], sort_keys=True).encode()
    return f"{hashlib.sha256(recipe).hexdigest()[:32]}.npz"


def floor_of_what_ships(scene: Scene, until: float) -> float | None:
    """Return how far, in m, rounding the inputs to binary64 moves the bob up to a row of the grid that is not before.

    It is the distance of the two motions that ship, decimal and binary64, and known to the bound of
    the latter's x and y; z follows from the sphere. None if they do not ship.
    """
    decimal = scene.with_values(["inputs=decimal"])
    binary64 = scene.with_values(["inputs=binary64"])
    golden = shipping(decimal)
    rounded = with_function(binary64)
    if golden is None or rounded is None:
        return None

    # many names, as each is a quantity of one formula
    rows = slice(0, int(np.searchsorted(golden.t, until)) + 1)
    truth = by_function(rounded, golden.t[rows])
    assert truth is not None
    # from the double to the exact time of each row
    later_s = np.array([float(t - Fraction(float(t))) for t in golden.times[rows]])
    x, y, z = truth.states.T[:3] + later_s * truth.states.T[3:]
    dx = golden.x[rows] - x
    dy = golden.y[rows] - y

    # from x² + y² + z² = l², to first order, or from z itself where that is ill-conditioned
    length = float(decimal.exact.length)
    dlength = float(decimal.exact.length - binary64.exact.length)
    with np.errstate(divide="ignore", invalid="ignore"):
        dz = (length * dlength - x * dx - y * dy) / z
    dz = np.where(np.abs(z) > _STEEP * length, dz, golden.z[rows] - z)
    return float(np.sqrt(dx**2 + dy**2 + dz**2).max())


def _span(t_end: float, until: float) -> float:
    """Return the scene's span, halved as long as it reaches `until`.

    `until` itself if that is beyond the span.
    """
    while t_end / 2 >= until:
        t_end /= 2
    return max(t_end, until)
