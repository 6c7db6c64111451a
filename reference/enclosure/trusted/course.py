"""TRUSTED. A proof from step to step: bound, output times and zeros are given one piece, in order and without a gap.

Who calls `advance` proposes steps and columns, and can do no harm: an exception closes a run for good, and there is a
result only for a run that is complete (THEOREM.md, section 9). Times are in s, states in m and m/s.
"""

from collections.abc import Iterable
from fractions import Fraction
from typing import Any
from weakref import WeakSet

from ...numbers.taylor_step import TaylorStep
from .balls import demand
from .defect import Piece, pieces
from .radius import Radius
from .shapes import XDOT, Proposal, Proved, State
from .six_columns import Columns
from .system import SceneBalls
from .tube import output
from .zeros import Scan

FINISHED = WeakSet[Any]()


class Course:
    """The states at `times` (increasing, from 0 on), and all zeros of `words` up to the last of them.

    With `second_order` highest and lowest points are enclosed as a box of inputs wants it.
    """

    def __init__(
        self,
        balls: SceneBalls,
        times: list[Fraction],
        columns: bool,
        words: tuple[str, ...],
        second_order: bool = False,
    ) -> None:
        self.balls = balls
        self.times = tuple(times)
        self.pieces = list[Piece]()  # that were read, and wait
        self.states = list[State]()
        self.open = True
        self.bound: Any = Columns(balls) if columns else Radius(balls)
        # xdot that is identically zero has no zeros
        sought = [word for word in words if not (word == XDOT and balls.still)]
        self.scans = {word: scan_of(balls, word, second_order) for word in sought}
        self.followers = list[Any]()

    def advance(self, step: TaylorStep, *proposal: Proposal) -> None:
        """Read a step and take it, with columns if it is proved by them."""
        self.read([step])
        self.take(*proposal)

    def read(self, steps: Iterable[TaylorStep]) -> None:
        """Read the next steps, together: that is faster than one after another."""
        demand(self.open, "the run is closed: a step failed")
        self.open = False
        self.pieces.extend(pieces(self.balls, steps))
        self.open = True

    def take(self, *proposal: Proposal) -> None:
        """Take the next of the steps that were read, and columns if it is proved by them."""
        demand(self.open, "the run is closed: a step failed")
        demand(bool(self.pieces), "no step was read")
        self.open = False
        covered = self.bound.advance(self.pieces.pop(0), *proposal)
        while len(self.states) < len(self.times):
            time = self.times[len(self.states)]
            if time > covered.piece.end:
                break
            self.states.append(output(covered, time))
        for follower in (*self.scans.values(), *self.followers):
            follower.advance(covered)
        self.open = True

    def finish(self) -> Proved:
        """Return what is proved; only this very object, and no copy of it, counts as the result of a proof."""
        end = self.times[-1]
        complete = self.open and len(self.states) == len(self.times)
        reached = {part.time for part in (self.bound, *self.scans.values())}
        demand(complete and (not end or reached == {end}), "the steps do not end with the run")

        zeros = {word: tuple(scan.finish() if end else ()) for word, scan in self.scans.items()}
        proved = Proved(self.balls.claim, self.times, tuple(self.states), zeros, self.balls.still)
        FINISHED.add(proved)
        return proved


def scan_of(balls: SceneBalls, word: str, second_order: bool) -> Scan:
    """Return a scan for the zeros of a word; a proof rests on the code of sections only where it asks for some."""
    if word == XDOT:
        return Scan(balls)
    from .sections import section_scan

    return section_scan(balls, word, second_order)
