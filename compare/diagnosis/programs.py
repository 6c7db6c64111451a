"""Programs: a scene's numbers as a program reads them, its choices, its `theta` and its motion.

A `Program` has the scene's numbers and a handful of choices; each mistake changes one of them. The
motion depends on the numbers of `theta` (`NAMES`), so that many programs are compared with one fit
without running any. A `SphericalPendulum` runs a theta: it swings on the sphere with a free vector
Ω and a free pull, whatever a program calls them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from reference import FoucaultError
from reference.engines.trajectory import Variants
from reference.model.constants import Constants, centrifugal_products
from reference.numbers.precision import Array
from reference.scenes.inputs import Inputs

from ..observed.least_squares import by_differences
from .phasors import FixedStepMethod, Phasors

NAMES = (
    "turn_x",
    "turn_y",
    "turn_z",
    "pull_x",
    "pull_y",
    "pull_z",
    "drag",
    "x",
    "y",
    "vx",
    "vy",
    "length",
    "gradient",
    "point_mass",
)
# indices of the numbers with such a unit
_PER_SECOND = [0, 1, 2, 6, 9, 10]
_PER_SECOND_SQUARED = [3, 4, 5]
# numbers of a program, and the inputs of a scene that they are
_GIVEN = {
    "g": "gravity",
    "length": "length",
    "latitude": "latitude",
    "rate": "rotation_rate",
    "radius": "equatorial_radius",
    "flattening": "flattening",
    "altitude": "altitude",
    "drag": "drag",
}
# factors of the centrifugal force at the suspension, northward and upward
WHOLE = (1.0, 1.0)
EFFECTIVE_G = (0.0, 0.0)
_HIGHEST = 12000.0  # m above or below the ellipsoid: no pendulum hangs farther away


@dataclass(frozen=True)
class Program:
    """The numbers and choices of a program; SI units, angles in degrees.

    Attributes:
        suspension: factors of the northward and of the upward part of the centrifugal force at the
            suspension: 0 and 0 for an effective g, which contains both.
        no_change: whether it leaves out the centrifugal force's change along the swing.
        coriolis: factors of the Coriolis force's Ωy and Ωz, and of both.
        coriolis_latitude: the latitude of the Coriolis force in degrees, of any size; None if it
            is that of the site.
        turned_plane: whether it ignores the rotation and turns the plane of its swing by hand.
        released: velocity of the release over that of a bob at rest against the stars.
        frame: matrix of the horizontal axes, rows are the program's x and y in east and north.
        point_mass: 1 if gravity falls off with 1/r² and points to the centre, else 0.
        kind: sphere; linear, with the restoring force of small swings; or angle, linear in the
            angle of the cord.
        late: time in s by which the rows are late.
        pace: its time over that of its clock.
        method: its integrator, with the `step` in s.
        nominal_rate: the scene's rotation rate, for which the gradient in theta is 1.
        phase_gain: relative error of the swing's frequency that its integrator causes.
        decay_rate: rate in 1/s that its integrator adds to the drag; negative if the swing grows.
    """

    g: float
    length: float
    latitude: float
    rate: float
    radius: float
    flattening: float
    altitude: float
    drag: float
    x: float
    y: float
    vx: float
    vy: float
    suspension: tuple[float, float] = WHOLE
    no_change: bool = False
    coriolis: tuple[float, float, float] = (1.0, 1.0, 1.0)
    coriolis_latitude: float | None = None
    turned_plane: bool = False
    released: float = 0.0
    frame: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 1.0)
    point_mass: float = 0.0
    kind: str = "sphere"
    late: float = 0.0
    pace: float = 1.0
    method: FixedStepMethod | None = None
    step: float = 0.0
    nominal_rate: float = 0.0
    phase_gain: float = 0.0
    decay_rate: float = 0.0

    @classmethod
    def of(cls, inputs: Inputs, start: Array) -> Program:
        """Return the right program of a scene.

        `start` is x, y, z, vx, vy, vz at the release in m and m/s.
        """
        x, y, _, vx, vy, _ = start.tolist()
        numbers: dict[str, Any] = {
            name: float(getattr(inputs, given)) for name, given in _GIVEN.items()
        }
        return cls(
            **numbers,
            x=x,
            y=y,
            vx=vx,
            vy=vy,
            suspension=WHOLE if inputs.gravity_is == "ellipsoid" else EFFECTIVE_G,
            nominal_rate=numbers["rate"],
        )

    @property
    def axis_distance(self) -> float:
        """R, the distance of the suspension from the axis of rotation, in m."""
        phi = math.radians(self.latitude)
        e2 = self.flattening * (2 - self.flattening)
        prime_vertical_radius = self.radius / math.sqrt(1 - e2 * math.sin(phi) ** 2)
        return (prime_vertical_radius + self.altitude) * math.cos(phi)

    @property
    def sensible(self) -> bool:
        """False if an input is outside its domain, so that no program can have it."""
        reachable = self.x * self.x + self.y * self.y < self.length * self.length
        return (
            self.g >= 0
            and self.length > 0
            and self.drag >= 0
            and abs(self.latitude) <= 90
            and (reachable or self.kind == "linear")
            and self.radius >= 0
            and abs(self.altitude) <= _HIGHEST
            and self.step >= 0
            and math.isfinite(self.rate)
        )

    @property
    def gradient(self) -> float:
        """1 if it takes the centrifugal force's change along the swing into account, else 0."""
        return float(not self.no_change)

    @property
    def gradient_square(self) -> tuple[float, float, float, float]:
        """xx, yy, yz, zz of |Ω|² - Ω Ωᵀ, the gradient of the centrifugal force, in 1/s²."""
        phi = math.radians(self.latitude)
        north = self.rate * math.cos(phi)
        up = self.rate * math.sin(phi)
        return centrifugal_products(self.rate, north, up)

    def _exact(self) -> Array:
        """Return theta of an exact integration of the equations."""
        north, up = self._turn()
        pull_y, pull_z = self._pull()
        vx, vy = self._release_velocity()
        gradient = self.gradient
        if self.nominal_rate:
            gradient *= (self.rate / self.nominal_rate) ** 2
        if self.turned_plane:
            north = 0.0

        # in the program's axes; Ω is a pseudovector
        a, b, c, d = self.frame
        handedness = a * d - b * c
        theta = np.array(
            [
                handedness * b * north,
                handedness * d * north,
                handedness * up,
                b * pull_y / self.length,
                d * pull_y / self.length,
                pull_z / self.length,
                self.drag,
                self.x,
                self.y,
                vx,
                vy,
                self.length,
                gradient,
                self.point_mass * self.g / abs(pull_z or 1.0),
            ]
        )
        if self.pace != 1:
            theta[_PER_SECOND] *= self.pace
            theta[_PER_SECOND_SQUARED] *= self.pace**2
            theta[NAMES.index("gradient")] *= self.pace**2
        theta[_PER_SECOND_SQUARED] *= (1 + self.phase_gain) ** 2
        theta[NAMES.index("drag")] += self.decay_rate
        return theta

    def _coriolis_phi(self) -> float:
        """Return the latitude of the Coriolis force in rad."""
        other = self.coriolis_latitude
        return math.radians(self.latitude if other is None else other)

    def _turn(self) -> tuple[float, float]:
        """Return Ωy and Ωz of the Coriolis force in rad/s."""
        phi = self._coriolis_phi()
        by_north, by_up, by_both = self.coriolis
        north = self.rate * math.cos(phi) * by_north * by_both
        up = self.rate * math.sin(phi) * by_up * by_both
        return north, up

    def _pull(self) -> tuple[float, float]:
        """Return the northward and the upward acceleration at the suspension in m/s²."""
        phi = math.radians(self.latitude)
        outward = self.rate**2 * self.axis_distance
        by_north, by_up = self.suspension
        north = -outward * math.sin(phi) * by_north
        up = outward * math.cos(phi) * by_up - self.g
        return north, up

    def _release_velocity(self) -> tuple[float, float]:
        """Return vx and vy of the release in m/s."""
        # a plane turned by hand has its own rate; otherwise it is the Earth's, without a factor of
        # the whole Coriolis force
        if self.turned_plane:
            _, rate = self._turn()
        else:
            rate = self.rate * math.sin(self._coriolis_phi()) * self.coriolis[1]
        stars = self.released * rate
        return self.vx + stars * self.y, self.vy - stars * self.x

    def _computed(self, theta: Array) -> Phasors:
        """Return the two phasors that its rows show, the effect of its integrator included."""
        square = -theta[5]
        if self.turned_plane:
            square -= theta[2] ** 2
        # phasors have one ω²: the mean of those of x and y
        if self.kind != "sphere" and theta[12]:
            xx, yy, *_ = self.gradient_square
            square -= (xx + yy) / 2
        start = complex(theta[7], theta[8])
        if self.kind == "angle" and start:
            sine = abs(start) / self.length
            start = start * math.asin(min(sine, 1.0)) / sine
        phasors = phasors_of(theta, square, start)
        if self.method is not None and self.step > 0:
            phasors = self.method.computed(phasors, self.step)
        return phasors.later(self.late) if self.late else phasors

    def phasors(self) -> Phasors:
        """Return the motion of a linear program.

        For one that is linear in the angle, it is the cord's angle times l.
        """
        return self._computed(self._exact())

    def theta(self) -> Array:
        """Return the numbers that the motion depends on, in the order of `NAMES`."""
        theta = self._exact()
        stepped = self.method is not None or self.late
        if not stepped and not self.turned_plane and self.kind == "sphere":
            return theta
        computed = theta_of(self._computed(theta), theta)
        if not stepped and self.kind == "sphere":
            computed[7:11] = theta[7:11]
        return computed

    def changed(self, **fields: object) -> Self:
        """Return the program with some fields replaced, like `replace` in a tenth of the time."""
        program = object.__new__(type(self))
        vars(program).update(vars(self) | fields)
        vars(program).pop("programs", None)  # the cached programs of a joint one
        return program

    def with_inputs(self, names: Sequence[str], values: Array) -> Self:
        """Return the program with these numbers replaced."""
        return self.changed(**dict(zip(names, values.tolist(), strict=True)))


def phasors_of(theta: Array, square: float, start: complex) -> Phasors:
    """Return the two phasors of a linear model.

    ω² and the position at t = 0 are given, all other numbers are those of theta.
    """
    centre = complex(theta[3], theta[4]) * theta[11] / square if square else 0j
    return Phasors.of(theta[2], square, theta[6], centre, start, complex(theta[9], theta[10]))


def theta_of(phasors: Phasors, theta: Array) -> Array:
    """Return theta, the numbers that two phasors determine replaced by theirs."""
    changed = theta.copy()
    pull = phasors.centre * phasors.square.real / theta[11]
    changed[2] = phasors.beta
    changed[3:5] = pull.real, pull.imag
    changed[5] = -phasors.square.real
    changed[6] = phasors.drag
    changed[7:9] = phasors.start.real, phasors.start.imag
    changed[9:11] = phasors.speed.real, phasors.speed.imag
    return changed


@dataclass(frozen=True)
class SphericalPendulum:
    """The spherical pendulum of a `theta`, in the units of the file.

    Attributes:
        model: runs it.
        radius: distance to the centre of a point mass, for its gradient, in m.
        square: xx, yy, yz, zz of the centrifugal force's gradient with gradient = 1, in 1/s².
        fastest: sum of rates in 1/s beyond which nothing is run.
    """

    model: Variants
    radius: float
    square: tuple[float, float, float, float]
    fastest: float = math.inf

    def is_too_fast(self, theta: Array) -> bool:
        """Return whether a motion is so fast that it is not run."""
        fastest_turn = float(np.abs(theta[0:3]).max())
        fastest_swing = math.sqrt(float(np.abs(theta[3:6]).max()))
        return bool(fastest_turn + abs(theta[6]) + fastest_swing > self.fastest)

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x, y (and z) in m, shape (times, columns); NaN where no such motion exists."""
        reachable = theta[11] ** 2 > theta[7] ** 2 + theta[8] ** 2
        if not reachable or not np.isfinite(theta).all() or self.is_too_fast(theta):
            return np.full((len(times), columns), np.nan)
        try:
            from_release = times if times[0] == 0 else np.concatenate([[0.0], times])
            start = self.start(theta).tolist()
            states = self.model.run(start, from_release, self.constants(theta))
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), columns), np.nan)
        return np.asarray(states[-len(times) :, :columns])

    def constants(self, theta: Array) -> Constants:
        """Return the constants of the force."""
        length, gradient, point_mass = theta[11:14]
        # gravity that falls off with 1/r² and points to the centre has a gradient like that of
        # the centrifugal force
        falloff = point_mass * abs(theta[5]) * length / self.radius if self.radius else 0.0
        xx, yy, yz, zz = (gradient * component for component in self.square)
        return Constants(
            length=float(length),
            turn=tuple(theta[:3].tolist()),
            pull=tuple(theta[3:6].tolist()),
            centrifugal=(xx - falloff, yy - falloff, yz, zz + 2 * falloff),
            drag=float(theta[6]),
        )

    def start(self, theta: Array) -> Array:
        """Return position and velocity of the release on the sphere, over the length.

        The release is below the suspension. They are NaN where the cord does not reach it.
        """
        x, y, vx, vy = theta[7:11]
        length = theta[11]
        z = -np.sqrt(length**2 - x * x - y * y)
        vz = -(x * vx + y * vy) / z
        return np.asarray(np.array([x, y, z, vx, vy, vz]) / length)

    def slopes(
        self, theta: Array, times: Array, columns: int, scales: Array, nudges: Array
    ) -> Array:
        """Return d rows / d theta times `scales`, shape (times * columns, 14).

        They are differences; each number of theta is moved by `nudges` scales.
        """

        def rows_of(change: Array) -> Array:
            return self.rows(theta + scales * change, times, columns).ravel()

        _, slopes = by_differences(rows_of, np.zeros(1), nudges)(np.zeros(len(theta)))
        return np.ascontiguousarray(slopes())
