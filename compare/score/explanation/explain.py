"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers tell."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from reference import FoucaultError, Scene
from reference.engines.variants import Variants
from reference.precision import Array

from .approximated import approximated
from .causes import NAMED, Cause, causes
from .conventions import Rows, made_right
from .findings import Explanation, Model, SizedCause
from .pendulum import NAMES, Fit, Pendulum, fit_pendulum
from .phasors import Phasors, as_angles, fit_phasors
from .programs import Program
from .readings import SAME, Reader, Reading
from .slips import slip

CONVENTION = 0.3  # decades that a convention has to explain
HARMLESS = ("z_constant", "decimals", "digits", "single_precision")  # conventions that a model may go with
RENAMED = ("xy_swapped", "x_west", "y_south", "xy_reversed", "axes_turned")
TRIED = 6  # readings of a family that are run
_FAST = 20.0  # times faster than the scene: nothing is run
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
LOOSE = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"
STEP_LIKE = 1e-4  # of a frequency: errors of a step that a program may well have
PLAINLY = 0.01  # of what fitted causes leave: an approximation that leaves less is meant
CLEAN = 1e-3  # of what an integrator does: a named one leaves less
MODEL = 0.3  # decades by which a simpler family has to be better than the sphere
NAMED_SHARE = 0.03  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number
FITTED = {"linear": ("turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy")}
MODELS = {
    "linear": ("linear_g", "is the linear two-dimensional model: its period does not grow with the amplitude"),
    "angle": ("linear_in_angle", "is linear in the angle of the cord: its period does not grow with the amplitude"),
}


@dataclass(frozen=True)
class _Family:
    """A family of models with its fit."""

    kind: str
    fit: Fit


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
    error = _rms(rows.positions - truth)
    whole = _largest(rows.positions - truth)
    plain = Explanation(rows.conventions, corrected_m=whole, score=_score_of(whole, allowed_m, rows))
    floor = max(rows.noise, allowed_m / 3)
    if error <= floor:
        return plain
    named = _of_families(rows, model, right, frequency, truth, allowed_m, floor)
    if named is not None and named.corrected_m <= max(allowed_m, 1.5 * rows.noise):
        return named
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
        explained=1 - _rms(as_printed.left) / error,
        score=_score_of(corrected, allowed_m, rows) + NAMED,
    )


def _of_families(
    rows: Rows, model: Variants, right: Program, frequency: float, truth: Array, allowed_m: float, floor: float
) -> Explanation | None:
    """Return what the fit of a family of models tells; None if nothing."""
    error, whole = _rms(rows.positions - truth), _largest(rows.positions - truth)
    pendulum = Pendulum(model, right.radius, right.gradient_square, _FAST * (frequency + abs(right.rate)))
    families = list(_families(rows, right, pendulum, frequency, floor))
    if not families:
        return None
    least = min(family.fit.rest for family in families)
    floor = max(floor, 1.2 * least)
    found: list[tuple[float, _Family, Reading]] = []
    for family in families:
        if family.fit.rest > 3 * max(least, floor / 1.2):
            continue
        reader = Reader(replace(right, kind=family.kind), family.fit, floor)
        known = list(causes(right, family.kind))
        extra = {"sphere": 0.0, "linear": MODEL, "angle": 2 * MODEL}[family.kind]
        likely = reader.readings(known)[:TRIED]
        likely += [reader.without(one, cause) for one in likely[:2] for cause in one.causes]
        for one in likely:  # the distance from the fit is linear in theta: what counts is the program itself
            leaves = _rms(rows.positions - _positions(one.program, pendulum, rows))
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
    named = list(_sized(best, reader, right, pendulum, rows, truth))
    left = rows.positions - _positions(best.program, pendulum, rows)
    corrected = _largest(left)
    named = [
        cause
        for cause in _loose(named, max(corrected - 5 * rows.noise, 0.0), frequency)
        if len(named) == 1 or not _trifling(cause, allowed_m)
    ]
    simple = {cause.stage for cause in best.causes} <= {"gravity", "model"}
    result = None
    if simple and corrected <= allowed_m and all(one.id in HARMLESS for one in rows.conventions):
        result = _model(family.kind, best, corrected, whole)
    explained = 1 - _rms(left) / error
    score = _score_of(corrected, allowed_m, rows) + sum(cause.cost for cause in best.causes)
    return Explanation(rows.conventions, tuple(named), result, corrected, explained=explained, score=score)


def _score_of(left: float, allowed_m: float, rows: Rows) -> float:
    """Return decades by which what is left exceeds the tolerance, plus what the conventions cost."""
    return math.log10(max(left / allowed_m, 1e-2)) + CONVENTION * len(rows.conventions)


def _sample(count: int) -> Array:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded, np.arange(min(count, ROWS // 4))]).astype(np.int64))


def _largest(difference: Array) -> float:
    return float(np.linalg.norm(difference, axis=1).max())


def _rms(difference: Array) -> float:
    return float(np.linalg.norm(difference)) / math.sqrt(len(difference))


def _families(rows: Rows, right: Program, pendulum: Pendulum, frequency: float, floor: float) -> Iterator[_Family]:
    """Yield the families that were fitted: linear, linear in the angle, and the sphere."""
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    best, phasors_of_best = math.inf, None
    for kind in ("linear", "angle"):
        seen = plane if kind == "linear" else as_angles(plane, right.length)
        fitted = fit_phasors(rows.times, seen, frequency)
        if fitted is None:
            continue
        phasors, rest = fitted
        if rest < best:
            best, phasors_of_best = rest, phasors
        yield _Family(kind, _fit_of(phasors, rest, rows.times, right))
    sphere = _sphere(rows, right, pendulum, phasors_of_best, best, floor)
    if sphere is not None:
        yield _Family("sphere", sphere)


def _sphere(
    rows: Rows, right: Program, pendulum: Pendulum, phasors: Phasors | None, rest: float, floor: float
) -> Fit | None:
    """Return the best spherical pendulum; None if nothing fits, or the phasors fit and it is plainly another motion."""
    nominal = right.theta()
    plane = rows.positions[:, :2] @ np.array([1, 1j])
    g = right.g / right.length or abs(nominal[5])
    scales = np.array(
        [*[max(abs(right.rate), 1e-6)] * 3, g, g, g, math.sqrt(g), *[right.length] * 2,
         *[right.length * math.sqrt(g)] * 2, right.length, 1.0, 1.0]
    )  # fmt: skip
    guesses = [nominal, nominal.copy()]
    guesses[1][3:6] = 0.0, 0.0, -g
    if phasors is not None:
        guess = guesses[1].copy()
        tilt = float(np.abs(plane).max()) / right.length
        guess[2] = phasors.beta
        guess[5] = -phasors.square.real * (1 + tilt**2 / 8)
        guess[7:9] = plane[0].real, plane[0].imag
        if not rows.starts:
            guess[9:11] = phasors.speed.real, phasors.speed.imag
        guesses.insert(0, guess)
        if rest < 1e-3 * floor:
            linear = guess.copy()
            linear[5] = -phasors.square.real
            linear[9:11] = phasors.speed.real, phasors.speed.imag
            apart = pendulum.rows(linear, rows.times, 2) - rows.positions[:, :2]
            if not _rms(apart) < 30 * floor:
                return None
    return fit_pendulum(pendulum, rows.times, rows.positions, guesses, scales, max(rows.noise, floor / 100))


def _fit_of(phasors: Phasors, rest: float, times: Array, right: Program) -> Fit:
    """Return two phasors as a fit of theta, with the slopes by central differences."""
    theta = np.zeros(len(NAMES))
    pull = phasors.centre * phasors.square.real
    theta[2], theta[5], theta[6] = phasors.beta, -phasors.square.real, phasors.drag
    theta[3:5] = pull.real, pull.imag
    theta[7:11] = phasors.start.real, phasors.start.imag, phasors.speed.real, phasors.speed.imag
    theta[11] = right.length
    free = tuple(NAMES.index(name) for name in FITTED["linear"])
    omega = abs(phasors.square) ** 0.5
    size = max(abs(phasors.start), abs(phasors.speed) / omega if omega else 0.0) or 1.0
    sizes = {2: omega, 3: omega**2 * size, 4: omega**2 * size, 5: omega**2, 6: omega}
    columns = []
    for i in free:
        nudge = 1e-6 * sizes.get(i, size * omega if i > 8 else size) / (1 + omega * times[-1] * (i in (2, 5, 6)))
        moved = []
        for side in (1, -1):
            other = theta.copy()
            other[i] += side * nudge
            moved.append(_phasors_of(other).at(times))
        slope = (moved[0] - moved[1]) / (2 * nudge)
        columns.append(np.column_stack([slope.real, slope.imag]).ravel())
    slopes = np.column_stack(columns) / math.sqrt(len(times))
    # the centrifugal force's change along the swing makes ω² differ from x to y, which no two phasors do
    xx, yy, *_ = right.gradient_square
    answer = float(np.linalg.norm(slopes[:, free.index(5)]))
    slopes = np.column_stack([slopes, np.zeros(len(slopes))])
    apart = np.zeros((1, slopes.shape[1]))
    apart[0, -1] = answer * max(abs(xx - yy), abs(xx)) / 2
    return Fit(theta, rest, (*free, 12), np.vstack([slopes, apart]))


def _phasors_of(theta: Array) -> Phasors:
    square = -theta[5]
    centre = complex(theta[3], theta[4]) / square if square else 0j
    return Phasors.of(theta[2], square, theta[6], centre, complex(theta[7], theta[8]), complex(theta[9], theta[10]))


def _positions(program: Program, pendulum: Pendulum, rows: Rows) -> Array:
    """Return what a program writes, in the rows' columns."""
    if program.kind == "sphere":
        return pendulum.rows(program.theta(), rows.times, rows.positions.shape[1])
    plane = program.phasors().at(rows.times)
    if program.kind == "angle":
        angle = np.abs(plane) / program.length
        safe = np.where(angle > 0, angle, 1.0)
        plane = plane * np.where(angle > 0, np.sin(safe) / safe, 1.0)
    found = np.column_stack([plane.real, plane.imag])
    if rows.positions.shape[1] == 3:
        below = np.maximum(program.length**2 - np.abs(plane) ** 2, 0)
        found = np.column_stack([found, -np.sqrt(below)])
    return found


ORDER = ("gravity", "model", "input", "release", "frame", "clock", "integrator")


def _sized(
    best: Reading, reader: Reader, right: Program, pendulum: Pendulum, rows: Rows, truth: Array
) -> Iterator[SizedCause]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    changes: list[tuple[str, str, str, object]] = [(cause.stage, cause.id, cause.text, cause) for cause in best.causes]
    kind = reader.right.kind
    if kind != "sphere":
        changes.append(("model", *MODELS[kind], None))
    changes.sort(key=lambda one: ORDER.index(one[0]))
    program, before = right, truth
    for stage, word, text, cause in changes:
        value = shift = uncertainty = None
        sentence = text
        if isinstance(cause, Cause):
            program = cause.change(program)
            if cause.free:
                value = best.value(cause)
                program = program.with_input(cause.free, value)
                shift = value - float(getattr(right, cause.free))
                uncertainty = reader.uncertainty(best, cause)
                sentence = text.format(value=_number(cause, value, right))
        else:
            program = replace(program, kind=kind)
        after = _positions(program, pendulum, rows)
        yield SizedCause(word, sentence, _largest(after - before), stage, value, shift, uncertainty)
        before = after


def _loose(named: list[SizedCause], left: float, frequency: float) -> Iterator[SizedCause]:
    """Call an integrator by its name only where that leaves next to nothing; else say that its error is like it.

    An integrator with a variable step moves the frequency and the amplitude as no fixed step does: numbers that were
    fitted beside it and do less than it are part of the same error.
    """
    fitted = {cause.id: cause for cause in named if cause.shift is not None}
    drag = fitted.get("pendulum.drag")
    for word in ("site.gravity", "pendulum.length"):
        other = fitted.get(word)
        if drag is None or other is None or other.shift is None or drag.shift is None or other.value is None:
            continue
        if abs(other.shift) < STEP_LIKE * abs(other.value) and abs(drag.shift) < 0.1 * STEP_LIKE * frequency:
            # frequency and amplitude off together and by this little: no input does that, a step does
            size = drag.size_m + other.size_m
            named = [cause for cause in named if cause not in (drag, other)]
            named.append(SizedCause("integrator_loose", LOOSE, size, "integrator"))
            yield from named
            return
    size = max((cause.size_m for cause in named if cause.stage == "integrator"), default=0.0)
    loose = size > 0 and left > CLEAN * size
    for cause in named:
        if cause.id in ("site.gravity", "pendulum.length") and _like_a_step(cause) and left > CLEAN * cause.size_m:
            if not size:
                yield replace(cause, id="integrator_loose", text=LOOSE, value=None, shift=None, uncertainty=None)
            continue
        if loose and cause.stage == "integrator":
            yield replace(cause, id="integrator_loose", text=LOOSE, value=None, shift=None, uncertainty=None)
        elif not (loose and cause.value is not None and cause.size_m < size):
            yield cause


def _like_a_step(cause: SizedCause) -> bool:
    return cause.value is not None and cause.shift is not None and abs(cause.shift) < STEP_LIKE * abs(cause.value)


def _trifling(cause: SizedCause, allowed_m: float) -> bool:
    """Return whether a fitted number is the scene's own but for an error of the integrator."""
    if cause.value is None or cause.shift is None:
        return False
    return abs(cause.shift) < SAME * abs(cause.value) and cause.size_m < 10 * allowed_m


def _number(cause: Cause, value: float, right: Program) -> str:
    unit = {"g": " m/s²", "length": " m", "latitude": " degrees", "drag": " 1/s", "step": " s", "x": " m", "y": " m",
            "altitude": " m", "vx": " m/s", "vy": " m/s"}.get(cause.free, "")  # fmt: skip
    if cause.free == "rate":
        return f"{value / right.rate:.8g}"
    if cause.free == "step":
        return f"{value:.3g}{unit}"
    return f"{value:.10g} and not {getattr(right, cause.free):.10g}{unit}"


def _model(kind: str, best: Reading, exact: float, costs: float) -> Model | None:
    words = [cause.id for cause in best.causes]
    if kind != "sphere":
        words = [MODELS[kind][0], *words]
    names = {
        "linear_g": "the linear two-dimensional model", "linear_in_angle": "the model linear in the angle",
        "no_centrifugal": "no centrifugal force (g effective)", "effective_gravity": "g effective",
        "uniform_gravity": "a centrifugal force constant along the swing", "no_tilt": "no horizontal centrifugal force",
        "point_mass": "gravity of a point mass", "sphere": "a spherical Earth", "mean_sphere": "a spherical Earth",
        "turned_plane": "a plane turned by hand", "turned_plane_sign": "a plane turned by hand, the wrong way",
    }  # fmt: skip
    if any(word not in names for word in words) or not words:
        return None
    return Model("+".join(words), ", ".join(names[word] for word in words), exact, costs)
