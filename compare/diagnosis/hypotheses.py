"""A proposed explanation that was run, and what the tests of a claim measure of it.

Causes of a program are one kind of explanation; other modules have further kinds.

A `Claim` knows what it leaves of the rows, and answers what each test asks. `claims.py` decides by the answers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reference.numbers.precision import Array

from .case import FileCase, largest, rms
from .causes import DRIFT, LIKE_A_DRIFT, Cause, is_like_a_drift, shortest_decimal
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
    """Return whether a person may have typed a number, since its shortest decimal within a doubt is no accident."""
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
        left: what it leaves in m, shape (rows, 2 or 3).
    """

    case: FileCase
    left: Array

    @property
    def rest(self) -> float:
        """Root mean square of the residual in m; residuals below rounding count as equal."""
        size = rms(self.left)
        return max(size, self.case.resolution) if math.isfinite(size) else math.inf

    @property
    def largest_m(self) -> float:
        """Largest residual in m."""
        size = largest(self.left)
        return size if math.isfinite(size) else math.inf

    @property
    def explains(self) -> bool:
        """Whether the residual is within the tolerance, or within the rounding of the file."""
        return self.largest_m <= self.case.enough

    @property
    def is_exact(self) -> bool:
        """Whether what it leaves is rounding: as a formula, or the steps of the right method, leave it."""
        return self.rest <= NEEDED * self.case.resolution

    @property
    def leaves_little(self) -> bool:
        """Whether it explains the rows, or what it leaves, which is stated then, is a small part of their error."""
        return self.explains or NEEDED**2 * rms(self.left) <= self.case.error

    @property
    def is_harmless(self) -> bool:
        """Whether the residual of each column is at most a few times the file's own error there."""
        errors = np.abs(self.case.rows.positions - self.case.truth).max(axis=0)
        own = np.maximum(errors, self.case.resolution)
        return bool((np.abs(self.left).max(axis=0) <= RIVAL * own).all())

    @property
    def free_numbers(self) -> int:
        """How many numbers were fitted."""
        return 0

    def foreseen(self, count: int) -> Array:
        """Return the residual in m if the numbers are fitted to the first `count` rows, shape as `left`."""
        return self.left

    def predicts(self) -> bool:
        """Return whether its numbers, fitted to the first rows, meet the others as well as all do."""
        times = self.case.rows.times
        count = int(np.searchsorted(times, times[0] + FIRST_PART * (times[-1] - times[0])))
        if not self.free_numbers or not 0 < count < len(times):
            return True
        later_m = rms(self.foreseen(count)[count:])
        return later_m <= RIVAL * max(rms(self.left[count:]), self.case.resolution)

    def enough_rows(self) -> bool:
        """Return whether the rows are as many as can say anything of its numbers, and last for a swing."""
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
        return cls(case, case.left(reading.program), reading)

    @property
    def words(self) -> frozenset[str]:
        """The ids of its causes, and of its model."""
        words = {cause.id for cause in self.reading.causes}
        if self.reading.program.kind != "sphere":
            words.add(MODELS[self.reading.program.kind][0])
        return frozenset(words)

    @property
    def numbers(self) -> list[Cause]:
        """The causes with a fitted number that the rows do not show by themselves."""
        return [cause for cause in self.reading.causes if cause.free and not self._shown(cause)]

    @property
    def untyped(self) -> list[Cause]:
        """Those whose number nobody typed; beside such an input, a rate that is typed as a factor alone is one too."""
        inputs = [cause for cause in self.numbers if cause not in DRIFT]
        untyped = [cause for cause in inputs if not self._is_typed(cause)]
        if all(cause.stage == "integrator" for cause in untyped):
            return untyped
        return [cause for cause in inputs if cause in untyped or self._is_factor(cause)]

    @property
    def untyped_inputs(self) -> list[Cause]:
        """Those of them that are no step."""
        return [cause for cause in self.untyped if cause.stage != "integrator"]

    @property
    def drifts(self) -> bool:
        """Whether an integrator's error is among its causes that has no name."""
        return DRIFT[0] in self.reading.causes

    @cached_property
    def undrifted(self) -> Hypothesis:
        """The hypothesis without that error, nothing fitted again."""
        reading = self.reading.reader.without(self.reading, DRIFT)
        return Hypothesis.of(self.case, reading)

    @property
    def names_no_step(self) -> bool:
        """Whether two of its numbers that nobody typed, or a step and one of them, are a drift by other names.

        Two numbers of a right program leave rounding; what a solver does leaves more.
        """
        if self.is_exact:
            return False
        alike = [cause for cause in self.untyped if cause.id in LIKE_A_DRIFT]
        steps = [cause for cause in self.numbers if cause.stage == "integrator"]
        return not self.drifts and len(alike) + len(steps) > 1

    @property
    def price(self) -> int:
        """One for each change, named model, or number of few digits; two for any other number, and for a factor."""
        has_model = self.reading.program.kind != "sphere"
        price = len(self.reading.causes) + has_model
        for cause in self.numbers:
            # another sign is a change of its own
            price += self._is_dear(cause) + self._has_other_sign(cause)
        return price

    def _has_other_sign(self, cause: Cause) -> bool:
        """Return whether the number of an input has another sign than the scene's, and no other cause says so."""
        if cause.stage == "integrator" or "hemisphere" in self.words:
            return False
        scene = float(getattr(self.case.right, cause.free))
        return self.reading.value(cause) * scene < 0

    def _is_dear(self, cause: Cause) -> bool:
        """Return whether a number costs one more than a change; a step does not on the sphere, where it is rough."""
        if cause in DRIFT:
            return True
        if cause.stage == "integrator" and self.reading.program.kind == "sphere":
            return False
        return not self._is_typed(cause, factors=False)

    def _shown(self, cause: Cause) -> bool:
        """Return whether row 0 has the number itself: the place of the release."""
        rows = self.case.rows
        return cause.id in ("release.x", "release.y") and rows.starts and rows.times[0] == 0

    def _is_typed(self, cause: Cause, factors: bool = True) -> bool:
        """Return whether a person may have typed a number, or the factor by which a rate differs from the scene's."""
        value = self.reading.value(cause)
        doubt = self.reading.reader.uncertainty(self.reading, cause, self.case.resolution)
        if cause.stage == "integrator":
            # on the sphere what a step does is known roughly, and so is the step
            return self.reading.program.kind != "sphere" and self._divides(value, doubt)
        if cause.id in LIKE_A_DRIFT and self._steps_roughly:
            return False
        return has_few_digits(value, doubt) or (factors and self._is_factor(cause))

    def _is_factor(self, cause: Cause) -> bool:
        """Return whether a number is the scene's rate times a factor that a person may have typed."""
        if cause.free != "rate":
            return False
        doubt = self.reading.reader.uncertainty(self.reading, cause, self.case.resolution)
        scene = self.case.right.rate
        factor = self.reading.value(cause) / scene
        return has_few_digits(factor, doubt / abs(scene), FACTOR_DIGITS)

    @property
    def _steps_roughly(self) -> bool:
        """Return whether a step of its own leaves more than rounding, and so moves numbers that are like a drift."""
        stepped = any(cause.stage == "integrator" for cause in self.reading.causes)
        return stepped and self.rest > NEEDED * self.case.resolution

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

    def without(self, word: str) -> Hypothesis:
        """Return the hypothesis without a cause, or without its model, everything else fitted again."""
        return self.refitted(self.left_out(word).reading)

    def left_out(self, word: str) -> Hypothesis:
        """Return the hypothesis without a cause, or without its model, its numbers as they are."""
        reading = self.reading
        kind = reading.program.kind
        causes = [cause for cause in reading.causes if cause.id == word]
        fewer = reading.reader.without(reading, causes)
        if not causes:  # the word is that of the model
            kind = "sphere"
        fewer = replace(fewer, program=fewer.program.changed(kind=kind))
        return Hypothesis.of(self.case, fewer)

    def takes_from(self, other: Hypothesis) -> bool:
        """Return whether a drift takes so much less beside its causes than beside another's that it is no accident."""
        if not (self.drifts and other.drifts and self.rest <= RIVAL * other.rest):
            return False
        return CATALOGUE * self.undrifted.rest < CHANCE * other.undrifted.rest

    def need_of(self, word: str) -> float:
        """Return how many times the residual grows without a cause, everything else fitted again."""
        without = self.without(word)
        if self.takes_from(without):
            return without.undrifted.rest / self.undrifted.rest
        return without.rest / self.rest

    def is_worth_saying(self, word: str) -> bool:
        """Return whether without a cause more than the tolerance is left, or a drift would take its place.

        Numbers that somebody typed are not fitted again.
        """
        fitted_again = bool(self.untyped) or self.drifts
        without = self.without(word) if fitted_again else self.left_out(word)
        return without.largest_m > self.case.allowed_m or self.takes_from(without)

    def is_no_accident(self) -> bool:
        """Return whether hardly any of all known causes would explain the rows as well in place of one of its own.

        Then what it leaves within the tolerance is a program's own error, which a free number takes up as well.
        """
        if self.untyped or not self.explains:
            return False
        least = min((self.without(word).rest for word in self.words), default=0.0)
        return CATALOGUE * self.rest < CHANCE * least

    @property
    def is_exact(self) -> bool:
        """Whether what it leaves is rounding; numbers that nobody typed take up what another method leaves."""
        most = 1.0 if self.untyped else NEEDED
        return self.rest <= most * self.case.resolution

    @property
    def free_numbers(self) -> int:
        """How many numbers were fitted that the rows do not show by themselves."""
        return len(self.numbers)

    @property
    def is_sound(self) -> bool:
        """Whether its numbers are certain; not if its swing is too fast for other models to be run beside it."""
        return super().is_sound and not self.case.pendulum.is_too_fast(self.reading.program.theta())

    def foreseen(self, count: int) -> Array:
        """Return the residual in m if the numbers are fitted to the first `count` rows."""
        names = [cause.free for cause in self.numbers]
        program = adjusted_to(self.case.part(count), self.reading.program, names)
        return self.case.left(program)


def simplest(hypotheses: Sequence[Hypothesis]) -> Hypothesis:
    """Return the cheapest hypothesis, unless a dearer one leaves far less; those that explain the rows come first."""
    enough = [one for one in hypotheses if one.explains] or hypotheses
    best, *dearer = sorted(enough, key=lambda one: (one.price, len(one.numbers), one.rest))
    for one in dearer:
        less = RIVAL if one.price == best.price else NEEDED
        better = less * one.rest <= best.rest or one.takes_from(best)
        if better and not (one.untyped and best.is_no_accident()):
            best = one
    return best


def without_needless(best: Hypothesis) -> Hypothesis:
    """Return a hypothesis without the causes without which about as little is left."""
    while best.words:
        needs = {word: best.need_of(word) for word in sorted(best.words)}
        word = min(needs, key=lambda word: needs[word])
        if needs[word] >= RIVAL:
            break
        best = best.without(word)
    return best


def worth_saying(best: Hypothesis) -> tuple[Hypothesis, dict[str, float]]:
    """Return a hypothesis without causes within the tolerance, and the residual's growth without each other one."""
    while best.words:
        slight = [word for word in sorted(best.words) if not best.is_worth_saying(word)]
        if not slight:
            return best, {word: best.need_of(word) for word in best.words}
        best = min(map(best.without, slight), key=lambda one: one.largest_m)
    return best, {}


def rivals_of(best: Hypothesis, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return the other hypotheses that cost no more and leave no more than a few times as much.

    Beside numbers that nobody typed it is enough that one without any explains the rows.
    """
    rivals: dict[frozenset[str], Hypothesis] = {}
    for hypothesis in hypotheses:
        if _is_rival(best, hypothesis):
            rivals.setdefault(hypothesis.words, hypothesis)
    # few digits beat many
    if any(rival.untyped for rival in rivals.values()) and best.is_no_accident():
        return [rival for rival in rivals.values() if not rival.untyped]
    return list(rivals.values())


def _is_rival(best: Hypothesis, other: Hypothesis) -> bool:
    """Return whether another hypothesis costs no more than the best one, and does about as well by other causes."""
    if other.words >= best.words or other.words < best.words:
        return False
    without_untyped = best.untyped_inputs and not other.untyped and other.explains
    if not without_untyped and other.rest > RIVAL * best.rest:
        return False
    if best.takes_from(other):
        return False
    if any(best.has_number(other, cause) for cause in other.numbers):
        return False
    # what is the same motion as a step error is a rival of it at any price
    is_same_motion = all(map(is_like_a_drift, other.words ^ best.words))
    return is_same_motion or other.price <= best.price
