"""TRUSTED. A proof from step to step: bound, output times and transits are given one piece, in order and without a gap.

Who drives it proposes steps and columns, and can do no harm: there is a result only for a run that is complete.
"""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from ..numbers.taylor_step import TaylorStep
from .balls import demand
from .bound import Piece, Radius, SceneBalls, output
from .enclosed_transits import Scan
from .shapes import EnclosedTransit, Interval, Proposal
from .six_columns import Columns


class Course:
    """The states at `times` (increasing, from 0 on) and, with `transits`, all zeros of xdot up to the last of them."""

    def __init__(self, balls: SceneBalls, times: list[Fraction], columns: bool, transits: bool) -> None:
        self.balls, self.times, self.states = balls, tuple(times), list[list[Interval]]()
        self.bound: Any = Columns(balls) if columns else Radius(balls)
        self.scan = Scan(balls) if transits and not balls.still else None

    def advance(self, step: TaylorStep, proposal: tuple[Proposal, ...], lap: Callable[[str], None]) -> Piece:
        """Take the next step, and columns if it is proved by them; `lap` is told which part of the work is done."""
        piece = Piece(self.balls, step)
        lap("defect" if piece.sizes else "")
        covered = self.bound.advance(piece, *proposal)
        while len(self.states) < len(self.times) and self.times[len(self.states)] <= piece.end:
            self.states.append(output(covered, self.times[len(self.states)]))
        lap("bound")
        if self.scan:
            self.scan.advance(covered)
            lap("transits")
        return piece

    def finish(self) -> tuple[list[list[Interval]], list[EnclosedTransit] | None]:
        """Return the states at `times`, and the transits; None if not requested or if xdot is zero for ever."""
        end, complete = self.times[-1], len(self.states) == len(self.times)
        demand(complete and (not end or self.bound.time == end), "the steps do not end with the run")
        transits = self.scan.finish() if self.scan and end else []
        return self.states, transits if self.scan else None
