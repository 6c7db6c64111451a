"""Programs: the numbers of a scene as a program may read them, its choices, and the `theta` that follows.

A `Program` is the scene's numbers and a handful of choices; each mistake changes one of them. `theta` is what the
motion depends on (`pendulum.NAMES`), so that many programs are held against one fit without running any.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array
from reference.scenes.inputs import Inputs

from .integrators import Method
from .phasors import Phasors

HIGHEST = 12000.0  # m, above and below the ellipsoid: nobody hangs a pendulum farther out


@dataclass(frozen=True)
class Program:
    """The numbers and choices of a program; SI units, angles in degrees.

    Attributes:
        gravity_reading: what it makes of g: ellipsoid (the centrifugal force added), effective (it is within, its
            change along the swing kept), none (no centrifugal force), no_tilt, uniform (no change along the swing).
        coriolis: factors of the Coriolis force's Ωy and Ωz, and of both.
        coriolis_latitude: the latitude of the Coriolis force in degrees, if it is another one; of any size.
        turned_plane: a pendulum that does not feel the rotation, its plane turned by hand.
        released: velocity of the release over that of a bob at rest against the stars.
        frame: matrix of the horizontal axes, rows are the program's x and y in east and north.
        point_mass: gravity falls off with 1/r² and points to the centre.
        kind: sphere; linear, whose restoring force is that of small swings; or angle, linear in the angle.
        late: time in s by which the rows are late.
        method: its integrator, with the `step` in s.
        nominal_rate: the scene's rotation rate, of which the gradient in theta is a part.
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
    method: Method | None = None
    step: float = 0.0
    nominal_rate: float = 0.0

    @classmethod
    def of(cls, inputs: Inputs, start: Array) -> Program:
        """Return the right program of a scene; `start` is x, y, z, vx, vy, vz at the release in m and m/s."""
        return cls(
            g=float(inputs.gravity),
            length=float(inputs.length),
            latitude=float(inputs.latitude),
            rate=float(inputs.rotation_rate),
            radius=float(inputs.equatorial_radius),
            flattening=float(inputs.flattening),
            altitude=float(inputs.altitude),
            drag=float(inputs.drag),
            x=float(start[0]),
            y=float(start[1]),
            vx=float(start[3]),
            vy=float(start[4]),
            gravity_reading=inputs.gravity_is,
            nominal_rate=float(inputs.rotation_rate),
        )

    @property
    def axis_distance(self) -> float:
        """R, the distance of the suspension from the axis of rotation, in m."""
        phi = math.radians(self.latitude)
        e2 = self.flattening * (2 - self.flattening)
        return (self.radius / math.sqrt(1 - e2 * math.sin(phi) ** 2) + self.altitude) * math.cos(phi)

    @property
    def sensible(self) -> bool:
        """False if an input is outside its domain, so that no program can have it."""
        inside = self.x * self.x + self.y * self.y < self.length * self.length or self.kind == "linear"
        return (
            self.g >= 0 and self.length > 0 and self.drag >= 0 and abs(self.latitude) <= 90 and inside
            and self.radius >= 0 and abs(self.altitude) <= HIGHEST and self.step >= 0 and math.isfinite(self.rate)
        )  # fmt: skip

    @property
    def gradient(self) -> float:
        """Share of the centrifugal force's change along the swing that it takes into account: 1 or 0."""
        return float(self.gravity_reading in ("ellipsoid", "effective"))

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
        if self.gravity_reading in ("ellipsoid", "uniform"):
            pull_y, pull_z = -outward * sin, outward * cos - self.g
        elif self.gravity_reading == "no_tilt":
            pull_z = outward * cos - self.g
        if self.nominal_rate:
            gradient *= (self.rate / self.nominal_rate) ** 2
        vx, vy = self.vx + self.released * up * self.y, self.vy - self.released * up * self.x
        if self.turned_plane:
            north = 0.0
        a, b, c, d = self.frame
        hand = a * d - b * c
        return np.array(
            [
                hand * b * north, hand * d * north, hand * up,
                b * pull_y / self.length, d * pull_y / self.length, pull_z / self.length,
                self.drag, self.x, self.y, vx, vy, self.length, gradient, self.point_mass * self.g / abs(pull_z or 1.0),
            ]
        )  # fmt: skip

    def _as_computed(self, theta: Array) -> Array:
        """Return theta as the integrator, the clock and a linear model make of it."""
        phasors = self._computed(theta)
        theta = theta.copy()
        if self.kind != "sphere" or self.late or self.method is not None:
            theta[7:11] = phasors.start.real, phasors.start.imag, phasors.speed.real, phasors.speed.imag
        pull = phasors.centre * phasors.square.real
        theta[2], theta[6], theta[5] = phasors.beta, phasors.drag, -phasors.square.real
        theta[3:5] = pull.real, pull.imag
        return theta

    def _computed(self, theta: Array) -> Phasors:
        square = -theta[5] - (theta[2] ** 2 if self.turned_plane else 0.0)
        if self.kind != "sphere" and theta[12]:  # the mean of x and y: what it does to each is no matter of phasors
            xx, yy, *_ = self.gradient_square
            square -= (xx + yy) / 2
        start, speed = complex(theta[7], theta[8]), complex(theta[9], theta[10])
        if self.kind == "angle" and start:
            out = abs(start) / self.length
            start = start * math.asin(min(out, 1.0)) / out
        centre = complex(theta[3], theta[4]) / square if square else 0j
        phasors = Phasors.of(theta[2], square, theta[6], centre, start, speed)
        if self.method is not None and self.step > 0:
            phasors = self.method.computed(phasors, self.step)
        return phasors.later(self.late) if self.late else phasors

    def phasors(self) -> Phasors:
        """Return the motion of a linear program; of one that is linear in the angle, the cord's angle times l."""
        return self._computed(self._exact())

    def theta(self) -> Array:
        """Return the numbers that the motion depends on, in the order of `pendulum.NAMES`."""
        theta = self._exact()
        if self.method is not None or self.late or self.turned_plane or self.kind != "sphere":
            theta = self._as_computed(theta)
        return theta

    def with_inputs(self, names: Sequence[str], values: Array) -> Program:
        """Return the program with these numbers replaced."""
        return Program(**(vars(self) | dict(zip(names, values.tolist(), strict=True))))  # `replace` takes twice as long

    def with_input(self, name: str, value: float) -> Program:
        """Return the program with one number replaced."""
        return replace(self, **{name: value})  # type: ignore[arg-type]
