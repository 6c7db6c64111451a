"""Long runs (30 days): does a method's error grow like t, like t^1.5 (Brouwer's law, rounding alone), or like t²?

A phase error grows like t² if the energy drifts at a constant rate, like t^1.5 if it does a random
walk, and like t if the frequency has a constant error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from reference import Scene, load_scene
from reference.status import Status

from ..methods import METHODS
from ..methods.method import available
from ..methods.rhs.problem import Problem
from ..observed.least_squares import power_of_time
from ..truth import Progress, golden_of
from .campaign import UNREPORTED, Reports, campaign
from .measure import OnScene, timed
from .row import FAILURES, failure
from .study_plan import Item

SCENE = "paris_30d"
_TRUTH_DIGITS = 36  # enough to judge runs in 113 bits
_TRUTH_LEVEL = "self_consistent"  # confirming it takes heyoka twenty minutes, which was done once
_LAWS = {"t": 1.0, "t^1.5": 1.5, "t^2": 2.0}
_PATIENCE_S = 1800.0  # wall-clock time for one method
FROM = 1 / 40  # the exponent of time is fitted from this part of the run to its end
DAY_S = 86400.0
_PARTS = 24  # points of the fitted curve, equally far apart in log t


@dataclass(frozen=True)
class LongRun:
    """A method's errors over a long run.

    Attributes:
        method, formulation, setting: the run.
        status: OK, or how it failed.
        reason: why it failed.
        t: times in s.
        error_m: position errors at these times.
        cpu_s: CPU seconds.
        bound_m: of the truth.
    """

    method: str
    formulation: str
    setting: float
    status: Status
    reason: str = ""
    t: list[float] = field(default_factory=list, repr=False)
    error_m: list[float] = field(default_factory=list, repr=False)
    cpu_s: float | None = None
    bound_m: float = 0.0

    @property
    def exponent(self) -> float | None:
        """The exponent p of error ∝ t^p, fitted to the largest error so far.

        None if too few errors were measured.
        """
        if not self.t:
            return None
        t = np.array(self.t)
        largest = np.maximum.accumulate(np.array(self.error_m))
        fitted = (t >= FROM * t[-1]) & (largest > 0)
        if fitted.sum() < _PARTS:
            return None
        return power_of_time(t[fitted], largest[fitted], _PARTS)

    @property
    def law(self) -> str | None:
        """The law nearest to the exponent."""
        exponent = self.exponent
        if exponent is None:
            return None
        return min(_LAWS, key=lambda word: abs(_LAWS[word] - exponent))

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        return asdict(self) | {"exponent": self.exponent, "law": self.law}


def long_runs(
    items: Sequence[Item],
    scene: Scene | None = None,
    *,
    journal_path: Path | None = None,
    reports: Reports = UNREPORTED,
) -> list[LongRun]:
    """Measure the errors of methods over a long run, and solve for the truth if needed.

    Args:
        items: method, formulation and setting of each run; `declared(methods, "long_runs")` lists
            them.
        scene: its inputs read as binary64; Paris over 30 days if None.
        journal_path: a file to which results are appended, and whose results are not measured
            again.
        reports: of the simulated days while the truth is solved for, and of the runs.
    """
    scene = scene or load_scene(SCENE, ["inputs=binary64", "run.transits=false"])
    days = float(scene.exact.t_end) / DAY_S
    solving = reports.solving
    golden = golden_of(
        scene,
        _TRUTH_DIGITS,
        Progress(report=solving and (lambda t: solving(t / DAY_S, days))),
        level=_TRUTH_LEVEL,
        grid=True,
    )
    recipe = [scene.id, scene.run.t_end, golden.manifest.files["grid.csv"].sha256]
    runs = _LongRuns(recipe, _PATIENCE_S, {}, scene, golden.path)
    return campaign(runs, items, journal_path=journal_path, report=reports.measuring)


@dataclass(frozen=True)
class _LongRuns(OnScene[Item, LongRun]):
    """Runs of methods over the whole span, with their errors at the grid times."""

    kind = LongRun

    def measure(self, item: Item) -> LongRun:
        name, formulation, setting = item
        run = partial(LongRun, *item)
        method = METHODS[name]
        missing = available(method)
        if missing is not None:
            return run(Status.NOT_INSTALLED, missing)
        truth = self.truth
        try:
            problem = Problem.of(self.scene, formulation, truth.times)
            outcome, cpu_s = timed(method.prepare(problem, setting))
        except FAILURES as error:
            return run(*failure(error))
        errors_m = truth.position_errors(outcome)
        return run(
            outcome.status,
            outcome.reason,
            t=truth.times[: len(errors_m)].tolist(),
            error_m=errors_m.tolist(),
            cpu_s=cpu_s,
            bound_m=float(truth.golden.manifest.bounds.position_m),
        )

    def failed(self, item: Item, status: Status, reason: str) -> LongRun:
        return LongRun(*item, status, reason)


def laws(rows: Sequence[LongRun]) -> Iterator[str]:
    """Yield a sentence on each method: its error at the end, and the law by which it grew."""
    for row in rows:
        exponent = row.exponent
        if exponent is None:
            yield f"{row.method} ({row.formulation}): {row.status}. {row.reason}"
        else:
            end = row.error_m[-1]
            days = row.t[-1] / DAY_S
            yield (
                f"{row.method} ({row.formulation}): {end:.2g} m after {days:g} days, grows like t^{exponent:.2f}: "
                f"nearest law {row.law}"
            )
