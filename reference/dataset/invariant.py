"""The invariant h over the printed rows of a grid, and the change of it that the rows' bounds allow."""

from __future__ import annotations

from fractions import Fraction

from ..model.constants import constants
from ..model.force import invariant
from ..numbers.columns import STATE
from ..numbers.fixed_point import FixedPoint, Integers
from ..numbers.precision import bits_of, context, fixed_decimal, rounded_up
from ..scenes.scene import Scene
from .sheets import Sheet

INVARIANT_BITS = 96  # beyond the digits: (R Ω)²/2 is about 5e4 m²/s², h of a small swing far less


def invariants(scene: Scene, states: list[Integers], unit: int) -> list[Fraction]:
    """Return h in m²/s² of states: their columns x, y, z, vx, vy, vz as integers over a unit."""
    bits = bits_of(scene.run.digits) + INVARIANT_BITS
    k = constants(scene.exact, context(bits)).converted(lambda number: FixedPoint.of(number, bits))
    x, y, z, vx, vy, vz = (FixedPoint.column(column, unit, bits) / k.length for column in states)
    h: FixedPoint = invariant((x, y, z), (vx, vy, vz), k)
    return h.fractions()


def invariant_drift(scene: Scene, grid: Sheet) -> tuple[str, str]:
    """Return h of the first printed row in m²/s², and its largest change over the rows (rounded up)."""
    values = invariants(scene, *grid.integers(STATE))
    return fixed_decimal(values[0], scene.run.digits), rounded_up(max(abs(value - values[0]) for value in values))
