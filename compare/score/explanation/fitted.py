"""Find the best reading of a file among the families that fit it, and the explanation that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array

from ...observed.least_squares import by_differences, gauss_newton
from .causes import Cause, causes
from .families import Family, families_of, positions_of
from .findings import Explanation, SizedCause
from .naming import CLEAN, LOOSE, WIDE, in_whole_steps, model_of, sized, told_as_loose, trifling
from .pendulum import Pendulum
from .programs import Program
from .readings import Reader, Reading
from .rows import Rows, largest, rms

HARMLESS = ("z_constant", "decimals", "digits", "single_precision")  # conventions that a model may go with
TRIED = 6  # readings of a family that are run
POLISHED = 3  # steps by which fitted numbers are moved
BETTER = 0.9  # of what was left, for a step that is taken
EXACT = 1e-14  # of the cord: two numbers that differ by less are one
EXTRA = {"sphere": 0.0, "linear": 0.3, "angle": 0.6}  # decades by which a simpler family has to be better
CONVENTION = 0.3  # decades that a convention has to explain
NAMED_SHARE = 0.03  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number


@dataclass(frozen=True)
class Case:
    """A file that is to be explained.

    Attributes:
        rows: of the file, conventions put right.
        truth: the positions of the full model at their times in m, shape (rows, 2 or 3).
        right: what a right program computes with.
        pendulum: runs a program.
        frequency: of the scene's swing in rad/s.
        allowed_m: distance in m that counts as agreement.
    """

    rows: Rows
    truth: Array
    right: Program
    pendulum: Pendulum
    frequency: float
    allowed_m: float

    @property
    def error(self) -> float:
        """Root mean square error of the rows in m."""
        return rms(self.rows.positions - self.truth)

    @property
    def floor(self) -> float:
        """Root mean square in m below which nothing is asked."""
        return max(self.rows.noise, self.allowed_m / 3)

    @property
    def enough(self) -> float:
        """Largest error in m that may be left."""
        return max(self.allowed_m, 1.5 * self.rows.noise)

    def score_of(self, left: float) -> float:
        """Return decades by which what is left exceeds the tolerance, plus what the conventions cost."""
        return math.log10(max(left / self.allowed_m, 1e-2)) + CONVENTION * len(self.rows.conventions)

    def causes(self, kind: str) -> list[Cause]:
        """Return the causes that its program may have as a member of a family."""
        rows, right = self.rows, self.right
        off = np.abs(rows.positions[0, :2] - (right.x, right.y)).max()
        released = rows.times[0] == 0 and off <= 2 * rows.noise + EXACT * right.length
        return list(causes(right, kind, rows.cord, bool(released)))


@dataclass(frozen=True)
class Best:
    """The best reading of a case: its family, and what holds readings against that family's fit."""

    family: Family
    reader: Reader
    reading: Reading


def best_of(case: Case, integrators: bool = True, sure: bool = True) -> Best | None:
    """Return the best reading of all families; None if it leaves too much for anything to be named.

    Args:
        case: the file.
        integrators: whether an integrator may be among the causes.
        sure: whether it has to leave little enough for its causes to be named.
    """
    rows, right, pendulum = case.rows, case.right, case.pendulum
    families = list(families_of(rows, right, pendulum, case.frequency, case.floor))
    least = min((family.fit.rest for family in families), default=math.inf)
    if sure and least > max(NAMED_SHARE * case.error, 1.5 * rows.noise):
        return None
    floor = max(case.floor, 1.2 * least)
    best: Best | None = None
    lowest = math.inf
    for family in families:
        if family.fit.rest > 3 * max(least, floor / 1.2):
            continue
        reader = Reader(replace(right, kind=family.kind), family.fit, floor)
        known = [cause for cause in case.causes(family.kind) if integrators or cause.stage != "integrator"]
        likely = reader.readings(known)[:TRIED]
        likely += [reader.without(one, cause) for one in likely[:2] for cause in one.causes]
        for one in likely:  # the distance from the fit is linear in theta: what counts is the program itself
            leaves = rms(rows.positions - positions_of(one.program, pendulum, rows))
            if math.isfinite(leaves):
                run = reader.scored(one.causes, one.program, leaves)
                if run.score + EXTRA[family.kind] < lowest:
                    best, lowest = Best(family, reader, run), run.score + EXTRA[family.kind]
    if best is not None:
        best = replace(best, reading=_polished(case, best))
    if best is None or not sure:
        return best
    share = FITTED_SHARE if any(cause.free for cause in best.reading.causes) else NAMED_SHARE
    return best if best.reading.rest <= max(share * case.error, 1.5 * rows.noise) else None


def _polished(case: Case, best: Best) -> Reading:
    """Return the best reading with its fitted numbers moved to where its program, run, leaves least.

    The numbers of a reading are linear in those of the fit, which a number that is far off is not.
    """
    reading, positions = best.reading, case.rows.positions
    names = [cause.free for cause in reading.causes if cause.free]
    if not names:
        return reading

    def rows_of(values: Array) -> Array:
        program = reading.program.with_inputs(names, values)
        found = positions_of(program, case.pendulum, case.rows) if program.sensible else np.full_like(positions, np.nan)
        return found.ravel()

    start = np.array([float(getattr(reading.program, name)) for name in names])
    nudges = np.array([best.reader.nudge(reading.program, name) for name in names])
    model = by_differences(rows_of, positions.ravel(), nudges)
    values, size = gauss_newton(model, start, steps=POLISHED, gain=BETTER)
    if (values == start).all():
        return reading
    program = reading.program.with_inputs(names, values)
    return best.reader.scored(reading.causes, program, size / math.sqrt(len(positions)))


def explanation_of(case: Case, best: Best) -> Explanation:
    """Return the explanation that the best reading of a case makes up."""
    rows, right = case.rows, case.right
    reading = _without_needless_step(case, best.reading)
    named = list(sized(reading, best.reader, right, case.pendulum, rows, case.truth))
    left = rows.positions - positions_of(reading.program, case.pendulum, rows)
    corrected = largest(left)
    kind = best.family.kind
    width = float(np.hypot(*rows.positions[:, :2].T).max()) / right.length if kind == "sphere" else 0.0
    clean = max(CLEAN, WIDE * width**2, WIDE * CLEAN if width else 0.0)
    named = list(in_whole_steps(named, float(rows.times[1] - rows.times[0]), clean))
    named = [
        cause
        for cause in told_as_loose(named, max(corrected - 5 * rows.noise, 0.0), case.frequency, clean)
        if len(named) == 1 or not trifling(cause, case.allowed_m)
    ]
    more = corrected > case.allowed_m and reading.rest > 2 * max(rows.noise, best.family.fit.rest)
    if more and best.reader.like_a_step(reading, case.causes(kind)):
        named.append(SizedCause("integrator_loose", LOOSE, corrected, "integrator"))
    result = None
    simple = {cause.stage for cause in named} <= {"gravity", "model"}
    if simple and corrected <= case.allowed_m and all(one.id in HARMLESS for one in rows.conventions):
        result = model_of(kind, named, corrected, largest(rows.positions - case.truth))
    explained = 1 - rms(left) / case.error
    score = case.score_of(corrected) + sum(cause.cost for cause in reading.causes)
    return Explanation(rows.conventions, tuple(named), result, corrected, explained=explained, score=score)


def _without_needless_step(case: Case, reading: Reading) -> Reading:
    """Return a reading without its integrator where what is left without it is within the tolerance."""
    bare = replace(reading.program, method=None, step=0.0)
    if reading.program.method is None:
        return reading
    left = case.rows.positions - positions_of(bare, case.pendulum, case.rows)
    if not largest(left) <= case.allowed_m:
        return reading
    others = tuple(cause for cause in reading.causes if cause.stage != "integrator")
    return replace(reading, causes=others, program=bare, rest=rms(left))
