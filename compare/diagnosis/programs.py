"""Programs: the numbers of a scene as a program may read them, its choices, the `theta` that follows, its motion.

A `Program` is the scene's numbers and a handful of choices; each mistake changes one of them. `theta` is what the
motion depends on (`NAMES`), so that many programs are compared with one fit without running any. A `SphericalPendulum`
runs one: it swings on the sphere by a free vector Ω and a free pull, whatever a program calls them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from reference import FoucaultError
from reference.engines.trajectory import Variants
from reference.model.constants import Constants
from reference.numbers.precision import Array
from reference.scenes.inputs import Inputs

from ..observed.least_squares import by_differences
from .phasors import FixedStepMethod, Phasors

NAMES = (
    "turn_x", "turn_y", "turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy", "length", "gradient",
    "point_mass",
)  # fmt: skip
PER_SECOND, PER_SECOND_SQUARED = [0, 1, 2, 6, 9, 10], [3, 4, 5]
HIGHEST = 12000.0  # m, above and below the ellipsoid: nobody hangs a pendulum farther out


@dataclass(frozen=True)
class Program:
    """The numbers and choices of a program; SI units, angles in degrees.

    Attributes:
        gravity_reading: what it makes of g: ellipsoid (the centrifugal force added), effective (it is within, its
            change along the swing kept), none (no centrifugal force), no_tilt (its vertical part alone), tilt (its
            horizontal part alone), tilt_no_sine (that part without sin φ), uniform (no change along the swing).
        coriolis: factors of the Coriolis force's Ωy and Ωz, and of both.
        coriolis_latitude: the latitude of the Coriolis force in degrees, if it is another one; of any size.
        turned_plane: a pendulum that does not feel the rotation, its plane turned by hand.
        released: velocity of the release over that of a bob at rest against the stars.
        frame: matrix of the horizontal axes, rows are the program's x and y in east and north.
        point_mass: gravity falls off with 1/r² and points to the centre.
        kind: sphere; linear, whose restoring force is that of small swings; or angle, linear in the angle.
        late: time in s by which the rows are late.
        pace: of its time over that of its clock.
        method: its integrator, with the `step` in s.
        nominal_rate: the scene's rotation rate, of which the gradient in theta is a part.
        phase_gain: share by which its integrator makes the swing too fast.
        decay_rate: rate in 1/s that its integrator adds to the drag; negative where the swing grows.
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
    gravity_reading: str = "ellipsoid"
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
        """Return the right program of a scene; `start` is x, y, z, vx, vy, vz at the release in m and m/s."""
        same = (
            "length",
            "latitude",
            "flattening",
            "altitude",
            "drag",
            "gravity",
            "rotation_rate",
            "equatorial_radius",
        )
        words = {"gravity": "g", "rotation_rate": "rate", "equatorial_radius": "radius"}
        fields: dict[str, Any] = {
            words.get(name, name): float(getattr(inputs, name)) for name in same
        }
        x, y, _, vx, vy, _ = start.tolist()
        fields |= {"x": x, "y": y, "vx": vx, "vy": vy, "nominal_rate": fields["rate"]}
        return cls(gravity_reading=inputs.gravity_is, **fields)

    @property
    def axis_distance(self) -> float:
        """R, the distance of the suspension from the axis of rotation, in m."""
        phi = math.radians(self.latitude)
        e2 = self.flattening * (2 - self.flattening)
        return (self.radius / math.sqrt(1 - e2 * math.sin(phi) ** 2) + self.altitude) * math.cos(
            phi
        )

    @property
    def sensible(self) -> bool:
        """False if an input is outside its domain, so that no program can have it."""
        inside = (
            self.x * self.x + self.y * self.y < self.length * self.length or self.kind == "linear"
        )
        return (
            self.g >= 0 and self.length > 0 and self.drag >= 0 and abs(self.latitude) <= 90 and inside
            and self.radius >= 0 and abs(self.altitude) <= HIGHEST and self.step >= 0 and math.isfinite(self.rate)
        )  # fmt: skip

    @property
    def gradient(self) -> float:
        """Share of the centrifugal force's change along the swing that it takes into account: 1 or 0."""
        return float(self.gravity_reading in ("ellipsoid", "effective", "tilt", "tilt_no_sine"))

    @property
    def gradient_square(self) -> tuple[float, float, float, float]:
        """xx, yy, yz, zz of |Ω|² - Ω Ωᵀ, the centrifugal force's change along the swing, in 1/s²."""
        phi = math.radians(self.latitude)
        north, up = self.rate * math.cos(phi), self.rate * math.sin(phi)
        return self.rate**2, up * up, -north * up, north * north

    def _exact(self) -> Array:
        """Return theta as an exact integration of the equations has it."""
        phi = math.radians(self.latitude)
        sin, cos = math.sin(phi), math.cos(phi)
        turned = phi if self.coriolis_latitude is None else math.radians(self.coriolis_latitude)
        north = self.rate * math.cos(turned) * self.coriolis[0] * self.coriolis[2]
        up = self.rate * math.sin(turned) * self.coriolis[1] * self.coriolis[2]
        outward = self.rate**2 * self.axis_distance
        pull_y, pull_z, gradient = 0.0, -self.g, self.gradient
        if self.gravity_reading in ("ellipsoid", "uniform", "tilt"):
            pull_y = -outward * sin
        elif self.gravity_reading == "tilt_no_sine":
            pull_y = -outward
        if self.gravity_reading in ("ellipsoid", "uniform", "tilt_no_sine", "no_tilt"):
            pull_z += outward * cos
        if self.nominal_rate:
            gradient *= (self.rate / self.nominal_rate) ** 2
        # a plane turned by hand takes its own turn with it; else the Earth's, without a factor of the Coriolis force
        stars = self.released * (
            up if self.turned_plane else self.rate * math.sin(turned) * self.coriolis[1]
        )
        vx, vy = self.vx + stars * self.y, self.vy - stars * self.x
        if self.turned_plane:
            north = 0.0
        a, b, c, d = self.frame
        hand = a * d - b * c
        theta = np.array(
            [
                hand * b * north, hand * d * north, hand * up,
                b * pull_y / self.length, d * pull_y / self.length, pull_z / self.length,
                self.drag, self.x, self.y, vx, vy, self.length, gradient, self.point_mass * self.g / abs(pull_z or 1.0),
            ]
        )  # fmt: skip
        if self.pace != 1:
            theta[PER_SECOND] *= self.pace
            theta[PER_SECOND_SQUARED] *= self.pace**2
            theta[NAMES.index("gradient")] *= self.pace**2
        theta[PER_SECOND_SQUARED] *= (1 + self.phase_gain) ** 2
        theta[NAMES.index("drag")] += self.decay_rate
        return theta

    def _computed(self, theta: Array) -> Phasors:
        square = -theta[5] - (theta[2] ** 2 if self.turned_plane else 0.0)
        # the mean of x and y: what it does to each is no matter of phasors
        if self.kind != "sphere" and theta[12]:
            xx, yy, *_ = self.gradient_square
            square -= (xx + yy) / 2
        start = complex(theta[7], theta[8])
        if self.kind == "angle" and start:
            out = abs(start) / self.length
            start = start * math.asin(min(out, 1.0)) / out
        phasors = phasors_of(theta, square, start)
        if self.method is not None and self.step > 0:
            phasors = self.method.computed(phasors, self.step)
        return phasors.later(self.late) if self.late else phasors

    def phasors(self) -> Phasors:
        """Return the motion of a linear program; of one that is linear in the angle, the cord's angle times l."""
        return self._computed(self._exact())

    def theta(self) -> Array:
        """Return the numbers that the motion depends on, in the order of `NAMES`."""
        theta, stepped = self._exact(), self.method is not None or self.late
        if not stepped and not self.turned_plane and self.kind == "sphere":
            return theta
        computed = theta_of(self._computed(theta), theta)
        if not stepped and self.kind == "sphere":
            computed[7:11] = theta[7:11]
        return computed

    def changed(self, **fields: object) -> Self:
        """Return the program with some fields replaced: as `replace` does it, in a tenth of the time."""
        made = object.__new__(type(self))
        vars(made).update(vars(self) | fields)
        vars(made).pop("programs", None)  # of a joint one, kept of the program as it was
        return made

    def with_inputs(self, names: Sequence[str], values: Array) -> Self:
        """Return the program with these numbers replaced."""
        return self.changed(**dict(zip(names, values.tolist(), strict=True)))


def phasors_of(theta: Array, square: float, start: complex) -> Phasors:
    """Return the two phasors of a linear model with the numbers of theta, but for ω² and the position at t = 0."""
    centre = complex(theta[3], theta[4]) * theta[11] / square if square else 0j
    return Phasors.of(theta[2], square, theta[6], centre, start, complex(theta[9], theta[10]))


def theta_of(phasors: Phasors, theta: Array) -> Array:
    """Return theta with the numbers that two phasors tell in place of its own."""
    changed, pull = theta.copy(), phasors.centre * phasors.square.real / theta[11]
    changed[2], changed[6], changed[5] = phasors.beta, phasors.drag, -phasors.square.real
    changed[3:5] = pull.real, pull.imag
    changed[7:11] = phasors.start.real, phasors.start.imag, phasors.speed.real, phasors.speed.imag
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

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x, y (and z) in m, shape (times, columns); NaN where no such motion exists."""
        rate = (
            float(np.abs(theta[0:3]).max())
            + abs(theta[6])
            + math.sqrt(float(np.abs(theta[3:6]).max()))
        )
        reached = theta[11] ** 2 > theta[7] ** 2 + theta[8] ** 2
        if not reached or not np.isfinite(theta).all() or rate > self.fastest:
            return np.full((len(times), columns), np.nan)
        try:
            span = times if times[0] == 0 else np.concatenate([[0.0], times])
            states = self.model.run(self.start(theta).tolist(), span, self.constants(theta))
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), columns), np.nan)
        return np.asarray(states[-len(times) :, :columns])

    def constants(self, theta: Array) -> Constants:
        """Return the constants of the force."""
        length, gradient, point = theta[11:14]
        pointing = point * abs(theta[5]) * length / self.radius if self.radius else 0.0
        xx, yy, yz, zz = (gradient * component for component in self.square)
        turn, pull = (tuple(vector.tolist()) for vector in (theta[:3], theta[3:6]))
        centrifugal = xx - pointing, yy - pointing, yz, zz + 2 * pointing
        return Constants(
            length=float(length),
            turn=turn,
            pull=pull,
            centrifugal=centrifugal,
            drag=float(theta[6]),
        )

    def start(self, theta: Array) -> Array:
        """Return position and velocity of the release over the length, below the suspension and along the sphere.

        They are NaN where the cord does not reach it.
        """
        x, y, vx, vy = theta[7:11]
        z = -np.sqrt(theta[11] ** 2 - x * x - y * y)
        return np.asarray(np.array([x, y, z, vx, vy, -(x * vx + y * vy) / z]) / theta[11])

    def slopes(
        self, theta: Array, times: Array, columns: int, scales: Array, nudges: Array
    ) -> Array:
        """Return d rows / d theta times `scales`, by differences of `nudges` scales, shape (times * columns, 14)."""

        def rows_of(change: Array) -> Array:
            return self.rows(theta + scales * change, times, columns).ravel()

        _, slopes = by_differences(rows_of, np.zeros(1), nudges)(np.zeros(len(theta)))
        return np.ascontiguousarray(slopes())
