"""Apparent gravity in m/s², the cord's tension per mass at the rest position: Gastebois 4.2, Mathar (48)."""

from __future__ import annotations

from typing import Any

from reference import Scene
from reference.model.force import tension

from .approximation import Order, Printed, Quantity
from .case import Case, under_gravity


def of_the_model(scene: Scene) -> Any:
    """Return the tension of the cord per mass at the full model's rest position."""
    case = Case.of_scene(scene)
    return case.length * tension(case.rest, (0, 0, 0), case.k)


def _triangle(scene: Scene) -> Any:
    """(g² + Ω⁴ R² - 2 g Ω² R cos λ)^(1/2), R = R_p cos λ of the suspension."""
    return Case.of_scene(scene).apparent_gravity


def _as_printed(scene: Scene) -> Any:
    """(g² + Ω² R_p cos λ - 2 g Ω² R_p cos² λ)^(1/2)."""
    case = Case.of_scene(scene)
    return case.ctx.sqrt(case.gravity**2 + case.outward - 2 * case.gravity * case.outward * case.cos)


APPROXIMATIONS = (
    Quantity(
        id="apparent_gravity",
        title="gravity and centrifugal force at the suspension",
        where="Gastebois 4.2; Mathar (48)",
        domain="any latitude",
        drops="the cord: the bob is nearer to the axis than the suspension",
        orders=(Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4)), Order("length", 1, (10, 20, 40, 80))),
        refuses=under_gravity,
        printed=Printed(
            "g_a² = g² + Ω² R_p cos λ - 2 g Ω² R_p cos² λ",
            "g_a² = g² + Ω⁴ R_p² cos² λ - 2 g Ω² R_p cos² λ: the term a_e² lost its square in print",
            _as_printed,
        ),
        formula=_triangle,
        truth=of_the_model,
        unit="m/s²",
    ),
)
