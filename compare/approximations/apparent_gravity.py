"""Apparent gravity in m/s², the cord's tension per mass at the rest position: Gastebois 4.2, Mathar (48)."""

from __future__ import annotations

from typing import Any

from .approximation import Order, Printed, Quantity
from .case import Case, under_gravity


def _as_printed(case: Case) -> Any:
    """Return (g² + Ω² R_p cos λ - 2 g Ω² R_p cos² λ)^(1/2)."""
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
        formula=lambda case: case.apparent_gravity,
        truth=lambda scene: Case.of_scene(scene).pull_at_rest,
        unit="m/s²",
    ),
)
