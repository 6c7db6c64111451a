"""Frequency of the swing in Hz: the five approximations of Mathar, section VII."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from reference import Scene

from ..observed.apsides import frequency
from .approximation import Order, Printed, Quantity
from .case import Case, released_at_rest, swinging
from .mathar_linear import slow_down

_STILL = ("site.rotation_rate=0",)
_SQUARE_IN_AMPLITUDE = Order("amplitude", 2, (1.0, 2.0, 4.0, 8.0), _STILL)
_EXACT = Order("amplitude", None, (1.0, 8.0, 40.0), _STILL)
_SQUARE_IN_RATE = Order("rotation_rate", 2, (1e-3, 2e-3, 4e-3), ("site.equatorial_radius=0",), 1e-2)
_CENTRIFUGAL = Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4), (), 1e-2)


def harmonic(case: Case) -> Any:
    """Return sqrt(g/l)/2π."""
    return case.ctx.sqrt(case.gravity / case.length) / (2 * case.ctx.pi)


def planar(case: Case) -> Any:
    """Return 1/(4 sqrt(l/g) K(sin(φ0/2))), with φ0 counted from the vertical."""
    quarter = case.ctx.ellipk((1 + case.position[2] / case.length) / 2)
    return case.ctx.sqrt(case.gravity / case.length) / (4 * quarter)


def _turntable(scene: Scene, gravity: Callable[[Case], Any]) -> Any:
    """sqrt(ĝ + (Ω sin φ)²)/2π."""
    case = Case.of_scene(scene)
    turn = case.rate * case.sin
    return case.ctx.sqrt(gravity(case) / case.length + turn**2) / (2 * case.ctx.pi)


def _slowed(scene: Scene) -> Any:
    """The frequency on a turntable with g', divided by 2K/π."""
    return _turntable(scene, lambda case: case.apparent_gravity) / slow_down(Case.of_scene(scene))


def _slowed_as_printed(scene: Scene) -> Any:
    """The frequency on a turntable with g', divided by 4K as printed."""
    case = Case.of_scene(scene)
    return _slowed(scene) / (2 * case.ctx.pi)


_frequency = partial(Quantity, domain="small amplitudes, slow rotation", refuses=swinging, truth=frequency, unit="Hz")

APPROXIMATIONS = (
    _frequency(
        id="frequency_harmonic",
        title="harmonic frequency sqrt(g/l)/2π",
        where="Mathar section VII, frequency 1",
        drops="the amplitude, Ω, the centrifugal force",
        orders=(_SQUARE_IN_AMPLITUDE, _CENTRIFUGAL),
        formula=lambda scene: harmonic(Case.of_scene(scene)),
    ),
    _frequency(
        id="frequency_planar",
        title="frequency of the plane pendulum of finite amplitude",
        where="Mathar section VII, frequency 2",
        drops="Ω and the centrifugal force",
        orders=(_EXACT, _CENTRIFUGAL),
        refuses=released_at_rest,
        formula=lambda scene: planar(Case.of_scene(scene)),
    ),
    _frequency(
        id="frequency_turntable",
        title="harmonic frequency on a turntable, sqrt(g/l + (Ω sin φ)²)/2π",
        where="Mathar section VII, frequency 3",
        drops="the amplitude, the centrifugal force",
        orders=(_SQUARE_IN_AMPLITUDE, _CENTRIFUGAL),
        formula=partial(_turntable, gravity=lambda case: case.gravity),
    ),
    _frequency(
        id="frequency_apparent",
        title="harmonic frequency on a turntable, with the apparent gravity g' of (48)",
        where="Mathar section VII, frequency 4",
        drops="the amplitude, the centrifugal gradient",
        orders=(_SQUARE_IN_AMPLITUDE, _SQUARE_IN_RATE),
        formula=partial(_turntable, gravity=lambda case: case.apparent_gravity),
    ),
    _frequency(
        id="frequency_anharmonic",
        title="harmonic frequency on a turntable with g', slowed down by the amplitude, 2K/π",
        where="Mathar section VII, frequency 5",
        drops="the centrifugal gradient; the effects of the ellipse and of Ω cos φ at finite amplitude",
        orders=(_EXACT, _SQUARE_IN_RATE),
        refuses=released_at_rest,
        printed=Printed(
            "slow-down with the factor 4K(sin(φ0/2))", "2K(sin(φ0/2))/π, which is 1 at amplitude 0", _slowed_as_printed
        ),
        formula=_slowed,
    ),
)
