"""Small angles about the tilted plumb line: Gastebois 5, with his closed solutions 6.1, 6.2 and 6.3.

Z = x + i y, Z'' = -ω0² Z - 2 i Ω_z Z' has the solution Z = C1 exp(-i (ω + Ω_z) t) + C2 exp(i (ω - Ω_z) t) of 6.1, with
ω² = ω0² + Ω_z²; `mathar_linear` uses it too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from reference import Scene, UnreachableError

from .approximation import CUBE_IN_AMPLITUDE, Array, Motion, Order, Printed
from .case import Case, PlumbAxes, hung, released_at_rest, swinging
from .gastebois_general import hanging

Pair = Sequence[Any]


def turntable_frequency(case: Case, gravity: Any, turn: Any) -> Any:
    """Return ω = (gravity/l + Ω_z²)^(1/2) in rad/s.

    Raises:
        UnreachableError: ω is zero.
    """
    omega = case.ctx.sqrt(gravity / case.length + turn**2)
    if not omega:
        raise UnreachableError("nothing pulls the bob back: gravity and centrifugal force cancel.")
    return omega


def constants_of(place: Pair, speed: Pair, omega: Any, turn: Any) -> tuple[Any, Any, Any, Any]:
    """Return c1, c1', c2, c2' of 6.1; arguments as in `oscillation`."""
    (x, y), (vx, vy) = place, speed
    slow, fast = omega - turn, omega + turn
    return tuple(part / (2 * omega) for part in (slow * x - vy, slow * y + vx, fast * x + vy, fast * y - vx))


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
    first, second = complex(c1, c1_prime), complex(c2, c2_prime)
    fast, slow = float(omega + turn), float(omega - turn)
    one, two = first * np.exp(-1j * fast * times), second * np.exp(1j * slow * times)
    return one + two, 1j * (slow * two - fast * one)


def small_angles(case: Case) -> tuple[PlumbAxes, Any, Any]:
    """Return the plumb line's axes, ω = (ω0² + Ω_z²)^(1/2) with ω0² = g_a/L0, and Ω_z = Ω sin λ_a."""
    turn = case.rate * case.ctx.sin(case.apparent_latitude)
    omega = turntable_frequency(case, case.apparent_gravity, turn)
    return PlumbAxes.tilted(-case.tilt, case.ctx), omega, turn


def _rows(case: Case, plumb: PlumbAxes, z: Any, rate: Any) -> Array:
    """Return rows along the scene's axes from Z = x + i y and Z' along the plumb line's."""
    return plumb.outward(hung(z.real, z.imag, rate.real, rate.imag, case.length))


def _general(scene: Scene, times: Array) -> Array:
    """Return rows of 6.1, for any release."""
    case = Case.of_scene(scene)
    plumb, omega, turn = small_angles(case)
    place, speed = plumb.inward(case.position), plumb.inward(case.velocity)
    return _rows(case, plumb, *oscillation(place[:2], speed[:2], omega, turn, times))


def _general_as_printed(scene: Scene, times: Array) -> Array:
    """Return rows of 6.1 with the sine that is printed at the end of v_x."""
    case = Case.of_scene(scene)
    plumb, omega, turn = small_angles(case)
    place, speed = plumb.inward(case.position)[:2], plumb.inward(case.velocity)[:2]
    z, rate = oscillation(place, speed, omega, turn, times)
    second, slow = float(constants_of(place, speed, omega, turn)[3]), float(omega - turn)
    return _rows(case, plumb, z, rate + second * slow * (np.cos(slow * times) - np.sin(slow * times)))


def in_turning_axes(minor: Any, omega: Any, turn: Any, t: Any, functions: Any) -> tuple[Any, Any, Any, Any]:
    """Return x, y, v_x, v_y over r0 of X = r0 cos ωt, Y = r0 `minor` sin ωt in axes that turn at -Ω_z.

    These are the lines of 6.2 with `minor` = 0, of 6.3 with Ω_z/ω.

    Args:
        minor: the small half axis of the ellipse over r0.
        omega: ω in rad/s.
        turn: Ω_z in rad/s.
        t: time or times in s.
        functions: mpmath or NumPy, with `cos` and `sin`.
    """
    cw, sw, cu, su = (
        functions.cos(omega * t),
        functions.sin(omega * t),
        functions.cos(turn * t),
        functions.sin(turn * t),
    )
    x, y = cu * cw + minor * su * sw, -su * cw + minor * cu * sw
    along, across = -omega * sw, minor * omega * cw
    return x, y, cu * along + su * across + turn * y, -su * along + cu * across - turn * x


def _ellipse(scene: Scene, times: Array, across: Callable[[Any, Any], Any]) -> Array:
    """Return rows of that motion, X along the release, with `minor` = `across`(ω, Ω_z)."""
    case = Case.of_scene(scene)
    plumb, omega, turn = small_angles(case)
    east, north, _ = plumb.inward(case.position)
    x, y, vx, vy = in_turning_axes(float(across(omega, turn)), float(omega), float(turn), times, np)
    release = complex(east, north)
    return _rows(case, plumb, release * (x + 1j * y), release * (vx + 1j * vy))


def _launched_in_the_plane(scene: Scene, times: Array) -> Array:
    return _ellipse(scene, times, lambda omega, turn: 0)


def _released(scene: Scene, times: Array) -> Array:
    return _ellipse(scene, times, lambda omega, turn: turn / omega)


def _released_clockwise(scene: Scene, times: Array) -> Array:
    return _ellipse(scene, times, lambda omega, turn: -turn / omega)


_SQUARE_IN_RATE = Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4, 4e-4), (), 1e-3)
_DROPS = "the centrifugal gradient, powers of the angle beyond the first (so the slow-down and the spherical drift)"

APPROXIMATIONS = (
    Motion(
        id="gastebois_6_1",
        title="small angles about the tilted plumb line, any release",
        where="Gastebois 5, 6.1, with g_a and λ_a of 4.2; 7.3",
        domain="small angles; an hour",
        drops=_DROPS,
        orders=(_SQUARE_IN_RATE, CUBE_IN_AMPLITUDE),
        refuses=swinging,
        printed=Printed(
            "v_x ends with - c'2 (ω - Ωz) sin (ω - Ωz)t; x and y are the integer part (partie entière)",
            "- c'2 (ω - Ωz) cos (ω - Ωz)t; real part",
            _general_as_printed,
        ),
        path=_general,
        rest=hanging,
    ),
    Motion(
        id="gastebois_6_2",
        title="small angles, launched so that the swing stays in a plane of the turning axes",
        where="Gastebois 6.2",
        domain="small angles, released with the transverse velocity -r0 Ωz; an hour",
        drops=_DROPS + "; the scene's own velocity of release (for a release at rest an error of the order Ω)",
        orders=(Order("rotation_rate", 1, (1e-4, 2e-4, 4e-4), ("site.equatorial_radius=0",)), CUBE_IN_AMPLITUDE),
        refuses=swinging,
        path=_launched_in_the_plane,
        rest=hanging,
    ),
    Motion(
        id="gastebois_6_3",
        title="small angles, released at rest: a thin ellipse in turning axes",
        where="Gastebois 6.3",
        domain="small angles, released at rest; an hour",
        drops=_DROPS,
        orders=(_SQUARE_IN_RATE, CUBE_IN_AMPLITUDE),
        refuses=released_at_rest,
        printed=Printed(
            "the ellipse is run through clockwise, transverse speed -r0 Ωz",
            "counter-clockwise in the north, +r0 Ωz, as his own X and Y say",
            _released_clockwise,
        ),
        path=_released,
        rest=hanging,
    ),
)
