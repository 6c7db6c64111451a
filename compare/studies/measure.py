"""One measurement: a method at a setting on a scene, its cost and error; every attempt gives a row, failed ones too.

Only the integration itself is timed, in one thread, with output at the golden grid times. A probe over a short span
comes first: it warms up, and it predicts the cost of the whole span. Where that exceeds the limit a part of the span is
measured. What this part takes beyond the probe tells what the rest will take, so that a costly start, as of a stiff
motion, is not counted again and again. Only if that exceeds the limit too is the cost extrapolated; the row says so,
and has no error over the whole span: extrapolated by its growth over a 16th of the span, the error of 53 runs was off
by up to 240 times.
"""

from __future__ import annotations

import math
import os
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from reference import Scene, load
from reference.numbers.precision import Array
from reference.status import Status

from ..methods.method import Method, RunOutcome, Work, available
from ..methods.rhs.problem import Problem, suited
from .campaign import Item, Measurement, Result, load_per_core
from .row import FAILURES, GridTruth, Row, failure, h_drift

PROBE = 64  # the probe runs 1/64 of the span, to warm up and to predict the cost
LEAST_ROWS = 4  # grid rows in any span
REPEAT_S = 1.0  # a run is repeated while the CPU time spent on its setting stays below this,
REPEATS = 5  # and at most this often
# transit times need a second, untimed run, which is made only if the first took at most this long
TRANSIT_S = 3.0
MISSED = 0.5  # a transit whose error exceeds this part of the gap to its neighbour counts as missed


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
        inputs, load = self.scene.inputs, load_per_core()
        base = Row(
            method.id, formulation or "", setting, method.setting, inputs, Status.OK, load=load
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
        times = self.truth.times
        longest = max(2, int(np.searchsorted(times, method.longest_s or math.inf, side="right")))
        probe_times = times[: min(longest, max(LEAST_ROWS, len(times) // PROBE))]
        base, outcome, costs_s = self._run(
            base, method, probe_times, repeats=2, budget_s=2 * self.limit_s / PROBE
        )
        probe_s = min(costs_s)  # the first run warms up
        expected_s, rows = probe_s * float(times[-1] / probe_times[-1]), min(len(times), longest)
        if outcome.status != Status.OK or rows <= len(probe_times) or probe_s > self.limit_s:
            return self._finished(base, method, outcome, [probe_s], probe_times, expected_s)
        if expected_s > self.limit_s:
            part = times[
                : max(2 * len(probe_times), int(self.limit_s / 4 / expected_s * len(times)))
            ]
            if len(part) < rows:
                base, outcome, costs_s = self._run(base, method, part, repeats=1)
                left = float((times[-1] - part[-1]) / (part[-1] - probe_times[-1]))
                expected_s = costs_s[0] + max(0.0, costs_s[0] - probe_s) * left
                if outcome.status != Status.OK or expected_s > self.limit_s:
                    return self._finished(base, method, outcome, costs_s, part, expected_s)
        base, outcome, costs_s = self._run(base, method, times[:rows], self.repeats)
        share = float(times[-1] / times[rows - 1])
        return self._finished(
            base, method, outcome, costs_s, times[:rows], statistics.median(costs_s) * share
        )

    def _run(
        self, base: Row, method: Method, times: Array, repeats: int, budget_s: float = REPEAT_S
    ) -> tuple[Row, RunOutcome, list[float]]:
        """Run a method to the end of `times`; return the row with what compiling took, the outcome, and CPU seconds.

        It is repeated while all runs take less than `budget_s`, and if it came to its end.
        """
        started = _spent_s()
        work = method.prepare(Problem.of(self.scene, base.formulation, times), base.setting)
        base = replace(base, compile_s=(base.compile_s or 0.0) + _spent_s() - started)
        outcome, cpu_s = timed(work)
        costs_s = [cpu_s]
        while (
            outcome.status == Status.OK
            and len(costs_s) < repeats
            and sum(costs_s) + cpu_s < budget_s
        ):
            costs_s.append(timed(work)[1])
        return base, outcome, costs_s

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

    def _finished(
        self,
        base: Row,
        method: Method,
        outcome: RunOutcome,
        costs_s: Sequence[float],
        times: Array,
        whole_s: float,
    ) -> Row:
        """Return the row of a run to the end of `times`, which would take `whole_s` CPU seconds over the whole span.

        Of one that did not come to that end, it is what the run tells of itself.
        """
        if outcome.status != Status.OK:
            return self._row_of(base, outcome, costs_s[0])
        whole = len(times) == len(self.truth.times)
        errors = self.truth.position_errors(outcome)
        cpu_s = statistics.median(costs_s)
        reason = (
            ""
            if whole
            else f"measured to t = {times[-1]:g} s; the cost is scaled to {self.truth.times[-1]:g} s"
        )
        row = replace(
            self._row_of(base, outcome, cpu_s if whole else whole_s),
            status=Status.OK if whole else Status.EXTRAPOLATED,
            reason=reason,
            error_m=float(errors.max()) if whole else None,
            end_error_m=float(errors[-1]),
            h_drift=h_drift(self.scene, outcome),
            cpu_spread=(max(costs_s) - min(costs_s)) / cpu_s
            if cpu_s and len(costs_s) > 1
            else None,
        )
        return (
            self._with_transits(row, method)
            if self.transits and whole and cpu_s <= TRANSIT_S
            else row
        )

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
        missed = errors_s > MISSED * np.minimum(gaps[1:], gaps[:-1])
        if missed.any():
            first = float(transits[np.argmax(missed)])
            text = f"{int(missed.sum())} of {len(transits)} transits are missed, the first at t = {first:.6f} s"
            return replace(row, status=Status.MISSED_TRANSITS, reason=text)
        largest = float(errors_s.max())
        return replace(
            row, transit_error_s=largest if largest > floor_s else None, transit_floor_s=floor_s
        )


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
