"""The tests of a claim: the only place where a sentence about a file or its program becomes certain.

Whatever is proposed is run: causes of a program, maps of columns, conventions of a file, approximations of the source
papers, steps, and slips of a formula. It is compared with the file column by column, with the residual without it, and
with every other explanation of the same price or less.

- What passes all tests is certain.
- Explanations that the file does not tell apart are said as "either … or …", as far as they differ.
- What the motion is merely like is said as that.
- Nothing else is said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from .case import AS_IF, EITHER, HARMLESS, Explanation, FileCase, NamedModel, largest
from .causes import LOOSE, PHASE, causes_of, is_like_a_drift
from .drift import drifting, instead_of_drift
from .fitted import model_of, same_motions, sentences, sized
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

# numbers that change the phase or the amplitude as the drift of a step error does
_ONE_DRIFT = ("site.gravity", "pendulum.length", "pendulum.drag")
# causes that say all that another one says, and more
_SHORTER = {
    # a g that is the effective one, without the centrifugal force's change along the swing
    "no_centrifugal": "effective_gravity",
    # all of Ω is vertical, and g is the effective one
    "pole": "no_sine",
}
# beside a phase that drifts, the vertical part of the centrifugal force is not seen
_WITHOUT_CENTRIFUGAL = ("no_centrifugal", "effective_gravity")
_OR_A_PART = "or leaves out its horizontal part alone"
_LONGER = {shorter: longer for longer, shorter in _SHORTER.items()}
# a linear motion shows only their quotient
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


_UNNAMED_STEP = Alternative("integrator_loose", LOOSE)


def graded(claim: Claim, part: Deviation, without_m: float) -> Deviation | None:
    """Return a part of an explanation as the tests of a claim allow it to be said; None if not at all.

    It is certain, or what the file or its motion is merely like.

    Args:
        claim: the explanation with it.
        part: a cause or a convention.
        without_m: root mean square of the residual in m without it, everything else fitted again.
    """
    if not claim.leaves_little or not claim.is_harmless:
        return None
    growth = without_m / claim.residual_rms_m
    return by_growth(part if claim.is_sound else hedged(part), growth)


def by_growth(part: Deviation, growth: float) -> Deviation | None:
    """Return a part of an explanation as certain or hedged, by how much it is needed; None if it is not needed.

    `growth` is the factor by which the residual grows without it.
    """
    if growth < RIVAL:
        return None
    return part if growth >= NEEDED else hedged(part)


def hedged(part: Deviation) -> Deviation:
    """Return a cause as one that the motion is merely like, or a convention as one that the file is like."""
    if part.stage == AS_IF:
        return part
    verb = "looks" if part.is_convention else "moves"
    text = f"{verb} like one that {part.text}"
    return replace(part, id=f"{AS_IF}.{part.id}", stage=AS_IF, text=text)


def _is_in_phase(cause: Deviation) -> bool:
    """Return whether a cause changes the phase as a clock does."""
    return cause.id in PHASE or cause.id.startswith("gravity_")


def unnamed_step_error(size_m: float, stage: str = "integrator") -> Deviation:
    """Return the cause that an integrator has an error whose method is not known."""
    cause = Deviation(_UNNAMED_STEP.ids, _UNNAMED_STEP.text, size_m, "integrator")
    return hedged(cause) if stage == AS_IF else cause


def shows_steps(best: Hypothesis) -> bool:
    """Return whether the length of a step may be known beside a hypothesis.

    A step changes the phase, and so does an arbitrary g, length or clock: each absorbs a part of the other. On the
    sphere nothing is left then only if both are right; a linear motion has one frequency, which both may make.
    """
    if best.reading.program.kind == "sphere" and best.is_exact:
        return True
    return all(cause.id not in PHASE for cause in best.arbitrary_inputs)


def no_explanation(case: FileCase) -> Explanation:
    """Return the explanation that has no cause."""
    return case.explanation((), case.rows.positions - case.truth, 0)


def explanation_of(
    case: FileCase, readings: Sequence[CauseReading], stepped: bool = False
) -> tuple[Explanation, Hypothesis | None]:
    """Return what may be said of a file, and the best hypothesis without a step error of unknown method.

    The explanation has no cause if no reading passes the tests.

    Args:
        case: the file.
        readings: combinations of causes whose programs were run.
        stepped: whether what steps do was taken from its rows: then there is no other step error.
    """
    hypotheses = _harmless(case, readings)
    if not hypotheses:
        return no_explanation(case), None

    likeliest = _best_of(hypotheses)
    best = likeliest
    if not stepped:
        best, hypotheses = _beside_a_drift(case, readings, hypotheses, likeliest)
    return _compared_with_rivals(best, hypotheses), likeliest


def _best_of(hypotheses: Sequence[Hypothesis]) -> Hypothesis:
    """Return the simplest hypothesis that is good enough, without causes that it does not need."""
    return without_needless(simplest(hypotheses))


def _beside_a_drift(
    case: FileCase,
    readings: Sequence[CauseReading],
    hypotheses: list[Hypothesis],
    likeliest: Hypothesis,
) -> tuple[Hypothesis, list[Hypothesis]]:
    """Return the best hypothesis, with or without a step error of unknown method, and all that were tried.

    A step error is tried if the likeliest hypothesis without one has arbitrary numbers, or does not explain the rows.

    Args:
        case: the file.
        readings: combinations of causes whose programs were run.
        hypotheses: those of them that are harmless.
        likeliest: the best of these.
    """
    best = likeliest
    if best.arbitrary or not best.explains:
        hypotheses = hypotheses + _harmless(case, drifting(case, readings))
        undisguised = [one for one in hypotheses if not one.is_drift_in_disguise]
        hypotheses = undisguised or hypotheses
        best = _best_of(hypotheses)

    if best.drifts:
        catalogue = list(causes_of(case, best.reading.program.kind))
        rivals = [
            *instead_of_drift(case, best.reading),
            *same_motions(case, best.reading, catalogue),
        ]
        hypotheses = hypotheses + _harmless(case, rivals)
        best = _best_of(hypotheses)
    return best, hypotheses


def _compared_with_rivals(best: Hypothesis, hypotheses: Sequence[Hypothesis]) -> Explanation:
    """Return the explanation by the best hypothesis: what it shares with its rivals, and how they differ."""
    case = best.case
    reported, growths = worth_saying(best)
    if not reported.leaves_little or not reported.is_harmless:
        return no_explanation(case)

    comparison = _AmongRivals(best, rivals_of(best, hypotheses), reported, growths)
    causes = tuple(comparison.causes())
    explanation = case.explanation(causes, reported.residuals, reported.price)
    model = _model(case, reported, causes)
    return replace(explanation, model=model, reading=reported.reading)


def _harmless(case: FileCase, readings: Sequence[CauseReading]) -> list[Hypothesis]:
    """Return readings as hypotheses, without those whose residual in a column exceeds the file's own error there."""
    hypotheses = [Hypothesis.of(case, reading) for reading in readings]
    return [one for one in hypotheses if one.is_harmless and one.residual_rms_m < math.inf]


def _model(case: FileCase, best: Hypothesis, causes: Sequence[Deviation]) -> NamedModel | None:
    """Return the simplification that all causes make up; None if they are none, or not certain."""
    simple = {cause.stage for cause in causes} <= {"gravity", "model"}
    plain = all(convention.id in HARMLESS for convention in case.rows.conventions)
    residual_m = largest(best.residuals)
    if not (causes and simple and plain and residual_m <= case.allowed_m):
        return None
    costs_m = largest(case.rows.positions - case.truth)
    return model_of(best.reading.program.kind, case.right, causes, residual_m, costs_m)


@dataclass(frozen=True, eq=False)
class _AmongRivals:
    """A hypothesis beside its rivals.

    Attributes:
        best: the hypothesis.
        rivals: of it.
        reported: the same without what is within the tolerance.
        growths: the factor by which its residual grows without each of its causes, by id.
    """

    best: Hypothesis
    rivals: Sequence[Hypothesis]
    reported: Hypothesis
    growths: dict[str, float]

    def causes(self) -> Iterator[Deviation]:
        """Yield the causes as they may be said; those that the rivals do not share as one of several."""
        differing = []
        for cause in self._sized():
            if cause.id in self._common_ids:
                yield self._graded_shared(cause)
            else:
                differing.append(cause)
        if not differing:
            return
        explained = self.best.explains or not self.best.arbitrary
        needed = all(self._growth(cause) >= NEEDED for cause in differing)
        certain = self.best.is_sound and explained and needed and not self._is_confounded(differing)
        yield from _either(differing, _without_longer_forms(self._alternatives), certain)

    def _is_confounded(self, differing: Sequence[Deviation]) -> bool:
        """Return whether a fitted number outside the alternatives may absorb a part of any of them.

        A step error of unknown method has two such numbers: beside it an alternative with a fitted number of its own
        is not certain.
        """
        differing_ids = {cause.id for cause in differing}
        arbitrary_ids = {cause.id for cause in self.best.arbitrary_inputs}
        if not arbitrary_ids <= differing_ids:
            return True
        hypotheses = (self.best, *self.rivals)
        has_number = any(hypothesis.arbitrary_inputs for hypothesis in hypotheses)
        return self.best.drifts and has_number

    def _sized(self) -> Iterator[Deviation]:
        """Yield the causes that are reported, each with the distance by which it moves the bob."""
        for cause in sized(self.best.case, self.reported.reading):
            is_shortened = cause.id not in self._ids_by_hypothesis[self.best]
            if is_shortened and cause.id in _SHORTER:
                shorter = _SHORTER[cause.id]
                yield replace(cause, id=shorter, text=self._texts[shorter])
            else:
                yield cause

    def _graded_shared(self, cause: Deviation) -> Deviation:
        """Return a cause that all rivals share: certain, or hedged."""
        if cause.stage == "integrator" and not self._names_the_step(cause):
            needed = self.best.is_sound and self._growth(cause) >= NEEDED
            certain = needed and not self.best.arbitrary_inputs
            return unnamed_step_error(cause.size_m, "integrator" if certain else AS_IF)
        needed = self.best.is_sound and self._growth(cause) >= self._least_growth
        if self.best.drifts and cause.id in _WITHOUT_CENTRIFUGAL:
            cause = replace(cause, text=f"{cause.text}, {_OR_A_PART}")
        if needed and self._has_round_number(cause):
            return self._in_whole_steps(cause)
        return hedged(cause)

    def _growth(self, cause: Deviation) -> float:
        """Return the factor by which the residual grows without a cause."""
        is_shortened = cause.id not in self.growths
        return self.growths[_LONGER[cause.id] if is_shortened else cause.id]

    def _names_the_step(self, cause: Deviation) -> bool:
        """Return whether the method of a step is known: its length is a round number, and the residual is rounding."""
        return cause.id not in self._arbitrary_ids and self.best.is_exact

    @cached_property
    def _least_growth(self) -> float:
        """The least factor by which the residual grows without a cause that is certain."""
        if self.best.explains:
            # each free number may absorb a part
            free_numbers = 0 if self.best.is_exact else len(self.best.arbitrary_inputs)
            return NEEDED ** (1 + free_numbers)
        if self.best.arbitrary_inputs:
            # if not even free numbers explain the rows, none of the causes in the catalogue may be as good by accident
            return CATALOGUE / CHANCE
        return NEEDED**2 if self.best.drifts else NEEDED

    def _has_round_number(self, cause: Deviation) -> bool:
        """Return whether the number of a cause, if it has one, counts as round.

        - The factor of a clock may be any number, but not beside other arbitrary numbers, which absorb its residual.
        - A factor of the rotation rate does not count as round beside arbitrary inputs: a clock has the same effect.
        - Beside an arbitrary clock, which absorbs a part, no g or length counts as round, unless nothing is left.
        - The length of a step may be any number, but not beside arbitrary inputs that change the phase as a step does.
        """
        if cause.stage == "clock":
            return self._arbitrary_ids <= {cause.id}
        if cause.stage == "integrator":
            return shows_steps(self.best)
        if cause.id == "rate_factor":
            return not self.best.arbitrary_inputs
        if "clock" in self._arbitrary_ids and _is_in_phase(cause):
            return self.best.is_exact
        return cause.id not in self._arbitrary_ids

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
    def _arbitrary_ids(self) -> set[str]:
        """The ids of the causes with an arbitrary number."""
        return {cause.id for cause in self.best.arbitrary}

    @cached_property
    def _ids_by_hypothesis(self) -> dict[Hypothesis, frozenset[str]]:
        """The ids of the causes of the hypothesis and of each rival.

        If all of them say what a cause says, and some of them more, only that cause is kept.
        """
        by_hypothesis = {one: one.cause_ids for one in (self.best, *self.rivals)}
        for longer, shorter in _SHORTER.items():
            forms = {longer, shorter}
            variants = {cause_ids & forms for cause_ids in by_hypothesis.values()}
            if all(variants) and len(variants) > 1:
                by_hypothesis = {
                    one: (cause_ids - forms) | {shorter} for one, cause_ids in by_hypothesis.items()
                }
        return by_hypothesis

    @cached_property
    def _texts(self) -> dict[str, str]:
        """The texts of the causes of the hypothesis and of its rivals, by id."""
        texts: dict[str, str] = {}
        for hypothesis in (*self.rivals, self.best):
            texts |= sentences(hypothesis.case, hypothesis.reading)
        return texts

    @cached_property
    def _shared_ids(self) -> frozenset[str]:
        """The ids of the causes that the hypothesis and all its rivals have."""
        return frozenset.intersection(*self._ids_by_hypothesis.values())

    @cached_property
    def _may_be_a_step(self) -> bool:
        """Whether a step error of unknown method has the same effect as the arbitrary numbers."""
        hypotheses = (self.best, *self.rivals)
        arbitrary = [cause for one in hypotheses for cause in one.arbitrary]
        if not any(cause.id in _ONE_DRIFT for cause in arbitrary):
            return False
        own_ids = self._ids_by_hypothesis[self.best] - self._shared_ids
        return all(map(is_like_a_drift, own_ids | self._arbitrary_ids))

    @cached_property
    def _common_ids(self) -> frozenset[str]:
        """The ids of the causes that every alternative has, a step error of unknown method included."""
        if self._may_be_a_step:
            return self._shared_ids - self._arbitrary_ids
        return self._shared_ids

    @property
    def _alternatives(self) -> list[Alternative]:
        """The causes by which the hypothesis and its rivals differ."""
        alternatives = [
            _alternative(one, cause_ids - self._common_ids)
            for one, cause_ids in self._ids_by_hypothesis.items()
        ]
        if not self.best.is_exact:
            alternatives = list(map(_without_name, alternatives))
        if self._may_be_a_step:
            alternatives.append(_UNNAMED_STEP)
        return alternatives


def _alternative(hypothesis: Hypothesis, cause_ids: frozenset[str]) -> Alternative:
    """Return some causes of a hypothesis as one alternative."""
    texts = dict(sentences(hypothesis.case, hypothesis.reading))
    chosen = [cause_id for cause_id in texts if cause_id in cause_ids]
    return Alternative("+".join(chosen), " and ".join(texts[cause_id] for cause_id in chosen))


def _without_name(alternative: Alternative) -> Alternative:
    """Return an alternative; a step alone as a step error of unknown method."""
    alone = alternative.ids.startswith("integrator") and "+" not in alternative.ids
    return _UNNAMED_STEP if alone else alternative


def _without_longer_forms(alternatives: Sequence[Alternative]) -> list[Alternative]:
    """Return different alternatives without longer forms of another, whose text begins with the other's.

    Of several with the same causes the first is enough: their fitted numbers hardly differ.
    """
    by_ids: dict[str, Alternative] = {}
    for alternative in alternatives:
        by_ids.setdefault(alternative.ids, alternative)
    by_text = {alternative.text: alternative for alternative in by_ids.values() if alternative.text}

    def is_longer_form(text: str) -> bool:
        return any(text.startswith(other) and text != other for other in by_text)

    return [alternative for text, alternative in by_text.items() if not is_longer_form(text)]


def _either(
    differing: Sequence[Deviation], alternatives: Sequence[Alternative], certain: bool
) -> Iterator[Deviation]:
    """Yield alternatives as one cause; if they are too many or not certain, the differing causes, hedged."""
    first = max(differing, key=lambda cause: cause.size_m)
    # g and l count as one: a linear motion shows only their quotient
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
    ids = [alternative.ids for alternative in alternatives]
    texts = [alternative.text for alternative in alternatives]
    if any(pair.issubset(ids) for pair in _COMBINED):
        texts.append("both" if len(alternatives) == 2 else "several of these")
    return Deviation("|".join(ids), f"either {', or '.join(texts)}", size_m, EITHER)


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
        return dear if NEEDED * dear.residual_rms_m < cheap.residual_rms_m else cheap
    if RIVAL * other.residual_rms_m < program.residual_rms_m:
        return other
    if RIVAL * program.residual_rms_m < other.residual_rms_m:
        return program
    return either_of(program, other)


def either_of(first: Explanation, second: Explanation) -> Explanation:
    """Return the explanation that one of two is true, with the conventions that both have."""
    shared = tuple(part for part in first.conventions if part in second.conventions)
    alternatives: list[Alternative] = []
    size_m = 0.0
    for explanation in (first, second):
        parts = [*explanation.causes, *explanation.conventions]
        parts = [part for part in parts if part not in shared]
        size_m = max(size_m, *(part.size_m for part in parts))
        alternatives += _alternatives_of(parts)
    if len(alternatives) > ALTERNATIVES:
        return replace(first, causes=tuple(map(hedged, first.causes)), model=None)
    cause = one_of(alternatives, size_m)
    return replace(first, causes=(cause,), conventions=shared, model=None)


def _alternatives_of(parts: Sequence[Deviation]) -> list[Alternative]:
    """Return what several parts say together as one alternative; one "either … or …" as its own alternatives."""
    if len(parts) == 1 and parts[0].stage == EITHER:
        texts = parts[0].text.removeprefix("either ").split(", or ")
        return list(map(Alternative, parts[0].id.split("|"), texts))
    ids = "+".join(part.id for part in parts)
    return [Alternative(ids, " and ".join(part.text for part in parts))]


def or_mirrored(cause: Deviation, release: Array) -> Deviation:
    """Return a cause, or that it or a mirrored axis is true where both make the same motion.

    Another hemisphere is the motion mirrored in y, and a Coriolis force of the wrong sign that mirrored in x. A release
    on the axis is the same in both.

    Args:
        cause: that is certain, or not.
        release: x, y, z, vx, vy, vz of the scene in m and m/s.
    """
    index = {"hemisphere": 1, "coriolis_sign": 0}.get(cause.id)
    if index is None or release[index] or release[index + 3]:
        return cause
    axis = "xy"[index]
    mirrored = Alternative("column_mirrored", f"prints −{axis} in its column of {axis}")
    return one_of([Alternative(cause.id, cause.text), mirrored], cause.size_m)


def likelier_step(named: Explanation, stepped: Explanation) -> Explanation:
    """Return the likelier of two explanations with different steps, or one in which either step may be the cause.

    The second one is no rival if it is dearer.
    """
    if stepped.price > named.price or stepped.residual_rms_m > RIVAL * named.residual_rms_m:
        return named
    if RIVAL * stepped.residual_rms_m < named.residual_rms_m:
        return stepped
    return with_alternative_steps(named, stepped.causes)


def with_alternative_steps(named: Explanation, rivals: Sequence[Deviation]) -> Explanation:
    """Return an explanation in which the cause is its own step, or one of some rivals that make the same rows."""
    own = [cause for cause in named.causes if cause.stage == "integrator"]
    if len(own) != 1:
        return named
    steps = {cause.id: cause for cause in (*rivals, *own) if cause.stage == "integrator"}
    if len(steps) == 1:
        return named
    if len(steps) > ALTERNATIVES:
        step = unnamed_step_error(own[0].size_m)
    else:
        alternatives = [Alternative(cause.id, cause.text) for cause in steps.values()]
        step = one_of(alternatives, own[0].size_m)
    causes = tuple(step if cause is own[0] else cause for cause in named.causes)
    return replace(named, causes=causes)
