"""The named mistakes that programs make, each as the trajectory that it would give.

A hypothesis changes the inputs, the model's constants, or the rows of the output. All else (the tilt of gravity, the
shape of the Earth, the equations of motion) is the reference's own, so that one mistake is seen by itself.
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
from reference.inputs import Inputs
from reference.model.constants import Constants
from reference.precision import Array, context, to_fraction

SOLAR_DAY = 86400  # s
MEAN_RADIUS = 6371000  # m, the sphere of the textbooks
COMMON_GRAVITY = ("9.8", "9.81", "9.80665", "9.82", "9.83", "10")
_CTX = context(120)  # 120 bits: the constants below reach a double's 53 bits with room to spare


@dataclass(frozen=True)
class Hypothesis:
    """A mistake that a program may make.

    Attributes:
        id: a short word.
        phrase: the end of the sentence "It seems that your program …".
        states: from times, starting at 0, to x, y, z, vx, vy, vz with this mistake, shape (times, 6).
    """

    id: str
    phrase: str
    states: Callable[[Array], Array]


def hypotheses(scene: Scene, model: Variants, *, approximations: bool = True) -> Iterator[Hypothesis]:
    """Yield the named mistakes that could make a difference to the scene, likely ones first; approximations last."""
    inputs = scene.exact
    for name, phrase, changed in _changed_inputs(inputs):
        if changed != inputs:
            yield Hypothesis(name, phrase, partial(model.states, changed))
    for name, phrase, alter in _changed_terms(inputs):
        yield Hypothesis(name, phrase, partial(model.states, inputs, alter=alter))
    for name, phrase, turn in _CHANGED_ROWS:
        yield Hypothesis(name, phrase, partial(_turned, turn, model, inputs))
    if approximations:
        yield from _approximations(scene)


def _turned(turn: Callable[[Array], Array], model: Variants, inputs: Inputs, times: Array) -> Array:
    return turn(model.states(inputs, times))


def _changed_inputs(inputs: Inputs) -> Iterator[tuple[str, str, Inputs]]:
    rate, latitude = inputs.rotation_rate, inputs.latitude
    if rate:
        solar = to_fraction(2 * _CTX.pi / SOLAR_DAY) * (1 if rate > 0 else -1)
        if abs(solar / rate - 1) < Fraction(1, 100):
            phrase = "turns the Earth once in a solar day (86400 s) instead of a sidereal day (86164.1 s)"
            yield "solar_day", phrase, replace(inputs, rotation_rate=solar)
        phrase = "gives the Coriolis force (or the rotation rate) the wrong sign"
        yield "coriolis_sign", phrase, replace(inputs, rotation_rate=-rate)
        yield "no_rotation", "leaves out the rotation of the Earth", replace(inputs, rotation_rate=Fraction(0))
    if inputs.flattening:
        yield "sphere", "treats the Earth as a sphere of the equatorial radius", replace(inputs, flattening=Fraction(0))
        phrase = f"treats the Earth as a sphere of radius {MEAN_RADIUS} m"
        yield "mean_sphere", phrase, replace(inputs, flattening=Fraction(0), equatorial_radius=Fraction(MEAN_RADIUS))
    if latitude:
        yield "hemisphere", "gives the latitude the wrong sign", replace(inputs, latitude=-latitude)
        radians = to_fraction(_CTX.degrees(_CTX.mpf(latitude.numerator) / latitude.denominator))
        yield "radians", "takes the latitude in degrees as if it were in radians", replace(inputs, latitude=radians)
    yield "colatitude", "uses the colatitude instead of the latitude", replace(inputs, latitude=90 - latitude)
    if inputs.flattening and abs(latitude) not in (0, 90):
        phrase = "uses the geocentric latitude instead of the geodetic one"
        yield "geocentric", phrase, replace(inputs, latitude=_geocentric(inputs))
    for text in COMMON_GRAVITY:
        if abs(Fraction(text) - inputs.gravity) < Fraction(1, 10**9):
            continue
        yield f"gravity_{text}", f"computes with g = {text} m/s²", replace(inputs, gravity=Fraction(text))
    if inputs.drag:
        yield "no_drag", "leaves out the drag", replace(inputs, drag=Fraction(0))
    if inputs.position is not None:
        x, y, vx, vy = inputs.position
        if vx or vy:
            yield "at_rest", "releases the bob at rest", replace(inputs, position=(x, y, Fraction(0), Fraction(0)))
        elif rate:
            up = rate * to_fraction(_CTX.sinpi(_CTX.mpf(latitude.numerator) / latitude.denominator / 180))
            phrase = "releases the bob at rest relative to the stars, not to the ground"
            yield "inertial_rest", phrase, replace(inputs, position=(x, y, up * y, -up * x))
        yield "swapped", "swaps x and y of the release", replace(inputs, position=(y, x, vy, vx))


def _geocentric(inputs: Inputs) -> Fraction:
    """Return the geocentric latitude atan((1 - e²) tan φ) in degrees."""
    squeeze = (1 - inputs.flattening) ** 2
    phi = math.radians(float(inputs.latitude))
    return Fraction(math.degrees(math.atan2(float(squeeze) * math.sin(phi), math.cos(phi))))


def _changed_terms(inputs: Inputs) -> Iterator[tuple[str, str, Callable[[Constants], Constants]]]:
    if not inputs.rotation_rate:
        return
    phrase = "leaves out the centrifugal force"
    yield "no_centrifugal", phrase, lambda k: replace(k, pull=(0, 0, -k.gravity), centrifugal=(0, 0, 0, 0))
    phrase = "leaves out the horizontal centrifugal force, as if g were measured along the plumb line"
    yield "no_tilt", phrase, lambda k: replace(k, pull=(0, 0, k.pull[2]), centrifugal=(0, 0, 0, 0))
    phrase = "omits the factor 2 in the Coriolis force"
    yield "coriolis_half", phrase, lambda k: replace(k, turn=(0, k.turn[1] / 2, k.turn[2] / 2))
    phrase = "uses only the vertical part of Ω in the Coriolis force"
    yield "vertical_only", phrase, lambda k: replace(k, turn=(0, 0, k.turn[2]))
    phrase = "leaves out the Coriolis force"
    yield "no_coriolis", phrase, lambda k: replace(k, turn=(0, 0, 0))
    phrase = "treats the centrifugal force as constant along the swing"
    yield "uniform_gravity", phrase, lambda k: replace(k, centrifugal=(0, 0, 0, 0))


def _mirrored(*signs: int) -> Callable[[Array], Array]:
    return lambda states: states * np.array(signs * 2, dtype=float)


_CHANGED_ROWS: tuple[tuple[str, str, Callable[[Array], Array]], ...] = (
    ("x_west", "has x pointing west instead of east", _mirrored(-1, 1, 1)),
    ("y_south", "has y pointing south instead of north", _mirrored(1, -1, 1)),
    ("xy_swapped", "writes north as x and east as y", lambda states: states[:, [1, 0, 2, 4, 3, 5]]),
)


def _approximations(scene: Scene) -> Iterator[Hypothesis]:
    """Yield the truncated models of the source papers."""
    from ..approximations import APPROXIMATIONS, Motion

    for approximation in APPROXIMATIONS.values():
        if isinstance(approximation, Motion):
            phrase = f"solves {approximation.title} ({approximation.where}) instead of the full equations"
            yield Hypothesis(approximation.id, phrase, partial(approximation.trajectory, scene))
