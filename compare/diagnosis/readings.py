"""Read a fit: find the fewest causes whose program has the numbers that the file shows.

Every combination of causes is a point in the space of `theta`. Its distance from the fitted point, weighed by how the
rows answer to each number, is the root mean square residual in m that it would have. The search keeps the best
combinations of one, two, … causes. A cause counts only if it lowers the residual by its cost, so that of two that
explain as much the one that contains the other loses.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import best_change, by_differences, gauss_newton
from .case import FileCase, first_least
from .causes import Cause
from .families import FamilyFit
from .programs import Program

ENOUGH = 5000  # combinations that are tried
BEAM = 20  # combinations that are kept of each size
ASIDE = 5  # and beside them, of those with the smallest residuals
MOST = 5  # causes at most
_MOST_NUMBERS = 3  # that are fitted at most
SAME = 3e-6  # relative distance of a fitted number from a named one that no accident brings about
PHASES = (0.02, 0.06, 0.2, 0.6)  # ωh of a first step, where the leading error shows none
BELOW = 0.3  # what a decade counts below the floor: of two explanations the closer one
NEWTON = 6  # steps that fit the free numbers of a combination
GAIN = 0.99  # of the residual before it: a step with a larger one is not taken
# causes that leave out the centrifugal force's change along the swing, or with it are one that does
WITHOUT_CHANGE = {"no_centrifugal", "effective_gravity", "no_tilt"}
SMALLEST = {
    "g": 1.0,
    "length": 1.0,
    "latitude": 10.0,
    "rate": 7e-5,
    "drag": 1e-5,
    "late": 1.0,
    "altitude": 100.0,
    "decay_rate": 1e-3,
    "phase_gain": 1e-3,
}


@dataclass(frozen=True)
class CauseReading:
    """A combination of causes.

    Attributes:
        causes: of different groups.
        program: the right one with them, fitted numbers in place.
        residual_rms_m: root mean square residual in m that it would have.
        score: less is better.
        reader: what the combination was compared by.
    """

    causes: tuple[Cause, ...]
    program: Program
    residual_rms_m: float
    score: float
    reader: Reader

    def value(self, cause: Cause) -> float:
        """Return the fitted number of a cause."""
        return float(getattr(self.program, cause.free))


@dataclass(frozen=True)
class Reader:
    """Compares combinations of causes with a fit.

    Attributes:
        right: what a right program computes with, with the family's kind.
        fit: the free fit of that family.
        floor: root mean square in m below which no error needs a cause.
        least: root mean square residual in m of the best fit of any family.
        joint: whether it is of several runs: then fits follow bent valleys, which in one run lead to numbers that are
            not there, and no name is put in place of a number, which may follow the scene.
    """

    right: Program
    fit: FamilyFit
    floor: float
    least: float
    joint: bool = False

    def readings(self, causes: Sequence[Cause], most: float = math.inf) -> list[CauseReading]:
        """Return the best combinations, the best first; none is looked for whose score is above `most` for certain."""
        without_cause = self._judged((), self.right)
        search = _CombinationSearch(self, causes, min(without_cause.score, most))
        best = [without_cause]
        beam = [without_cause]
        for _ in range(MOST):
            longer = search.longer(beam)
            best += longer[:BEAM]
            # of two mistakes as large as each other, neither lowers the residual by much: those that lower it at all
            others = sorted(longer[BEAM:], key=lambda reading: reading.residual_rms_m)
            beam = [*longer[:BEAM], *others[:ASIDE]]
            if not beam:
                break
        best = [self._with_named_sign(reading, causes) for reading in best]
        best.sort(key=lambda reading: reading.score)
        first = self._exchanged(best[0], causes)
        named = first if self.joint else self._exactly_named(first, causes)
        return [named, *(reading for reading in best if reading is not first)]

    def _exchanged(self, reading: CauseReading, causes: Sequence[Cause]) -> CauseReading:
        """Return the best reading that comes from one by leaving causes out, or taking others of their groups."""
        readings = [reading]
        for cause in reading.causes:
            fewer = self.without(reading, [cause])
            same_group = [
                other for other in causes if other.group == cause.group and other is not cause
            ]
            exchanged = [self.with_cause(fewer, other) for other in same_group]
            readings += [fewer, *filter(None, exchanged)]
        best = readings[first_least([10**other.score for other in readings])]
        return best if best is reading else self._exchanged(best, causes)

    def _with_named_sign(self, reading: CauseReading, causes: Sequence[Cause]) -> CauseReading:
        """Return a reading whose fitted rate turns the other way with a Coriolis force of the wrong sign in its place.

        That is the same motion: the centrifugal force has the square of the rate.
        """
        rates = [cause for cause in reading.causes if cause.free == "rate"]
        groups = {cause.group for cause in reading.causes}
        rate = reading.program.rate
        if not rates or rate * self.right.rate >= 0 or "coriolis" in groups:
            return reading
        sign = next(cause for cause in causes if cause.id == "coriolis_sign")
        together = (*reading.causes, sign)
        if abs(rate + self.right.rate) <= SAME * abs(rate):
            rate = -self.right.rate
            together = tuple(cause for cause in together if cause not in rates)
        return self._judged(together, sign.change(reading.program.changed(rate=-rate)))

    def _exactly_named(self, reading: CauseReading, causes: Sequence[Cause]) -> CauseReading:
        """Put a named cause in place of a fitted number that is as good as equal to its own: that is no accident."""
        for cause in reading.causes:
            if not cause.free or cause.stage == "integrator":
                continue
            named = self._named(reading, cause, causes)
            if named is not None:
                return named
        return reading

    def _named(
        self, reading: CauseReading, cause: Cause, causes: Sequence[Cause]
    ) -> CauseReading | None:
        """Return a reading with a named cause in place of one with a number; None if none has its number."""
        value = reading.value(cause)
        same = SAME * abs(value)
        for other in causes:
            if other.free or other.group != cause.group:
                continue
            program = other.change(reading.program)
            exact = float(getattr(program, cause.free))
            if exact != value and abs(exact - value) <= same:
                together = tuple(other if each is cause else each for each in reading.causes)
                return self._judged(together, program)
        return None

    def with_cause(self, reading: CauseReading, cause: Cause) -> CauseReading | None:
        """Return a reading with one more cause, its numbers fitted; None if no program can have it."""
        if _clash(reading.causes, cause):
            return None
        program = cause.change(reading.program)
        if not program.sensible:
            return None
        together = (*reading.causes, cause)
        free = [part.free for part in together if part.free]
        if not free:
            return self._judged(together, program)
        if len(free) > _MOST_NUMBERS:
            return None
        if program.method is not None and not program.step:
            program = self._with_first_step(reading.program, together, program)
        goal = np.zeros(len(self._triangle))
        fitted, _ = adjusted(
            program,
            free,
            self._off,
            goal,
            keeps_sign=False,
            steps=NEWTON,
            gain=GAIN,
            strays=self.joint,
        )
        return self._judged(together, fitted)

    def _with_first_step(
        self, before: Program, together: tuple[Cause, ...], program: Program
    ) -> Program:
        """Return a program with the likeliest of a few steps.

        Args:
            before: the program without its method.
            together: its causes.
            program: with a method that has no step yet.
        """
        assert program.method is not None
        theta = before.theta()
        omega = math.sqrt(abs(theta[5])) or 1.0
        square, drag = self._shown(before)
        steps = [
            program.method.first_step(-theta[5], square, theta[6], drag),
            *(phase / omega for phase in PHASES),
        ]
        tried = [self._judged(together, program.changed(step=step)) for step in steps if step > 0]
        return tried[first_least([reading.residual_rms_m for reading in tried])].program

    def _shown(self, program: Program) -> tuple[float, float]:
        """Return ω² and the drag that the rows ask of a program, its release free: other numbers may stand for them."""
        theta = program.theta()
        free = list(self.fit.free)
        columns = [free.index(i) for i in (5, 6, 9, 10) if i in free]
        change = best_change(self._triangle[:, columns], self._off(program))
        return -float(theta[5] + change[0]), float(theta[6] + change[1])

    def drifts(self, case: FileCase, program: Program) -> bool:
        """Return whether phase and amplitude drift beside a program, each by itself, as only an integrator does it."""
        columns = len(self.fit.slopes) // len(case.rows.times)
        weighted = case.residuals(program)[:, :columns] / math.sqrt(len(case.rows.times))
        residuals = weighted.ravel()

        def rms_with(*numbers: int) -> float:
            """Return the root mean square residual in m if some numbers of theta are fitted."""
            slopes = self.fit.slopes[: len(residuals), numbers]
            change = best_change(slopes, residuals)
            return float(np.linalg.norm(residuals - slopes @ change))

        pull = self.fit.free.index(5)
        drag = self.fit.free.index(6)
        enough = math.hypot(self.floor, self.fit.residual_rms_m)
        return rms_with(pull, drag) <= enough < min(rms_with(pull), rms_with(drag))

    def uncertainty(self, reading: CauseReading, cause: Cause, resolution: float) -> float:
        """Return by how much a fitted number may be off: the residual over how the rows answer to it.

        A residual below the resolution, in m, is rounding and says nothing.
        """
        nudge = _nudge(reading.program, cause.free)
        nudged = reading.program.changed(**{cause.free: reading.value(cause) + nudge})
        moved = self._off(nudged) - self._off(reading.program)
        answer = float(np.linalg.norm(moved)) / nudge
        return max(reading.residual_rms_m, resolution) / answer if answer else math.inf

    def _judged(self, together: tuple[Cause, ...], program: Program) -> CauseReading:
        distance_m = float(np.linalg.norm(self._off(program)))
        residual_rms_m = math.inf
        if math.isfinite(distance_m):
            residual_rms_m = math.hypot(distance_m, self.fit.residual_rms_m)
        return self.scored(together, program, residual_rms_m)

    def without(self, reading: CauseReading, causes: Sequence[Cause]) -> CauseReading:
        """Return a reading without some of its causes, the other fitted numbers as they were."""
        program = self.right
        together = tuple(cause for cause in reading.causes if cause not in causes)
        for cause in together:
            program = cause.change(program)
            if cause.free:
                program = program.changed(**{cause.free: reading.value(cause)})
        return self._judged(together, program)

    def scored(
        self, together: tuple[Cause, ...], program: Program, residual_rms_m: float
    ) -> CauseReading:
        """Return a combination with its root mean square residual in m and its score."""
        low = max(1.2 * self.least, 1e-3 * self.floor)
        score = math.inf
        if math.isfinite(residual_rms_m):
            above = math.log10(max(residual_rms_m, self.floor) / self.floor)
            below = math.log10(max(residual_rms_m, low) / low)
            score = above + BELOW * below
        score += sum(cause.cost for cause in together)
        return CauseReading(together, program, residual_rms_m, score, self)

    def _off(self, program: Program) -> Array:
        """Return the vector whose length is the root mean square, in m, between a program and the fit."""
        change = self.fit.theta - program.theta()
        return np.asarray(self._triangle @ change[list(self.fit.free)])

    @cached_property
    def _triangle(self) -> Array:
        """The slopes with as many rows as there are numbers: products with it are as long as with them."""
        slopes = self.fit.slopes
        return np.asarray(np.linalg.qr(slopes, mode="r")) if np.isfinite(slopes).all() else slopes


@dataclass
class _CombinationSearch:
    """A search for combinations of causes.

    Attributes:
        reader: compares them with a fit.
        causes: that are combined.
        least: the least score so far.
        tried: number of combinations that were tried.
        seen: the combinations that were tried.
    """

    reader: Reader
    causes: Sequence[Cause]
    least: float
    tried: int = 0
    seen: set[frozenset[int]] = field(default_factory=set)

    def longer(self, beam: Sequence[CauseReading]) -> list[CauseReading]:
        """Return the readings with one more cause than those of a beam, the best first."""
        readings = []
        for reading in beam:
            for cause in self.causes:
                if not self._may_be_better(reading, cause):
                    continue
                self.tried += 1
                if self.tried > ENOUGH:
                    break
                # whose first step depends on the program before it
                if cause.stage != "integrator":
                    self.seen.add(_key(reading, cause))
                extended = self.reader.with_cause(reading, cause)
                if extended is not None:
                    readings.append(extended)
                    self.least = min(self.least, extended.score)
        return sorted(readings, key=lambda reading: reading.score)

    def _may_be_better(self, reading: CauseReading, cause: Cause) -> bool:
        """Return whether a reading with one more cause is new, and may have a score below the least so far."""
        if any(part.group == cause.group for part in reading.causes):
            return False
        cost = self._bound + sum(part.cost for part in reading.causes)
        return cost + cause.cost <= self.least and _key(reading, cause) not in self.seen

    @cached_property
    def _bound(self) -> float:
        """The score of no cause with the residual of the fit: no combination has a smaller one."""
        return self.reader.scored((), self.reader.right, self.reader.fit.residual_rms_m).score


def _key(reading: CauseReading, cause: Cause) -> frozenset[int]:
    """Return what a combination is known by, whatever the order of its causes."""
    return frozenset((*map(id, reading.causes), id(cause)))


def adjusted(
    program: Program,
    names: Sequence[str],
    rows_of: Callable[[Program], Array],
    goal: Array,
    keeps_sign: bool = True,
    **options: Any,
) -> tuple[Program, float]:
    """Return a program, some of its numbers moved to where the rows it makes come nearest to a goal, and the distance.

    Unless `keeps_sign` is False, its Earth does not begin to turn the other way: that is a cause of its own.
    Further arguments are those of `gauss_newton`.
    """

    def rows_with(values: Array) -> Array:
        moved = program.with_inputs(names, values)
        same_way = moved.rate * program.rate >= 0
        is_allowed = moved.sensible and (same_way or not keeps_sign)
        return (rows_of(moved) if is_allowed else np.full_like(goal, np.nan)).ravel()

    start = np.array([float(getattr(program, name)) for name in names])
    nudges = np.array([_nudge(program, name) for name in names])
    model = by_differences(rows_with, goal.ravel(), nudges)
    values, distance = gauss_newton(model, start, **options)
    return program.with_inputs(names, values), distance


def _nudge(program: Program, name: str) -> float:
    """Return a change of a number that is small for it."""
    return 1e-6 * max(abs(float(getattr(program, name))), SMALLEST.get(name, 1e-3))


def _clash(together: tuple[Cause, ...], cause: Cause) -> bool:
    """Return whether a cause would undo another: without rotation there is no Coriolis force to be wrong."""
    every = (*together, cause)
    cause_ids = {part.id for part in every}
    groups = {part.group for part in every}
    if "no_rotation" in cause_ids:
        return bool(groups & {"latitude", "frame", "coriolis", "turn"})
    if "uniform_gravity" in cause_ids and cause_ids & WITHOUT_CHANGE:
        return True
    # of a turn alone, the rate at any latitude is as good
    if {"pole", "site.rotation_rate"} <= cause_ids:
        return True
    return "no_coriolis" in cause_ids and bool(groups & {"frame", "turn"})
