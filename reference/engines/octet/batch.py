"""The kernel as an engine that solves many undamped scenes side by side; numba is imported when it runs."""

from __future__ import annotations

from ..batch import Batch, Outcomes, Rows, Wanted

ORDER, MOVED_ORDER = 24, 22  # of a run, and of the run that tells the error
TOLERANCE = 2.0**-54
COMPILE_S = 15.0  # CPU seconds, cold
WARM_S = 0.6
SWING_S = 1e-6  # of a default row over the period of a small swing


class OctetBatch(Batch):
    """Taylor series of fixed order and adaptive step, eight rows at a time in machine code."""

    name = "octet"
    requires = ("numba",)
    extra = "methods"
    drag = False

    @property
    def identity(self) -> str:
        """Return orders and tolerance; the same instructions on every machine that fuses products and sums."""
        return f"octet, orders {ORDER} and {MOVED_ORDER}, tolerance {TOLERANCE!r}"

    def prepare(self, wanted: Wanted, drag: bool) -> float:
        """Compile the kernel, or read it from the disk, once a process."""
        from .run import prepare

        return prepare()

    def solve(self, rows: Rows, wanted: Wanted) -> Outcomes:
        """Solve rows without drag."""
        from .run import solve

        return solve(rows, wanted)

    def expected_s(self, swings: float) -> float:
        """Return the expected CPU seconds."""
        return COMPILE_S + swings * SWING_S


BATCH = OctetBatch()
