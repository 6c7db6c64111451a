"""One measurement: a method at a setting on a scene, its cost and error; failed attempts give a row too.

Only the integration itself is timed, in one thread, with output at the golden grid times. A probe
over a short span comes first: it warms up, and it predicts the cost of the whole span. Where that
exceeds the limit a part of the span is measured. What this part takes beyond the probe tells what
the rest will take, so that a costly start, as of a stiff motion, is not counted again and again.
Only if that exceeds the limit too is the cost extrapolated; the row says so, and has no error over
the whole span: extrapolated by its growth over a 16th of the span, the error of 53 runs was off by
up to 240 times.
"""

from __future__ import annotations

import math
import os
import statistics
import time
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from reference import Scene, load
from reference.numbers.precision import Array
from reference.status import Status

from ..methods.method import Method, RunOutcome, Work, available
from ..methods.rhs.problem import Problem, suited
from .campaign import Item, Measurement, Result, load_per_core
from .row import FAILURES, GridTruth, Row, failure, h_drift

_PROBE = 64  # the probe runs 1/64 of the span, to warm up and to predict the cost
_LEAST_ROWS = 4  # grid rows in any span
REPEAT_S = 1.0  # a run is repeated while the CPU time spent on its setting stays below this,
REPEATS = 5  # and at most this often
# transit times need a second, untimed run, which is made only if the first took at most this long
_TRANSIT_S = 3.0
_MISSED = (
    0.5  # a transit whose error exceeds this part of the gap to its neighbour counts as missed
)


@dataclass(frozen=True)
class Bench:
    """A scene ready for measurements.

    Attributes:
        scene: its inputs read as the methods read them.
        truth: its golden states.
        limit_s: CPU seconds that one run may take.
        repeats: largest number of runs at a setting.
        transits: whether the times of transits are measured as well.
    """

    scene: Scene
    truth: GridTruth
    limit_s: float
    repeats: int = REPEATS
    transits: bool = True

    def row(self, method: Method, formulation: str | None, setting: float) -> Row:
        """Measure a method at a setting; a failure of any kind becomes the row's status and reason.

        The formulation may be None: the first of the method's that can describe the motion.
        """
        base = Row(
            method.id,
            formulation or "",
            setting,
            method.setting,
            self.scene.inputs,
            Status.OK,
            load=load_per_core(),
        )
        missing = available(method)
        if missing is not None:
            return replace(base, status=Status.NOT_INSTALLED, reason=missing)
        try:
            base = replace(base, formulation=formulation or suited(self.scene, method.formulations))
            return self._measured(base, method)
        except FAILURES as error:
            status, reason = failure(error)
            return replace(base, status=status, reason=reason)

    def _measured(self, base: Row, method: Method) -> Row:
        """Measure a short probe, then a longer part if the whole may be too long, then the whole."""
        times = self.truth.times
        longest = max(2, int(np.searchsorted(times, method.longest_s or math.inf, side="right")))
        rows = min(len(times), longest)

        probe_rows = min(longest, max(_LEAST_ROWS, len(times) // _PROBE))
        probe = self._run(base, method, probe_rows, repeats=2, budget_s=2 * self.limit_s / _PROBE)
        probe_s = min(probe.costs_s)  # the first run warms up
        probe = replace(probe, costs_s=[probe_s])
        expected_s = probe_s * float(times[-1] / probe.times[-1])
        if not probe.ended or rows <= probe_rows or probe_s > self.limit_s:
            return self._finished(probe, method, expected_s)

        row = probe.row
        if expected_s > self.limit_s:
            rows_within_limit = int(self.limit_s / 4 / expected_s * len(times))
            part_rows = max(2 * probe_rows, rows_within_limit)
            if part_rows < rows:
                part = self._run(row, method, part_rows, repeats=1)
                part_s = part.costs_s[0]
                remaining = float((times[-1] - part.times[-1]) / (part.times[-1] - probe.times[-1]))
                expected_s = part_s + max(0.0, part_s - probe_s) * remaining
                if not part.ended or expected_s > self.limit_s:
                    return self._finished(part, method, expected_s)
                row = part.row

        run = self._run(row, method, rows, self.repeats)
        share = float(times[-1] / run.times[-1])
        return self._finished(run, method, statistics.median(run.costs_s) * share)

    def _run(
        self, base: Row, method: Method, rows: int, repeats: int, budget_s: float = REPEAT_S
    ) -> _Run:
        """Run a method over the first rows of the truth.

        The run is repeated if it reached its end, as long as all runs take less than `budget_s`.
        """
        times = self.truth.times[:rows]
        started = _spent_s()
        work = method.prepare(Problem.of(self.scene, base.formulation, times), base.setting)
        compile_s = _spent_s() - started
        outcome, cpu_s = timed(work)
        costs_s = [cpu_s]
        if outcome.status == Status.OK:
            while len(costs_s) < repeats and sum(costs_s) + cpu_s < budget_s:
                costs_s.append(timed(work)[1])
        row = replace(base, compile_s=(base.compile_s or 0.0) + compile_s)
        return _Run(row, outcome, costs_s, times)

    def _row_of(self, base: Row, outcome: RunOutcome, cpu_s: float) -> Row:
        """Return the row with what a run tells of itself, however far it came."""
        return replace(
            base,
            status=outcome.status,
            reason=outcome.reason,
            cpu_s=cpu_s,
            reached_t=outcome.reached_t,
            steps=outcome.steps,
            rhs_evaluations=outcome.rhs_evaluations,
        )

    def _finished(self, run: _Run, method: Method, whole_s: float) -> Row:
        """Return the row of a run; `whole_s` are the CPU seconds expected for the whole span."""
        if not run.ended:
            return self._row_of(run.row, run.outcome, run.costs_s[0])
        cpu_s = statistics.median(run.costs_s)
        errors_m = self.truth.position_errors(run.outcome)
        spread = None
        if cpu_s and len(run.costs_s) > 1:
            spread = (max(run.costs_s) - min(run.costs_s)) / cpu_s
        measured: dict[str, Any] = {
            "end_error_m": float(errors_m[-1]),
            "h_drift": h_drift(self.scene, run.outcome),
            "cpu_spread": spread,
        }
        end_s = self.truth.times[-1]
        if len(run.times) < len(self.truth.times):
            reason = f"measured to t = {run.times[-1]:g} s; the cost is scaled to {end_s:g} s"
            row = self._row_of(run.row, run.outcome, whole_s)
            return replace(row, status=Status.EXTRAPOLATED, reason=reason, **measured)
        row = self._row_of(run.row, run.outcome, cpu_s)
        row = replace(row, reason="", error_m=float(errors_m.max()), **measured)
        if self.transits and cpu_s <= _TRANSIT_S:
            return self._with_transits(row, method)
        return row

    def _with_transits(self, row: Row, method: Method) -> Row:
        """Return the row with the largest error of a transit's time, or as failed if a transit is missed."""
        transits = self.truth.transits
        if not len(transits):
            return row
        problem = Problem.of(self.scene, row.formulation, np.concatenate([[0.0], transits]))
        outcome = method.prepare(problem, row.setting)()
        if outcome.status != Status.OK:
            return row
        errors_s, floor_s = self.truth.transit_errors(self.scene, outcome)
        gaps = np.diff(transits, prepend=0.0, append=np.inf)
        missed = errors_s > _MISSED * np.minimum(gaps[1:], gaps[:-1])
        if missed.any():
            first_s = float(transits[np.argmax(missed)])
            text = (
                f"{int(missed.sum())} of {len(transits)} transits are missed, the first at "
                f"t = {first_s:.6f} s"
            )
            return replace(row, status=Status.MISSED_TRANSITS, reason=text)
        largest_s = float(errors_s.max())
        resolved_s = largest_s if largest_s > floor_s else None
        return replace(row, transit_error_s=resolved_s, transit_floor_s=floor_s)


@dataclass(frozen=True)
class _Run:
    """A run of a method over a part of the span.

    Attributes:
        row: the row so far, with the CPU seconds of compiling.
        outcome: of the first run.
        costs_s: CPU seconds of each repeat.
        times: grid times of the output, in s.
    """

    row: Row
    outcome: RunOutcome
    costs_s: list[float]
    times: Array

    @property
    def ended(self) -> bool:
        """Whether the run reached the end of its times."""
        return self.outcome.status == Status.OK


@dataclass(frozen=True)
class OnScene(Measurement[Item, Result]):
    """A measurement on one scene, whose golden dataset each child process reads for itself.

    Attributes:
        scene: its inputs read as the methods read them.
        golden: folder of its dataset.
    """

    scene: Scene
    golden: Path

    @cached_property
    def truth(self) -> GridTruth:
        """The golden states of the scene's span."""
        return GridTruth(load(self.golden), float(self.scene.exact.t_end))


def _spent_s() -> float:
    """Return the CPU seconds of this process and of its children that ended, such as a compiler."""
    times = os.times()
    return time.process_time() + times.children_user + times.children_system


def timed(work: Work) -> tuple[RunOutcome, float]:
    """Run a prepared method; return its outcome and its CPU seconds."""
    started = time.process_time()
    outcome = work()
    spent = time.process_time() - started
    return outcome, spent if outcome.cpu_s is None else outcome.cpu_s
