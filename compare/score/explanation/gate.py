"""The gate of all that is told of a reading: a cause that the rows speak for, and that nothing else looks like."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ...candidates.candidate import Deviation
from .findings import AS_IF
from .readings import SAME

CHANCE = 0.02  # that a number which nobody typed has as few digits, within its uncertainty
TYPED, MOST_DIGITS = 7, 9  # digits that people type, and that anybody does
SHARE = 3.0  # times what is left: a cause that moves the bob by less is not told from it
FAR = 1.5  # times the scene's g or length, or less by as much: what no program has that is merely off
METHOD_SHARE = 10.0  # times what is left: a method that moves it by less is not told from another
SLIGHT = 10.0  # times the tolerance: what a number that is nearly the scene's may move
WHOLE = 1e-6  # of a step: how far the rows' spacing may be from a whole number of them
ALIKE = 1.5  # ratio of two sizes that may cancel each other
LOOSE = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"


def loose(size_m: float, stage: str = "integrator") -> Deviation:
    """Return the cause that an integrator has an error, which one is not known."""
    return Deviation("integrator_loose", LOOSE, size_m, stage)


def may_be_told(
    causes: Iterable[Deviation], left_m: float, allowed_m: float, enough_m: float, spacing: float
) -> Iterator[Deviation]:
    """Yield what may be told of causes.

    Args:
        causes: those that were read from the rows.
        left_m: the largest distance in m that they leave.
        allowed_m: distance in m that counts as agreement.
        enough_m: that may be left, the rounding of the file included.
        spacing: of the rows in s.
    """
    causes, agrees = list(causes), left_m <= enough_m
    if any(not is_likely(cause) for cause in causes):
        return
    causes = [cause for cause in causes if cause.size_m > allowed_m and not is_the_scenes(cause, allowed_m)]
    typed = [
        cause.value is None or is_typed(cause, allowed_m / left_m if agrees and left_m else 0.0) for cause in causes
    ]
    least = 0.0
    if not agrees:  # what is not known may look like anything that is smaller
        unknown = [cause.size_m for cause, sure in zip(causes, typed, strict=True) if not sure and not _is_step(cause)]
        least = max(SHARE * left_m, *unknown, 0.0)
    steps = [cause.size_m for cause in causes if cause.id == "integrator_loose"]
    for cause, sure in zip(causes, typed, strict=True):
        if cause.stage == "model":
            if not agrees and any(size / ALIKE < cause.size_m < ALIKE * size for size in steps):
                continue  # a step's error takes back what this does
        elif cause.size_m < least:
            continue
        if _is_step(cause):
            clear = (agrees or cause.size_m > METHOD_SHARE * left_m) and _divides(cause, spacing)
            yield cause if clear else loose(cause.size_m)
        elif sure:
            yield cause
        else:
            text = f"moves like one that {cause.text}; a clock, a step or another term may do the same"
            yield replace(cause, id=f"{AS_IF}.{cause.id}", stage=AS_IF, text=text)


def _is_step(cause: Deviation) -> bool:
    return cause.stage == "integrator" and cause.value is not None


def _divides(step: Deviation, spacing: float) -> bool:
    """Return whether a step may divide the spacing of the rows, within its uncertainty."""
    assert step.value is not None
    many = spacing / step.value
    return abs(many - round(many)) <= many * max(WHOLE, (step.uncertainty or 0.0) / step.value)


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


def is_typed(cause: Deviation, within: float = 0.0) -> bool:
    """Return whether a person may have typed a fitted number, or the factor by which it differs from the scene's.

    Args:
        cause: with the number and its uncertainty.
        within: the tolerance over what is left, if nothing else is off: then numbers that serve as well count, and
            all of few digits; else 0, and it has to be shorter than by chance.
    """
    value, doubt = cause.value or 0.0, (cause.uncertainty or 0.0) * max(within, 1.0)
    if has_few_digits(value, doubt, within > 0):
        return True
    scene = value - (cause.shift or 0.0)
    factor = cause.id == "site.rotation_rate" and scene != 0
    return factor and has_few_digits(value / scene, doubt / abs(scene), within > 0)


def has_few_digits(value: float, doubt: float, any_few: bool) -> bool:
    """Return whether the shortest decimal within a doubt has few digits; see `is_typed`."""
    doubt = max(doubt, 2.0**-50 * abs(value))
    if abs(value) <= doubt:
        return True
    for digits in range(1, MOST_DIGITS + 1):
        unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
        if abs(round(value / unit) * unit - value) <= doubt:
            return (any_few and digits <= TYPED) or 2 * doubt < CHANCE * unit
    return False
