"""The invariant h over the printed rows of a grid, and the change of it that the rows' bounds allow."""

from __future__ import annotations

from fractions import Fraction

from ..columns import STATE
from ..model.constants import constants
from ..model.force import invariant
from ..precision import bits_of, context, fixed_decimal, rounded_up, to_fraction, to_mpf
from ..scene import Scene
from .sheets import Sheet

INVARIANT_BITS = 96  # beyond the digits: (R Ω)²/2 is about 5e4 m²/s², h of a small swing far less


def invariants(scene: Scene, states: list[list[Fraction]]) -> list[Fraction]:
    """Return h of printed states x, y, z, vx, vy, vz, in m²/s²."""
    ctx = context(bits_of(scene.run.digits) + INVARIANT_BITS)
    k = constants(scene.exact, ctx)

    def h_of(row: list[Fraction]) -> Fraction:
        x, y, z, vx, vy, vz = (to_mpf(value, ctx) / k.length for value in row)
        return to_fraction(invariant((x, y, z), (vx, vy, vz), k) + ctx.mpf(0))

    return [h_of(row) for row in states]


def invariant_drift(scene: Scene, grid: Sheet) -> tuple[str, str]:
    """Return h of the first printed row in m²/s², and its largest change over the rows (rounded up)."""
    values = invariants(scene, list(grid.numbers(STATE)))
    return fixed_decimal(values[0], scene.run.digits), rounded_up(max(abs(value - values[0]) for value in values))
