"""Mistakes that programs make: each is a trajectory that a candidate may turn out to follow.

A hypothesis changes the inputs, the model's constants, or the rows that come out. The tilt of gravity, the
formulas of the Earth and the equations are the reference's own, so that a mistake is seen by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from reference import Scene
from reference.engines.variants import Variants
from reference.model.constants import Constants
from reference.precision import Array, context, to_fraction
from reference.scene import Inputs

SOLAR_DAY = 86400
MEAN_RADIUS = 6371000  # m, the sphere of the textbooks
COMMON_GRAVITY = ("9.8", "9.81", "9.80665", "9.82", "9.83", "10")
_CTX = context(120)


@dataclass(frozen=True)
class Hypothesis:
    """A mistake.

    Attributes:
        id: a short word.
        says: what the program seems to do, as a sentence's end: "it seems that your program …".
        states: x, y, z, vx, vy, vz that it would give at times from 0, shape (times, 6).
    """

    id: str
    says: str
    states: Callable[[Array], Array]


def hypotheses(scene: Scene, model: Variants, *, approximations: bool = True) -> Iterator[Hypothesis]:
    """Every named mistake that makes a difference to the scene, likely ones first; the approximations last."""
    inputs = scene.exact
    for name, says, changed in _changed_inputs(inputs):
        if changed != inputs:
            yield Hypothesis(name, says, partial(model.states, changed))
    for name, says, alter in _changed_terms(inputs):
        yield Hypothesis(name, says, partial(model.states, inputs, alter=alter))
    for name, says, turn in _CHANGED_ROWS:
        yield Hypothesis(name, says, partial(_turned, turn, model, inputs))
    if approximations:
        yield from _approximations(scene)


def _turned(turn: Callable[[Array], Array], model: Variants, inputs: Inputs, times: Array) -> Array:
    return turn(model.states(inputs, times))


def _changed_inputs(inputs: Inputs) -> Iterator[tuple[str, str, Inputs]]:
    rate, latitude = inputs.rotation_rate, inputs.latitude
    if rate:
        solar = to_fraction(2 * _CTX.pi / SOLAR_DAY) * (1 if rate > 0 else -1)
        if abs(solar / rate - 1) < Fraction(1, 100):
            says = "takes a day of 86400 s for one turn of the Earth, which is sidereal (86164.1 s)"
            yield "solar_day", says, replace(inputs, rotation_rate=solar)
        says = "has the sign of the Coriolis force (or of the rotation) wrong"
        yield "coriolis_sign", says, replace(inputs, rotation_rate=-rate)
        yield "no_rotation", "leaves the rotation out", replace(inputs, rotation_rate=Fraction(0))
    if inputs.flattening:
        yield "sphere", "takes the Earth for a sphere of the equatorial radius", replace(inputs, flattening=Fraction(0))
        says = f"takes the Earth for a sphere of {MEAN_RADIUS} m"
        yield "mean_sphere", says, replace(inputs, flattening=Fraction(0), equatorial_radius=Fraction(MEAN_RADIUS))
    if latitude:
        yield "hemisphere", "has the sign of the latitude wrong", replace(inputs, latitude=-latitude)
        radians = to_fraction(_CTX.degrees(_CTX.mpf(latitude.numerator) / latitude.denominator))
        yield "radians", "takes the latitude in degrees for radians", replace(inputs, latitude=radians)
    yield "colatitude", "takes the latitude from the pole", replace(inputs, latitude=90 - latitude)
    if inputs.flattening and abs(latitude) not in (0, 90):
        says = "uses the geocentric latitude where the geodetic one is meant"
        yield "geocentric", says, replace(inputs, latitude=_geocentric(inputs))
    for text in COMMON_GRAVITY:
        if abs(Fraction(text) - inputs.gravity) < Fraction(1, 10**9):
            continue
        yield f"gravity_{text}", f"computes with g = {text} m/s²", replace(inputs, gravity=Fraction(text))
    if inputs.drag:
        yield "no_drag", "leaves the drag out", replace(inputs, drag=Fraction(0))
    if inputs.position is not None:
        x, y, vx, vy = inputs.position
        if vx or vy:
            yield "at_rest", "releases the bob at rest", replace(inputs, position=(x, y, Fraction(0), Fraction(0)))
        elif rate:
            up = rate * to_fraction(_CTX.sinpi(_CTX.mpf(latitude.numerator) / latitude.denominator / 180))
            says = "releases the bob at rest against the stars, not against the ground"
            yield "inertial_rest", says, replace(inputs, position=(x, y, up * y, -up * x))
        yield "swapped", "has x and y of the release swapped", replace(inputs, position=(y, x, vy, vx))


def _geocentric(inputs: Inputs) -> Fraction:
    """atan((1 - e²) tan φ) in degrees."""
    squeeze = (1 - inputs.flattening) ** 2
    phi = math.radians(float(inputs.latitude))
    return Fraction(math.degrees(math.atan2(float(squeeze) * math.sin(phi), math.cos(phi))))


def _changed_terms(inputs: Inputs) -> Iterator[tuple[str, str, Callable[[Constants], Constants]]]:
    if not inputs.rotation_rate:
        return
    says = "leaves the centrifugal force out"
    yield "no_centrifugal", says, lambda k: replace(k, pull=(0, 0, -k.gravity), centrifugal=(0, 0, 0, 0))
    says = "leaves the tilt of the centrifugal force out, as if g were measured along the plumb line"
    yield "no_tilt", says, lambda k: replace(k, pull=(0, 0, k.pull[2]), centrifugal=(0, 0, 0, 0))
    says = "has the factor 2 of the Coriolis force missing"
    yield "coriolis_half", says, lambda k: replace(k, turn=(0, k.turn[1] / 2, k.turn[2] / 2))
    says = "takes the vertical part of Ω only for the Coriolis force"
    yield "vertical_only", says, lambda k: replace(k, turn=(0, 0, k.turn[2]))
    says = "leaves the Coriolis force out"
    yield "no_coriolis", says, lambda k: replace(k, turn=(0, 0, 0))
    says = "leaves the change of the centrifugal force along the swing out"
    yield "uniform_gravity", says, lambda k: replace(k, centrifugal=(0, 0, 0, 0))


def _mirrored(*signs: int) -> Callable[[Array], Array]:
    return lambda states: states * np.array(signs * 2, dtype=float)


_CHANGED_ROWS: tuple[tuple[str, str, Callable[[Array], Array]], ...] = (
    ("x_west", "counts x to the west", _mirrored(-1, 1, 1)),
    ("y_south", "counts y to the south", _mirrored(1, -1, 1)),
    ("xy_swapped", "writes x north and y east", lambda states: states[:, [1, 0, 2, 4, 3, 5]]),
)


def _approximations(scene: Scene) -> Iterator[Hypothesis]:
    """The truncated models of the seeds."""
    from ..approximations import APPROXIMATIONS, Motion

    for approximation in APPROXIMATIONS.values():
        if isinstance(approximation, Motion):
            says = f"solves {approximation.title} ({approximation.where}) instead of the full equations"
            yield Hypothesis(approximation.id, says, partial(approximation.trajectory, scene))
