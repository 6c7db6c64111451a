"""What closed forms need of a scene, in high precision; and the ways back to rows of binary64."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from reference import Scene, UnreachableError
from reference.model.constants import Constants, Vector, constants, release
from reference.model.force import rest_position
from reference.precision import context

from .approximation import Array

PREC = 200  # bits: a series that cancels to Ω⁶, some 40 digits below its first term, keeps 20 digits


@dataclass(frozen=True)
class Case:
    """A scene's numbers as mpf in SI units, under the names of the documents."""

    ctx: Any
    k: Constants
    position: Vector
    velocity: Vector

    @classmethod
    def of(cls, scene: Scene) -> Case:
        """Read a scene."""
        ctx = context(PREC)
        position, velocity = release(scene.exact, ctx)
        return cls(ctx, constants(scene.exact, ctx), position, velocity)

    @cached_property
    def length(self) -> Any:
        """Cord length l (Gastebois L0)."""
        return self.k.length

    @cached_property
    def gravity(self) -> Any:
        """Gravity g, down along the ellipsoid's normal."""
        return self.ctx.mpf(self.k.gravity) * self.length

    @cached_property
    def rate(self) -> Any:
        """Rotation rate Ω."""
        return self.ctx.mpf(self.k.rate)

    @cached_property
    def sin(self) -> Any:
        """Sine of the geodetic latitude."""
        return self.ctx.mpf(self.k.sin)

    @cached_property
    def cos(self) -> Any:
        """Cosine of the geodetic latitude."""
        return self.ctx.mpf(self.k.cos)

    @cached_property
    def axis_distance(self) -> Any:
        """R = (N + h) cos φ of the suspension, Mathar (3)."""
        return self.ctx.mpf(self.k.axis_distance) * self.length

    @cached_property
    def outward(self) -> Any:
        """Centrifugal acceleration R Ω² at the suspension (Gastebois a_e)."""
        return self.axis_distance * self.rate**2

    @cached_property
    def apparent_gravity(self) -> Any:
        """The g' of Mathar (48), which is g_a of Gastebois 4.2 rightly printed: the law of cosines."""
        g, a = self.gravity, self.outward
        return self.ctx.sqrt(g**2 + a**2 - 2 * g * a * self.cos)

    @cached_property
    def tilt(self) -> Any:
        """Angle α from the vertical to the plumb line, south positive, Gastebois 4.2."""
        return self.ctx.atan2(self.outward * self.sin, self.gravity - self.outward * self.cos)

    @cached_property
    def rest(self) -> Vector:
        """Direction n of the full model's point of rest, Mathar (46).

        Raises:
            UnreachableError: there is none, or none that an iteration finds.
        """
        try:
            return rest_position(self.k, self.ctx)
        except (ValueError, ZeroDivisionError):
            raise UnreachableError("the scene has no point of rest to swing about.") from None

    @cached_property
    def apparent_latitude(self) -> Any:
        """λ_a = λ + α."""
        return self.ctx.atan2(self.sin, self.cos) + self.tilt


@dataclass(frozen=True)
class Level:
    """Axes east, north and up along a plumb line that hangs at n = (0, sin θ, -cos θ)."""

    sin: Any
    cos: Any

    @classmethod
    def tilted(cls, theta: Any, ctx: Any) -> Level:
        """From θ in the context `ctx`; north of the vertical is positive."""
        return cls(ctx.sin(theta), ctx.cos(theta))

    def inward(self, v: Vector) -> Vector:
        """Components along the plumb line's axes of a vector given along the scene's."""
        return (v[0], self.cos * v[1] + self.sin * v[2], self.cos * v[2] - self.sin * v[1])

    def outward(self, rows: Array) -> Array:
        """Rows x, y, z, vx, vy, vz of the plumb line's axes, along the scene's."""
        x, y, z, vx, vy, vz = rows.T
        sin, cos = float(self.sin), float(self.cos)
        return np.column_stack((x, cos * y - sin * z, sin * y + cos * z, vx, cos * vy - sin * vz, sin * vy + cos * vz))


def hung(x: Array, y: Array, vx: Array, vy: Array, length: Any) -> Array:
    """Rows with z below the suspension from |r| = l, and vz from r·v = 0: Mathar (7), (12).

    Raises:
        UnreachableError: x² + y² reaches l².
    """
    l2 = float(length) ** 2
    square = l2 - x * x - y * y
    if not np.min(square) > 0:
        raise UnreachableError("the approximate motion leaves the sphere.", "The amplitude is beyond its domain.")
    z = -np.sqrt(square)
    return np.column_stack((x, y, z, vx, vy, -(x * vx + y * vy) / z))


def without_drag(scene: Scene) -> str | None:
    """A reason, if the scene has drag: none of the documents has."""
    return "It has no drag: set pendulum.drag=0" if scene.exact.drag else None


def below(scene: Scene) -> str | None:
    """A reason, if the bob has drag or is not let go below the suspension."""
    angles = scene.exact.angles
    if angles is not None and angles[0] >= 90:
        return "It holds below the suspension only: give release.angle under 90"
    return without_drag(scene)


def at_rest(scene: Scene) -> str | None:
    """A reason, if the bob has drag, starts above or is not let go at rest."""
    return below(scene) or (None if scene.exact.at_rest else "It is for a release at rest: leave out vx and vy")


def under_gravity(scene: Scene) -> str | None:
    """A reason, if nothing pulls the bob back."""
    return None if scene.exact.gravity else "Nothing pulls it back: give site.gravity above 0"
