"""Pendulums for judging printed formulas: random points, Paris, and runs of the reference.

On the Earth a term such as RΩ² is hidden behind g; at random points all numbers are of order one
and no term is small, so a wrong one shows at once.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Annotated, Any, get_type_hints

import numpy as np

from reference import Scene, Solution, load, load_scene, solve, trajectory
from reference.model.constants import Constants, constants
from reference.numbers.precision import LONG_DOUBLE, Array, to_fraction
from reference.scenes.shipped import golden_root

from ..approximations.case import PaperCase
from ..observed.swing_plane import Gauge
from .digits import MP, Vector, cos, mpf, radians, sin, sqrt, vector

COUNT = 5  # random points
SEED = 20231117  # of the random numbers: the points are the same in every run


@dataclass(frozen=True)
class Point:
    """Numbers of one random point, exact; lengths in m, times in s, angles in radians unless stated.

    Each is drawn between the two that stand with it.

    Attributes:
        radius, flattening, altitude, latitude: the planet's (latitude in degrees).
        length, gravity, rate: of the pendulum and of the rotation, l, g, Ω.
        cord, azimuth: angles of the cord, φ and λ in Mathar, θ and φ in Gastebois; with rates and
            accelerations.
        x, y: horizontal position, with velocities and accelerations.
        t, mass: a time and a mass.
    """

    radius: Annotated[Any, 2, 3] = MP.zero
    flattening: Annotated[Any, 0.1, 0.3] = MP.zero
    altitude: Annotated[Any, 0.1, 0.5] = MP.zero
    latitude: Annotated[Any, 15, 75] = MP.zero
    length: Annotated[Any, 1, 2] = MP.zero
    gravity: Annotated[Any, 6, 10] = MP.zero
    rate: Annotated[Any, 0.3, 0.9] = MP.zero
    cord: Annotated[Any, 0.4, 1.2] = MP.zero
    azimuth: Annotated[Any, -3, 3] = MP.zero
    cord_rate: Annotated[Any, 0.2, 0.9] = MP.zero
    azimuth_rate: Annotated[Any, 0.2, 0.9] = MP.zero
    cord_second: Annotated[Any, -0.9, 0.9] = MP.zero
    azimuth_second: Annotated[Any, -0.9, 0.9] = MP.zero
    x: Annotated[Any, 0.1, 0.6] = MP.zero
    y: Annotated[Any, 0.1, 0.6] = MP.zero
    vx: Annotated[Any, 0.2, 0.9] = MP.zero
    vy: Annotated[Any, 0.2, 0.9] = MP.zero
    ax: Annotated[Any, -0.9, 0.9] = MP.zero
    ay: Annotated[Any, -0.9, 0.9] = MP.zero
    t: Annotated[Any, 0.5, 2] = MP.zero
    mass: Annotated[Any, 1.5, 3] = MP.zero

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
        """The model's constants at this point, for `reference.model`.

        They take nothing else of Paris.
        """
        names = ("length", "latitude", "altitude", "gravity", "flattening")
        numbers: dict[str, Any] = {name: to_fraction(getattr(self, name)) for name in names}
        numbers |= {
            "rotation_rate": to_fraction(self.rate),
            "equatorial_radius": to_fraction(self.radius),
        }
        return constants(replace(load_scene("paris").exact, **numbers), MP)

    @cached_property
    def uniform(self) -> Constants:
        """The same constants with gravity alone: no centrifugal force, as in the other two papers."""
        return replace(self.k, pull=(0, 0, -self.gravity / self.length), centrifugal=(0, 0, 0, 0))

    @cached_property
    def case(self) -> PaperCase:
        """The same numbers as a `PaperCase`, the input of the approximations."""
        return PaperCase(MP, self.k, tuple(self.position), tuple(self.velocity))

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
        """Return a copy of the point with some of its numbers changed."""
        return replace(self, **changes)


@cache
def points() -> tuple[Point, ...]:
    """Return random points, the same in every run."""
    draw, kinds = random.Random(SEED), get_type_hints(Point, include_extras=True).values()
    return tuple(
        Point(*(MP.mpf(draw.uniform(*kind.__metadata__)) for kind in kinds)) for _ in range(COUNT)
    )


@cache
def paris() -> Point:
    """Return the Paris pendulum at its release, Mathar VII: decimals as printed."""
    texts = {"radius": "6378137", "altitude": "0", "latitude": "48.846111", "length": "67", "gravity": "9.80665",
             "rate": "7.292115e-5", "x": "0.3", "y": "0.4", "mass": "1"}  # fmt: skip
    return Point(
        **{name: mpf(text) for name, text in texts.items()}, flattening=1 / mpf("298.257223564")
    )


@cache
def transits(column: str) -> list[Any]:
    """Return a column of the transits of the Paris pendulum, by its golden dataset: 24 h, 40 digits, every one.

    It is the dataset that ships: the name alone would also mean a shorter one in ./golden.
    """
    return [mpf(text) for text in load(golden_root() / "paris").transits.decimals(column)]


@cache
def paris_path() -> tuple[Array, Array]:
    """Return times every 30 s for 24 h and x, y, z, vx, vy, vz there, shape (times, 6), by a long double run."""
    times = np.arange(0.0, 86430.0, 30.0)
    return times, path_in(load_scene("paris"), times)


def path_in(scene: Scene, times: Array) -> Array:
    """Return x, y, z, vx, vy, vz of any scene, shape (times, 6), to about the last digit of a double."""
    return trajectory(scene, times, number=LONG_DOUBLE)


def window(
    begin: float, span: float, scene: Scene | None = None, step: float = 0.05
) -> tuple[Array, Array]:
    """Return the times of an interval and the states of a scene there, shape (times, 6).

    The default is Paris.
    """
    times: Array = begin + np.arange(round(span / step) + 1) * np.float64(step)
    return times, path_in(scene or load_scene("paris"), np.union1d(0.0, times))[-len(times) :]


def rotation(times: Array, swing_plane: Array) -> tuple[float, float]:
    """Return a swing plane's rotation in degrees an hour by a fitted line, and the line's largest residual."""
    hours, turned = times / 3600, np.degrees(swing_plane)
    slope, start = np.polyfit(hours, turned, 1)
    return float(slope), float(np.abs(turned - slope * hours - start).max())


@cache
def solved(changes: tuple[str, ...], t_end: str, digits: int = 20) -> Solution:
    """Solve the scene `paris` with some values changed, up to t_end, with its transits."""
    scene = load_scene("paris", [*changes, f"run.grid_step={t_end}"])
    return solve(scene, t_end=t_end, digits=digits, level="computed")


def frequency(solution: Solution) -> Any:
    """Return the swings a second, from the release to the last transit that ends a whole swing."""
    times = solution.transits.exact("t")
    swings = [(round(2 * t / times[1]), t) for t in times]
    halves, last = max((count, t) for count, t in swings if count % 2 == 0)
    return mpf(halves) / 2 / mpf(last)


# in degrees, of figure 8: that of Paris is the last
LATITUDES = [*map(str, range(-90, 91, 10)), "48.846111"]


@cache
def frequencies() -> dict[float, float]:
    """Return the frequency in Hz by latitude in degrees, from runs of ten minutes."""
    return {
        float(text): float(frequency(solved((f"site.latitude={text}",), "600", 12)))
        for text in LATITUDES
    }


def swing_plane(scene: Scene, states: Array) -> Array:
    """Return the azimuth of the swing plane in rad, east to north, without jumps."""
    return np.unwrap(Gauge.of(scene).swing_plane(states), period=np.pi)


@cache
def paris_swing_plane() -> Array:
    """Return the azimuth of the Paris pendulum's swing plane in rad, every 30 s for 24 h."""
    return swing_plane(load_scene("paris"), paris_path()[1])


@cache
def paris_passage() -> tuple[Array, Array]:
    """Return the states near the vertical, and the distance in m at which a straight line through each passes it.

    The rest position lies south of the vertical, so that the swing passes nearest while its plane
    lies north and south. Ten minutes before and after, the plane has turned by 1.9° and misses the
    vertical by 4 mm.
    """
    passage = paris_path()[0][np.abs(np.cos(paris_swing_plane())).argmin()]
    states = window(passage - 600, 1200, step=0.25)[1]
    near = states[np.hypot(states[:, 0], states[:, 1]) < 0.06]
    return near, np.abs(near[:, 0] * near[:, 4] - near[:, 1] * near[:, 3]) / np.hypot(
        near[:, 3], near[:, 4]
    )
