"""One measurement: a method at a setting on a scene, its cost and its error against the truth, never a gap.

Timed is the work alone, in one thread, with output at the golden grid times. Before it a probe over a short
span warms up and tells what the whole span will cost; where that is beyond the limit, a part of the span is
measured and the cost is extrapolated, which the row says.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from reference import FoucaultError, Golden, Scene, load, parse_scene
from reference.constants import constants
from reference.mechanics import acceleration, invariant
from reference.precision import context
from reference.solution import GRID_COLUMNS, Array
from reference.worker import Emit

from ..methods import METHODS, Method, Outcome, Problem, available

PROBE = 64  # part of the span that is run first, to warm up and to estimate
LEAST_ROWS = 4  # of the grid in any span
REPEAT_S = 1.0  # a run is repeated until so much CPU time is spent on a setting, or
REPEATS = 5  # so often
TRANSIT_S = 3.0  # transit times cost a second, untimed run: only up to this much CPU time
H_ROWS = 64  # at which the drift of h is taken
TRANSIT_FLOOR_S = 1e-29  # what one Newton step from the double next to a transit leaves; nothing finer is reported
MISSED = 0.5  # of the gap to the next transit: a transit that is further off than that is missed

OK, EXTRAPOLATED = "ok", "extrapolated"


@dataclass(frozen=True)
class Row:
    """What a study knows of a method at a setting.

    Attributes:
        method: its id.
        formulation: of the equations of motion.
        setting: step in s, relative tolerance, or bits.
        kind: which of these.
        inputs: the reading of the scene's numbers.
        status: ok; extrapolated (cost of the whole span from a part; the errors are of that part);
            not_installed, gave_up, not_finite, missed_transits, out_of_time, refused.
        reason: why it is not ok.
        error_m: largest position error on the grid.
        end_error_m: at the last row reached.
        transit_error_s: largest error of a transit's time, by one Newton step from the state at the true time.
        h_drift: largest change of h, over the largest kinetic energy.
        cpu_s: median CPU seconds of the whole span.
        cpu_spread: largest minus smallest over the median.
        compile_s: CPU seconds of imports and compilation.
        rhs_evaluations: of the right-hand side.
        steps: taken.
        reached_t: where it came, in s.
    """

    method: str
    formulation: str
    setting: float
    kind: str
    inputs: str
    status: str
    reason: str = ""
    error_m: float | None = None
    end_error_m: float | None = None
    transit_error_s: float | None = None
    h_drift: float | None = None
    cpu_s: float | None = None
    cpu_spread: float | None = None
    compile_s: float | None = None
    rhs_evaluations: int | None = None
    steps: int | None = None
    reached_t: float | None = None

    @property
    def key(self) -> tuple[str, str, float]:
        """What tells rows of one study apart."""
        return self.method, self.formulation, self.setting

    @property
    def measured(self) -> bool:
        """True if the row has a cost and an error."""
        return self.status in (OK, EXTRAPOLATED)

    @classmethod
    def parsed(cls, document: dict[str, Any]) -> Row:
        """A row from its JSON form."""
        names = {one.name for one in fields(cls)}
        return cls(**{key: value for key, value in document.items() if key in names})


@dataclass(frozen=True)
class Truth:
    """The golden states that rows are measured against.

    Args:
        golden: of the scene in the reading that the methods get.
        t_end: end of the span in s.
    """

    golden: Golden
    t_end: float

    @cached_property
    def times(self) -> Array:
        """Grid times of the span in s."""
        t: Array = self.golden.t
        return np.asarray(t[t <= self.t_end])

    @cached_property
    def exact(self) -> list[list[Fraction]]:
        """x, y, z in m as printed, per grid time."""
        columns = [self.golden.exact(name)[: len(self.times)] for name in GRID_COLUMNS[:3]]
        return [list(row) for row in zip(*columns, strict=True)]

    @cached_property
    def transits(self) -> Array:
        """Times of the transits within the span in s."""
        t = self.golden.transits["t"]
        return np.asarray(t[t < self.times[-1]])

    @cached_property
    def transits_rounded_by(self) -> Array:
        """How far the doubles of `transits` are from the printed times, in s."""
        texts = self.golden.transits_text["t"][: len(self.transits)]
        pairs = zip(self.transits, texts, strict=True)
        return np.array([float(Fraction(float(t)) - Fraction(text)) for t, text in pairs])

    def position_errors(self, outcome: Outcome) -> Array:
        """Distance from the truth at each row, in m, without cancellation in any number type."""
        finer = outcome.exact
        if finer is not None:
            unit = Fraction(1, 2**finer.scale)
            found: Any = [[unit * part for part in row[:3]] for row in finer.rows]
        else:
            found = [[Fraction(float(part)) for part in row] for row in outcome.states[:, :3]]
        differences = [
            [float(p - q) for p, q in zip(row, true, strict=True)]
            for row, true in zip(found, self.exact[: len(found)], strict=True)
        ]
        return np.asarray(np.sqrt((np.array(differences) ** 2).sum(axis=1)))


@dataclass(frozen=True)
class Bench:
    """A scene ready for measurements.

    Attributes:
        scene: in the reading that the methods get.
        truth: its golden states.
        limit_s: CPU seconds that one run may take.
        repeats: runs of a setting at most.
        transits: whether to look at their times as well.
    """

    scene: Scene
    truth: Truth
    limit_s: float
    repeats: int = REPEATS
    transits: bool = True

    def row(self, method: Method, formulation: str, setting: float) -> Row:
        """Measure a method at a setting; whatever goes wrong becomes the row's status and reason."""
        base = Row(method.id, formulation, setting, method.setting, self.scene.inputs, OK)
        missing = available(method)
        if missing is not None:
            return _changed(base, status="not_installed", reason=missing)
        try:
            return self._measured(base, method)
        except FoucaultError as error:
            return _changed(base, status="refused", reason=str(error))
        except (ArithmeticError, ValueError, RuntimeError, MemoryError) as error:
            return _changed(base, status="gave_up", reason=f"{type(error).__name__}: {error}")

    def _measured(self, base: Row, method: Method) -> Row:
        times = self.truth.times
        longest = max(2, int(np.searchsorted(times, method.longest_s or math.inf, side="right")))
        begun = time.process_time()
        probe_times = times[: min(longest, max(LEAST_ROWS, len(times) // PROBE))]
        probe = method.prepare(self._problem(base, probe_times), base.setting)
        compile_s = time.process_time() - begun
        tried, probe_s = _timed(probe)
        base = _changed(base, compile_s=compile_s)
        if tried.status != OK:
            return self._failed(base, tried, probe_s)
        probe_s = min(probe_s, _timed(probe)[1]) if probe_s < self.limit_s / PROBE else probe_s
        expected = probe_s * float(times[-1] / probe_times[-1])
        rows = min(len(times), longest)
        if expected > self.limit_s:
            rows = min(rows, max(LEAST_ROWS, int(self.limit_s / 4 / expected * len(times))))
        if rows <= len(probe_times):
            return self._finished(base, tried, [probe_s], probe_times)
        begun = time.process_time()
        work = method.prepare(self._problem(base, times[:rows]), base.setting)
        base = _changed(base, compile_s=compile_s + time.process_time() - begun)
        outcome, cpu_s = _timed(work)
        if outcome.status != OK:
            return self._failed(base, outcome, cpu_s)
        taken = [cpu_s]
        while len(taken) < self.repeats and sum(taken) + cpu_s < REPEAT_S:
            taken.append(_timed(work)[1])
        return self._finished(base, outcome, taken, times[:rows])

    def _problem(self, base: Row, times: Array) -> Problem:
        return Problem.of(self.scene, base.formulation, times)

    def _failed(self, base: Row, outcome: Outcome, cpu_s: float) -> Row:
        return _changed(
            base,
            status=outcome.status,
            reason=outcome.reason,
            cpu_s=cpu_s,
            reached_t=outcome.reached_t,
            steps=outcome.steps,
            rhs_evaluations=outcome.rhs_evaluations,
        )

    def _finished(self, base: Row, outcome: Outcome, taken: Sequence[float], times: Array) -> Row:
        whole = len(times) == len(self.truth.times)
        share = float(self.truth.times[-1] / times[-1])
        errors = self.truth.position_errors(outcome)
        cpu_s = statistics.median(taken)
        reason = "" if whole else f"measured to t = {times[-1]:g} s; the cost is scaled to {self.truth.times[-1]:g} s"
        row = _changed(
            base,
            status=OK if whole else EXTRAPOLATED,
            reason=reason,
            error_m=float(errors.max()),
            end_error_m=float(errors[-1]),
            h_drift=self._h_drift(outcome),
            cpu_s=cpu_s * share,
            cpu_spread=(max(taken) - min(taken)) / cpu_s if cpu_s and len(taken) > 1 else None,
            rhs_evaluations=outcome.rhs_evaluations,
            steps=outcome.steps,
            reached_t=float(times[-1]),
        )
        return self._with_transits(row) if self.transits and whole and cpu_s <= TRANSIT_S else row

    def _with_transits(self, row: Row) -> Row:
        """The row with the largest error of a transit's time, or as failed if one is missed."""
        found = self.truth.transits
        if not len(found):
            return row
        work = METHODS[row.method].prepare(self._problem(row, np.concatenate([[0.0], found])), row.setting)
        outcome = work()
        if outcome.status != OK:
            return row
        finer = outcome.exact
        states = outcome.states[1:]
        vx = states[:, 3] if finer is None else np.array([row[3] / (1 << finer.scale) for row in finer.rows[1:]])
        k = constants(self.scene.exact, context(80)).converted(float)
        n, v = (tuple(states[:, part] / k.length for part in parts) for parts in ((0, 1, 2), (3, 4, 5)))
        ax = np.asarray(acceleration(n, v, k)[0] * k.length)
        with np.errstate(divide="ignore", invalid="ignore"):
            late = np.abs(self.truth.transits_rounded_by - vx / ax)
        late = np.where(np.isfinite(late), late, np.inf)
        gaps = np.diff(np.concatenate([[0.0], found, [np.inf]]))
        missed = late > MISSED * np.minimum(gaps[1:], gaps[:-1])
        if missed.any():
            first = float(found[np.argmax(missed)])
            text = f"{int(missed.sum())} of {len(found)} transits are missed, the first at t = {first:.6f} s"
            return _changed(row, status="missed_transits", reason=text)
        return _changed(row, transit_error_s=max(float(late.max()), TRANSIT_FLOOR_S))

    def _h_drift(self, outcome: Outcome) -> float | None:
        """Drift of h over the largest kinetic energy, in the precision of the outcome; None with drag."""
        if self.scene.exact.drag:
            return None
        ctx = context(80 if outcome.exact is None else outcome.exact.scale + 64)
        k = constants(self.scene.exact, ctx)
        finer = outcome.exact
        rows: Any = outcome.states if finer is None else finer.rows
        unit = ctx.mpf(1) if finer is None else ctx.mpf(2) ** -finer.scale
        values, kinetic = [], ctx.mpf(0)
        for i in np.unique(np.linspace(0, len(rows) - 1, H_ROWS).astype(int)):
            numbers = [ctx.mpf(float(part) if finer is None else part) * unit / k.length for part in rows[i][:6]]
            n, v = tuple(numbers[:3]), tuple(numbers[3:])
            values.append(invariant(n, v, k))
            kinetic = max(kinetic, sum(part * part for part in v) * k.length**2 / 2)
        return float(max(abs(value - values[0]) for value in values) / kinetic) if kinetic else None


def _timed(work: Any) -> tuple[Outcome, float]:
    begun = time.process_time()
    outcome = work()
    spent = time.process_time() - begun
    return outcome, spent if outcome.cpu_s is None else outcome.cpu_s


def _changed(row: Row, **changes: Any) -> Row:
    return replace(row, **changes)


def ladder(emit: Emit, scene: dict[str, Any], golden: Path, t_end: float, limit_s: float, todo: list[Any]) -> None:
    """In a process of its own: measure (method, formulation, setting) one after the other and send each row."""
    bench = Bench(parse_scene(scene), Truth(load(golden), t_end), limit_s)
    for name, formulation, setting in todo:
        emit(bench.row(METHODS[name], formulation, setting))
