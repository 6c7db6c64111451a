"""Gastebois' pendulum about the tilted plumb line: any amplitude, 7.2, and small angles, 5, solved in 6.1 to 6.3.

7.2: his angles θ (from the plumb line) and φ (from east to north) are singular on the plumb line.
Along the scene's axes his system is the model without the centrifugal gradient: the apparent
gravity is everywhere that at the suspension, `pull`.

5: Z = x + i y, Z'' = -ω0² Z - 2 i Ω_z Z' has the solution Z = C1 exp(-i (ω + Ω_z) t) + C2 exp(i (ω - Ω_z) t) of 6.1,
with ω² = ω0² + Ω_z²; `mathar` uses it too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from reference import Scene, UnreachableError
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import Array

from .approximation import Motion
from .case import RELEASED_AT_REST, SWINGING, PaperCase, hung, integrated

Pair = Sequence[Any]


def hanging(scene: Scene) -> Any:
    """Return his rest position in m, along the apparent gravity of 4.2: (0, -l sin α, -l cos α)."""
    case = PaperCase.of_scene(scene)
    return (0, case.length * case.plumb.sin, -case.length * case.plumb.cos)


def _any_amplitude(case: PaperCase, times: Array) -> Array:
    """Return rows of 7.2: the model, with the apparent gravity at the suspension everywhere."""
    model, case = FORMULATIONS["spin"], replace(case, k=replace(case.k, centrifugal=(0, 0, 0, 0)))
    states = integrated(model.variables, model.derivatives, case.state(model), case, times)
    place, speed = model.cartesian(tuple(states.T), case.k, np)
    return np.column_stack((*place, *speed)) * float(case.length)


def turntable_frequency(case: PaperCase, gravity: Any, turn: Any) -> Any:
    """Return ω = (gravity/l + Ω_z²)^(1/2) in rad/s.

    Raises:
        UnreachableError: ω is zero.
    """
    omega = case.ctx.sqrt(gravity / case.length + turn**2)
    if not omega:
        raise UnreachableError("no force pulls the bob back: gravity and centrifugal force cancel.")
    return omega


def constants_of(place: Pair, speed: Pair, omega: Any, turn: Any) -> tuple[Any, Any, Any, Any]:
    """Return c1, c1', c2, c2' of 6.1; arguments as in `oscillation`."""
    (x, y), (vx, vy) = place, speed
    slow, fast = omega - turn, omega + turn
    return tuple(
        part / (2 * omega) for part in (slow * x - vy, slow * y + vx, fast * x + vy, fast * y - vx)
    )


def oscillation(place: Pair, speed: Pair, omega: Any, turn: Any, times: Array) -> Any:
    """Return Z in m and Z' in m/s at the times, two complex arrays.

    Args:
        place: x, y in m at t = 0, mpf.
        speed: vx, vy in m/s at t = 0, mpf.
        omega: ω in rad/s, mpf, not zero.
        turn: Ω_z in rad/s, mpf.
        times: in s.
    """
    c1, c1_prime, c2, c2_prime = constants_of(place, speed, omega, turn)
    fast, slow = float(omega + turn), float(omega - turn)
    first = complex(c1, c1_prime) * np.exp(-1j * fast * times)
    second = complex(c2, c2_prime) * np.exp(1j * slow * times)
    return first + second, 1j * (slow * second - fast * first)


def small_angles(case: PaperCase) -> tuple[Any, Any]:
    """Return ω = (ω0² + Ω_z²)^(1/2) with ω0² = g_a/L0, and Ω_z = Ω sin λ_a, in rad/s."""
    turn = case.k.rate * case.ctx.sin(case.apparent_latitude)
    return turntable_frequency(case, case.apparent_gravity, turn), turn


def _rows(case: PaperCase, z: Any, rate: Any) -> Array:
    """Return rows along the scene's axes from Z = x + i y and Z' along the plumb line's."""
    return case.plumb.outward(hung(z.real, z.imag, rate.real, rate.imag, case.length))


def _any_release(case: PaperCase, times: Array) -> Array:
    """Return rows of 6.1."""
    omega, turn = small_angles(case)
    place, speed = case.plumb.inward(case.position)[:2], case.plumb.inward(case.velocity)[:2]
    return _rows(case, *oscillation(place, speed, omega, turn, times))


def in_turning_axes(
    minor: Any, omega: Any, turn: Any, t: Any, functions: Any
) -> tuple[Any, Any, Any, Any]:
    """Return x, y, v_x, v_y over r0 of X = r0 cos ωt, Y = r0 `minor` sin ωt in axes that turn at -Ω_z.

    These are the lines of 6.2 with `minor` = 0, of 6.3 with Ω_z/ω.

    Args:
        minor: the small half axis of the ellipse over r0.
        omega: ω in rad/s.
        turn: Ω_z in rad/s.
        t: time or times in s.
        functions: mpmath or NumPy, with `cos` and `sin`.
    """
    cw, sw = functions.cos(omega * t), functions.sin(omega * t)
    cu, su = functions.cos(turn * t), functions.sin(turn * t)
    x, y = cu * cw + minor * su * sw, -su * cw + minor * cu * sw
    along, across = -omega * sw, minor * omega * cw
    return x, y, cu * along + su * across + turn * y, -su * along + cu * across - turn * x


def _ellipse(case: PaperCase, times: Array, sense: int) -> Array:
    """Return rows of that motion, X along the release: `sense` 0 is 6.2, 1 is 6.3."""
    omega, turn = small_angles(case)
    east, north, _ = case.plumb.inward(case.position)
    x, y, vx, vy = in_turning_axes(
        float(sense * turn / omega), float(omega), float(turn), times, np
    )
    release = complex(east, north)
    return _rows(case, release * (x + 1j * y), release * (vx + 1j * vy))


_DROPS = "the centrifugal gradient, powers of the angle beyond the first (so the slow-down and the spherical drift)"

APPROXIMATIONS = (
    Motion(
        id="gastebois_general",
        title="any amplitude in uniform apparent gravity",
        where="Gastebois 7.2, with g_a and λ_a of 4.2",
        drops="the centrifugal gradient: Ω² times distances of the order of l",
        path=_any_amplitude,
        rest=hanging,
    ),
    Motion(
        id="gastebois_6_1",
        title="small angles about the tilted plumb line, any release",
        where="Gastebois 5, 6.1, with g_a and λ_a of 4.2; 7.3",
        drops=_DROPS,
        needs=SWINGING,
        path=_any_release,
        rest=hanging,
    ),
    Motion(
        id="gastebois_6_2",
        title="small angles, launched so that the swing stays in a plane of the turning axes",
        where="Gastebois 6.2",
        drops=_DROPS
        + "; the scene's own velocity of release (for a release at rest an error of the order Ω)",
        needs=SWINGING,
        path=partial(_ellipse, sense=0),
        rest=hanging,
    ),
    Motion(
        id="gastebois_6_3",
        title="small angles, released at rest: a thin ellipse in turning axes",
        where="Gastebois 6.3",
        drops=_DROPS,
        needs=RELEASED_AT_REST,
        path=partial(_ellipse, sense=1),
        rest=hanging,
    ),
)
