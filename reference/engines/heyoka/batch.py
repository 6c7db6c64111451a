"""heyoka as an engine that solves many scenes; it is imported when it runs."""

from __future__ import annotations

from importlib.metadata import version

from ..batch_interface import Batch, Outcomes, Rows, RunOptions

_TOLERANCE = 2.0**-52  # of a run, the relative error of a step: order 20
_MOVED_TOLERANCE = 2.0**-61  # of the run that tells the error: order 23


class HeyokaBatch(Batch):
    """heyoka for many rows, one at a time, in the formulation `momentum`; event detection finds the zeros."""

    name = "heyoka"
    requires = ("heyoka",)
    extra = ""
    drag = True
    lanes = 1
    swing_s = 2.2e-5
    section_work = (0.7, 0.7)
    compile_s = (0.4, 0.1)

    @property
    def identity(self) -> str:
        """Return version and tolerances."""
        return f"heyoka {version('heyoka')}, tolerances {_TOLERANCE!r} and {_MOVED_TOLERANCE!r}"

    def prepare(self, options: RunOptions) -> None:
        """Compile what such rows need in the calling thread."""
        from .loop import prepare

        prepare(options, _tolerance(options))

    def solve(self, rows: Rows, options: RunOptions) -> Outcomes:
        """Solve rows, one after the other."""
        from .loop import solve

        return solve(rows, options, _tolerance(options))


def _tolerance(options: RunOptions) -> float:
    return _MOVED_TOLERANCE if options.moved else _TOLERANCE


BATCH = HeyokaBatch()
