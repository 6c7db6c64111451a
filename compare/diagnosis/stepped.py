"""Fixed-step methods on the sphere, run as programs run them: in whole steps from row to row.

The leading error of a step describes what a method does to a small swing, but not to a wide
one, which leaves the sphere on its way. So the equations of a program are stepped with the same
method, and the difference from an exact integration is subtracted from the rows before they are
read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from reference.engines.heyoka.propagator import compiled
from reference.model.constants import Constants
from reference.model.force import acceleration
from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import best_change
from .case import AS_IF, Explanation, FileCase, largest, rms
from .causes import PHASE
from .claims import explanation_of, graded, hedged, shows_steps, with_alternative_steps
from .families import fit_pendulum
from .fitted import BETTER, POLISHED, polished, readings_of
from .hypotheses import Claim, Hypothesis
from .loops import LinearSteps, likely_loops
from .phasors import TITLES
from .programs import Program, SphericalPendulum
from .readings import CauseReading, adjusted

_TITLES = TITLES | {"heun": TITLES["rk2"]}
# ωh: the shortest step that is tried
_FINEST = {
    "semi_implicit_euler": 0.004,
    "semi_implicit_euler_drift": 0.004,
    "leapfrog": 0.004,
    "explicit_euler": 0.001,
    "rk2": 0.004,
    "heun": 0.004,
    "rk4": 0.02,
}
# places of the stages after the first, weights of all stages
_RUNGE_KUTTA: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "explicit_euler": ((), (1.0,)),
    "rk2": ((1 / 2,), (0.0, 1.0)),
    "heun": ((1.0,), (1 / 2, 1 / 2)),
    "rk4": ((1 / 2, 1 / 2, 1.0), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
}
# The rows up to there are read first, and all rows only if some steps explain these.
FIRST_STEPS = 15_000
_FEWEST = 30  # rows that determine a motion; up to twice as many steps are run to reach them
# A step takes about a microsecond, and a quarter of that in long leaps. A day in Paris takes 8 million
# of the shortest steps that are tried. Longer files are not explained, because their last rows would not be checked.
_MOST_STEPS = 10_000_000
_TRIED = 24  # numbers of steps that are run at a time
# steps that are compiled as one, by the number of steps from which compiling them pays
_LEAPS = {4: 4_000, 16: 400_000}
_SEARCHED = 8_000  # steps that are run at most while their number is unknown
_SWING = 1.5  # periods at the beginning from which the step is estimated
_LIKELY = 3  # steps that are tried on all rows
# the largest residual of a likely step in the first swing, over that of an exact integration
_PLAIN = 0.3
_READINGS = 2  # how often the rows are read, the effect of the steps computed again in between
_STEP_LEFT = 1e-3  # of the effect of the steps: largest residual of steps that are right
_ALIKE = 10.0  # ratio of residuals: beyond that of the likeliest steps, others are not tried
_NEWTON = 2  # Gauss-Newton steps before any fixed step is tried
# indices of theta that are fitted together with a step: turn, pull, drag, place of the release
_UNSURE = [2, 3, 4, 5, 6, 7, 8]
_State = list[Any]


@dataclass(frozen=True)
class Steps(SphericalPendulum):
    """A pendulum that a fixed-step method moves, with a whole number of steps from row to row.

    Attributes:
        method: a key of `_FINEST`.
        steps_per_row: number of steps from row to row.
        spacing_s: time from row to row.
        guess: the theta with which it meets the first swing; empty if unknown.
    """

    method: str = ""
    steps_per_row: int = 1
    spacing_s: float = 0.0
    guess: tuple[float, ...] = ()
    kind: str = "sphere"

    @property
    def step_s(self) -> float:
        """Its step."""
        return self.spacing_s / self.steps_per_row

    @property
    def title(self) -> tuple[str, str]:
        """The id of its method, and the name that people use."""
        method_id = "rk2" if self.method == "heun" else self.method
        return method_id, _TITLES[self.method]

    def exact(self, theta: Array, times: Array) -> Array:
        """Return x and y in m of an exact integration, shape (times, 2)."""
        return super().rows(theta, times, 2)

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x and y in m, shape (times, 2)."""
        return self._at(times, theta[:, None])[:, :, 0]

    def slopes(
        self, theta: Array, times: Array, columns: int, scales: Array, nudges: Array
    ) -> Array:
        """Return d rows / d theta times `scales`, shape (times * 2, 14).

        They are differences; each number of theta is moved by `nudges` scales.
        """
        nudged = theta[:, None] + np.diag(nudges * scales)
        rows = self._at(times, np.column_stack([theta, nudged]))
        differences = rows[:, :, 1:] - rows[:, :, :1]
        return np.asarray(differences / nudges).reshape(-1, len(theta))

    def _at(self, times: Array, thetas: Array) -> Array:
        """Return x and y in m at some times, shape (times, 2, columns of thetas)."""
        indices = np.round(times / self.spacing_s).astype(np.int64)
        steps_per_row = np.full(thetas.shape[1], self.steps_per_row)
        return self.rows_at(thetas, steps_per_row, indices)

    def rows_at(
        self,
        thetas: Array,
        steps_per_row: npt.NDArray[np.int64],
        indices: npt.NDArray[np.int64],
    ) -> Array:
        """Return x and y in m of some rows, shape (indices, 2, columns of thetas).

        Args:
            thetas: one in each column.
            steps_per_row: number of steps from row to row, for each column.
            indices: of the rows, counted in spacings from the release on.
        """
        # one function, because all steps are a loop over arrays that are prepared before it
        constants = [self.constants(theta) for theta in thetas.T]
        parameters = np.array(
            [[0.0, *k.pull, *k.turn, *k.centrifugal, k.drag] for k in constants]
        ).T.copy()
        parameters[0] = self.spacing_s / steps_per_row
        state = np.column_stack([self.start(theta) for theta in thetas.T])
        rows = np.full((len(indices), *state[:2].shape), np.nan)

        # the number of steps after which each column reaches each row, sorted; what is reached
        # after the same number is stored together
        steps_to_row = indices[:, None] * steps_per_row
        step_counts, first = np.unique(np.sort(steps_to_row, axis=None), return_index=True)
        reached = np.split(np.argsort(steps_to_row, axis=None), first[1:])

        leaps = [leap for leap, worth in _LEAPS.items() if step_counts[-1] >= worth]
        done = 0
        for step_count, places in zip(step_counts.tolist(), reached, strict=True):
            remaining = step_count - done
            for leap in (*reversed(leaps), 1):
                steps = _compiled_steps(self.method, leap)
                repeats, remaining = divmod(remaining, leap)
                for _ in range(repeats):
                    state = steps(state, pars=parameters)
            done = step_count
            row, column = np.divmod(places, len(steps_per_row))
            rows[row, :, column] = state[:2, column].T
        return np.asarray(rows * thetas[11])


def of_steps(case: FileCase, reading: CauseReading | None) -> Explanation | None:
    """Return the explanation of rows that a fixed-step method made; None if none did.

    The numbers of the motion are fitted with these steps; the effect of the steps is subtracted
    from the rows before they are read. Of a long file the first rows show whether some steps are
    likely; what is said of them holds for all rows.

    Args:
        case: the rows.
        reading: of the rows, with the integrator's step known roughly; or None.
    """
    by_loop = of_loops(case)
    if by_loop is not None:
        return by_loop

    rows = case.rows
    flat = case.in_the_plane()
    right = case.right.changed(length=case.rows.cord or case.right.length)
    program = None if reading is None else reading.program
    explanations = []
    for steps in likely_steps(replace(flat, right=right), program):
        first_steps = max(FIRST_STEPS, min(_FEWEST * steps.steps_per_row, 2 * FIRST_STEPS))
        count = int((rows.times <= steps.step_s * first_steps).sum())
        if count < _FEWEST:
            continue
        explanation = _explanation_with(flat, steps, count)
        if explanation is None:
            continue
        explanations.append(explanation)
        if all(cause.stage != AS_IF for cause in explanation.causes):
            break
    return min(explanations, key=lambda explanation: explanation.score, default=None)


def of_loops(case: FileCase) -> Explanation | None:
    """Return the explanation of rows that a loop of statements made, one after the other; None if none did.

    Several loops may make the same motion, each with other numbers: those that need the fewest causes are told.
    """
    flat = case.in_the_plane()
    row_count = len(flat.rows.times)
    loops = likely_loops(flat)
    explained = [(loop, _explanation_with(flat, loop, row_count)) for loop in loops]
    possible = [(loop, found) for loop, found in explained if found is not None]
    if not possible:
        return None
    _, best = min(possible, key=lambda pair: pair[1].price)
    rivals = [step_cause(loop) for loop, found in possible if found.price == best.price]
    return with_alternative_steps(best, rivals)


@dataclass(frozen=True)
class _SteppedMotion:
    """The motion that some steps make of a theta.

    Attributes:
        steps: that make it.
        rows: x and y in m.
        effect: the rows less those of an exact integration, in m.
    """

    steps: Steps | LinearSteps
    rows: Array
    effect: Array

    @classmethod
    def of(cls, steps: Steps | LinearSteps, theta: Array, times: Array) -> _SteppedMotion:
        """Return the motion at some times."""
        rows = steps.rows(theta, times, 2)
        return cls(steps, rows, rows - steps.exact(theta, times))

    @classmethod
    def of_program(
        cls, case: FileCase, program: Program, steps: Steps | LinearSteps
    ) -> _SteppedMotion:
        """Return the motion of a program with some steps, at the times of a case."""
        pendulum, theta = case.pendulum_of(program)
        return cls.of(replace(steps, **vars(pendulum)), theta, case.rows.times)

    def taken_from(self, case: FileCase) -> FileCase:
        """Return a case with the effect of the steps subtracted from its rows."""
        rows = replace(case.rows, positions=case.rows.positions - self.effect)
        return replace(case, rows=rows)

    def residuals(self, case: FileCase) -> Array:
        """Return the rows of a case less its own in m, shape (rows, 2)."""
        return np.asarray(case.rows.positions - self.rows)

    def is_near(self, case: FileCase) -> bool:
        """Return whether the residual is a small part of the effect of the steps, so that they may be right."""
        most_m = max(case.floor, _STEP_LEFT * rms(self.effect))
        return rms(self.residuals(case)) <= most_m


@dataclass(frozen=True)
class _SteppedReading:
    """What the rows show once the effect of the steps is taken out.

    Attributes:
        case: the rows.
        best: the best hypothesis of the rows less the effect.
        readings: of these.
        motion: of the best hypothesis with the steps.
    """

    case: FileCase
    best: Hypothesis
    readings: list[CauseReading]
    motion: _SteppedMotion

    @classmethod
    def of(cls, case: FileCase, motion: _SteppedMotion) -> _SteppedReading | None:
        """Return the reading of rows less the effect of a motion's steps; None if they are of another model.

        If the motion is nearly right, they are read again less the effect of a better one.
        """
        reading = None
        for _ in range(_READINGS):
            exact_case = motion.taken_from(case)
            readings = readings_of(exact_case, stepped=True)
            _, best = explanation_of(exact_case, readings, stepped=True)
            if best is None or best.reading.program.kind != motion.steps.kind:
                return None
            motion = _SteppedMotion.of_program(case, best.reading.program, motion.steps)
            reading = cls(case, best, readings, motion)
            if rms(motion.residuals(case)) <= case.floor or not motion.is_near(case):
                break
        return reading

    @property
    def explains(self) -> bool:
        """Whether the steps make the rows, with the causes of the best hypothesis."""
        residuals = self.motion.residuals(self.case)
        return self.motion.is_near(self.case) and largest(residuals) <= self.case.enough

    def of_all(self, case: FileCase) -> _SteppedReading | None:
        """Return the reading of all rows of a case, of which this one has read the first.

        The numbers are fitted again first: they were known to the precision of the first rows, and their
        effect grows with time.
        """
        program = self.best.reading.program
        names = [cause.free for cause in self.best.reading.causes if cause.free]

        def rows_of(program: Program) -> Array:
            pendulum, theta = case.pendulum_of(program)
            steps = replace(self.motion.steps, **vars(pendulum))
            return steps.rows(theta, case.rows.times, 2)

        if names:
            goal = case.rows.positions
            program, _ = adjusted(program, names, rows_of, goal, steps=POLISHED, gain=BETTER)
        motion = _SteppedMotion.of_program(case, program, self.motion.steps)
        return _SteppedReading.of(case, motion)

    def explanation(self) -> Explanation | None:
        """Return the explanation by its causes and the steps; None if the tests of a claim do not allow the steps."""
        case = self.case
        best = self.best
        residuals = self.motion.residuals(case)
        readings = [replace(best.reading, residual_rms_m=rms(residuals)), *self.readings]
        explanation, _ = explanation_of(self.motion.taken_from(case), readings, stepped=True)
        without_steps = polished(case, best.reading)
        step = graded(
            Claim(case, residuals),
            step_cause(self.motion.steps, largest(self.motion.effect)),
            rms(case.residuals(without_steps.program)),
        )
        if step is None:
            return None
        causes = explanation.causes
        if not shows_steps(best):
            step = hedged(step)
            causes = tuple(hedged(cause) if cause.id in PHASE else cause for cause in causes)
        causes = (*causes, step)
        found = case.explanation(causes, residuals, explanation.price + 1)
        return replace(found, reading=best.reading)


def _explanation_with(
    case: FileCase, steps: Steps | LinearSteps, first_rows: int
) -> Explanation | None:
    """Return the explanation of rows that some steps made; None if others did.

    All rows are read only if the steps explain the first ones.
    """
    first = case.part(first_rows)
    fit = fit_pendulum(first, steps, [np.array(steps.guess)])
    if fit is None:
        return None
    motion = _SteppedMotion.of(steps, fit.theta, first.rows.times)
    if not motion.is_near(first):
        return None
    # the steps of a linear model are exact: a residual beyond rounding refutes them, whatever numbers are fitted
    if steps.kind == "linear" and rms(motion.residuals(first)) > case.resolution:
        return None
    reading = _SteppedReading.of(first, motion)
    if reading is None or not reading.explains:
        return None
    if first_rows < len(case.rows.times):
        reading = reading.of_all(case)
    return None if reading is None else reading.explanation()


def step_cause(steps: Steps | LinearSteps, size_m: float = math.nan) -> Deviation:
    """Return the cause that a program takes some steps; they move its rows by `size_m`, if that is known."""
    method_id, title = steps.title
    step_s = steps.step_s
    text = f"integrates with {title} at a step of {step_s:.3g} s"
    return Deviation(f"integrator_{method_id}", text, size_m, "integrator", step_s, step_s)


@dataclass(frozen=True)
class _Candidate:
    """Steps that may have made the first swing, and the norm in m of their residuals in it."""

    residual_m: float
    steps: Steps


def likely_steps(case: FileCase, program: Program | None) -> list[Steps]:
    """Return the methods and steps that fit the first swing, the likeliest first.

    There are none for rows that are not evenly spaced, nor steps so short that they do not run to the last row.

    Args:
        case: the rows, with x and y alone, the first of them evenly spaced from the release on.
        program: its step is tried first. If rows are too far apart for all steps to be tried,
            steps near its own are tried, or the shortest steps are left out.
    """
    swing = _FirstSwing.of(case)
    if swing is None:
        return []
    candidates: list[_Candidate] = []
    for method in _FINEST:
        candidates += _candidates(swing, method, program)
    # steps that diverge have no finite residual
    candidates = [candidate for candidate in candidates if math.isfinite(candidate.residual_m)]
    last_s = float(case.rows.times[-1])
    candidates = [one for one in candidates if one.steps.step_s * _MOST_STEPS >= last_s]
    candidates.sort(key=lambda candidate: candidate.residual_m)
    sizes = [candidate.residual_m for candidate in candidates]
    least_m = next((size for size in sizes if size), 0.0)
    most_m = min(_PLAIN * swing.exact_residual_m, _ALIKE * least_m)
    likeliest = candidates[:_LIKELY]
    return [candidate.steps for candidate in likeliest if candidate.residual_m < most_m]


@dataclass(frozen=True)
class _FirstSwing:
    """The first rows, evenly spaced from the release on, and the exact integration that fits them.

    Attributes:
        case: the first rows.
        pendulum: runs theta.
        right: theta of a right program.
        theta: that fits the rows best without fixed steps.
        slopes: d rows / d theta by its unsure numbers, in scales.
    """

    case: FileCase
    pendulum: SphericalPendulum
    right: Array
    theta: Array
    slopes: Array

    @classmethod
    def of(cls, case: FileCase) -> _FirstSwing | None:
        """Return the first swing of a case; None if its rows are not evenly spaced."""
        first = _first_rows(case)
        if first is None:
            return None
        pendulum, right = case.pendulum_of(case.right)
        theta = right
        for _ in range(_NEWTON):
            theta, slopes = _improved(first, pendulum, theta)
        return cls(first, pendulum, right, theta, slopes)

    @property
    def spacing_s(self) -> float:
        """Time from row to row."""
        return float(self.case.rows.times[1])

    @property
    def exact_residual_m(self) -> float:
        """Norm in m of the residuals of theta without fixed steps."""
        rows = self.case.rows
        return float(np.linalg.norm(rows.positions - self.pendulum.rows(self.theta, rows.times, 2)))


def _first_rows(case: FileCase) -> FileCase | None:
    """Return the rows of the first swing; None if they are not even from the release on."""
    times = case.rows.times
    if len(times) < 8 or times[0] != 0 or not case.frequency:
        return None
    spacing_s = float(times[1])
    count = max(10, math.ceil(_SWING * 2 * math.pi / case.frequency / spacing_s))
    spacings = times / spacing_s
    if not np.abs(spacings - np.round(spacings)).max() < 1e-6 * times[-1] / spacing_s:
        return None
    if len(times) <= count or abs(spacings[count] - count) > 1e-6:
        return None
    return case.part(count + 1)


def _candidates(swing: _FirstSwing, method: str, program: Program | None) -> list[_Candidate]:
    """Return the steps of a method that may have made the first swing.

    They are the number of steps with the smallest residual, its neighbours, and a program's own number.
    """
    steps = Steps(**vars(swing.pendulum), method=method, spacing_s=swing.spacing_s)
    finest = int(swing.spacing_s * swing.case.frequency / _FINEST[method])
    low = 1
    high = min(finest, _SEARCHED // (len(swing.case.rows.times) - 1))
    candidates = []
    expected = _steps_per_row(program, method, swing.spacing_s)
    if 0 < expected <= finest:
        guess = tuple(swing.theta)
        expected_steps = replace(steps, steps_per_row=expected, guess=guess)
        candidates.append(_Candidate(0.0, expected_steps))
        if expected > high:
            low = expected - _TRIED // 4
            high = min(finest, expected + _TRIED // 4)
    return candidates + _closest(swing, steps, low, high)


def _steps_per_row(program: Program | None, method: str, spacing_s: float) -> int:
    """Return the steps from row to row of a program with a method; 0 if it has another, or none."""
    if program is None or program.method is None or not program.step:
        return 0
    return round(spacing_s / program.step) if program.method.id == method else 0


def _improved(swing: FileCase, pendulum: SphericalPendulum, theta: Array) -> tuple[Array, Array]:
    """Return theta after a Gauss-Newton step of its unsure numbers, and the slopes by these."""
    times = swing.rows.times
    all_slopes = pendulum.slopes(theta, times, 2, swing.scales, np.full(len(theta), 1e-6))
    slopes = all_slopes[:, _UNSURE]
    residuals = (swing.rows.positions - pendulum.rows(theta, times, 2)).ravel()
    if not (np.isfinite(slopes).all() and np.isfinite(residuals).all()):
        return theta, np.zeros((len(residuals), 0))
    improved = theta.copy()
    improved[_UNSURE] += swing.scales[_UNSURE] * best_change(slopes, residuals)
    return improved, slopes


def _closest(swing: _FirstSwing, steps: Steps, low: int, high: int) -> list[_Candidate]:
    """Return the number of steps from row to row with the smallest residual, between its neighbours.

    The numbers tried lie from `low` to `high`, then ever closer around the best. All are tried
    with every theta; the best one is improved after each round.
    """
    thetas = np.column_stack([swing.right, swing.theta])
    slopes = swing.slopes
    settled = False
    while low <= high:
        steps_per_row = np.unique(np.geomspace(low, high, _TRIED).round().astype(np.int64))
        norms_m = _residual_norms(swing.case, steps, thetas, slopes, steps_per_row)
        smallest = np.argmin(np.where(np.isfinite(norms_m), norms_m, np.inf))
        which, best = divmod(int(smallest), len(steps_per_row))
        theta = thetas[:, which]
        norms_m = norms_m[which]

        near = slice(max(best - 1, 0), best + 2)
        if settled or not np.isfinite(norms_m[best]):
            counts = steps_per_row[near].tolist()
            guess = tuple(theta)
            return [
                _Candidate(norm_m, replace(steps, steps_per_row=count, guess=guess))
                for norm_m, count in zip(norms_m[near].tolist(), counts, strict=True)
            ]
        best_steps = replace(steps, steps_per_row=int(steps_per_row[best]))
        theta, slopes = _improved(swing.case, best_steps, theta)
        thetas = theta[:, None]
        settled = high - low < len(steps_per_row)
        if not settled:
            low = int(steps_per_row[near][0])
            high = int(steps_per_row[near][-1])
    return []


def _residual_norms(
    swing: FileCase,
    steps: Steps,
    thetas: Array,
    slopes: Array,
    steps_per_row: npt.NDArray[np.int64],
) -> Array:
    """Return the norms in m of the residuals, shape (columns of thetas, numbers of steps).

    What the slopes can take up is not counted.
    """
    count = len(steps_per_row)
    repeated = thetas.repeat(count, axis=1)
    rows = steps.rows_at(
        repeated, np.tile(steps_per_row, thetas.shape[1]), np.arange(len(swing.rows.times))
    )
    residuals = (swing.rows.positions[:, :, None] - rows).reshape(-1, rows.shape[2])
    basis = np.linalg.qr(slopes)[0]
    norms = np.linalg.norm(residuals - basis @ (basis.T @ residuals), axis=0)
    return np.asarray(norms.reshape(-1, count))


@cache
def _compiled_steps(method: str, count: int) -> Any:
    """Return `count` steps of a method as machine code.

    The state is over l; the parameters are h, pull, turn, centrifugal force's gradient, drag.
    """

    def change(state: _State, parameters: _State) -> _State:
        k = Constants(
            pull=tuple(parameters[1:4]),
            turn=tuple(parameters[4:7]),
            centrifugal=tuple(parameters[7:11]),
            drag=parameters[11],
        )
        for _ in range(count):
            state = _stepped(method, state, parameters[0], k)
        return state

    return compiled(("x", "y", "z", "vx", "vy", "vz"), 12, change)


def _stepped(method: str, state: _State, h: Any, k: Constants) -> _State:
    """Return position and velocity after one step."""

    def rates(state: _State) -> _State:
        return [*state[3:], *acceleration(tuple(state[:3]), tuple(state[3:]), k)]

    def kicked(state: _State, h: Any) -> _State:
        return [*state[:3], *_moved(state[3:], h, rates(state)[3:])]

    def drifted(state: _State, h: Any) -> _State:
        return [*_moved(state[:3], h, state[3:]), *state[3:]]

    if method == "semi_implicit_euler":
        return drifted(kicked(state, h), h)
    if method == "semi_implicit_euler_drift":
        return kicked(drifted(state, h), h)
    if method == "leapfrog":
        return kicked(drifted(kicked(state, h / 2), h), h / 2)

    places, weights = _RUNGE_KUTTA[method]
    stages = [rates(state)]
    for place in places:
        stages.append(rates(_moved(state, place * h, stages[-1])))
    for weight, stage in zip(weights, stages, strict=True):
        if weight:
            state = _moved(state, weight * h, stage)
    return state


def _moved(values: Sequence[Any], h: Any, rates: Sequence[Any]) -> _State:
    """Return values + h * rates."""
    return [value + h * rate for value, rate in zip(values, rates, strict=True)]
