"""The tests of a claim: the only place where a sentence about a program becomes certain.

An explanation is a set of causes whose program was run. It is compared with the file column by column, with itself
without each of its causes, and with every other explanation of the same price or less. What passes all tests is
certain. Of explanations that the file does not tell apart the difference is said as "either … or …". What the motion is
merely like is said as that, and the rest not at all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from .case import AS_IF, EITHER, HARMLESS, Explanation, FileCase, NamedModel, largest, rms
from .causes import DRIFT, EFFECTIVE, LIKE_A_DRIFT, LOOSE, Cause, is_like_a_drift, shortest_decimal
from .drift import drifting
from .fitted import MODELS, adjusted_to, model_of, polished, sentences, sized
from .readings import CauseReading
from .thresholds import (
    ALTERNATIVES,
    CATALOGUE,
    CHANCE,
    FACTOR_DIGITS,
    FIRST_PART,
    MOST_DIGITS,
    NEEDED,
    RIVAL,
    ROWS_A_NUMBER,
)

ONE_DRIFT = (
    "site.gravity",
    "pendulum.length",
    "pendulum.drag",
)  # beside which no clock is believed
# a g that is the effective one, with the centrifugal force's change along the swing and without it
EFFECTIVE_G, WITHOUT_CHANGE = "effective_gravity", "no_centrifugal"
A_STEP = "integrator_loose", LOOSE
ONE_NUMBER = ("site.gravity", "pendulum.length")  # of a linear motion their quotient alone is known


def loose(size_m: float, stage: str = "integrator") -> Deviation:
    """Return the cause that an integrator has an error, which one is not known."""
    cause = Deviation("integrator_loose", LOOSE, size_m, stage)
    return hedged(cause) if stage == AS_IF else cause


def harmless(case: FileCase, left: Array) -> bool:
    """Return whether what an explanation leaves, shape (rows, 2 or 3), is in no column more than the file's error."""
    errors = np.abs(case.rows.positions - case.truth).max(axis=0)
    return bool((np.abs(left).max(axis=0) <= RIVAL * np.maximum(errors, case.resolution)).all())


def explains(case: FileCase, left: Array) -> bool:
    """Return whether what is left is within the tolerance, or the rounding of the file."""
    return largest(left) <= case.enough


def has_few_digits(value: float, doubt: float, most: int = MOST_DIGITS) -> bool:
    """Return whether a person may have typed a number, since its shortest decimal within a doubt is no accident."""
    doubt = max(doubt, 2.0**-50 * abs(value))
    if abs(value) <= doubt:
        return True
    _, digits = shortest_decimal(value, doubt)
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    return digits <= most and 2 * doubt < CHANCE * unit


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A combination of causes whose program was run.

    Attributes:
        case: the file.
        reading: the causes and their program.
        left: what it leaves in m, shape (rows, 2 or 3).
    """

    case: FileCase
    reading: CauseReading
    left: Array

    @classmethod
    def of(cls, case: FileCase, reading: CauseReading) -> Hypothesis:
        """Return the hypothesis of a reading, its program run."""
        return cls(case, reading, case.left(reading.program))

    @property
    def rest(self) -> float:
        """Root mean square in m of what is left; smaller residuals than rounding are equal."""
        size = rms(self.left)
        return max(size, self.case.resolution) if math.isfinite(size) else math.inf

    @property
    def largest_m(self) -> float:
        """Largest distance in m of what is left."""
        size = largest(self.left)
        return size if math.isfinite(size) else math.inf

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
        """Those whose number nobody typed."""
        inputs = [cause for cause in self.numbers if cause not in DRIFT]
        return [cause for cause in inputs if not self._is_typed(cause)]

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
        model = self.reading.program.kind != "sphere"
        inputs = [cause for cause in self.numbers if cause.stage != "integrator"]
        dear = sum(self._is_dear(cause) for cause in self.numbers)
        # another sign is a change of its own
        dear += sum(
            self.reading.value(cause) * float(getattr(self.case.right, cause.free)) < 0
            for cause in inputs
        )
        return len(self.reading.causes) + dear + model

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
        """Return whether a person may have typed a number, or the factor by which a rate differs from the scene's.

        The steps of a program may move its number by as much as the tolerance allows.
        """
        value = self.reading.value(cause)
        doubt = self.reading.reader.uncertainty(self.reading, cause, self.case.resolution)
        if cause.stage == "integrator":
            # on the sphere what a step does is known roughly, and so is the step
            return self.reading.program.kind != "sphere" and self._divides(value, doubt)
        if cause.id in LIKE_A_DRIFT and self._steps_roughly:
            return False
        scene = float(getattr(self.case.right, cause.free))
        widest = doubt * max(1.0, self.case.allowed_m / self.rest)
        for within in (doubt, widest):
            # what may be the scene's own number is no number that somebody typed
            if abs(value - scene) > within and has_few_digits(value, within):
                return True
        factor = factors and cause.free == "rate"
        return factor and has_few_digits(value / scene, doubt / abs(scene), FACTOR_DIGITS)

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
        return round(count) > 0 and abs(count - round(count)) <= max(
            RIVAL * doubt * count / step, CHANCE
        )

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
        """Return how many times as much is left without a cause, everything else fitted again."""
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
        if self.untyped or not explains(self.case, self.left):
            return False
        least = min((self.without(word).rest for word in self.words), default=0.0)
        return CATALOGUE * self.rest < CHANCE * least

    @property
    def is_exact(self) -> bool:
        """Whether what it leaves is rounding: as the steps of a method leave it, if it is the right one.

        Numbers that nobody typed take up what another method leaves.
        """
        most = 1.0 if self.untyped else NEEDED
        return self.rest <= most * self.case.resolution

    def predicts(self) -> bool:
        """Return whether its numbers, fitted to the first rows, meet the others as well as all do."""
        names = [cause.free for cause in self.numbers]
        times = self.case.rows.times
        count = int(np.searchsorted(times, times[0] + FIRST_PART * (times[-1] - times[0])))
        if not names or not 0 < count < len(times):
            return True
        program = adjusted_to(self.case.part(count), self.reading.program, names)
        later = rms(self.case.left(program)[count:])
        return later <= RIVAL * max(rms(self.left[count:]), self.case.resolution)

    def enough_rows(self) -> bool:
        """Return whether the rows are as many as can say anything of its numbers, and last for a swing."""
        rows, numbers = self.case.rows, len(self.numbers)
        if not numbers:
            return True
        swing = 2 * math.pi / self.case.frequency if self.case.frequency else 0.0
        lasts = float(rows.times[-1]) >= swing
        return lasts and len(rows.times) >= ROWS_A_NUMBER * numbers


def simplest(hypotheses: Sequence[Hypothesis]) -> Hypothesis:
    """Return the cheapest hypothesis, unless a dearer one leaves far less; those that explain the rows come first."""
    case = hypotheses[0].case
    enough = [one for one in hypotheses if explains(case, one.left)] or hypotheses
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
    """Return a hypothesis without what is within the tolerance, and how many times as much is left without the rest."""
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
    found: dict[frozenset[str], Hypothesis] = {}
    for hypothesis in hypotheses:
        typed = (
            best.untyped_inputs and not hypothesis.untyped and explains(best.case, hypothesis.left)
        )
        near = typed or hypothesis.rest <= RIVAL * best.rest
        other = not hypothesis.words >= best.words and not hypothesis.words < best.words
        same = any(best.has_number(hypothesis, cause) for cause in hypothesis.numbers)
        near = near and not best.takes_from(hypothesis)
        # what is the same motion as a step error is a rival of it at any price
        alike = all(map(is_like_a_drift, hypothesis.words ^ best.words))
        if near and other and not same and (alike or hypothesis.price <= best.price):
            found.setdefault(hypothesis.words, hypothesis)
    # few digits beat many
    if any(rival.untyped for rival in found.values()) and best.is_no_accident():
        return [rival for rival in found.values() if not rival.untyped]
    return list(found.values())


def told(
    best: Hypothesis,
    rivals: Sequence[Hypothesis],
    reported: Hypothesis,
    needs: dict[str, float],
) -> Iterator[Deviation]:
    """Yield what may be said of the causes of a hypothesis.

    Args:
        best: the hypothesis.
        rivals: of it.
        reported: the same without what is within the tolerance.
        needs: how many times as much is left without each of its causes, by word.
    """
    case = best.case
    explained = explains(case, best.left) or not best.untyped
    sound = best.predicts() and best.enough_rows()
    needed = _needed(best)
    words = {one: _shared_words(one, [best, *rivals]) for one in (best, *rivals)}
    common = frozenset.intersection(*words.values())
    untyped = {cause.id for cause in best.untyped}
    every = untyped.union(*({cause.id for cause in rival.untyped} for rival in rivals))
    # what a step of no name does as well
    by_step = bool(every & {*ONE_DRIFT}) and all(
        map(is_like_a_drift, words[best] - common | untyped)
    )
    if by_step:
        common -= untyped
    alternatives = [_said(one, words[one] - common) for one in (best, *rivals)]
    if not best.is_exact:
        alternatives = [_without_name(*alternative) for alternative in alternatives]
    if by_step:
        alternatives.append(A_STEP)
    spacing = float(np.ptp(case.rows.times[:2]))
    differing = []
    for sized_cause in sized(case, reported.reading):
        cause = sized_cause
        enough = sound and needs.get(cause.id, 0.0) >= needed
        if cause.id == WITHOUT_CHANGE and cause.id not in words[best]:
            cause = replace(cause, id=EFFECTIVE_G, text=EFFECTIVE)
        if cause.id not in common:
            differing.append(cause)
        elif cause.stage == "integrator" and not (cause.id not in untyped and best.is_exact):
            needed_step = sound and needs.get(cause.id, 0.0) >= NEEDED
            certain = needed_step and not best.untyped_inputs
            yield loose(cause.size_m, "integrator" if certain else AS_IF)
        elif enough and _is_an_input(cause, untyped):
            yield _in_whole_steps(cause, spacing)
        else:
            yield hedged(cause)
    are_needed = all(needs.get(cause.id, math.inf) >= NEEDED for cause in differing)
    if differing:
        certain = sound and explained and are_needed
        yield from _either(differing, _different(alternatives), certain)


def _without_name(ids: str, text: str) -> tuple[str, str]:
    """Return an alternative; a step alone as one that has no name."""
    alone = ids.startswith("integrator") and "+" not in ids
    return A_STEP if alone else (ids, text)


def _shared_words(hypothesis: Hypothesis, every: Sequence[Hypothesis]) -> frozenset[str]:
    """Return the words of a hypothesis; of a g that is effective in all, and more in some, that it is effective."""
    effective = {WITHOUT_CHANGE, EFFECTIVE_G}
    spoken = [one.words & effective for one in every]
    if all(spoken) and len(set(spoken)) > 1:
        return hypothesis.words - effective | {EFFECTIVE_G}
    return hypothesis.words


def _needed(best: Hypothesis) -> float:
    """Return how many times as much has to be left without a cause that is certain."""
    if explains(best.case, best.left):
        return NEEDED
    if best.untyped_inputs:
        # where not even free numbers explain the rows, no other cause may be about as good by accident
        return CATALOGUE / CHANCE
    return NEEDED**2 if best.drifts else NEEDED


def _is_an_input(cause: Deviation, untyped: set[str]) -> bool:
    """Return whether the number of a cause, if it has one, is one that somebody typed.

    A clock is no input: any factor will do, but not beside other numbers that take up what it leaves.
    """
    if cause.stage == "clock":
        return untyped <= {cause.id}
    return cause.id not in untyped or cause.stage == "integrator"


def _in_whole_steps(cause: Deviation, spacing: float) -> Deviation:
    """Return a cause, its step replaced by the one that goes into the spacing of the rows, if there is only one."""
    if cause.stage != "integrator" or not cause.value or cause.uncertainty is None:
        return cause
    count = spacing / cause.value
    if RIVAL * cause.uncertainty * count / cause.value >= 1 / 2 or not round(count):
        return cause
    step = spacing / round(count)
    text = cause.text.replace(f"about {cause.value:.3g} s", f"{step:.3g} s")
    return replace(cause, text=text, value=step, shift=step)


def _said(hypothesis: Hypothesis, words: frozenset[str]) -> tuple[str, str]:
    """Return some causes of a hypothesis as one alternative: their ids, and what is said of them."""
    chosen = dict(sentences(hypothesis.case, hypothesis.reading))
    if EFFECTIVE_G in words and EFFECTIVE_G not in chosen:
        chosen[EFFECTIVE_G] = EFFECTIVE
    said = [word for word in chosen if word in words]
    return "+".join(said), " and ".join(chosen[word] for word in said)


def _different(alternatives: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return alternatives without those that say another one, and more: what both say is enough."""
    texts = {text: ids for ids, text in alternatives if text}
    return [
        (ids, text)
        for text, ids in texts.items()
        if not any(text.startswith(other) and text != other for other in texts)
    ]


def _either(
    differing: Sequence[Deviation], alternatives: Sequence[tuple[str, str]], sound: bool
) -> Iterator[Deviation]:
    """Yield alternatives as one cause; where there are too many, those of the best as what the motion is like."""
    first = max(differing, key=lambda cause: cause.size_m)
    quotient = sum(ids in ONE_NUMBER for ids, _ in alternatives)
    count = len(alternatives) - max(0, quotient - 1)
    if not sound or count > ALTERNATIVES:
        yield from map(hedged, differing)
    elif len(alternatives) == 1:
        ids, text = alternatives[0]
        yield replace(first, id=ids, text=text)
    else:
        ids = "|".join(ids for ids, _ in alternatives)
        text = f"either {', or '.join(text for _, text in alternatives)}"
        yield Deviation(ids, text, first.size_m, EITHER)


def either_of(first: Explanation, second: Explanation) -> Explanation:
    """Return the explanation that one of two is true."""
    alternatives = []
    size_m = 0.0
    for explanation in (first, second):
        parts = [*explanation.causes, *explanation.conventions]
        size_m = max(size_m, *(part.size_m for part in parts))
        ids = "+".join(part.id for part in parts)
        alternatives.append((ids, " and ".join(part.text for part in parts)))
    text = f"either {', or '.join(text for _, text in alternatives)}"
    cause = Deviation("|".join(ids for ids, _ in alternatives), text, size_m, EITHER)
    return replace(first, causes=(cause,), conventions=(), model=None)


def with_rival_step(named: Explanation, stepped: Explanation, case: FileCase) -> Explanation:
    """Return the better of two explanations with different steps, or one in which either step may be the cause.

    The other one is no rival if it is dearer.
    """
    rest_m = max(named.rest_m, case.resolution)
    rival_m = max(stepped.rest_m, case.resolution)
    if stepped.price > named.price or rival_m > RIVAL * rest_m:
        return named
    if RIVAL * rival_m < rest_m:
        return stepped
    own = [cause for cause in named.causes if cause.stage == "integrator"]
    other = [cause for cause in stepped.causes if cause.stage == "integrator"]
    if len(own) != 1 or len(other) != 1 or own[0].id == other[0].id:
        return named
    either = Deviation(
        f"{own[0].id}|{other[0].id}",
        f"either {own[0].text}, or {other[0].text}",
        own[0].size_m,
        EITHER,
    )
    causes = tuple(either if cause is own[0] else cause for cause in named.causes)
    return replace(named, causes=causes)


def hedged(cause: Deviation) -> Deviation:
    """Return a cause as one that the motion is merely like."""
    text = f"moves like one that {cause.text}"
    return replace(cause, id=f"{AS_IF}.{cause.id}", stage=AS_IF, text=text)


def explanation_of(
    case: FileCase, readings: Sequence[CauseReading], step: Deviation | None = None
) -> tuple[Explanation, Hypothesis | None]:
    """Return what may be said of a file, and the hypothesis behind it; no cause where no reading passes the tests.

    Args:
        case: the file.
        readings: combinations of causes whose programs were run.
        step: that was taken from the rows before they were read, or None.
    """
    hypotheses = _harmless(case, readings)
    if not hypotheses:
        return nothing(case), None
    best = without_needless(simplest(hypotheses))
    likeliest = best
    if step is None and (best.untyped or not explains(case, best.left)):
        hypotheses += _harmless(case, drifting(case, readings))
        hypotheses = [one for one in hypotheses if not one.names_no_step] or hypotheses
        best = without_needless(simplest(hypotheses))
    reported, needs = worth_saying(best)
    enough = explains(case, reported.left) or NEEDED**2 * rms(reported.left) <= case.error
    if not enough or not harmless(case, reported.left):
        return nothing(case), likeliest
    causes = [*told(best, rivals_of(best, hypotheses), reported, needs), *filter(None, [step])]
    left_m = largest(reported.left)
    explanation = case.explanation(tuple(causes), left_m, rms(reported.left), reported.price)
    return replace(explanation, model=_model(case, reported, causes)), likeliest


def _harmless(case: FileCase, readings: Sequence[CauseReading]) -> list[Hypothesis]:
    """Return readings as hypotheses, without those that leave a column worse than the file has it."""
    hypotheses = [Hypothesis.of(case, reading) for reading in readings]
    return [one for one in hypotheses if harmless(case, one.left) and one.rest < math.inf]


def _model(case: FileCase, best: Hypothesis, causes: Sequence[Deviation]) -> NamedModel | None:
    """Return the simplification that all causes make up; None if they are none, or not certain."""
    simple = {cause.stage for cause in causes} <= {"gravity", "model"}
    plain = all(convention.id in HARMLESS for convention in case.rows.conventions)
    left_m = largest(best.left)
    if not (causes and simple and plain and left_m <= case.allowed_m):
        return None
    costs_m = largest(case.rows.positions - case.truth)
    return model_of(best.reading.program.kind, case.right, causes, left_m, costs_m)


def nothing(case: FileCase) -> Explanation:
    """Return the explanation that has no cause."""
    return case.explanation((), largest(case.rows.positions - case.truth), case.error, 0)
