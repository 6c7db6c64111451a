"""The tests of a claim: the only place where a sentence about a file or its program becomes certain.

Whatever is proposed is run: causes of a program, maps of columns, conventions of a file, approximations of the source
papers, steps, and slips of a formula. It is compared with the file column by column, with what is left without it, and
with every other explanation of the same price or less. What passes all tests is certain. Of explanations that the file
does not tell apart the difference is said as "either … or …". What the motion is merely like is said as that, and the
rest not at all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..candidates.candidate import Deviation
from .case import AS_IF, EITHER, HARMLESS, Explanation, FileCase, NamedModel, largest
from .causes import EFFECTIVE, LOOSE, is_like_a_drift
from .drift import drifting, instead_of_drift
from .fitted import model_of, sentences, sized
from .hypotheses import (
    Claim,
    Hypothesis,
    rivals_of,
    simplest,
    without_needless,
    worth_saying,
)
from .readings import CauseReading
from .thresholds import ALTERNATIVES, CATALOGUE, CHANCE, NEEDED, RIVAL

# beside which no clock is believed
_ONE_DRIFT = ("site.gravity", "pendulum.length", "pendulum.drag")
# a g that is the effective one, with the centrifugal force's change along the swing and without it
_EFFECTIVE_G = "effective_gravity"
_WITHOUT_CHANGE = "no_centrifugal"
# of a linear motion their quotient alone is known
_ONE_NUMBER = ("site.gravity", "pendulum.length")
# numbers of which a motion may show one combination alone: each may be wrong, or both
_COMBINED = (frozenset(_ONE_NUMBER), frozenset(("site.latitude", "site.rotation_rate")))


@dataclass(frozen=True)
class Alternative:
    """Causes of which an "either … or …" says that they, or others, are true.

    Attributes:
        ids: of the causes, joined by +.
        text: what is said of them.
    """

    ids: str
    text: str


_A_STEP = Alternative("integrator_loose", LOOSE)


def tested(claim: Claim, part: Deviation, without_m: float) -> Deviation | None:
    """Return a part of an explanation as the tests of a claim allow it to be said; None if not at all.

    It is certain, or what the file or its motion is merely like.

    Args:
        claim: the explanation with it.
        part: a cause or a convention.
        without_m: root mean square of the residual in m without it, everything else fitted again.
    """
    if not claim.leaves_little or not claim.is_harmless:
        return None
    return by_need(part if claim.is_sound else hedged(part), without_m / claim.rest)


def by_need(part: Deviation, need: float) -> Deviation | None:
    """Return a part of an explanation as its need allows it to be said; None if it is not needed.

    `need` says how many times the residual grows without it.
    """
    if need < RIVAL:
        return None
    return part if need >= NEEDED else hedged(part)


def hedged(part: Deviation) -> Deviation:
    """Return a cause as one that the motion is merely like, or a convention as one that the file is like."""
    if part.stage == AS_IF:
        return part
    verb = "moves" if part.stage else "looks"
    text = f"{verb} like one that {part.text}"
    return replace(part, id=f"{AS_IF}.{part.id}", stage=AS_IF, text=text)


def loose(size_m: float, stage: str = "integrator") -> Deviation:
    """Return the cause that an integrator has an error, which one is not known."""
    cause = Deviation(_A_STEP.ids, _A_STEP.text, size_m, "integrator")
    return hedged(cause) if stage == AS_IF else cause


def nothing(case: FileCase) -> Explanation:
    """Return the explanation that has no cause."""
    return case.explanation((), case.rows.positions - case.truth, 0)


def explanation_of(
    case: FileCase, readings: Sequence[CauseReading]
) -> tuple[Explanation, Hypothesis | None]:
    """Return what may be said of a file, and the best hypothesis without a step error of unknown method.

    There is no cause where no reading passes the tests.

    Args:
        case: the file.
        readings: combinations of causes whose programs were run.
    """
    hypotheses = _harmless(case, readings)
    if not hypotheses:
        return nothing(case), None
    best = without_needless(simplest(hypotheses))
    likeliest = best
    if best.untyped or not best.explains:
        hypotheses += _harmless(case, drifting(case, readings))
        hypotheses = [one for one in hypotheses if not one.names_no_step] or hypotheses
        best = without_needless(simplest(hypotheses))
    if best.drifts:
        hypotheses += _harmless(case, list(instead_of_drift(case, best.reading)))
        best = without_needless(simplest(hypotheses))
    reported, needs = worth_saying(best)
    if not reported.leaves_little or not reported.is_harmless:
        return nothing(case), likeliest
    comparison = _AmongRivals(best, rivals_of(best, hypotheses), reported, needs)
    causes = tuple(comparison.causes())
    explanation = case.explanation(causes, reported.left, reported.price)
    model = _model(case, reported, causes)
    return replace(explanation, model=model, reading=reported.reading), likeliest


def _harmless(case: FileCase, readings: Sequence[CauseReading]) -> list[Hypothesis]:
    """Return readings as hypotheses, without those that leave a column worse than the file has it."""
    hypotheses = [Hypothesis.of(case, reading) for reading in readings]
    return [one for one in hypotheses if one.is_harmless and one.rest < math.inf]


def _model(case: FileCase, best: Hypothesis, causes: Sequence[Deviation]) -> NamedModel | None:
    """Return the simplification that all causes make up; None if they are none, or not certain."""
    simple = {cause.stage for cause in causes} <= {"gravity", "model"}
    plain = all(convention.id in HARMLESS for convention in case.rows.conventions)
    left_m = largest(best.left)
    if not (causes and simple and plain and left_m <= case.allowed_m):
        return None
    costs_m = largest(case.rows.positions - case.truth)
    return model_of(best.reading.program.kind, case.right, causes, left_m, costs_m)


@dataclass(frozen=True, eq=False)
class _AmongRivals:
    """A hypothesis beside its rivals.

    Attributes:
        best: the hypothesis.
        rivals: of it.
        reported: the same without what is within the tolerance.
        needs: how many times the residual grows without each of its causes, by word.
    """

    best: Hypothesis
    rivals: Sequence[Hypothesis]
    reported: Hypothesis
    needs: dict[str, float]

    def causes(self) -> Iterator[Deviation]:
        """Yield what may be said of the causes, those that the rivals do not share as one of several."""
        differing = []
        for cause in self._sized():
            if cause.id in self._common:
                yield self._graded(cause)
            else:
                differing.append(cause)
        if not differing:
            return
        explained = self.best.explains or not self.best.untyped
        needed = all(self._need(cause) >= NEEDED for cause in differing)
        certain = self.best.is_sound and explained and needed and not self._is_confounded(differing)
        yield from _either(differing, _different(self._alternatives), certain)

    def _is_confounded(self, differing: Sequence[Deviation]) -> bool:
        """Return whether a fitted number outside the alternatives may absorb a part of any of them.

        A step error of unknown method has two such numbers: beside it an alternative with a fitted number of its own
        is not certain.
        """
        own = {cause.id for cause in differing}
        beside = {cause.id for cause in self.best.untyped_inputs} - own
        has_number = any(hypothesis.untyped_inputs for hypothesis in self._words)
        return bool(beside) or (self.best.drifts and has_number)

    def _sized(self) -> Iterator[Deviation]:
        """Yield the causes that are reported, each with the distance by which it moves the bob."""
        for cause in sized(self.best.case, self.reported.reading):
            if cause.id == _WITHOUT_CHANGE and cause.id not in self._words[self.best]:
                yield replace(cause, id=_EFFECTIVE_G, text=EFFECTIVE)
            else:
                yield cause

    def _graded(self, cause: Deviation) -> Deviation:
        """Return a cause that all rivals share: certain, or as what the motion is like."""
        if cause.stage == "integrator" and not self._names_the_step(cause):
            needed = self.best.is_sound and self._need(cause) >= NEEDED
            certain = needed and not self.best.untyped_inputs
            return loose(cause.size_m, "integrator" if certain else AS_IF)
        needed = self.best.is_sound and self._need(cause) >= self._least_need
        if needed and self._is_an_input(cause):
            return self._in_whole_steps(cause)
        return hedged(cause)

    def _need(self, cause: Deviation) -> float:
        """Return how many times the residual grows without a cause."""
        is_renamed = cause.id == _EFFECTIVE_G and cause.id not in self.needs
        return self.needs[_WITHOUT_CHANGE if is_renamed else cause.id]

    def _names_the_step(self, cause: Deviation) -> bool:
        """Return whether the method of a step is known: its length is typed, and it leaves rounding."""
        return cause.id not in self._untyped and self.best.is_exact

    @cached_property
    def _least_need(self) -> float:
        """How many times as much has to be left without a cause that is certain."""
        if self.best.explains:
            return NEEDED
        if self.best.untyped_inputs:
            # where not even free numbers explain the rows, no other cause may be about as good by accident
            return CATALOGUE / CHANCE
        return NEEDED**2 if self.best.drifts else NEEDED

    def _is_an_input(self, cause: Deviation) -> bool:
        """Return whether the number of a cause, if it has one, is one that somebody typed.

        A clock is no input: any factor will do, but not beside other numbers that take up what it leaves. Nor is a
        factor of the rotation rate beside such numbers: a clock makes that as well.
        """
        if cause.stage == "clock":
            return self._untyped <= {cause.id}
        if cause.id == "rate_factor":
            return not self.best.untyped_inputs
        return cause.id not in self._untyped or cause.stage == "integrator"

    def _in_whole_steps(self, cause: Deviation) -> Deviation:
        """Return a cause, its step replaced by the one that goes into the spacing of the rows, if there is only one."""
        if cause.stage != "integrator" or not cause.value or cause.uncertainty is None:
            return cause
        spacing = float(np.ptp(self.best.case.rows.times[:2]))
        count = spacing / cause.value
        doubt = RIVAL * cause.uncertainty * count / cause.value
        if doubt >= 1 / 2 or not round(count):
            return cause
        step = spacing / round(count)
        text = cause.text.replace(f"about {cause.value:.3g} s", f"{step:.3g} s")
        return replace(cause, text=text, value=step, shift=step)

    @cached_property
    def _untyped(self) -> set[str]:
        """The ids of the causes whose number nobody typed."""
        return {cause.id for cause in self.best.untyped}

    @cached_property
    def _words(self) -> dict[Hypothesis, frozenset[str]]:
        """The words of the hypothesis and of its rivals.

        If all of them take g as effective, and some say more about it, only "effective" is kept.
        """
        words = {one: one.words for one in (self.best, *self.rivals)}
        effective = {_WITHOUT_CHANGE, _EFFECTIVE_G}
        spoken = {one & effective for one in words.values()}
        if all(spoken) and len(spoken) > 1:
            return {one: every - effective | {_EFFECTIVE_G} for one, every in words.items()}
        return words

    @cached_property
    def _shared(self) -> frozenset[str]:
        """The words that the hypothesis and all its rivals have."""
        return frozenset.intersection(*self._words.values())

    @cached_property
    def _may_be_a_step(self) -> bool:
        """Whether a step of no name does what the numbers do that nobody typed."""
        untyped = [cause for one in self._words for cause in one.untyped]
        if not any(cause.id in _ONE_DRIFT for cause in untyped):
            return False
        different = self._words[self.best] - self._shared | self._untyped
        return all(map(is_like_a_drift, different))

    @cached_property
    def _common(self) -> frozenset[str]:
        """The words of causes that are in every alternative."""
        return self._shared - self._untyped if self._may_be_a_step else self._shared

    @property
    def _alternatives(self) -> list[Alternative]:
        """The causes by which the hypothesis and its rivals differ."""
        alternatives = [
            _alternative(one, words - self._common) for one, words in self._words.items()
        ]
        if not self.best.is_exact:
            alternatives = list(map(_without_name, alternatives))
        if self._may_be_a_step:
            alternatives.append(_A_STEP)
        return alternatives


def _alternative(hypothesis: Hypothesis, words: frozenset[str]) -> Alternative:
    """Return some causes of a hypothesis as one alternative."""
    texts = dict(sentences(hypothesis.case, hypothesis.reading))
    if _EFFECTIVE_G in words and _EFFECTIVE_G not in texts:
        texts[_EFFECTIVE_G] = EFFECTIVE
    chosen = [word for word in texts if word in words]
    return Alternative("+".join(chosen), " and ".join(texts[word] for word in chosen))


def _without_name(alternative: Alternative) -> Alternative:
    """Return an alternative; a step alone as one that has no name."""
    alone = alternative.ids.startswith("integrator") and "+" not in alternative.ids
    return _A_STEP if alone else alternative


def _different(alternatives: Sequence[Alternative]) -> list[Alternative]:
    """Return alternatives without those that say another one, and more: what both say is enough."""
    by_text = {alternative.text: alternative for alternative in alternatives if alternative.text}

    def says_another(text: str) -> bool:
        return any(text.startswith(other) and text != other for other in by_text)

    return [alternative for text, alternative in by_text.items() if not says_another(text)]


def _either(
    differing: Sequence[Deviation], alternatives: Sequence[Alternative], certain: bool
) -> Iterator[Deviation]:
    """Yield alternatives as one cause; where there are too many, those of the best as what the motion is like."""
    first = max(differing, key=lambda cause: cause.size_m)
    quotient = sum(alternative.ids in _ONE_NUMBER for alternative in alternatives)
    count = len(alternatives) - max(0, quotient - 1)
    if not certain or count > ALTERNATIVES:
        yield from map(hedged, differing)
    elif len(alternatives) == 1:
        (only,) = alternatives
        yield replace(first, id=only.ids, text=only.text)
    else:
        yield one_of(alternatives, first.size_m)


def one_of(alternatives: Sequence[Alternative], size_m: float) -> Deviation:
    """Return the cause that one of several alternatives is true."""
    words = [alternative.ids for alternative in alternatives]
    texts = [alternative.text for alternative in alternatives]
    if any(pair.issubset(words) for pair in _COMBINED):
        texts.append("both" if len(alternatives) == 2 else "several of these")
    return Deviation("|".join(words), f"either {', or '.join(texts)}", size_m, EITHER)


def likelier(other: Explanation, program: Explanation) -> Explanation:
    """Return the likelier one of two explanations, or that either is true.

    One that explains the rows is likelier than one that does not.

    Args:
        other: by columns that are printed otherwise, or by an approximation of the source papers.
        program: by the causes of a program.
    """
    if not program.causes:
        return other
    if other.explains != program.explains:
        return other if other.explains else program
    cheap, dear = sorted((other, program), key=lambda explanation: explanation.price)
    if cheap.price < dear.price:
        return dear if NEEDED * dear.rest_m < cheap.rest_m else cheap
    if RIVAL * other.rest_m < program.rest_m:
        return other
    if RIVAL * program.rest_m < other.rest_m:
        return program
    return _either_of(program, other)


def _either_of(first: Explanation, second: Explanation) -> Explanation:
    """Return the explanation that one of two is true."""
    alternatives = []
    size_m = 0.0
    for explanation in (first, second):
        parts = [*explanation.causes, *explanation.conventions]
        size_m = max(size_m, *(part.size_m for part in parts))
        ids = "+".join(part.id for part in parts)
        alternatives.append(Alternative(ids, " and ".join(part.text for part in parts)))
    cause = one_of(alternatives, size_m)
    return replace(first, causes=(cause,), conventions=(), model=None)


def with_rival_step(named: Explanation, stepped: Explanation) -> Explanation:
    """Return the better of two explanations with different steps, or one in which either step may be the cause.

    The other one is no rival if it is dearer.
    """
    if stepped.price > named.price or stepped.rest_m > RIVAL * named.rest_m:
        return named
    if RIVAL * stepped.rest_m < named.rest_m:
        return stepped
    return with_rival_steps(named, stepped.causes)


def with_rival_steps(named: Explanation, rivals: Sequence[Deviation]) -> Explanation:
    """Return an explanation in which its step, or one of others that make the same rows, is the cause."""
    own = [cause for cause in named.causes if cause.stage == "integrator"]
    if len(own) != 1:
        return named
    steps = {cause.id: cause for cause in (*rivals, *own) if cause.stage == "integrator"}
    if len(steps) == 1:
        return named
    if len(steps) > ALTERNATIVES:
        step = loose(own[0].size_m)
    else:
        alternatives = [Alternative(cause.id, cause.text) for cause in steps.values()]
        step = one_of(alternatives, own[0].size_m)
    causes = tuple(step if cause is own[0] else cause for cause in named.causes)
    return replace(named, causes=causes)
