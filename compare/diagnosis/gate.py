"""The gate of an explanation: it lets through a cause that the rows speak for, and that nothing else looks like."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ..candidates.candidate import Deviation
from .case import AS_IF
from .causes import shortest_decimal
from .readings import SAME

CHANCE = 0.02  # that a number which nobody typed has as few digits, within its uncertainty
SCARCE = 0.2  # and where all the rest agrees: a doubt of a tenth of the last digit, either way
TYPED, MOST_DIGITS = 7, 9  # digits that people type, and that anybody does
FACTOR_DIGITS = 4  # and of a factor
# times what is left, or what is not known: a cause that moves the bob by less is not told from it
SHARE = 3.0
# times the scene's g or length, or less by as much: what no program has that is merely off
FAR = 1.5
METHOD_SHARE = 0.1  # of what a method does that may be left, or it is not told from another
EXACTLY = 1e-3  # of the tolerance: a step that leaves less needs no other number to be known
UNSURE_SHARE = 0.03  # where several steps divide the spacing of the rows
SLIGHT = 10.0  # times the tolerance: what a number that is nearly the scene's may move
STEP_LIKE = 1e-4  # of a frequency: errors of a step that a program may well have
APART = 0.02  # of a step: how far a whole number of them may be from the spacing of the rows
SMALLEST_STEP = 1e-5  # over the frequency: no program makes smaller steps
CLEAN = 1e-3  # of what an integrator does: a named one leaves less
LOOSE = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"


@dataclass(frozen=True)
class Evidence:
    """How much error a reading leaves, and how much the file can show.

    Attributes:
        left_m: the largest distance in m that its causes leave.
        allowed_m: distance in m that counts as agreement.
        enough_m: that may be left, the rounding of the file included.
        spacing: of the rows in s.
        frequency: of the swing in rad/s.
        clean: share of what an integrator does that its name may leave.
        shown: ids of inputs that row 0 has itself.
    """

    left_m: float
    allowed_m: float
    enough_m: float
    spacing: float
    frequency: float
    clean: float
    shown: tuple[str, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether what is left is no more than the tolerance and the rounding."""
        return self.left_m <= self.enough_m


def loose(size_m: float, stage: str = "integrator") -> Deviation:
    """Return the cause that an integrator has an error, which one is not known."""
    return Deviation("integrator_loose", LOOSE, size_m, stage)


def hedged(cause: Deviation) -> Deviation:
    """Return a cause as one that the motion is merely like."""
    text = f"moves like one that {cause.text}; a clock, a step or another term may do the same"
    return replace(cause, id=f"{AS_IF}.{cause.id}", stage=AS_IF, text=text)


def supported_causes(causes: Sequence[Deviation], evidence: Evidence) -> Iterator[Deviation]:
    """Yield the causes, read from the rows, that these speak for; a number that nobody typed as a motion like it."""
    if any(not is_likely(cause) or not math.isfinite(cause.size_m) for cause in causes):
        return
    allowed, left, agrees = evidence.allowed_m, evidence.left_m, evidence.agrees
    causes = [_in_whole_steps(cause, evidence) for cause in _drift_as_step(causes, evidence)]
    causes = [
        cause
        for cause in causes
        if cause.size_m > evidence.enough_m and not is_the_scenes(cause, allowed)
    ]
    typed = [
        cause.stage == "integrator"
        or cause.value is None
        or cause.id in evidence.shown
        or is_typed(cause, agrees)
        for cause in causes
    ]
    unknown = max(
        (cause.size_m for cause, sure in zip(causes, typed, strict=True) if not sure), default=0.0
    )
    steps = max((cause.size_m for cause in causes if cause.stage == "integrator"), default=0.0)
    # what a step does is known exactly where it was taken, and in a linear model
    exact = any(_is_step(cause) and cause.uncertainty is None for cause in causes)
    rough = evidence.clean * steps if evidence.clean > CLEAN and not exact else 0.0
    causes = [_as_known(cause, evidence, unknown) for cause in causes]
    nameless = max(
        (cause.size_m for cause in causes if cause.id == "integrator_loose"), default=0.0
    )
    for cause, sure in zip(causes, typed, strict=True):
        if cause.stage != "integrator" and cause.size_m < rough:
            continue
        doubtful = typed.count(False) > 1 and left > EXACTLY * allowed
        if cause.stage == "integrator" and doubtful and cause.size_m < unknown:
            continue  # several numbers that nobody typed make what a step does
        # what is not known may look like anything that is smaller, and what is not known of a step like a model
        like = (
            0.0
            if agrees
            else max(left, unknown if sure else 0.0, steps if cause.stage == "model" else 0.0)
        )
        if cause.size_m < max(
            SHARE * like, nameless if cause.stage in ("gravity", "model") else 0.0
        ):
            continue
        if sure:
            yield cause
        elif agrees or cause.size_m > steps:  # else it is part of the step's error
            yield hedged(cause)


def _as_known(cause: Deviation, evidence: Evidence, unknown: float) -> Deviation:
    """Return a cause; of a step that leaves too much, or beside a number of unknown origin in m, only that it errs."""
    if not _is_step(cause):
        return cause
    left, agrees = evidence.left_m, evidence.agrees
    run = agrees and (
        cause.uncertainty is None or (not cause.uncertainty and left < EXACTLY * evidence.allowed_m)
    )
    share = min(evidence.clean, UNSURE_SHARE if cause.uncertainty else METHOD_SHARE)
    clear = agrees or left < share * cause.size_m
    return cause if run or (clear and not unknown) else loose(cause.size_m)


def without_doubtful_steps(
    causes: Sequence[Deviation], left_m: float, enough_m: float
) -> list[Deviation]:
    """Return causes of which those steps have no name any more that leave too much beside what they do."""
    return [
        loose(cause.size_m)
        if _is_step(cause) and left_m > max(enough_m, METHOD_SHARE * cause.size_m)
        else cause
        for cause in causes
    ]


def _is_step(cause: Deviation) -> bool:
    return cause.stage == "integrator" and cause.value is not None


def _in_whole_steps(cause: Deviation, evidence: Evidence) -> Deviation:
    """Return a cause, its step replaced by that which divides the spacing of the rows: one of no name if none does.

    Its uncertainty is 0 then, unless several steps do.
    """
    if not _is_step(cause) or not cause.uncertainty:
        return cause
    assert cause.value is not None
    steps = round(evidence.spacing / cause.value)
    doubt, off = evidence.clean * steps, abs(evidence.spacing / cause.value - steps)
    too_fine = cause.value * evidence.frequency < SMALLEST_STEP
    if not steps or off > max(doubt, APART) or evidence.clean >= 1 or too_fine:
        return loose(cause.size_m)
    if doubt >= 1 / 2:
        return replace(cause, uncertainty=max(cause.uncertainty, evidence.clean * cause.value))
    step = evidence.spacing / steps
    text = cause.text.replace(f"about {cause.value:.3g} s", f"{step:.3g} s")
    return replace(cause, value=step, shift=step, uncertainty=0.0, text=text)


def divides(step: float, spacing: float, clean: float) -> bool:
    """Return whether a step, known to a share `clean` of it, plainly divides the spacing of the rows."""
    steps = round(spacing / step)
    doubt = clean * steps
    off = abs(spacing / step - steps)
    return steps > 0 and off <= max(doubt, APART) and 2 * doubt < SCARCE


def _drift_as_step(causes: Sequence[Deviation], evidence: Evidence) -> list[Deviation]:
    """Return causes in which a step's error stands for a frequency that is off by little.

    An integrator with a variable step moves the frequency and the amplitude, as no input does and no fixed step.
    """
    fitted = {cause.id: cause for cause in causes if cause.shift is not None}
    drag = fitted.get("pendulum.drag")
    slow = drag is not None and abs(drag.shift or 0.0) < 0.1 * STEP_LIKE * evidence.frequency
    steps = any(cause.stage == "integrator" for cause in causes)
    kept = list(causes)
    for word in ("site.gravity", "pendulum.length"):
        cause = fitted.get(word)
        if cause is None or not abs(cause.shift or 0.0) < STEP_LIKE * abs(cause.value or 0.0):
            continue
        if slow and drag is not None:
            return [
                *(other for other in kept if other not in (drag, cause)),
                loose(drag.size_m + cause.size_m),
            ]
        if not evidence.agrees and evidence.left_m > CLEAN * cause.size_m:
            kept = [other for other in kept if other is not cause]
            if not steps:
                kept.append(loose(cause.size_m))
    return kept


def is_the_scenes(cause: Deviation, allowed_m: float) -> bool:
    """Return whether a fitted number is the scene's own within its uncertainty, or but for a small step."""
    if cause.value is None or cause.shift is None:
        return False
    slight = abs(cause.shift) < SAME * abs(cause.value) and cause.size_m < SLIGHT * allowed_m
    return slight or abs(cause.shift) <= (cause.uncertainty or 0.0)


def is_likely(cause: Deviation) -> bool:
    """Return whether a g or a length is one that a program may have: not far from the scene's, or typed."""
    if cause.id not in ("site.gravity", "pendulum.length") or cause.value is None:
        return True
    scene = cause.value - (cause.shift or 0.0)
    return scene / FAR < cause.value < FAR * scene or is_typed(cause)


def is_typed(cause: Deviation, agrees: bool = False) -> bool:
    """Return whether a person may have typed a fitted number, or the factor by which it differs from the scene's.

    Args:
        cause: with the number and its uncertainty.
        agrees: whether nothing else is off: then a number of few digits needs less evidence.
    """
    value = cause.value or 0.0
    doubt = cause.uncertainty or 0.0
    scene = value - (cause.shift or 0.0)
    # another size and another sign at once take better evidence
    lenient = agrees and value * scene >= 0
    if has_few_digits(value, doubt, lenient):
        return True
    factor = cause.id == "site.rotation_rate" and scene != 0
    return factor and has_few_digits(value / scene, doubt / abs(scene), lenient, FACTOR_DIGITS)


def has_few_digits(value: float, doubt: float, lenient: bool, most: int = MOST_DIGITS) -> bool:
    """Return whether the shortest decimal within a doubt has few digits; see `is_typed`."""
    doubt = max(doubt, 2.0**-50 * abs(value))
    if abs(value) <= doubt:
        return True
    _, digits = shortest_decimal(value, doubt)
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    chance = SCARCE if lenient and digits <= TYPED else CHANCE
    return digits <= most and 2 * doubt < chance * unit
