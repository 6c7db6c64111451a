"""TRUSTED. A proof from step to step: bound, output times and transits are given one piece, in order and without a gap.

Who calls `advance` proposes steps and columns, and can do no harm: an exception closes a run for good, and there is a
result only for a run that is complete.
"""

from fractions import Fraction
from typing import Any
from weakref import WeakSet

from ...numbers.taylor_step import TaylorStep
from .balls import demand
from .defect import Piece
from .radius import Radius
from .shapes import Proposal, Proved, State
from .six_columns import Columns
from .system import SceneBalls
from .transits import Scan
from .tube import output

FINISHED = WeakSet[Any]()


class Course:
    """The states at `times` (increasing, from 0 on) and, with `transits`, all zeros of xdot up to the last of them."""

    def __init__(self, balls: SceneBalls, times: list[Fraction], columns: bool, transits: bool) -> None:
        self.balls, self.times, self.states, self.open = balls, tuple(times), list[State](), True
        self.bound: Any = Columns(balls) if columns else Radius(balls)
        self.scan, self.followers = Scan(balls) if transits and not balls.still else None, list[Any]()

    def advance(self, step: TaylorStep, *proposal: Proposal) -> None:
        """Take the next step, and columns if it is proved by them."""
        demand(self.open, "the run is closed: a step failed")
        self.open = False
        covered = self.bound.advance(Piece(self.balls, step), *proposal)
        while len(self.states) < len(self.times) and self.times[len(self.states)] <= covered.piece.end:
            self.states.append(output(covered, self.times[len(self.states)]))
        for follower in filter(None, (self.scan, *self.followers)):
            follower.advance(covered)
        self.open = True

    def finish(self) -> Proved:
        """Return what is proved; only this very object, and no copy of it, counts as the result of a proof."""
        end, complete = self.times[-1], self.open and len(self.states) == len(self.times)
        reached = {part.time for part in (self.bound, self.scan) if part}
        demand(complete and (not end or reached == {end}), "the steps do not end with the run")
        transits = tuple(self.scan.finish() if end else ()) if self.scan else None
        FINISHED.add(proved := Proved(self.balls.inputs, self.times, tuple(self.states), transits, self.balls.still))
        return proved
