"""TRUSTED. A proof from step to step: bound, output times and transits are given one piece, in order and without a gap.

Who drives it proposes steps and columns, and can do no harm: there is a result only for a run that is complete.
"""

from collections.abc import Callable
from fractions import Fraction

from ..taylor_step import TaylorStep
from .bound import Piece, Radius, World, output
from .columns import Columns
from .shapes import EnclosedTransit, Interval, Proposal
from .transits import Scan


class Course:
    """The states at `times` (increasing, from 0 on) and, with `transits`, all zeros of xdot up to the last of them."""

    def __init__(self, world: World, times: list[Fraction], columns: bool, transits: bool) -> None:
        self.world, self.times, self.states = world, tuple(times), list[list[Interval]]()
        self.radius, self.columns = (None, Columns(world)) if columns else (Radius(world), None)
        self.scan = Scan(world) if transits and not world.still else None

    def advance(self, step: TaylorStep, proposal: Proposal | None, lap: Callable[[str], None]) -> None:
        """Take the next step; `lap` is told which part of the work is done."""
        piece = Piece(self.world, step)
        lap("defect" if piece.sizes else "")
        covered = self.radius.advance(piece) if self.radius else self.columns.advance(piece, proposal)
        while len(self.states) < len(self.times) and self.times[len(self.states)] <= piece.end:
            self.states.append(output(covered, self.times[len(self.states)]))
        lap("bound")
        if self.scan:
            self.scan.advance(covered)
            lap("transits")

    def finish(self) -> tuple[list[list[Interval]], list[EnclosedTransit] | None]:
        """Return the states at `times`, and the transits; None if not requested or if xdot is zero for ever."""
        end, bound = self.times[-1], self.radius or self.columns
        if len(self.states) < len(self.times) or (end and bound.time != end):
            raise ArithmeticError("the steps do not end with the run")
        return self.states, self.scan and (self.scan.finish() if end else [])
