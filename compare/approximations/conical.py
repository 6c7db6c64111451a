"""Conical pendulum without rotation (Ω = 0): a circle at constant height."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import Scene
from reference.numbers.precision import Array

from .approximation import Motion
from .case import SWINGING, PaperCase, lowest_point

# part of the circle's speed by which the velocity of release may differ from it
_CONICAL_ENOUGH = 0.1


def _circle(case: PaperCase) -> tuple[Any, Any]:
    """Return the radius in m and the angular velocity in rad/s, sqrt(g/(l cos φ)) in the sense of the release."""
    ctx, (x, y, z), (vx, vy, _) = case.ctx, case.position, case.velocity
    return ctx.hypot(x, y), ctx.sign(x * vy - y * vx) * ctx.sqrt(case.gravity / -z)


def _path(case: PaperCase, times: Array) -> Array:
    x, y, z = (float(part) for part in case.position)
    _, omega = _circle(case)
    place = complex(x, y) * np.exp(1j * float(omega) * times)
    speed = 1j * float(omega) * place
    still = np.zeros_like(times)
    return np.column_stack((place.real, place.imag, still + z, speed.real, speed.imag, still))


def _on_a_circle(scene: Scene) -> str | None:
    case = PaperCase.of_scene(scene)
    radius, omega = _circle(case)
    x, y, _ = case.position
    circular = (-y * omega, x * omega)
    miss = case.ctx.hypot(case.velocity[0] - circular[0], case.velocity[1] - circular[1])
    if not radius or not omega or miss > _CONICAL_ENOUGH * radius * abs(omega):
        return (
            "The bob moves on a circle: give a velocity at right angles to x, y of about "
            "sqrt(g/|z|) times the radius"
        )
    return None


APPROXIMATIONS = (
    Motion(
        id="conical",
        title="conical pendulum without the Foucault effect",
        where="Mathar section III, limit of Ω to 0, and [23]: angular velocity sqrt(g/(l cos φ))",
        drops="Ω",
        needs=(*SWINGING, _on_a_circle),
        path=_path,
        rest=lowest_point,
    ),
)
