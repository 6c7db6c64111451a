"""The Taylor polynomials of a step as integers, made where they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from .digits import Array, aligned, joined
from .lanes import LANES
from .march import polynomials
from .polynomials import ROWS
from .series import Series
from .step import Model


class Rows(Sequence[list[int]]):
    """Coefficients of n and h H: six rows of integers over 2**fraction_bits(limbs), kept as digits until asked for.

    Attributes:
        digits: shape (order + 1, limbs, 8), the first six lanes.
    """

    def __init__(self, digits: Array) -> None:
        self.digits = digits
        self._made: dict[int, list[int]] = {}

    def __len__(self) -> int:
        """Six."""
        return ROWS

    def __getitem__(self, lane: Any) -> Any:
        """One row, lowest order first."""
        if not 0 <= lane < ROWS:
            raise IndexError(lane)
        if lane not in self._made:
            self._made[lane] = joined(self.digits[:, :, lane]).tolist()
        return self._made[lane]


@dataclass(frozen=True)
class Expansion:
    """Taylor polynomials of n and h H at t, of s = (time - t)/h, to be used up to t + h; east, north, up.

    Attributes:
        t: centre in s, exact.
        h: step in s, exact.
        bits: coefficients are integers over 2**bits.
    """

    t: Fraction
    h: Fraction
    bits: int
    _series: Array = field(repr=False)
    _room: Series = field(repr=False)
    _model: Model = field(repr=False)

    @property
    def coefficients(self) -> Rows:
        """Six rows, made when asked for: a proof needs every second expansion only."""
        limbs, order = self._model.limbs, self._model.order
        made = aligned((order + 1) * limbs * LANES)
        self._room.c[:] = self._series
        polynomials(made, self._room, self._model)
        return Rows(made.reshape(order + 1, limbs, LANES))
