"""Harmonic pendulum on a turntable, Mathar (51)-(52), and its improvements in section VII: g', centre, slow-down.

All four are Gastebois' closed solution 6.1 with other constants: gravity g or g', the centre of the swing, and the
frequency. In print (51)-(52) lost hats and dots; dimensions and the limit of (43) leave no doubt about the right form.
"""

from __future__ import annotations

from typing import Any

from reference import Scene
from reference.model.algebra import dot

from .approximation import CUBE_IN_AMPLITUDE, SQUARE_IN_RATE, Array, Motion, Order, Printed
from .case import Case, hung, lowest_point, released_at_rest, swinging
from .gastebois_small import oscillation, turntable_frequency

_ABOUT_REST = Order("rotation_rate", 2, (1e-3, 2e-3, 4e-3), ("site.equatorial_radius=0",), 1e-3)


def slow_down(case: Case) -> Any:
    """Return 2K/π, the period over the harmonic one; K has the modulus sin(φ0/2), φ0 counted from the rest position."""
    cosine = dot(case.position, case.rest) / case.length
    return 2 * case.ctx.ellipk((1 - cosine) / 2) / case.ctx.pi


def _swung(case: Case, gravity: Any, centre: Any, times: Array, slowed: Any = 1) -> Array:
    """Return rows of Mathar (51)-(52): ω0² = gravity/l about (0, centre), Ω_z = Ω sin φ, and ω divided by `slowed`."""
    turn = case.rate * case.sin
    omega = turntable_frequency(case, gravity, turn) / slowed
    place = (case.position[0], case.position[1] - centre)
    z, rate = oscillation(place, case.velocity[:2], omega, turn, times)
    return hung(z.real, z.imag + float(centre), rate.real, rate.imag, case.length)


def _with_gravity(scene: Scene, times: Array) -> Array:
    case = Case.of_scene(scene)
    return _swung(case, case.gravity, case.ctx.zero, times)


def _with_apparent_gravity(scene: Scene, times: Array) -> Array:
    case = Case.of_scene(scene)
    return _swung(case, case.apparent_gravity, case.ctx.zero, times)


def _about_rest(scene: Scene, times: Array) -> Array:
    case = Case.of_scene(scene)
    return _swung(case, case.apparent_gravity, _north_of_rest(case), times)


def _slowed(scene: Scene, times: Array) -> Array:
    case = Case.of_scene(scene)
    return _swung(case, case.apparent_gravity, _north_of_rest(case), times, slow_down(case))


def _north_of_rest(case: Case) -> Any:
    return case.ctx.mpf(case.rest[1]) * case.length


APPROXIMATIONS = (
    Motion(
        id="linear_g",
        title="harmonic pendulum on a turntable",
        where="Mathar (51)-(52)",
        domain="small amplitudes, slow rotation; some seconds, because the plumb line is not vertical",
        drops="Ω² (so the tilt and strength of the apparent gravity), all powers of x/l and y/l beyond the first",
        orders=(SQUARE_IN_RATE, CUBE_IN_AMPLITUDE),
        refuses=swinging,
        printed=Printed("ẍ = -x̂ ĝ + 2 Ω sin φ ŷ", "x̂'' = -x̂ ĝ + 2 Ω sin φ ŷ', each with a hat and ŷ with its dot"),
        path=_with_gravity,
        rest=lowest_point,
    ),
    Motion(
        id="linear_apparent",
        title="harmonic pendulum on a turntable, apparent gravity",
        where="Mathar (51)-(52) with g' of (48), section VII",
        domain="small amplitudes; the frequency holds for hours, the centre does not",
        drops="the tilt of the plumb line, the centrifugal gradient, all powers of x/l and y/l beyond the first",
        orders=(SQUARE_IN_RATE, CUBE_IN_AMPLITUDE),
        refuses=swinging,
        path=_with_apparent_gravity,
        rest=lowest_point,
    ),
    Motion(
        id="linear_recentred",
        title="harmonic pendulum on a turntable, about the rest position",
        where="Mathar (51)-(52) with g' of (48), about the point of section V",
        domain="small amplitudes; an hour",
        drops="Ω at the tilted latitude (Ω³), the centrifugal gradient (Ω²), the anharmonic slow-down",
        orders=(_ABOUT_REST, CUBE_IN_AMPLITUDE),
        refuses=swinging,
        path=_about_rest,
    ),
    Motion(
        id="linear_anharmonic",
        title="harmonic pendulum on a turntable, about the rest position, with the slow-down of the plane pendulum",
        where="Mathar section VII, fifth frequency: 2K(sin(φ0/2))/π, where 4K is printed",
        domain="amplitudes of some degrees, released at rest; a day",
        drops="Ω at the tilted latitude (Ω³), the centrifugal gradient (Ω²), the overtones of the swing",
        orders=(_ABOUT_REST, CUBE_IN_AMPLITUDE),
        refuses=released_at_rest,
        path=_slowed,
    ),
)
