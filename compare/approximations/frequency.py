"""Numbers of a motion: apparent gravity, frequency in Hz, precession period T_f in s; rest position in rad.

Gravity is that of Gastebois 4.2 and Mathar (48), the frequencies are those of Mathar VII, and the
precession is that of Gastebois 4.1, 4.2, 6.3, where T_p is 2π/Ω. The rest position is that of
Mathar V: an angle from the vertical, positive to the south, so that y = -l sin of it in either
hemisphere. `foucault paper` lists the misprints.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from reference import Scene
from reference.model.constants import Vector

from ..observed.swing_plane import frequency, precession_period
from .approximation import Quantity
from .case import RELEASED_AT_REST, SWINGING, PaperCase, at_rest, under_gravity
from .mathar import slow_down


def harmonic(case: PaperCase) -> Any:
    """Return sqrt(g/l)/2π."""
    return case.ctx.sqrt(case.gravity / case.length) / (2 * case.ctx.pi)


def planar(case: PaperCase) -> Any:
    """Return 1/(4 sqrt(l/g) K(sin(φ0/2))), with φ0 counted from the vertical."""
    quarter = case.ctx.ellipk((1 + case.position[2] / case.length) / 2)
    return case.ctx.sqrt(case.gravity / case.length) / (4 * quarter)


def turntable(case: PaperCase, gravity: Any) -> Any:
    """Return sqrt(gravity/l + (Ω sin φ)²)/2π, the frequency of Mathar (51)-(52)."""
    return case.ctx.sqrt(gravity / case.length + case.turn**2) / (2 * case.ctx.pi)


def anharmonic(case: PaperCase) -> Any:
    """Return the frequency on a turntable with g', divided by 2K/π."""
    return turntable(case, case.apparent_gravity) / slow_down(case)


def _over_tilted_sine(case: PaperCase) -> Any:
    """Return T_p/sin λ_a, λ_a = λ + α."""
    return abs(2 * case.ctx.pi / (case.k.rate * case.ctx.sin(case.apparent_latitude)))


def _spherical(case: PaperCase) -> Any:
    """Return T_p/sin λ_a (1 + 3/8 r0²/L0²), with r0 counted from the plumb line."""
    x, y, _ = case.plumb.inward(case.position)
    return _over_tilted_sine(case) * (1 + 3 * (x**2 + y**2) / (8 * case.length**2))


def _turning(scene: Scene) -> str | None:
    still = not scene.exact.rotation_rate or not scene.exact.latitude
    return (
        "The plane does not turn: give a rotation rate and a latitude other than 0"
        if still
        else None
    )


_frequency = partial(Quantity, needs=SWINGING, truth=frequency, unit="Hz")
_precession = partial(
    Quantity,
    needs=(_turning, *SWINGING),
    truth=precession_period,
    unit="s",
)

_SWING = (
    Quantity(
        id="apparent_gravity",
        title="gravity and centrifugal force at the suspension",
        where="Gastebois 4.2; Mathar (48)",
        drops="the cord: the bob is nearer to the axis than the suspension",
        needs=(under_gravity,),
        formula=lambda case: case.apparent_gravity,
        truth=lambda scene: PaperCase.of_scene(scene).pull_at_rest,
        unit="m/s²",
    ),
    _frequency(
        id="frequency_harmonic",
        title="harmonic frequency sqrt(g/l)/2π",
        where="Mathar section VII, frequency 1",
        drops="the amplitude, Ω, the centrifugal force",
        formula=harmonic,
    ),
    _frequency(
        id="frequency_planar",
        title="frequency of the plane pendulum of finite amplitude",
        where="Mathar section VII, frequency 2",
        drops="Ω and the centrifugal force",
        needs=RELEASED_AT_REST,
        formula=planar,
    ),
    _frequency(
        id="frequency_turntable",
        title="harmonic frequency on a turntable, sqrt(g/l + (Ω sin φ)²)/2π",
        where="Mathar section VII, frequency 3",
        drops="the amplitude, the centrifugal force",
        formula=lambda case: turntable(case, case.gravity),
    ),
    _frequency(
        id="frequency_apparent",
        title="harmonic frequency on a turntable, with the apparent gravity g' of (48)",
        where="Mathar section VII, frequency 4",
        drops="the amplitude, the centrifugal gradient",
        formula=lambda case: turntable(case, case.apparent_gravity),
    ),
    _frequency(
        id="frequency_anharmonic",
        title="harmonic frequency on a turntable with g', slowed down by the amplitude, 2K/π",
        where="Mathar section VII, frequency 5",
        drops="the centrifugal gradient; the effects of the ellipse and of Ω cos φ at finite amplitude",
        needs=RELEASED_AT_REST,
        formula=anharmonic,
    ),
    _precession(
        id="precession_sine",
        title="precession period T_p/sin λ",
        where="Gastebois 4.1",
        drops="the centrifugal force, the amplitude",
        formula=lambda case: abs(2 * case.ctx.pi / case.turn),
    ),
    _precession(
        id="precession_tilted",
        title="precession period T_p/sin λ_a, with the tilt of the plumb line",
        where="Gastebois 4.2, 6.3",
        drops="the centrifugal gradient, the amplitude",
        formula=_over_tilted_sine,
    ),
    _precession(
        id="precession_spherical",
        title="precession period with the drift of the spherical pendulum, T_p/sin λ_a (1 + 3/8 r0²/L0²)",
        where="Gastebois 6.3",
        drops="the fourth power of the amplitude; the centrifugal gradient, which changes the ellipse that drifts",
        needs=(_turning, *SWINGING, at_rest),
        formula=_spherical,
    ),
)


def line_of_46(case: PaperCase, angle: Any, sign: int = -1) -> Any:
    """Return ±R̂Ω² sin(ϕ∓φ) ∓ Ω² cos(ϕ∓φ) sin(ϕ∓φ) + (g/l) sin φ, (46), at an angle φ from the vertical, in 1/s².

    The upper sign, 1, is that of a cord that leans to the north.
    """
    ctx, square = case.ctx, case.k.rate**2
    tilted = case.latitude - sign * angle
    far = sign * case.axis_distance / case.length * square * ctx.sin(tilted)
    return far - sign * square * ctx.cos(tilted) * ctx.sin(tilted) + case.k.gravity * ctx.sin(angle)


def series(case: PaperCase) -> Vector:
    """Return the coefficients of Ω², Ω⁴ and Ω⁶ in (47), for the lower sign: positive to the south."""
    ctx, cord, g, latitude = case.ctx, case.length, case.gravity, case.latitude
    n = case.axis_distance / case.k.cos  # N + h
    two, four = ctx.cos(2 * latitude), ctx.cos(4 * latitude)
    bracket = n**2 * (four + 3 * two + 2)
    bracket -= n * cord * (ctx.mpf(37) / 8 * four + ctx.mpf(11) / 8 + 6 * two)
    bracket += cord**2 * (ctx.mpf(35) / 8 * four + ctx.mpf(13) / 8)
    terms = (1 / (2 * g), (n * (1 + two) / 2 - cord * two) / (2 * g**2), bracket / (12 * g**3))
    return tuple(ctx.sin(2 * latitude) * (n - cord) * term for term in terms)


def _series(case: PaperCase, terms: int) -> Any:
    """Return the series (47) up to Ω^(2 terms)."""
    return sum(c * case.k.rate ** (2 * i + 2) for i, c in enumerate(series(case)[:terms]))


def triangle(case: PaperCase) -> Any:
    """Return the angle of (50): the sine rule in the triangle of g, RΩ² and g'."""
    return case.ctx.asin(case.outward * case.k.sin / case.apparent_gravity)


def _pulled(scene: Scene) -> str | None:
    pulled = PaperCase.of_scene(scene).apparent_gravity
    return None if pulled else "Gravity and centrifugal force cancel: there is no triangle"


def _not_at_a_pole(scene: Scene) -> str | None:
    pole = abs(scene.exact.latitude) == 90
    return (
        "(47) is computed with a division by cos φ, which is 0 at a pole: give another latitude"
        if pole
        else None
    )


_rest_angle = partial(
    Quantity,
    needs=(under_gravity,),
    truth=lambda scene: PaperCase.of_scene(scene).rest_angle,
    unit="rad",
)

_REST = (
    _rest_angle(
        id="rest_equation",
        title="rest position by the equation of forces",
        where="Mathar (46); (45) is the same in y",
        drops="nothing",
        # south of the vertical
        formula=lambda case: case.ctx.findroot(partial(line_of_46, case), case.tilt),
    ),
    *(
        _rest_angle(
            id=f"rest_series_{terms}",
            title=f"rest position by the series up to {name}",
            where=f"Mathar (47) up to {name}",
            drops=f"Ω to the power {2 * terms + 2} and beyond",
            needs=(_not_at_a_pole, under_gravity),
            formula=partial(_series, terms=terms),
        )
        for terms, name in enumerate(("Ω²", "Ω⁴", "Ω⁶"), start=1)
    ),
    _rest_angle(
        id="rest_triangle",
        title="rest position by the triangle of forces",
        where="Mathar (48)-(50)",
        drops="the cord: N + h stands for N + h - l, the distance of the bob",
        needs=(under_gravity, _pulled),
        formula=triangle,
    ),
)

APPROXIMATIONS = (*_SWING, *_REST)
