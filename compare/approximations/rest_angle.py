"""Angle in rad from the vertical to the rest position: Mathar section V, equation, series and triangle of forces.

The angle is positive to the south, so that y = -l sin of the angle at the rest position, in either hemisphere.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from reference import Scene
from reference.model.constants import Vector

from .approximation import Order, Quantity
from .case import Case, under_gravity


def line_of_46(case: Case, angle: Any, sign: int = -1) -> Any:
    """Return ±R̂Ω² sin(ϕ∓φ) ∓ Ω² cos(ϕ∓φ) sin(ϕ∓φ) + (g/l) sin φ, (46), at an angle φ from the vertical, in 1/s².

    The upper sign, 1, is that of a cord that leans to the north.
    """
    ctx, square = case.ctx, case.rate**2
    tilted = case.latitude - sign * angle
    far = sign * case.axis_distance / case.length * square * ctx.sin(tilted)
    return far - sign * square * ctx.cos(tilted) * ctx.sin(tilted) + case.k.gravity * ctx.sin(angle)


def _equation(case: Case) -> Any:
    """Solve (46) for its angle south of the vertical."""
    return case.ctx.findroot(partial(line_of_46, case), case.tilt)


def series(case: Case) -> Vector:
    """Return the coefficients of Ω², Ω⁴ and Ω⁶ in (47), for the lower sign: positive to the south."""
    ctx, cord, g, latitude = case.ctx, case.length, case.gravity, case.latitude
    n = case.axis_distance / case.cos  # N + h
    two, four = ctx.cos(2 * latitude), ctx.cos(4 * latitude)
    bracket = n**2 * (four + 3 * two + 2)
    bracket -= n * cord * (ctx.mpf(37) / 8 * four + ctx.mpf(11) / 8 + 6 * two)
    bracket += cord**2 * (ctx.mpf(35) / 8 * four + ctx.mpf(13) / 8)
    terms = (1 / (2 * g), (n * (1 + two) / 2 - cord * two) / (2 * g**2), bracket / (12 * g**3))
    return tuple(ctx.sin(2 * latitude) * (n - cord) * term for term in terms)


def _series(case: Case, terms: int) -> Any:
    """Return the series (47) up to Ω^(2 terms)."""
    return sum(c * case.rate ** (2 * i + 2) for i, c in enumerate(series(case)[:terms]))


def triangle(case: Case) -> Any:
    """Return the angle of (50): the sine rule in the triangle of g, RΩ² and g'."""
    return case.ctx.asin(case.outward * case.sin / case.apparent_gravity)


def _pulled(scene: Scene) -> str | None:
    return under_gravity(scene) or (
        None if Case.of_scene(scene).apparent_gravity else "Gravity and centrifugal force cancel: there is no triangle"
    )


def _not_at_a_pole(scene: Scene) -> str | None:
    if abs(scene.exact.latitude) == 90:
        return "(47) is computed with a division by cos φ, which is 0 at a pole: give another latitude"
    return under_gravity(scene)


_rest_angle = partial(
    Quantity,
    refuses=under_gravity,
    truth=lambda scene: Case.of_scene(scene).rest_angle,
    unit="rad",
    relative=False,
)

_RATES = (5e-5, 1e-4, 2e-4)
_FAST, _SMALL_BODY = (4e-3, 8e-3, 1.6e-2), ("site.equatorial_radius=300",)  # where l is a large part of N + h

APPROXIMATIONS = (
    _rest_angle(
        id="rest_equation",
        title="rest position by the equation of forces",
        where="Mathar (46); (45) is the same in y",
        drops="nothing",
        orders=(Order("rotation_rate", None, _RATES), Order("length", None, (1, 67, 10000))),
        formula=_equation,
    ),
    *(
        _rest_angle(
            id=f"rest_series_{terms}",
            title=f"rest position by the series up to {name}",
            where=f"Mathar (47) up to {name}",
            drops=f"Ω to the power {2 * terms + 2} and beyond",
            orders=tuple(Order("rotation_rate", 2 * terms + 2, *of) for of in ((_RATES,), (_FAST, _SMALL_BODY))),
            refuses=_not_at_a_pole,
            formula=partial(_series, terms=terms),
        )
        for terms, name in enumerate(("Ω²", "Ω⁴", "Ω⁶"), start=1)
    ),
    _rest_angle(
        id="rest_triangle",
        title="rest position by the triangle of forces",
        where="Mathar (48)-(50)",
        drops="the cord: N + h stands for N + h - l, the distance of the bob",
        orders=(Order("rotation_rate", 2, _RATES), Order("length", 1, (10, 20, 40, 80))),
        refuses=_pulled,
        formula=triangle,
    ),
)
