"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers tell."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from reference import FoucaultError, Scene
from reference.engines.variants import Variants
from reference.precision import Array

from .approximated import approximated
from .causes import NAMED, causes
from .conventions import made_right
from .families import Family, families_of, positions_of
from .findings import Explanation, SizedCause
from .formulas import slip_in_formula
from .naming import CLEAN, LOOSE, WIDE, in_whole_steps, model_of, sized, told_as_loose, trifling
from .pendulum import Pendulum
from .programs import Program
from .readings import Reader, Reading
from .rows import Rows, largest, rms
from .slips import slip

CONVENTION = 0.3  # decades that a convention has to explain
HARMLESS = ("z_constant", "decimals", "digits", "single_precision")  # conventions that a model may go with
RENAMED = ("xy_swapped", "x_west", "y_south", "xy_reversed", "axes_turned")
TRIED = 6  # readings of a family that are run
_FAST = 20.0  # times faster than the scene: nothing is run
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
PLAINLY = 0.01  # of what fitted causes leave: an approximation that leaves less is meant
EXACT = 1e-14  # of the cord: two numbers that differ by less are one
MODEL = 0.3  # decades by which a simpler family has to be better than the sphere
NAMED_SHARE = 0.03  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number


def explain(times: Array, columns: dict[str, Array], scene: Scene, allowed_m: float) -> Explanation:
    """Return what is known of the reasons for an error; empty where nothing is.

    Args:
        times: of the rows, in s.
        columns: x, y and perhaps z in m.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
    """
    try:
        with np.errstate(all="ignore"):
            return _explained(times, columns, scene, allowed_m)
    except (FoucaultError, ArithmeticError, np.linalg.LinAlgError):  # no program solves such a scene, or fits it
        return Explanation()


def _explained(times: Array, columns: dict[str, Array], scene: Scene, allowed_m: float) -> Explanation:
    model = Variants()
    inputs = scene.exact
    start = model.states(inputs, np.zeros(1))[0]
    right = Program.of(inputs, start)
    frequency = math.sqrt(abs(right.theta()[5]))
    read = made_right(times, columns, start, right.length, frequency)
    found = _of_rows(read, model, right, frequency, scene, allowed_m)
    if any(one.id in RENAMED for one in read.conventions):
        # the release may be at fault, and not the names of the columns
        as_named = made_right(times, columns, start, right.length, frequency, rename=False)
        other = _of_rows(as_named, model, right, frequency, scene, allowed_m)
        if other.score < found.score:
            found = other
    vague = any(one.id == "integrator_loose" for one in found.causes)
    if found.slip:
        return found
    if vague or (not found.causes and found.corrected_m > max(allowed_m, 1.5 * read.noise)):
        told = slip(read.times, read.positions, scene)
        if told:  # one term of a formula, as no integrator changes it
            return Explanation(found.conventions, slip=told)
    return found


def _of_rows(
    rows: Rows, model: Variants, right: Program, frequency: float, scene: Scene, allowed_m: float
) -> Explanation:
    inputs = scene.exact
    chosen = _sample(len(rows.times))
    rows = replace(rows, times=rows.times[chosen], positions=rows.positions[chosen])
    truth = model.states(inputs, rows.times if rows.times[0] == 0 else np.concatenate([[0.0], rows.times]))
    truth = truth[-len(rows.times) :, : rows.positions.shape[1]]
    error = rms(rows.positions - truth)
    whole = largest(rows.positions - truth)
    plain = Explanation(rows.conventions, corrected_m=whole, score=_score_of(whole, allowed_m, rows))
    floor = max(rows.noise, allowed_m / 3)
    if error <= floor:
        return plain
    named = _of_families(rows, model, right, frequency, truth, allowed_m, floor)
    if named is not None and named.corrected_m <= max(allowed_m, 1.5 * rows.noise):
        return named
    if named is None or any(cause.id == "integrator_loose" for cause in named.causes):
        misprinted = _of_formula(rows, model, right, frequency, truth, floor)
        if misprinted is not None:
            return misprinted
    as_printed = approximated(scene, rows, truth)
    if as_printed is None or (named is not None and as_printed.model.exact_to_m > PLAINLY * named.corrected_m):
        return named or plain
    corrected = as_printed.model.exact_to_m
    exact = corrected <= max(allowed_m, 1.5 * rows.noise) and all(one.id in HARMLESS for one in rows.conventions)
    return Explanation(
        rows.conventions,
        (as_printed.cause,),
        as_printed.model if exact else None,
        corrected,
        explained=1 - rms(as_printed.left) / error,
        score=_score_of(corrected, allowed_m, rows) + NAMED,
    )


def _of_families(
    rows: Rows, model: Variants, right: Program, frequency: float, truth: Array, allowed_m: float, floor: float
) -> Explanation | None:
    """Return what the fit of a family of models tells; None if nothing."""
    error, whole = rms(rows.positions - truth), largest(rows.positions - truth)
    pendulum = Pendulum(model, right.radius, right.gradient_square, _FAST * (frequency + abs(right.rate)))
    families = list(families_of(rows, right, pendulum, frequency, floor))
    if not families:
        return None
    least = min(family.fit.rest for family in families)
    if least > max(NAMED_SHARE * error, 1.5 * rows.noise):
        return None
    floor = max(floor, 1.2 * least)
    found: list[tuple[float, Family, Reading]] = []
    for family in families:
        if family.fit.rest > 3 * max(least, floor / 1.2):
            continue
        reader = Reader(replace(right, kind=family.kind), family.fit, floor)
        known = list(causes(right, family.kind, rows.cord, _released(rows, right)))
        extra = {"sphere": 0.0, "linear": MODEL, "angle": 2 * MODEL}[family.kind]
        likely = reader.readings(known)[:TRIED]
        likely += [reader.without(one, cause) for one in likely[:2] for cause in one.causes]
        for one in likely:  # the distance from the fit is linear in theta: what counts is the program itself
            leaves = rms(rows.positions - positions_of(one.program, pendulum, rows))
            if math.isfinite(leaves):
                run = reader.scored(one.causes, one.program, leaves)
                found.append((run.score + extra, family, run))
    if not found:
        return None
    found.sort(key=lambda one: one[0])
    _, family, best = found[0]
    share = FITTED_SHARE if any(cause.free for cause in best.causes) else NAMED_SHARE
    if best.rest > max(share * error, 1.5 * rows.noise):
        return None
    reader = Reader(replace(right, kind=family.kind), family.fit, floor)
    named = list(sized(best, reader, right, pendulum, rows, truth))
    left = rows.positions - positions_of(best.program, pendulum, rows)
    corrected = largest(left)
    width = float(np.hypot(*rows.positions[:, :2].T).max()) / right.length if family.kind == "sphere" else 0.0
    clean = max(CLEAN, WIDE * width**2, WIDE * CLEAN if width else 0.0)
    named = list(in_whole_steps(named, float(rows.times[1] - rows.times[0]), clean))
    named = [
        cause
        for cause in told_as_loose(named, max(corrected - 5 * rows.noise, 0.0), frequency, clean)
        if len(named) == 1 or not trifling(cause, allowed_m)
    ]
    if corrected > allowed_m and best.rest > 2 * max(rows.noise, family.fit.rest):
        known = list(causes(right, family.kind, rows.cord, _released(rows, right)))
        if reader.like_a_step(best, known):
            named.append(SizedCause("integrator_loose", LOOSE, corrected, "integrator"))
    simple = {cause.stage for cause in best.causes} <= {"gravity", "model"}
    result = None
    if simple and corrected <= allowed_m and all(one.id in HARMLESS for one in rows.conventions):
        result = model_of(family.kind, best, corrected, whole)
    explained = 1 - rms(left) / error
    score = _score_of(corrected, allowed_m, rows) + sum(cause.cost for cause in best.causes)
    return Explanation(rows.conventions, tuple(named), result, corrected, explained=explained, score=score)


def _released(rows: Rows, right: Program) -> bool:
    """Return whether row 0 is the release to its last digit."""
    off = np.abs(rows.positions[0, :2] - (right.x, right.y)).max()
    return bool(rows.times[0] == 0 and off <= 2 * rows.noise + EXACT * right.length)


def _of_formula(
    rows: Rows, model: Variants, right: Program, frequency: float, truth: Array, floor: float
) -> Explanation | None:
    """Return what is known of rows that follow a closed formula with a slip; None if they do not."""
    slipped = slip_in_formula(rows, right, floor, list(causes(right, "linear")))
    if slipped is None:
        return None
    pendulum = Pendulum(model, right.radius, right.gradient_square, _FAST * (frequency + abs(right.rate)))
    named = tuple(sized(slipped.reading, slipped.reader, right, pendulum, rows, truth))
    left = slipped.formula.rest
    explained = 1 - left / rms(rows.positions - truth)
    return Explanation(rows.conventions, named, None, left, slip=slipped.text, explained=explained)


def _score_of(left: float, allowed_m: float, rows: Rows) -> float:
    """Return decades by which what is left exceeds the tolerance, plus what the conventions cost."""
    return math.log10(max(left / allowed_m, 1e-2)) + CONVENTION * len(rows.conventions)


def _sample(count: int) -> Array:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded, np.arange(min(count, ROWS // 4))]).astype(np.int64))
