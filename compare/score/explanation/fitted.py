"""Find the best reading of a file among the families that fit it, and name its causes with their sizes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Deviation
from ...observed.least_squares import by_differences, gauss_newton
from .causes import causes_of
from .families import fits_of
from .findings import HARMLESS, Explanation, Model
from .gate import loose, may_be_told
from .readings import Reader, Reading
from .unexplained import Case, largest, rms

TRIED = 6  # readings of a family that are run
POLISHED = 3  # steps by which fitted numbers are moved
BETTER = 0.9  # of what was left, for a step that is taken
EXTRA = {"sphere": 0.0, "linear": 0.3, "angle": 0.6}  # decades by which a simpler family has to be better
NAMED_SHARE = 0.03  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number
ORDER = ("gravity", "model", "input", "release", "frame", "clock", "integrator")
STEP_LIKE = 1e-4  # of a frequency: errors of a step that a program may well have
CLEAN = 1e-3  # of what an integrator does: a named one leaves less
WIDE = 2.0  # times the square of the swing: what the leading error of a step leaves of the whole one
APART = 0.02  # of a step: how far a whole number of them may be from the spacing of the rows
MODELS = {
    "linear": ("linear_g", "is the linear two-dimensional model: its period does not grow with the amplitude"),
    "angle": ("linear_in_angle", "is linear in the angle of the cord: its period does not grow with the amplitude"),
}
TITLES = {
    "linear_g": "the linear two-dimensional model", "linear_in_angle": "the model linear in the angle",
    "no_centrifugal": "no centrifugal force (g effective)", "effective_gravity": "g effective",
    "uniform_gravity": "a centrifugal force constant along the swing", "no_tilt": "no horizontal centrifugal force",
    "point_mass": "gravity of a point mass", "sphere": "a spherical Earth", "mean_sphere": "a spherical Earth",
    "turned_plane": "a plane turned by hand", "turned_plane_sign": "a plane turned by hand, the wrong way",
}  # fmt: skip


def of_causes(case: Case) -> Explanation | None:
    """Return the explanation by the fewest causes; None if they leave too much for anything to be named."""
    best = best_of(case)
    return None if best is None else explanation_of(case, best)


def best_of(case: Case, integrators: bool = True, sure: bool = True) -> Reading | None:
    """Return the best reading of all families; None if it leaves too much for anything to be named.

    Args:
        case: the file.
        integrators: whether an integrator may be among the causes.
        sure: whether it has to leave little enough for its causes to be named.
    """
    fits = list(fits_of(case))
    noise = 1.5 * case.rows.noise
    least = min((fit.rest for fit in fits), default=math.inf)
    if sure and least > max(NAMED_SHARE * case.error, noise):
        return None
    floor = max(case.floor, 1.2 * least)
    best: Reading | None = None
    lowest = math.inf
    for fit in fits:
        if fit.rest > 3 * max(least, floor / 1.2):
            continue
        reader = Reader(replace(case.right, kind=fit.kind), fit, floor)
        causes = [cause for cause in causes_of(case, fit.kind) if integrators or cause.stage != "integrator"]
        likely = reader.readings(causes)[:TRIED]
        likely += [reader.without(reading, cause) for reading in likely[:2] for cause in reading.causes]
        for reading in likely:  # the distance from the fit is linear in theta: what counts is the program itself
            leaves = rms(case.left(reading.program))
            if math.isfinite(leaves):
                run = reader.scored(reading.causes, reading.program, leaves)
                if run.score + EXTRA[fit.kind] < lowest:
                    best, lowest = run, run.score + EXTRA[fit.kind]
    if best is not None:
        best = _polished(case, best)
    if best is None or not sure:
        return best
    share = FITTED_SHARE if any(cause.free for cause in best.causes) else NAMED_SHARE
    return best if best.rest <= max(share * case.error, noise) else None


def _polished(case: Case, reading: Reading) -> Reading:
    """Return the best reading with its fitted numbers moved to where its program, run, leaves least.

    The numbers of a reading are linear in those of the fit, which a number that is far off is not.
    """
    positions = case.rows.positions
    names = [cause.free for cause in reading.causes if cause.free]
    if not names:
        return reading

    def rows_of(values: Array) -> Array:
        program = reading.program.with_inputs(names, values)
        return (case.positions(program) if program.sensible else np.full_like(positions, np.nan)).ravel()

    start = np.array([float(getattr(reading.program, name)) for name in names])
    nudges = np.array([reading.reader.nudge(reading.program, name) for name in names])
    model = by_differences(rows_of, positions.ravel(), nudges)
    values, size = gauss_newton(model, start, steps=POLISHED, gain=BETTER)
    if (values == start).all():
        return reading
    program = reading.program.with_inputs(names, values)
    return reading.reader.scored(reading.causes, program, size / math.sqrt(len(positions)))


def explanation_of(case: Case, reading: Reading) -> Explanation:
    """Return the explanation that the best reading of a case makes up."""
    rows, reader = case.rows, reading.reader
    kind, reading = reader.right.kind, _without_needless_step(case, reading)
    causes = list(sized(case, reading))
    left = case.left(reading.program)
    corrected = largest(left)
    width = float(np.hypot(*rows.plane.T).max()) / case.right.length if kind == "sphere" else 0.0
    clean = max(CLEAN, WIDE * width**2, WIDE * CLEAN if width else 0.0)
    spacing = float(rows.times[1] - rows.times[0])
    causes = list(in_whole_steps(causes, spacing, clean))
    causes = list(as_loose(causes, max(corrected - 5 * rows.noise, 0.0), case.frequency, clean))
    causes = list(may_be_told(causes, corrected, case.allowed_m, max(case.allowed_m, 2 * rows.noise), spacing))
    more = corrected > case.allowed_m and reading.rest > 2 * max(rows.noise, reader.fit.rest)
    if more and reader.like_a_step(reading, causes_of(case, kind)):
        causes.append(loose(corrected))
    model = None
    simple = {cause.stage for cause in causes} <= {"gravity", "model"}
    if simple and corrected <= case.allowed_m and all(convention.id in HARMLESS for convention in rows.conventions):
        model = _model_of(kind, causes, corrected, largest(rows.positions - case.truth))
    price = sum(cause.cost for cause in reading.causes)
    return case.explanation(tuple(causes), corrected, rms(left), price, model)


def _without_needless_step(case: Case, reading: Reading) -> Reading:
    """Return a reading without its integrator where what is left without it is within the tolerance."""
    if reading.program.method is None:
        return reading
    bare = replace(reading.program, method=None, step=0.0)
    left = case.left(bare)
    if not largest(left) <= case.allowed_m:
        return reading
    others = tuple(cause for cause in reading.causes if cause.stage != "integrator")
    return replace(reading, causes=others, program=bare, rest=rms(left))


def sized(case: Case, reading: Reading) -> Iterator[Deviation]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    kind = reading.reader.right.kind
    changes = [(cause.stage, cause) for cause in reading.causes] + [("model", None)] * (kind != "sphere")
    program, before = case.right, case.truth
    for stage, cause in sorted(changes, key=lambda change: ORDER.index(change[0])):
        value = shift = uncertainty = None
        if cause is None:
            (word, text), program = MODELS[kind], replace(program, kind=kind)
        else:
            word, text, program = cause.id, cause.text, cause.change(program)
            if cause.free:
                value = reading.value(cause)
                program = program.with_input(cause.free, value)
                shift = value - float(getattr(case.right, cause.free))
                uncertainty = reading.reader.uncertainty(reading, cause)
                text = cause.sentence(value, case.right)
        after = case.positions(program)
        yield Deviation(word, text, largest(after - before), stage, value, shift, uncertainty)
        before = after


def in_whole_steps(causes: Sequence[Deviation], spacing: float, share: float) -> Iterator[Deviation]:
    """Yield the causes, a step that the rows' spacing holds a whole number of times put in place of the fitted one.

    Args:
        causes: those that were named.
        spacing: of the rows in s.
        share: of the step, within which it is known.
    """
    for cause in causes:
        if cause.stage != "integrator" or not cause.value or cause.uncertainty is None:
            yield cause
            continue
        many = round(spacing / cause.value)
        doubt = share * many
        if many and doubt < 0.5 and abs(spacing / cause.value - many) <= max(doubt, APART):
            step = spacing / many
            text = cause.text.replace(f"about {cause.value:.3g} s", f"{step:.3g} s")
            yield replace(cause, value=step, shift=step, text=text)
        else:
            yield replace(cause, uncertainty=max(cause.uncertainty, share * cause.value))


def as_loose(causes: Sequence[Deviation], left: float, frequency: float, clean: float) -> Iterator[Deviation]:
    """Call an integrator by its name only where that leaves next to nothing; else say that its error is like it.

    An integrator with a variable step moves the frequency and the amplitude as no fixed step does: numbers that were
    fitted beside it and do less than it are part of the same error.

    Args:
        causes: those that were named.
        left: the largest distance in m that they leave.
        frequency: of the swing in rad/s.
        clean: share of what an integrator does that it may leave.
    """
    fitted = {cause.id: cause for cause in causes if cause.shift is not None}
    drag = fitted.get("pendulum.drag")
    for word in ("site.gravity", "pendulum.length"):
        other = fitted.get(word)
        if drag is None or drag.shift is None or other is None:
            continue
        if _like_a_step(other) and abs(drag.shift) < 0.1 * STEP_LIKE * frequency:
            # frequency and amplitude off together and by this little: no input does that, a step does
            yield from (cause for cause in causes if cause not in (drag, other))
            yield loose(drag.size_m + other.size_m)
            return
    size = max((cause.size_m for cause in causes if cause.stage == "integrator"), default=0.0)
    unclear = size > 0 and left > clean * size
    for cause in causes:
        if cause.id in ("site.gravity", "pendulum.length") and _like_a_step(cause) and left > CLEAN * cause.size_m:
            if not size:
                yield loose(cause.size_m, cause.stage)
        elif unclear and cause.stage == "integrator":
            yield loose(cause.size_m)
        elif not (unclear and cause.value is not None and cause.size_m < size):
            yield cause


def _like_a_step(cause: Deviation) -> bool:
    return cause.value is not None and cause.shift is not None and abs(cause.shift) < STEP_LIKE * abs(cause.value)


def _model_of(kind: str, causes: Sequence[Deviation], exact: float, costs: float) -> Model | None:
    """Return the model that causes make up; None if one of them is no simplification with a name."""
    words = [cause.id for cause in causes]
    if kind != "sphere":
        words = [MODELS[kind][0], *(word for word in words if word != MODELS[kind][0])]
    if not words or any(word not in TITLES for word in words):
        return None
    return Model("+".join(words), ", ".join(TITLES[word] for word in words), exact, costs)
