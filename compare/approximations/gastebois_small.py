"""Small angles about the tilted plumb line: Gastebois 5, with his closed solutions 6.1, 6.2 and 6.3.

Z = x + i y, Z'' = -ω0² Z - 2 i Ω_z Z' has the solution Z = C1 exp(-i (ω + Ω_z) t) + C2 exp(i (ω - Ω_z) t) of 6.1, with
ω² = ω0² + Ω_z²; `mathar_linear` uses it too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reference import Scene, UnreachableError

from .approximation import CUBE_IN_AMPLITUDE, Array, Motion, Order, Printed
from .case import Case, PlumbAxes, hung, released_at_rest, swinging
from .gastebois_general import hanging


def turntable_frequency(case: Case, gravity: Any, turn: Any) -> Any:
    """Return ω = (gravity/l + Ω_z²)^(1/2) in rad/s.

    Raises:
        UnreachableError: ω is zero.
    """
    omega = case.ctx.sqrt(gravity / case.length + turn**2)
    if not omega:
        raise UnreachableError("nothing pulls the bob back: gravity and centrifugal force cancel.")
    return omega


def oscillation(place: tuple[Any, Any], speed: tuple[Any, Any], omega: Any, turn: Any, times: Array) -> Any:
    """Return Z in m and Z' in m/s at the times, two complex arrays.

    Args:
        place: x, y in m at t = 0, mpf.
        speed: vx, vy in m/s at t = 0, mpf.
        omega: ω in rad/s, mpf, not zero.
        turn: Ω_z in rad/s, mpf.
        times: in s.
    """
    (x, y), (vx, vy) = place, speed
    first = complex(((omega - turn) * x - vy) / (2 * omega), ((omega - turn) * y + vx) / (2 * omega))
    second = complex(((omega + turn) * x + vy) / (2 * omega), ((omega + turn) * y - vx) / (2 * omega))
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
    (x, y, _), (vx, vy, _) = plumb.inward(case.position), plumb.inward(case.velocity)
    z, rate = oscillation((x, y), (vx, vy), omega, turn, times)
    second, slow = float(((omega + turn) * y - vx) / (2 * omega)), float(omega - turn)  # c'2
    return _rows(case, plumb, z, rate + second * slow * (np.cos(slow * times) - np.sin(slow * times)))


def _in_turning_axes(scene: Scene, times: Array, across: Callable[[Any, Any], Any]) -> Array:
    """Return rows of X = r0 cos ωt, Y = r0 `across`(ω, Ω_z) sin ωt in axes that turn at -Ω_z, X along the release."""
    case = Case.of_scene(scene)
    plumb, omega, turn = small_angles(case)
    x, y, _ = plumb.inward(case.position)
    minor, w, u = float(across(omega, turn)), float(omega), float(turn)
    cos, sin = np.cos(w * times), np.sin(w * times)
    place, speed = cos + 1j * minor * sin, w * (1j * minor * cos - sin)
    turned = complex(x, y) * np.exp(-1j * u * times)
    return _rows(case, plumb, turned * place, turned * (speed - 1j * u * place))


def _launched_in_the_plane(scene: Scene, times: Array) -> Array:
    return _in_turning_axes(scene, times, lambda omega, turn: 0)


def _released(scene: Scene, times: Array) -> Array:
    return _in_turning_axes(scene, times, lambda omega, turn: turn / omega)


def _released_clockwise(scene: Scene, times: Array) -> Array:
    return _in_turning_axes(scene, times, lambda omega, turn: -turn / omega)


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
