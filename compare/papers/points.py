"""Random points at which printed formulas are evaluated: pendulum, planet and state, all numbers of order one.

On the Earth a term such as RΩ² is hidden behind g; at these points no term is small, so a wrong one shows at once.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

from reference import load_scene
from reference.model.constants import Constants, constants
from reference.numbers.precision import to_fraction
from reference.scenes.inputs import Inputs

from ..approximations.case import Case
from .digits import MP, Vector, cos, mpf, radians, sin, sqrt, vector

COUNT = 5  # random points
SEED = 20231117  # of the random numbers: the points are the same in every run


@dataclass(frozen=True)
class Point:
    """Numbers of one random point, exact; lengths in m, times in s, angles in radians unless stated.

    Attributes:
        radius, flattening, altitude, latitude: the planet's (latitude in degrees).
        length, gravity, rate: of the pendulum and of the rotation, l, g, Ω.
        cord, azimuth: angles of the cord, φ and λ in Mathar, θ and φ in Gastebois; with rates and accelerations.
        x, y: horizontal position, with velocities and accelerations.
        t, mass: a time and a mass.
    """

    radius: Any
    flattening: Any
    altitude: Any
    latitude: Any
    length: Any
    gravity: Any
    rate: Any
    cord: Any
    azimuth: Any
    cord_rate: Any
    azimuth_rate: Any
    cord_second: Any
    azimuth_second: Any
    x: Any
    y: Any
    vx: Any
    vy: Any
    ax: Any
    ay: Any
    t: Any
    mass: Any

    @cached_property
    def phi(self) -> Any:
        """Latitude in radians."""
        return radians(self.latitude)

    @cached_property
    def e2(self) -> Any:
        """Squared eccentricity of the ellipsoid."""
        return self.flattening * (2 - self.flattening)

    @cached_property
    def N(self) -> Any:  # noqa: N802  # the field's symbol
        """Radius of curvature in the prime vertical, Mathar (2)."""
        return self.radius / sqrt(1 - self.e2 * sin(self.phi) ** 2)

    @cached_property
    def R(self) -> Any:  # noqa: N802
        """Distance of the suspension from the axis, Mathar (3)."""
        return (self.N + self.altitude) * cos(self.phi)

    @cached_property
    def z(self) -> Any:
        """Height of the bob relative to the suspension (negative)."""
        return -sqrt(self.length**2 - self.x**2 - self.y**2)

    @cached_property
    def vz(self) -> Any:
        """Vertical velocity, from r·v = 0."""
        return -(self.x * self.vx + self.y * self.vy) / self.z

    @cached_property
    def position(self) -> Vector:
        """Position x, y, z."""
        return vector(self.x, self.y, self.z)

    @cached_property
    def velocity(self) -> Vector:
        """Velocity vx, vy, vz."""
        return vector(self.vx, self.vy, self.vz)

    @cached_property
    def k(self) -> Constants:
        """The model's constants at this point, for the functions of `reference.model`."""
        return constants(_inputs(self), MP)

    @cached_property
    def uniform(self) -> Constants:
        """The same with gravity alone: no centrifugal force, as in the other two papers."""
        return replace(self.k, pull=(0, 0, -self.gravity / self.length), centrifugal=(0, 0, 0, 0))

    @cached_property
    def case(self) -> Case:
        """The same numbers as the approximations take them."""
        return Case(MP, self.k, tuple(self.position), tuple(self.velocity))

    @cached_property
    def angle_functions(self) -> tuple[Any, Any, Any, Any]:
        """Sine and cosine of the cord's angle, then of its azimuth."""
        return sin(self.cord), cos(self.cord), sin(self.azimuth), cos(self.azimuth)

    def swinging(self, s: Any) -> Point:
        """Return the point with s times its place and velocity."""
        return self.but(x=self.x * s, y=self.y * s, vx=self.vx * s, vy=self.vy * s)

    def faster(self, s: Any) -> Point:
        """Return the point with Ω² s times as large."""
        return self.but(rate=self.rate * sqrt(s))

    def but(self, **changes: Any) -> Point:
        """Return the point with some of its numbers changed."""
        return replace(self, **changes)


def _inputs(p: Point) -> Inputs:
    """Return the point's numbers, beside the rest of Paris, of which the constants take nothing."""
    names = ("length", "latitude", "altitude", "gravity", "flattening")
    numbers: dict[str, Any] = {name: to_fraction(getattr(p, name)) for name in names}
    numbers |= {"rotation_rate": to_fraction(p.rate), "equatorial_radius": to_fraction(p.radius)}
    return replace(load_scene("paris").exact, **numbers)


_RANGES = {
    "radius": (2, 3), "flattening": (0.1, 0.3), "altitude": (0.1, 0.5), "latitude": (15, 75),
    "length": (1, 2), "gravity": (6, 10), "rate": (0.3, 0.9), "cord": (0.4, 1.2), "azimuth": (-3, 3),
    "cord_rate": (0.2, 0.9), "azimuth_rate": (0.2, 0.9), "cord_second": (-0.9, 0.9), "azimuth_second": (-0.9, 0.9),
    "x": (0.1, 0.6), "y": (0.1, 0.6), "vx": (0.2, 0.9), "vy": (0.2, 0.9), "ax": (-0.9, 0.9), "ay": (-0.9, 0.9),
    "t": (0.5, 2), "mass": (1.5, 3),
}  # fmt: skip


@cache
def points() -> tuple[Point, ...]:
    """Return random points, the same in every run."""
    draw = random.Random(SEED)
    return tuple(Point(**{name: MP.mpf(draw.uniform(*ends)) for name, ends in _RANGES.items()}) for _ in range(COUNT))


@cache
def paris() -> Point:
    """Return the Paris pendulum at its release, Mathar VII: decimals as printed."""
    texts = {"radius": "6378137", "altitude": "0", "latitude": "48.846111", "length": "67", "gravity": "9.80665",
             "rate": "7.292115e-5", "x": "0.3", "y": "0.4"}  # fmt: skip
    numbers = {name: mpf(text) for name, text in texts.items()}
    blank = dict.fromkeys(_RANGES, MP.zero) | {"mass": MP.one}
    return Point(**(blank | numbers | {"flattening": 1 / mpf("298.257223564")}))
