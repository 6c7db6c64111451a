"""A scene's numbers for closed forms in high precision, plumb-line axes, rows in binary64, and reasons to refuse.

Truncated systems are integrated with the constants as parameters. A sweep over latitudes then
compiles one system instead of one for each latitude, and compiling costs more than the integration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from reference import Scene, UnreachableError
from reference.model.algebra import Functions, State
from reference.model.constants import Constants, Vector
from reference.model.force import tension
from reference.model.start import Start
from reference.numbers.precision import DOUBLE, Array

# bits, 60 digits: a series that cancels to Ω⁶, some 40 digits below its first term, keeps 20 digits
PREC = 200
Derivatives = Callable[[State, Constants, Functions], State]


@dataclass(frozen=True)
class PaperCase(Start):
    """A scene's start, with its numbers as mpf in SI units under the names used in the source papers."""

    @classmethod
    def of_scene(cls, scene: Scene) -> PaperCase:
        """Return the case of a scene."""
        return cls.of(scene.exact, PREC)

    @cached_property
    def length(self) -> Any:
        """Cord length l (Gastebois L0)."""
        return self.k.length

    @cached_property
    def gravity(self) -> Any:
        """Gravity g, down along the ellipsoid's normal."""
        return self.k.gravity * self.length

    @cached_property
    def turn(self) -> Any:
        """Ω sin φ: how fast the ground turns about its vertical (Gastebois Ω_z, with the geodetic latitude)."""
        return self.k.rate * self.k.sin

    @cached_property
    def latitude(self) -> Any:
        """Geodetic latitude in rad."""
        return self.ctx.atan2(self.k.sin, self.k.cos)

    @cached_property
    def axis_distance(self) -> Any:
        """R = (N + h) cos φ of the suspension, Mathar (3)."""
        return self.k.axis_distance * self.length

    @cached_property
    def outward(self) -> Any:
        """Centrifugal acceleration R Ω² at the suspension (Gastebois a_e)."""
        return self.axis_distance * self.k.rate**2

    @cached_property
    def apparent_gravity(self) -> Any:
        """Apparent gravity g' by the law of cosines: Mathar (48); g_a of Gastebois 4.2, misprint corrected."""
        g, a = self.gravity, self.outward
        return self.ctx.sqrt(g**2 + a**2 - 2 * g * a * self.k.cos)

    @cached_property
    def tilt(self) -> Any:
        """Angle α from the vertical to the plumb line, positive to the south, Gastebois 4.2."""
        return self.ctx.atan2(self.outward * self.k.sin, self.gravity - self.outward * self.k.cos)

    @cached_property
    def apparent_latitude(self) -> Any:
        """Apparent latitude λ_a = λ + α, Gastebois 4.2."""
        return self.latitude + self.tilt

    @cached_property
    def plumb(self) -> PlumbLine:
        """Axes of the plumb line along the apparent gravity, Gastebois 4.2."""
        return PlumbLine(-self.ctx.sin(self.tilt), self.ctx.cos(self.tilt))

    @property
    def rest_angle(self) -> Any:
        """Angle in rad from the vertical to the full model's rest position, positive to the south."""
        _, y, z = self.rest
        return self.ctx.atan2(-y, -z)

    @property
    def pull_at_rest(self) -> Any:
        """Tension of the cord per mass in m/s² at the full model's rest position."""
        return self.length * tension(self.rest, (0, 0, 0), self.k)


@dataclass(frozen=True)
class PlumbLine:
    """Axes east, north and up of a plumb line that hangs along n = (0, sin θ, -cos θ)."""

    sin: Any
    cos: Any

    def inward(self, v: Vector) -> Vector:
        """Turn a vector from the scene's axes to the plumb line's."""
        return (v[0], self.cos * v[1] + self.sin * v[2], self.cos * v[2] - self.sin * v[1])

    def outward(self, rows: Array) -> Array:
        """Turn rows x, y, z, vx, vy, vz from the plumb line's axes to the scene's."""
        x, y, z, vx, vy, vz = rows.T
        sin, cos = float(self.sin), float(self.cos)
        return np.column_stack(
            (x, cos * y - sin * z, sin * y + cos * z, vx, cos * vy - sin * vz, sin * vy + cos * vz)
        )


def integrated(
    variables: Sequence[str],
    derivatives: Derivatives,
    start: Sequence[Any],
    case: PaperCase,
    times: Array,
) -> Array:
    """Integrate a system with the constants of a case and return its states at the times.

    Args:
        variables: names of the state variables.
        derivatives: `derivatives(state, constants, functions)`; it may use the constants turn,
            pull, centrifugal and drag.
        start: the state at t = 0, mpf.
        case: its constants are used; those that are exactly zero are left out of the system.
        times: increasing, from 0, in s.

    Returns:
        Shape (times, variables).

    Raises:
        IntegrationError: the motion comes to a singularity, or needs more than `MAX_STEPS` steps.
    """
    from reference.engines.heyoka.propagator import AutonomousSystem, Propagator
    from reference.engines.trajectory import MAX_STEPS

    used = case.k.entries("turn", "pull", "centrifugal", "drag")

    def rates(state: State, functions: Functions, parameters: Sequence[Any] = ()) -> State:
        return derivatives(state, Constants.of(dict(zip(used, parameters, strict=True))), functions)

    system = AutonomousSystem(variables, rates, len(used))
    propagator = Propagator(system, DOUBLE, radians=case.fastest_rate * times[-1])
    begin, constants = map(propagator.numbers.all_of, (start, [*used.values()]))
    return np.asarray(propagator.from_zero(begin, times, constants, MAX_STEPS))


def lowest_point(scene: Scene) -> Vector:
    """Return the point straight below the suspension, (0, 0, -l) in m."""
    return (0, 0, -PaperCase.of_scene(scene).length)


def hung(x: Array, y: Array, vx: Array, vy: Array, length: Any) -> Array:
    """Return rows x, y, z, vx, vy, vz with z < 0 from |r| = l and vz from r·v = 0: Mathar (7), (12).

    Raises:
        UnreachableError: x² + y² reaches l².
    """
    l2 = float(length) ** 2
    square = l2 - x * x - y * y
    if not np.min(square) > 0:
        raise UnreachableError(
            "the approximate motion leaves the sphere.",
            "The amplitude is too large for this approximation.",
        )
    z = -np.sqrt(square)
    return np.column_stack((x, y, z, vx, vy, -(x * vx + y * vy) / z))


def without_drag(scene: Scene) -> str | None:
    """Return a reason to refuse a scene with drag, which none of the source papers has, or None."""
    return "The approximation has no drag: set pendulum.drag=0" if scene.exact.drag else None


def underneath(scene: Scene, law: str = "The formula") -> str | None:
    """Return a reason to refuse a release that is not below the suspension, or None."""
    angles = scene.exact.angles
    high = angles is not None and angles[0] >= 90
    return (
        f"{law} is valid only below the suspension: give release.angle below 90" if high else None
    )


def at_rest(scene: Scene) -> str | None:
    """Return a reason to refuse a release with a velocity, or None."""
    return (
        None
        if scene.exact.at_rest
        else "The approximation is for a release at rest: leave out the velocity"
    )


def under_gravity(scene: Scene) -> str | None:
    """Return a reason to refuse a scene without gravity, where nothing pulls the bob back, or None."""
    return (
        None
        if scene.exact.gravity
        else "Without gravity no force pulls the bob back: give site.gravity above 0"
    )


SWINGING = (underneath, without_drag, under_gravity)
RELEASED_AT_REST = (underneath, without_drag, at_rest, under_gravity)
