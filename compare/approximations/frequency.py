"""Numbers of the swing: apparent gravity in m/s², frequency in Hz, and precession period T_f of its plane in s.

Gravity is that of Gastebois 4.2 and Mathar (48), the frequencies are those of Mathar VII, and the precession is that
of Gastebois 4.1, 4.2, 6.3, where T_p is 2π/Ω. `foucault paper` lists the misprints in them.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from reference import Scene

from ..observed.swing_plane import frequency, precession_period
from .approximation import Order, Quantity
from .case import Case, at_rest, released_at_rest, swinging, under_gravity
from .mathar import slow_down

_STILL = ("site.rotation_rate=0",)
_SQUARE_IN_AMPLITUDE = Order("amplitude", 2, (1.0, 2.0, 4.0, 8.0), _STILL)
_EXACT = Order("amplitude", None, (1.0, 8.0, 40.0), _STILL)
_SQUARE_IN_RATE = Order("rotation_rate", 2, (1e-3, 2e-3, 4e-3), ("site.equatorial_radius=0",), 1e-2)
_CENTRIFUGAL = Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4), (), 1e-2)
_AT_POLE = ("site.latitude=90", "site.rotation_rate=2e-3")
_SMALL = 1e-2
_SQUARE_AT_POLE = Order("amplitude", 2, (2.0, 4.0, 8.0), _AT_POLE)


def harmonic(case: Case) -> Any:
    """Return sqrt(g/l)/2π."""
    return case.ctx.sqrt(case.gravity / case.length) / (2 * case.ctx.pi)


def planar(case: Case) -> Any:
    """Return 1/(4 sqrt(l/g) K(sin(φ0/2))), with φ0 counted from the vertical."""
    quarter = case.ctx.ellipk((1 + case.position[2] / case.length) / 2)
    return case.ctx.sqrt(case.gravity / case.length) / (4 * quarter)


def turntable(case: Case, gravity: Any) -> Any:
    """Return sqrt(gravity/l + (Ω sin φ)²)/2π, the frequency of Mathar (51)-(52)."""
    turn = case.rate * case.sin
    return case.ctx.sqrt(gravity / case.length + turn**2) / (2 * case.ctx.pi)


def anharmonic(case: Case) -> Any:
    """Return the frequency on a turntable with g', divided by 2K/π."""
    return turntable(case, case.apparent_gravity) / slow_down(case)


def _over_sine(case: Case) -> Any:
    """Return T_p/sin λ."""
    return abs(2 * case.ctx.pi / (case.rate * case.sin))


def _over_tilted_sine(case: Case) -> Any:
    """Return T_p/sin λ_a, λ_a = λ + α."""
    return abs(2 * case.ctx.pi / (case.rate * case.ctx.sin(case.apparent_latitude)))


def _spherical(case: Case) -> Any:
    """Return T_p/sin λ_a (1 + 3/8 r0²/L0²), with r0 counted from the plumb line."""
    x, y, _ = case.plumb.inward(case.position)
    return _over_tilted_sine(case) * (1 + 3 * (x**2 + y**2) / (8 * case.length**2))


def _turning(scene: Scene) -> str | None:
    still = not scene.exact.rotation_rate or not scene.exact.latitude
    return "The plane does not turn: give a rotation rate and a latitude other than 0" if still else swinging(scene)


_frequency = partial(Quantity, refuses=swinging, truth=frequency, unit="Hz")
_precession = partial(
    Quantity,
    refuses=_turning,
    truth=precession_period,
    unit="s",
)

APPROXIMATIONS = (
    Quantity(
        id="apparent_gravity",
        title="gravity and centrifugal force at the suspension",
        where="Gastebois 4.2; Mathar (48)",
        drops="the cord: the bob is nearer to the axis than the suspension",
        orders=(Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4)), Order("length", 1, (10, 20, 40, 80))),
        refuses=under_gravity,
        formula=lambda case: case.apparent_gravity,
        truth=lambda scene: Case.of_scene(scene).pull_at_rest,
        unit="m/s²",
    ),
    _frequency(
        id="frequency_harmonic",
        title="harmonic frequency sqrt(g/l)/2π",
        where="Mathar section VII, frequency 1",
        drops="the amplitude, Ω, the centrifugal force",
        orders=(_SQUARE_IN_AMPLITUDE, _CENTRIFUGAL),
        formula=harmonic,
    ),
    _frequency(
        id="frequency_planar",
        title="frequency of the plane pendulum of finite amplitude",
        where="Mathar section VII, frequency 2",
        drops="Ω and the centrifugal force",
        orders=(_EXACT, _CENTRIFUGAL),
        refuses=released_at_rest,
        formula=planar,
    ),
    _frequency(
        id="frequency_turntable",
        title="harmonic frequency on a turntable, sqrt(g/l + (Ω sin φ)²)/2π",
        where="Mathar section VII, frequency 3",
        drops="the amplitude, the centrifugal force",
        orders=(_SQUARE_IN_AMPLITUDE, _CENTRIFUGAL),
        formula=lambda case: turntable(case, case.gravity),
    ),
    _frequency(
        id="frequency_apparent",
        title="harmonic frequency on a turntable, with the apparent gravity g' of (48)",
        where="Mathar section VII, frequency 4",
        drops="the amplitude, the centrifugal gradient",
        orders=(_SQUARE_IN_AMPLITUDE, _SQUARE_IN_RATE),
        formula=lambda case: turntable(case, case.apparent_gravity),
    ),
    _frequency(
        id="frequency_anharmonic",
        title="harmonic frequency on a turntable with g', slowed down by the amplitude, 2K/π",
        where="Mathar section VII, frequency 5",
        drops="the centrifugal gradient; the effects of the ellipse and of Ω cos φ at finite amplitude",
        orders=(_EXACT, _SQUARE_IN_RATE),
        refuses=released_at_rest,
        formula=anharmonic,
    ),
    _precession(
        id="precession_sine",
        title="precession period T_p/sin λ",
        where="Gastebois 4.1",
        drops="the centrifugal force, the amplitude",
        orders=(Order("rotation_rate", 2, (1e-4, 2e-4, 4e-4), (), _SMALL), _SQUARE_AT_POLE),
        formula=_over_sine,
    ),
    _precession(
        id="precession_tilted",
        title="precession period T_p/sin λ_a, with the tilt of the plumb line",
        where="Gastebois 4.2, 6.3",
        drops="the centrifugal gradient, the amplitude",
        orders=(
            Order("rotation_rate", 2, (2e-3, 4e-3, 8e-3), ("site.equatorial_radius=0",), _SMALL),
            _SQUARE_AT_POLE,
        ),
        formula=_over_tilted_sine,
    ),
    _precession(
        id="precession_spherical",
        title="precession period with the drift of the spherical pendulum, T_p/sin λ_a (1 + 3/8 r0²/L0²)",
        where="Gastebois 6.3",
        drops="the fourth power of the amplitude; the centrifugal gradient, which changes the ellipse that drifts",
        orders=(Order("amplitude", 4, (4.0, 8.0, 16.0), _AT_POLE),),
        refuses=lambda scene: _turning(scene) or at_rest(scene),
        formula=_spherical,
    ),
)
