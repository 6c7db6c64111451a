"""Angle in rad from the vertical to the rest position: Mathar section V, equation, series and triangle of forces.

The angle is positive to the south, so that y = -l sin of the angle at the rest position, in either hemisphere.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from reference import Scene

from .approximation import Order, Printed, Quantity
from .case import Case, under_gravity


def of_the_model(scene: Scene) -> Any:
    """Return the angle at which the tangential force vanishes in the model of `reference`."""
    case = Case.of_scene(scene)
    _, y, z = case.rest
    return case.ctx.atan2(-y, -z)


def _equation(scene: Scene) -> Any:
    """Solve (46) for its angle ϕ south of the vertical: R̂Ω² sin(φ + ϕ) - Ω² cos(φ + ϕ) sin(φ + ϕ) = (g/l) sin ϕ."""
    case = Case.of_scene(scene)
    ctx, square = case.ctx, case.rate**2
    latitude, distance, fall = ctx.atan2(case.sin, case.cos), case.axis_distance / case.length, case.k.gravity

    def balance(angle: Any) -> Any:
        apparent = latitude + angle
        return (
            distance * square * ctx.sin(apparent)
            - square * ctx.cos(apparent) * ctx.sin(apparent)
            - fall * ctx.sin(angle)
        )

    return ctx.findroot(balance, case.tilt)


def _series(scene: Scene, terms: int) -> Any:
    """Return the series (47) up to Ω^(2 terms)."""
    case = Case.of_scene(scene)
    ctx, cord, g = case.ctx, case.length, case.gravity
    latitude = ctx.atan2(case.sin, case.cos)
    n = case.axis_distance / case.cos  # N + h
    two, four = ctx.cos(2 * latitude), ctx.cos(4 * latitude)
    coefficients = (
        1 / (2 * g),
        (n * (1 + two) / 2 - cord * two) / (2 * g**2),
        (
            n**2 * (four + 3 * two + 2)
            - n * cord * (ctx.mpf(37) / 8 * four + ctx.mpf(11) / 8 + 6 * two)
            + cord**2 * (ctx.mpf(35) / 8 * four + ctx.mpf(13) / 8)
        )
        / (12 * g**3),
    )
    total = sum(c * case.rate ** (2 * i + 2) for i, c in enumerate(coefficients[:terms]))
    return ctx.sin(2 * latitude) * (n - cord) * total


def _triangle(scene: Scene) -> Any:
    """(50): the sine rule in the triangle of g, RΩ² and g'."""
    case = Case.of_scene(scene)
    return case.ctx.asin(case.outward * case.sin / case.apparent_gravity)


def _not_at_a_pole(scene: Scene) -> str | None:
    pole = abs(scene.exact.latitude) == 90
    return (
        "(47) is computed with a division by cos φ, which is 0 at a pole: give another latitude"
        if pole
        else under_gravity(scene)
    )


def _quantity(
    word: str, title: str, where: str, drops: str, orders: tuple[Order, ...], formula: Any, **more: Any
) -> Any:
    """Declare one formula for the angle of the rest position; `more` are further fields."""
    return Quantity(
        id=word,
        title=title,
        where=where,
        domain="any length and latitude on a body that gravity holds together",
        drops=drops,
        orders=orders,
        formula=formula,
        truth=of_the_model,
        unit="rad",
        relative=False,
        **{"refuses": under_gravity} | more,
    )


_RATES = (5e-5, 1e-4, 2e-4)
_FAST, _SMALL_BODY = (4e-3, 8e-3, 1.6e-2), ("site.equatorial_radius=300",)  # where l is a large part of N + h
_NAMES = ("Ω²", "Ω⁴", "Ω⁶")
_EQUATION = _quantity(
    "rest_equation",
    "rest position by the equation of forces",
    "Mathar (46); (45) is the same in y",
    "nothing",
    (Order("rotation_rate", None, _RATES), Order("length", None, (1, 67, 10000))),
    _equation,
    printed=Printed(
        "(45) begins with y²",
        "y; as printed it has no solution in the north, where its right side is negative for every y near 0",
    ),
)
_SERIES = tuple(
    _quantity(
        f"rest_series_{terms}",
        f"rest position by the series up to {_NAMES[terms - 1]}",
        f"Mathar (47) up to {_NAMES[terms - 1]}",
        f"Ω to the power {2 * terms + 2} and beyond",
        (Order("rotation_rate", 2 * terms + 2, _RATES), Order("rotation_rate", 2 * terms + 2, _FAST, _SMALL_BODY)),
        partial(_series, terms=terms),
        refuses=_not_at_a_pole,
    )
    for terms in (1, 2, 3)
)
_TRIANGLE = _quantity(
    "rest_triangle",
    "rest position by the triangle of forces",
    "Mathar (48)-(50)",
    "the cord: N + h stands for N + h - l, the distance of the bob",
    (Order("rotation_rate", 2, _RATES), Order("length", 1, (10, 20, 40, 80))),
    _triangle,
)

APPROXIMATIONS = (_EQUATION, *_SERIES, _TRIANGLE)
