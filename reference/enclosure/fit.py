"""Proposals of the golden function: ends of its pieces, coefficients, degree. Untrusted: their errors are measured.

Bytes follow from them. So only operations are used that IEEE 754 rounds alike on every machine, one after another.
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
from .trusted.function import CUT, Following, position
from .trusted.shapes import ProvedFunction
from .trusted.system import SceneBalls

SHALLOW = 0.96  # of the length: a bob that stays so deep, within 16 degrees, has no series of z
SHARE = 1 / 3  # of the errors that are there anyway: what leaving out coefficients may add
ROUNDING = 1.95  # of z, in ulp of the length: a piece whose series rounds more is halved
LEAST = Fraction(1, 1 << 59)  # length of a piece in s
WIDER = Fraction(GRAIN + 1, GRAIN)  # unit of a step's series that has to reach farther back


class FunctionFit:
    """Proposes a piece for each step of a course: the series of its own polynomials, in doubles."""

    def __init__(self, course: Course) -> None:
        self.following = Following(course, 2 if _stays_deep(course.balls) else 3)

    def add(self) -> None:
        """Propose the piece of the step that was proved last."""
        following, ((piece, _),) = self.following, self.following.covered
        last = until = double_below(piece.end)
        while Fraction(last) > (begin := following.end) + LEAST:
            rows = position(piece, begin, Fraction(until), following.count)
            if self.rounding_of_z(rows.entries(), 3 if 2 * begin >= until else 7) > ROUNDING:
                until = double_below((begin + Fraction(until)) / 2)
            else:
                following.add(until, [float(c) for c in rows.entries()])
                until = last

    def rounding_of_z(self, series: list[arb], off: int) -> float:
        """Return how far a series of z rounds, its coefficients and its values, in ulp of the length; 0 without one."""
        costs = (
            (off * k**2 + k + 1) * abs(x) * 2**-53 + abs(x - float(x))
            for k, x in enumerate(series[2 * CUT :])
        )
        return float(sum(costs, arb(0))) / ulp(float(self.following.balls.inputs.length))

    def finish(self) -> ProvedFunction:
        """Finish the proof, with the lowest degree that costs next to nothing."""
        pieces, count, k, degree = self.following.pieces, self.following.count, np.arange(CUT), 0
        sizes = np.abs(np.array([piece[1] for piece in pieces])).reshape(-1, count, CUT)
        there = np.array([[float(off) for off in piece[4].entries()] for piece in pieces]).reshape(
            -1, count, 4
        )
        half = np.array([[[float(2 / piece[3])]] for piece in pieces])
        weights: dict[int, Any] = {
            0: (3 * k**2 + k + 1, k**0, 1.0),
            2: (k**2 * (k**2 + k + 7 / 3), k**2, half),
        }
        for j, (kept, left, scale) in weights.items():
            rounding = (2.0**-53 * scale * sizes * kept).cumsum(2)[..., -1]
            tails = (scale * sizes * left)[..., ::-1].cumsum(2)[..., ::-1].max(0)
            needed = tails > SHARE * (rounding + there[..., j]).max(0)[:, None]
            degree = max(degree, int(needed.sum(1).max()) - 1)
        return self.following.finish(degree)


def _stays_deep(balls: SceneBalls) -> bool:
    """Return whether energy keeps the bob near the rest position."""
    pull = dot(balls.c, balls.c).sqrt()
    if not (pull > 0 and balls.release[0][2] < 0):
        return False
    aside = size(add(times(1 / pull, balls.c), balls.turned([arb(0), arb(0), arb(1)], 1)))
    return bool((balls.w0**2 - balls.lambda_minus) / pull - aside > SHALLOW)


def on_doubles(steps: Iterable[TaylorStep]) -> Iterator[TaylorStep]:
    """Yield steps that meet at doubles: each is cut a little earlier, and the next one begins there."""
    begin = Fraction(0)
    for step in steps:
        far = begin < step.centre - step.h
        own = rescaled(step, WIDER) if far else step
        end = step.centre + step.h * step.high
        low, begin = (begin - own.centre) / own.h, Fraction(double_below(end))
        yield own._replace(low=low, high=(begin - own.centre) / own.h)
