"""A proposed explanation that was run, and what the tests of a claim measure of it.

Causes of a program are one kind of explanation; other modules have further kinds.

A `Claim` knows its residuals, and answers what each test asks. `claims.py` decides by the answers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reference.numbers.precision import Array

from .case import FileCase, largest, rms
from .causes import DRIFT, LIKE_A_DRIFT, SAME_MOTIONS, Cause, is_like_a_drift, shortest_decimal
from .fitted import MODELS, adjusted_to, polished
from .readings import CauseReading
from .thresholds import (
    CATALOGUE,
    CHANCE,
    FACTOR_DIGITS,
    FIRST_PART,
    MOST_DIGITS,
    NEEDED,
    RIVAL,
    ROWS_A_NUMBER,
)


def has_few_digits(value: float, doubt: float, most: int = MOST_DIGITS) -> bool:
    """Return whether a number is round: it has as few digits as a number that a person types.

    Its shortest decimal within a doubt must be no accident. A fitted number that is not round is *arbitrary*.
    """
    doubt = max(doubt, 2.0**-50 * abs(value))
    if abs(value) <= doubt:
        return True
    _, digits = shortest_decimal(value, doubt)
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    return digits <= most and 2 * doubt < CHANCE * unit


@dataclass(frozen=True, eq=False)
class Claim:
    """A proposed explanation that was run. This one has no fitted number.

    Attributes:
        case: the file.
        residuals: the rows less its own in m, shape (rows, 2 or 3).
    """

    case: FileCase
    residuals: Array

    @property
    def residual_rms_m(self) -> float:
        """Root mean square of the residuals in m, at least the resolution: below it, residuals are rounding."""
        size = rms(self.residuals)
        return max(size, self.case.resolution) if math.isfinite(size) else math.inf

    @property
    def largest_m(self) -> float:
        """Largest residual in m."""
        size = largest(self.residuals)
        return size if math.isfinite(size) else math.inf

    @property
    def explains(self) -> bool:
        """Whether the residual is within the tolerance, or within the rounding of the file."""
        return self.largest_m <= self.case.enough

    @property
    def is_exact(self) -> bool:
        """Whether the residual is rounding, as that of a formula, or of the steps of the right method, is.

        It may be NEEDED times the resolution. A `Hypothesis` with arbitrary numbers has a stricter limit.
        """
        return self.residual_rms_m <= NEEDED * self.case.resolution

    @property
    def leaves_little(self) -> bool:
        """Whether it explains the rows, or the residual, which is stated then, is a small part of their error."""
        return self.explains or NEEDED**2 * rms(self.residuals) <= self.case.error

    @property
    def is_harmless(self) -> bool:
        """Whether the residual of each column is at most a few times the file's own error there."""
        errors = np.abs(self.case.rows.positions - self.case.truth).max(axis=0)
        own = np.maximum(errors, self.case.resolution)
        return bool((np.abs(self.residuals).max(axis=0) <= RIVAL * own).all())

    @property
    def free_numbers(self) -> int:
        """How many numbers were fitted."""
        return 0

    def foreseen(self, count: int) -> Array:
        """Return the residuals in m if the numbers are fitted to the first `count` rows, shape as `residuals`."""
        return self.residuals

    def predicts(self) -> bool:
        """Return whether its numbers, fitted to the first rows, predict the others as well as if fitted to all."""
        times = self.case.rows.times
        count = int(np.searchsorted(times, times[0] + FIRST_PART * (times[-1] - times[0])))
        if not self.free_numbers or not 0 < count < len(times):
            return True
        later_m = rms(self.foreseen(count)[count:])
        return later_m <= RIVAL * max(rms(self.residuals[count:]), self.case.resolution)

    def enough_rows(self) -> bool:
        """Return whether the rows are enough to determine its numbers, and last for a swing."""
        if not self.free_numbers:
            return True
        rows = self.case.rows
        swing_s = 2 * math.pi / self.case.frequency if self.case.frequency else 0.0
        lasts = float(rows.times[-1]) >= swing_s
        return lasts and len(rows.times) >= ROWS_A_NUMBER * self.free_numbers

    @property
    def is_sound(self) -> bool:
        """Whether its numbers are certain: it predicts, and has enough rows."""
        return self.enough_rows() and self.predicts()


@dataclass(frozen=True, eq=False)
class Hypothesis(Claim):
    """A combination of causes whose program was run.

    Attributes:
        reading: the causes and their program.
    """

    reading: CauseReading

    @classmethod
    def of(cls, case: FileCase, reading: CauseReading) -> Hypothesis:
        """Return the hypothesis of a reading, its program run."""
        return cls(case, case.residuals(reading.program), reading)

    @property
    def cause_ids(self) -> frozenset[str]:
        """The ids of its causes, and of its model."""
        cause_ids = {cause.id for cause in self.reading.causes}
        if self.reading.program.kind != "sphere":
            cause_ids.add(MODELS[self.reading.program.kind][0])
        return frozenset(cause_ids)

    @property
    def numbers(self) -> list[Cause]:
        """The causes with a fitted number that the rows do not show by themselves."""
        return [cause for cause in self.reading.causes if cause.free and not self._shown(cause)]

    @property
    def arbitrary(self) -> list[Cause]:
        """The causes with an arbitrary number, a step error of unknown method aside.

        Beside an arbitrary input, a rate that is round only as a factor is arbitrary too.
        """
        candidates = [cause for cause in self.numbers if cause not in DRIFT]
        arbitrary = [cause for cause in candidates if not self._is_round(cause)]
        if all(cause.stage == "integrator" for cause in arbitrary):
            return arbitrary
        return [cause for cause in candidates if cause in arbitrary or self._is_factor(cause)]

    @property
    def arbitrary_inputs(self) -> list[Cause]:
        """The causes with an arbitrary number that are no step."""
        return [cause for cause in self.arbitrary if cause.stage != "integrator"]

    @property
    def drifts(self) -> bool:
        """Whether a step error of unknown method is among its causes."""
        return DRIFT[0] in self.reading.causes

    @cached_property
    def undrifted(self) -> Hypothesis:
        """The hypothesis without its step error of unknown method, nothing fitted again.

        Its residual shows how much of the motion its other causes explain by themselves.
        """
        reading = self.reading.reader.without(self.reading, DRIFT)
        return Hypothesis.of(self.case, reading)

    @property
    def is_drift_in_disguise(self) -> bool:
        """Whether two arbitrary numbers, or one and a step, only imitate a drift of phase and amplitude.

        If a program had two such numbers, its residual would be rounding; that of an imitated drift is larger.
        """
        if self.is_exact:
            return False
        alike = [cause for cause in self.arbitrary if cause.id in LIKE_A_DRIFT]
        steps = [cause for cause in self.numbers if cause.stage == "integrator"]
        return not self.drifts and len(alike) + len(steps) > 1

    @property
    def price(self) -> int:
        """One for each change, named model, or round number; two for an arbitrary number, and for a factor."""
        has_model = self.reading.program.kind != "sphere"
        price = len(self.reading.causes) + has_model
        for cause in self.numbers:
            # another sign is a change of its own
            price += self._is_dear(cause) + self._has_other_sign(cause)
        return price

    def _has_other_sign(self, cause: Cause) -> bool:
        """Return whether the number of an input has another sign than the scene's, and no other cause says so."""
        if cause.stage == "integrator" or "hemisphere" in self.cause_ids:
            return False
        scene = float(getattr(self.case.right, cause.free))
        return self.reading.value(cause) * scene < 0

    def _is_dear(self, cause: Cause) -> bool:
        """Return whether a number costs one more than a change; a step does not on the sphere, where it is rough."""
        if cause in DRIFT:
            return True
        if cause.stage == "integrator" and self.reading.program.kind == "sphere":
            return False
        return not self._is_round(cause, factors=False)

    def _shown(self, cause: Cause) -> bool:
        """Return whether row 0 has the number itself: the place of the release, unless rows are late."""
        rows = self.case.rows
        is_place = cause.id in ("release.x", "release.y") and "late" not in self.cause_ids
        return is_place and rows.starts and bool(rows.times[0] == 0)

    def _is_round(self, cause: Cause, factors: bool = True) -> bool:
        """Return whether the number of a cause is round; of a step, whether it divides the spacing of the rows.

        If `factors`, a rate is round as well if its factor is: its ratio to the scene's.
        """
        value = self.reading.value(cause)
        doubt = self.reading.reader.uncertainty(self.reading, cause, self.case.resolution)
        if cause.stage == "integrator":
            # on the sphere what a step does is known roughly, and so is the step
            return self.reading.program.kind != "sphere" and self._divides(value, doubt)
        if cause.id in LIKE_A_DRIFT and self.steps_roughly:
            return False
        return has_few_digits(value, doubt) or (factors and self._is_factor(cause))

    def _is_factor(self, cause: Cause) -> bool:
        """Return whether a number is the scene's rate times a round factor."""
        if cause.free != "rate":
            return False
        doubt = self.reading.reader.uncertainty(self.reading, cause, self.case.resolution)
        scene = self.case.right.rate
        factor = self.reading.value(cause) / scene
        return has_few_digits(factor, doubt / abs(scene), FACTOR_DIGITS)

    @property
    def without_steps(self) -> Hypothesis:
        """The hypothesis without its integrator, everything else fitted again."""
        steps = [cause for cause in self.reading.causes if cause.stage == "integrator"]
        return self.refitted(self.reading.reader.without(self.reading, steps))

    @property
    def steps_roughly(self) -> bool:
        """Whether the residual beside a step is more than rounding; the numbers that are like a drift absorb a part."""
        stepped = any(cause.stage == "integrator" for cause in self.reading.causes)
        return stepped and self.residual_rms_m > NEEDED * self.case.resolution

    def _divides(self, step: float, doubt: float) -> bool:
        """Return whether a step may go into the spacing of the rows a whole number of times."""
        if not step > 0:
            return False
        count = float(np.ptp(self.case.rows.times[:2])) / step
        doubt_of_count = doubt * count / step
        off = abs(count - round(count))
        return round(count) > 0 and off <= max(RIVAL * doubt_of_count, CHANCE)

    def refitted(self, reading: CauseReading) -> Hypothesis:
        """Return the hypothesis of another reading, its numbers fitted to the same rows."""
        return Hypothesis.of(self.case, polished(self.case, reading))

    def has_number(self, rival: Hypothesis, cause: Cause) -> bool:
        """Return whether its program has a number of a rival, within the rival's uncertainty, by another cause."""
        if cause in self.reading.causes or cause.stage == "integrator":
            return False
        doubt = rival.reading.reader.uncertainty(rival.reading, cause, self.case.resolution)
        mine = float(getattr(self.reading.program, cause.free))
        return abs(rival.reading.value(cause) - mine) <= RIVAL * doubt

    def without(self, cause_id: str) -> Hypothesis:
        """Return the hypothesis without a cause, or without its model, everything else fitted again."""
        return self.refitted(self.left_out(cause_id).reading)

    def left_out(self, cause_id: str) -> Hypothesis:
        """Return the hypothesis without a cause, or without its model, its numbers as they are."""
        reading = self.reading
        kind = reading.program.kind
        causes = [cause for cause in reading.causes if cause.id == cause_id]
        fewer = reading.reader.without(reading, causes)
        if not causes:  # the id is that of the model
            kind = "sphere"
        fewer = replace(fewer, program=fewer.program.changed(kind=kind))
        return Hypothesis.of(self.case, fewer)

    def takes_from(self, other: Hypothesis) -> bool:
        """Return whether the drift beside its causes is far smaller than the one beside another's: no accident."""
        if not (self.drifts and other.drifts):
            return False
        if self.residual_rms_m > RIVAL * other.residual_rms_m:
            return False
        # a, b: the residual with these causes, and with others.
        # CATALOGUE causes, each as good by accident with probability about a/b: together less likely than CHANCE
        return CATALOGUE * self.undrifted.residual_rms_m < CHANCE * other.undrifted.residual_rms_m

    def growth_without(self, cause_id: str) -> float:
        """Return the factor by which the residual grows without a cause, everything else fitted again."""
        without = self.without(cause_id)
        if self.takes_from(without):
            return without.undrifted.residual_rms_m / self.undrifted.residual_rms_m
        return without.residual_rms_m / self.residual_rms_m

    def is_worth_saying(self, cause_id: str) -> bool:
        """Return whether the residual without a cause exceeds the tolerance, or a drift would take its place.

        The other numbers are fitted again only if one is arbitrary, or beside a step error of unknown method.
        """
        fitted_again = bool(self.arbitrary) or self.drifts
        without = self.without(cause_id) if fitted_again else self.left_out(cause_id)
        return without.largest_m > self.case.allowed_m or self.takes_from(without)

    def is_no_accident(self) -> bool:
        """Return whether hardly any of all known causes would explain the rows as well in place of one of its own.

        Then its residual, within the tolerance, is a program's own error, which an arbitrary number would absorb too.
        """
        if self.arbitrary or not self.explains:
            return False
        without_each = [self.without(cause_id) for cause_id in self.cause_ids]
        least = min((hypothesis.residual_rms_m for hypothesis in without_each), default=0.0)
        # a, b: the residual with these causes, and with others.
        # CATALOGUE causes, each as good by accident with probability about a/b: together less likely than CHANCE
        return CATALOGUE * self.residual_rms_m < CHANCE * least

    @property
    def is_exact(self) -> bool:
        """Whether the residual is rounding.

        With arbitrary numbers it may not exceed the resolution: they absorb the residual of a wrong method.
        """
        most = 1.0 if self.arbitrary else NEEDED
        return self.residual_rms_m <= most * self.case.resolution

    @property
    def free_numbers(self) -> int:
        """How many numbers were fitted that the rows do not show by themselves."""
        return len(self.numbers)

    @property
    def is_sound(self) -> bool:
        """Whether its numbers are certain; not if its swing is too fast for other models to be run beside it."""
        return super().is_sound and not self.case.pendulum.is_too_fast(self.reading.program.theta())

    def foreseen(self, count: int) -> Array:
        """Return the residuals in m if the numbers are fitted to the first `count` rows."""
        names = [cause.free for cause in self.numbers]
        program = adjusted_to(self.case.part(count), self.reading.program, names)
        return self.case.residuals(program)


def simplest(hypotheses: Sequence[Hypothesis]) -> Hypothesis:
    """Return the cheapest hypothesis, unless a dearer one has a far smaller residual.

    Those that explain the rows come first.
    """
    enough = [one for one in hypotheses if one.explains] or hypotheses
    best, *dearer = sorted(
        enough, key=lambda one: (one.price, len(one.numbers), one.residual_rms_m)
    )
    for one in dearer:
        less = RIVAL if one.price == best.price else NEEDED
        better = less * one.residual_rms_m <= best.residual_rms_m or one.takes_from(best)
        if better and not (one.arbitrary and best.is_no_accident()):
            best = one
    return best


def without_needless(best: Hypothesis) -> Hypothesis:
    """Return a hypothesis without the causes without which the residual is about as small."""
    while best.cause_ids:
        growths = {cause_id: best.growth_without(cause_id) for cause_id in sorted(best.cause_ids)}
        least_needed = min(growths, key=lambda cause_id: growths[cause_id])
        if growths[least_needed] >= RIVAL:
            break
        best = best.without(least_needed)
    return best


def worth_saying(best: Hypothesis) -> tuple[Hypothesis, dict[str, float]]:
    """Return a hypothesis without causes within the tolerance, and the residual's growth without each other cause."""
    while best.cause_ids:
        slight = [
            cause_id for cause_id in sorted(best.cause_ids) if not best.is_worth_saying(cause_id)
        ]
        if not slight:
            return best, {cause_id: best.growth_without(cause_id) for cause_id in best.cause_ids}
        best = min(map(best.without, slight), key=lambda one: one.largest_m)
    return best, {}


def rivals_of(best: Hypothesis, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return the other hypotheses that cost no more, and whose residual is at most a few times as large.

    If the best one has arbitrary inputs, it is enough that one without arbitrary numbers explains the rows.
    """
    rivals: dict[frozenset[str], Hypothesis] = {}
    for hypothesis in hypotheses:
        if _is_rival(best, hypothesis):
            rivals.setdefault(hypothesis.cause_ids, hypothesis)
    # round numbers beat arbitrary ones
    if any(rival.arbitrary for rival in rivals.values()) and best.is_no_accident():
        return [rival for rival in rivals.values() if not rival.arbitrary]
    return list(rivals.values())


def _is_rival(best: Hypothesis, other: Hypothesis) -> bool:
    """Return whether another hypothesis costs no more than the best one, and does about as well by other causes."""
    # one contains the other
    if other.cause_ids >= best.cause_ids or other.cause_ids < best.cause_ids:
        return False
    explains_without_arbitrary = best.arbitrary_inputs and not other.arbitrary and other.explains
    explains_as_well = explains_without_arbitrary or _is_alike_without_steps(best, other)
    if not explains_as_well and other.residual_rms_m > RIVAL * best.residual_rms_m:
        return False
    if best.takes_from(other):
        return False
    if any(best.has_number(other, cause) for cause in other.numbers):
        return False
    # what is the same motion as a step error is a rival of it at any price
    is_same_motion = all(map(is_like_a_drift, other.cause_ids ^ best.cause_ids))
    # where not even the best one explains the rows, what is cheaper is not more likely
    return is_same_motion or not best.explains or other.price <= best.price


def _is_alike_without_steps(best: Hypothesis, other: Hypothesis) -> bool:
    """Return whether two hypotheses are the same motion in principle, which steps that are known roughly do not tell.

    Then their residuals without the steps are about as large.
    """
    if not (best.steps_roughly and other.steps_roughly):
        return False
    mine = best.cause_ids - other.cause_ids
    others = other.cause_ids - best.cause_ids
    if (mine, others) not in SAME_MOTIONS:
        return False
    return other.without_steps.residual_rms_m <= RIVAL * best.without_steps.residual_rms_m
