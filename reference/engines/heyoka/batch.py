"""heyoka as an engine that solves many scenes side by side; it is imported when it runs."""

from __future__ import annotations

from importlib.metadata import version

from ..batch_interface import Batch, Outcomes, Rows, Wanted
from .batch_tolerances import MOVED_TOLERANCE, TOLERANCE

COMPILE_S = 1.5  # CPU seconds, cold
SWING_S = 8e-6  # of a default row over the period of a small swing


class HeyokaBatch(Batch):
    """Batches of eight in `momentum`; events find the zeros, and a second pass gives the states there."""

    name = "heyoka"
    requires = ("heyoka",)
    extra = ""
    drag = True

    @property
    def identity(self) -> str:
        """Return version and tolerances."""
        return f"heyoka {version('heyoka')}, {self.lanes} lanes, tolerances {TOLERANCE!r} and {MOVED_TOLERANCE!r}"

    def prepare(self, wanted: Wanted, drag: bool) -> float:
        """Compile what such rows need in the calling thread."""
        from .batch_run import prepare

        return prepare(wanted, drag)

    def solve(self, rows: Rows, wanted: Wanted) -> Outcomes:
        """Solve rows, eight at a time."""
        from .batch_run import solve

        return solve(rows, wanted)

    def expected_s(self, swings: float) -> float:
        """Return the expected CPU seconds."""
        return COMPILE_S + swings * SWING_S


BATCH = HeyokaBatch()
