"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers tell."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from reference import FoucaultError, Scene
from reference.engines.trajectory import Variants
from reference.numbers.precision import Array

from ...approximations import APPROXIMATIONS, Motion
from .causes import NAMED
from .conventions import made_right
from .findings import Explanation, Model, SizedCause
from .fitted import HARMLESS, Case, best_of, explanation_of
from .formulas import slip_in_formula
from .naming import sized
from .pendulum import Pendulum
from .programs import Program
from .rows import Rows, largest, rms
from .slips import slip
from .stepped import of_steps

LOW = 0.25  # of the cord: a bob that comes nearer to the suspension's height makes no small swings
SHARE = 0.01  # of the error that may be left


@dataclass(frozen=True)
class Approximated:
    """An approximation that the rows follow.

    Attributes:
        cause: it, with the distance by which it moves the bob.
        model: it, as a model that the rows are exact within.
        left: what it leaves of each row in m, shape (rows, 2 or 3).
    """

    cause: SizedCause
    model: Model
    left: Array


def approximated(scene: Scene, rows: Rows, truth: Array) -> Approximated | None:
    """Return the approximation that leaves least, if that is next to nothing; of equal ones the first.

    Args:
        scene: the scene.
        rows: those of the file, conventions put right.
        truth: the positions of the full model at their times in m, shape (rows, 2 or 3).
    """
    count = rows.positions.shape[1]
    if count == 3 and not float(truth[:, 2].max()) < -LOW * float(scene.exact.length):
        return None
    error = float(np.linalg.norm(rows.positions - truth))
    best: Approximated | None = None
    least = max(SHARE * error, rows.noise * len(rows.times) ** 0.5)
    for word, motion in APPROXIMATIONS.items():
        if not isinstance(motion, Motion) or motion.refuses(scene) is not None:
            continue
        positions = motion.trajectory(scene, rows.times)[:, :count]
        left = rows.positions - positions
        rest = float(np.linalg.norm(left))
        if not rest < (least if best is None else least / 2):
            continue
        least = rest
        exact, costs = (float(np.linalg.norm(part, axis=1).max()) for part in (left, positions - truth))
        text = f"solves {motion.title} ({motion.where}) instead of the full equations"
        cause = SizedCause(word, text, costs, "model")
        best = Approximated(cause, Model(word, motion.title, exact, costs), left)
    return best


RENAMED = ("xy_swapped", "x_west", "y_south", "xy_reversed", "axes_turned")
_FAST = 20.0  # times faster than the scene: nothing is run
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
PLAINLY = 0.01  # of what fitted causes leave: an approximation that leaves less is meant


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
        wrong_term = slip(read.times, read.positions, scene)
        if wrong_term:  # one term of a formula, as no integrator changes it
            return Explanation(found.conventions, slip=wrong_term)
    return found


def _of_rows(
    rows: Rows, model: Variants, right: Program, frequency: float, scene: Scene, allowed_m: float
) -> Explanation:
    chosen = _sample(len(rows.times))
    rows = replace(rows, times=rows.times[chosen], positions=rows.positions[chosen])
    truth = model.states(scene.exact, rows.times if rows.times[0] == 0 else np.concatenate([[0.0], rows.times]))
    truth = truth[-len(rows.times) :, : rows.positions.shape[1]]
    pendulum = Pendulum(model, right.radius, right.gradient_square, _FAST * (frequency + abs(right.rate)))
    case = Case(rows, truth, right, pendulum, frequency, allowed_m)
    whole = largest(rows.positions - truth)
    plain = Explanation(rows.conventions, corrected_m=whole, score=case.score_of(whole))
    if case.error <= case.floor:
        return plain
    best = best_of(case)
    named = None if best is None else explanation_of(case, best)
    if named is not None and named.corrected_m <= case.enough:
        return named
    vague = named is None or any(cause.stage == "integrator" for cause in named.causes)
    spherical = best is None or best.family.kind == "sphere" or rows.cord is not None
    stepping = of_steps(case) if vague and spherical else None
    certain = stepping or (_of_formula(case) if vague else None)
    return certain or _of_approximation(case, scene, named) or named or plain


def _of_formula(case: Case) -> Explanation | None:
    """Return what is known of rows that follow a closed formula with a slip; None if they do not."""
    rows, right = case.rows, case.right
    slipped = slip_in_formula(rows, right, case.floor, case.causes("linear"))
    if slipped is None:
        return None
    named = tuple(sized(slipped.reading, slipped.reader, right, case.pendulum, rows, case.truth))
    left = slipped.formula.rest
    return Explanation(
        rows.conventions, named, None, left, slip=slipped.text, explained=1 - left / case.error,
        score=case.score_of(left) + slipped.price,
    )  # fmt: skip


def _of_approximation(case: Case, scene: Scene, named: Explanation | None) -> Explanation | None:
    """Return the approximation of the source papers that the rows follow; None if causes explain them as well."""
    rows = case.rows
    found = approximated(scene, rows, case.truth)
    if found is None or (named is not None and found.model.exact_to_m > PLAINLY * named.corrected_m):
        return None
    corrected = found.model.exact_to_m
    exact = corrected <= case.enough and all(one.id in HARMLESS for one in rows.conventions)
    return Explanation(
        rows.conventions, (found.cause,), found.model if exact else None, corrected,
        explained=1 - rms(found.left) / case.error, score=case.score_of(corrected) + NAMED,
    )  # fmt: skip


def _sample(count: int) -> Array:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded, np.arange(min(count, ROWS // 4))]).astype(np.int64))
