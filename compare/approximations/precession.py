"""Precession period T_f of the swing plane in s: Gastebois 4.1, 4.2, 6.3, where T_p is 2π/Ω."""

from __future__ import annotations

from functools import partial
from typing import Any

from reference import Scene

from ..observed.apsides import precession_period
from .approximation import Order, Printed, Quantity
from .case import Case, PlumbAxes, at_rest, swinging
from .gastebois_small import small_angles

_AT_POLE = ("site.latitude=90", "site.rotation_rate=2e-3")
_SMALL = 1e-2
_SQUARE_IN_AMPLITUDE = Order("amplitude", 2, (2.0, 4.0, 8.0), _AT_POLE)


def _turning(scene: Scene) -> str | None:
    still = not scene.exact.rotation_rate or not scene.exact.latitude
    return "The plane does not turn: give a rotation rate and a latitude other than 0" if still else swinging(scene)


def _released_at_rest(scene: Scene) -> str | None:
    return _turning(scene) or at_rest(scene)


def _sine(scene: Scene) -> Any:
    """T_p/sin λ."""
    case = Case.of_scene(scene)
    return abs(2 * case.ctx.pi / (case.rate * case.sin))


def _tilted(scene: Scene) -> Any:
    """T_p/sin λ_a, λ_a = λ + α."""
    case = Case.of_scene(scene)
    return abs(2 * case.ctx.pi / (case.rate * case.ctx.sin(case.apparent_latitude)))


def _spherical(scene: Scene) -> Any:
    """T_p/sin λ_a (1 + 3/8 r0²/L0²), with r0 counted from the plumb line."""
    case = Case.of_scene(scene)
    x, y, _ = PlumbAxes.tilted(-case.tilt, case.ctx).inward(case.position)
    return _tilted(scene) * (1 + 3 * (x**2 + y**2) / (8 * case.length**2))


def _swing_over_sine(scene: Scene) -> Any:
    """T/sin λ_a with the period T of the swing, as 6.3 prints it."""
    case = Case.of_scene(scene)
    _, omega, _ = small_angles(case)
    return abs(2 * case.ctx.pi / (omega * case.ctx.sin(case.apparent_latitude)))


_precession = partial(
    Quantity,
    domain="small angles, away from the equator; the mean over a half turn",
    refuses=_turning,
    truth=precession_period,
    unit="s",
)

APPROXIMATIONS = (
    _precession(
        id="precession_sine",
        title="precession period T_p/sin λ",
        where="Gastebois 4.1",
        drops="the centrifugal force, the amplitude",
        orders=(Order("rotation_rate", 2, (1e-4, 2e-4, 4e-4), (), _SMALL), _SQUARE_IN_AMPLITUDE),
        formula=_sine,
    ),
    _precession(
        id="precession_tilted",
        title="precession period T_p/sin λ_a, with the tilt of the plumb line",
        where="Gastebois 4.2, 6.3",
        drops="the centrifugal gradient, the amplitude",
        orders=(
            Order("rotation_rate", 2, (2e-3, 4e-3, 8e-3), ("site.equatorial_radius=0",), _SMALL),
            _SQUARE_IN_AMPLITUDE,
        ),
        printed=Printed("T_f = 2π/Ωz = T/sin λ_a", "T_f = T_p/sin λ_a: T is the period of the swing", _swing_over_sine),
        formula=_tilted,
    ),
    _precession(
        id="precession_spherical",
        title="precession period with the drift of the spherical pendulum, T_p/sin λ_a (1 + 3/8 r0²/L0²)",
        where="Gastebois 6.3",
        drops="the fourth power of the amplitude; the centrifugal gradient, which changes the ellipse that drifts",
        orders=(Order("amplitude", 4, (4.0, 8.0, 16.0), _AT_POLE),),
        refuses=_released_at_rest,
        formula=_spherical,
    ),
)
