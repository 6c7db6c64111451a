"""Proposes the golden function: the ends, coefficients and degree of its pieces.

The proof does not rely on these proposals: it measures their errors. But the bytes of a dataset
follow from them, so only operations are used that IEEE 754 rounds alike on every machine, one after
another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import ulp
from typing import Any

import numpy as np
from flint import arb

from ..numbers.precision import double_below
from ..numbers.taylor_step import TaylorStep
from .approximant import GRAIN, rescaled
from .trusted.balls import add, dot, size, times
from .trusted.course import Course
from .trusted.function import CUT, Following, position, variable_error
from .trusted.shapes import ProvedFunction
from .trusted.system import SceneBalls

# depth over the length: a bob that stays so deep, within 16 degrees, has no series of z
DEEP = 0.96
# of the errors of the proof and of evaluation: what leaving out coefficients may add
TRUNCATION_SHARE = 1 / 3
# rounding of z, in ulp of the length: a piece whose series rounds more is halved
MAX_ROUNDING_ULP = 1.95
SHORTEST_PIECE_S = Fraction(1, 1 << 59)
WIDER = Fraction(GRAIN + 1, GRAIN)  # unit of a step's series that has to reach farther back


class FunctionFit:
    """Proposes a piece of the golden function for each step of a course, from the step's own polynomials."""

    def __init__(self, course: Course) -> None:
        self.following = Following(course, 2 if _stays_deep(course.balls) else 3)

    def add(self) -> None:
        """Propose the piece of the last proved step, or several if rounding would cost z too many digits."""
        following = self.following
        assert following.covered is not None
        piece = following.covered.piece
        last = double_below(piece.end)
        until = last
        while Fraction(last) > following.end + SHORTEST_PIECE_S:
            begin = following.end
            end = Fraction(until)
            rows = position(piece, begin, end, following.count)
            series = rows.entries()
            if self._rounding_of_z(series, variable_error(begin, end)) > MAX_ROUNDING_ULP:
                until = double_below((begin + end) / 2)
            else:
                following.add(until, [float(c) for c in series])
                until = last

    def _rounding_of_z(self, series: list[arb], lam: int) -> float:
        """Return how far the coefficients and values of a series of z round, in ulp of the length.

        It is 0 without a series of z.
        """
        rounding = arb(0)
        for k, c in enumerate(series[2 * CUT :]):
            of_value = ((2 + lam) * k**2 + k + 1) * abs(c) * 2**-53
            of_coefficient = abs(c - float(c))
            rounding += of_value + of_coefficient
        return float(rounding) / ulp(float(self.following.balls.inputs.length))

    def finish(self) -> ProvedFunction:
        """Finish the proof, with the lowest degree that loses almost no accuracy."""
        pieces = self.following.pieces
        count = self.following.count
        sizes = np.abs(np.array([piece.series for piece in pieces])).reshape(-1, count, CUT)
        of_proof = [[float(x) for x in piece.of_proof.entries()] for piece in pieces]
        errors = np.array(of_proof).reshape(-1, count, 4)
        to_rates = np.array([[[float(2 / piece.duration)]] for piece in pieces])

        k = np.arange(CUT)
        value_rounding = 2.0**-53 * sizes * (3 * k**2 + k + 1)
        rate_rounding = 2.0**-53 * to_rates * sizes * (k**2 * (k**2 + k + 7 / 3))
        degree = max(
            _degree(sizes, value_rounding, errors[..., 0]),
            _degree(to_rates * sizes * k**2, rate_rounding, errors[..., 2]),
        )
        return self.following.finish(degree)


def _degree(truncation: Any, rounding: Any, errors: Any) -> int:
    """Return the lowest degree, at least 0, whose truncation adds no more than TRUNCATION_SHARE.

    Args:
        truncation: what leaving out each coefficient costs, by piece and component.
        rounding: what evaluating it costs.
        errors: those of the proof, by piece and component.
    """
    evaluated = rounding.cumsum(2)[..., -1]
    tails = truncation[..., ::-1].cumsum(2)[..., ::-1].max(0)
    needed = tails > TRUNCATION_SHARE * (evaluated + errors).max(0)[:, None]
    return max(0, int(needed.sum(1).max()) - 1)


def _stays_deep(balls: SceneBalls) -> bool:
    """Return whether energy keeps the bob near the rest position."""
    pull = dot(balls.c, balls.c).sqrt()
    if not (pull > 0 and balls.release[0][2] < 0):
        return False
    aside = size(add(times(1 / pull, balls.c), balls.turned([arb(0), arb(0), arb(1)], 1)))
    return bool((balls.w0**2 - balls.lambda_minus) / pull - aside > DEEP)


def on_doubles(steps: Iterable[TaylorStep]) -> Iterator[TaylorStep]:
    """Yield steps that meet at doubles: each is cut slightly short, and the next one begins there."""
    begin = Fraction(0)
    for step in steps:
        far = begin < step.centre - step.h
        own = rescaled(step, WIDER) if far else step
        end = step.centre + step.h * step.high
        low = (begin - own.centre) / own.h
        begin = Fraction(double_below(end))
        high = (begin - own.centre) / own.h
        yield own._replace(low=low, high=high)
