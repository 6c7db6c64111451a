"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers tell."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from reference import Scene
from reference.engines.variants import Variants
from reference.precision import Array

from .causes import Cause, causes
from .conventions import Convention, Rows, made_right
from .pendulum import NAMES, Fit, Pendulum, fit_pendulum
from .phasors import Phasors, as_angles, fit_phasors
from .programs import Program
from .readings import Reader, Reading

_FAST = 20.0  # times faster than the scene: nothing is run
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
CLEAN = 1e-3  # of what an integrator does: a named one leaves less
MODEL = 0.3  # decades by which a simpler family has to be better than the sphere
NAMED_SHARE = 0.1  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number
FITTED = {"linear": ("turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy")}
MODELS = {
    "linear": ("linear_g", "is the linear two-dimensional model: its period does not grow with the amplitude"),
    "angle": ("linear_in_angle", "is linear in the angle of the cord: its period does not grow with the amplitude"),
}


@dataclass(frozen=True)
class SizedCause:
    """A cause with its size: the distance in m by which it alone moves the bob, on top of those before it."""

    id: str
    text: str
    size_m: float
    stage: str
    value: float | None = None
    uncertainty: float | None = None


@dataclass(frozen=True)
class Model:
    """A named simplification that the file is exact within.

    Attributes:
        id: a stable word.
        text: its name.
        exact_to_m: the largest distance in m between the file and it.
        costs_m: the largest distance in m between it and the full Lagrangian.
    """

    id: str
    text: str
    exact_to_m: float
    costs_m: float


@dataclass(frozen=True)
class Explanation:
    """What is known of the reasons for an error.

    Attributes:
        conventions: of the rows.
        causes: in the order gravity, model, inputs, release, frame, clock, integrator.
        model: the simplification that the file is exact within, if it is.
        corrected_m: the largest error in m that is left after all of these.
        also: other explanations as good, as text.
    """

    conventions: tuple[Convention, ...] = ()
    causes: tuple[SizedCause, ...] = ()
    model: Model | None = None
    corrected_m: float = math.nan
    also: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class _Family:
    """A family of models with its fit."""

    kind: str
    fit: Fit
    rows: Array


def explain(times: Array, columns: dict[str, Array], scene: Scene, allowed_m: float) -> Explanation:
    """Return what is known of the reasons for an error; empty where nothing is.

    Args:
        times: of the rows, in s.
        columns: x, y and perhaps z in m.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
    """
    model = Variants()
    inputs = scene.exact
    start = model.states(inputs, np.zeros(1))[0]
    right = Program.of(inputs, start)
    frequency = math.sqrt(abs(right.theta()[5]))
    rows = made_right(times, columns, start, right.length, frequency)
    chosen = _sample(len(rows.times))
    rows = replace(rows, times=rows.times[chosen], positions=rows.positions[chosen])
    truth = model.states(inputs, rows.times if rows.times[0] == 0 else np.concatenate([[0.0], rows.times]))
    truth = truth[-len(rows.times) :, : rows.positions.shape[1]]
    error = _rms(rows.positions - truth)
    corrected = float(np.linalg.norm(rows.positions - truth, axis=1).max())
    plain = Explanation(rows.conventions, corrected_m=corrected)
    floor = max(rows.noise, allowed_m / 3)
    if error <= floor:
        return plain
    pendulum = Pendulum(model, right.radius, right.gradient_square, _FAST * (frequency + abs(right.rate)))
    families = list(_families(rows, right, pendulum, frequency, floor))
    if not families:
        return plain
    least = min(family.fit.rest for family in families)
    floor = max(floor, 1.2 * least)
    found: list[tuple[float, _Family, Reading]] = []
    for family in families:
        if family.fit.rest > 3 * max(least, floor / 1.2):
            continue
        reader = Reader(replace(right, kind=family.kind), family.fit, floor)
        known = list(causes(right, family.kind))
        extra = {"sphere": 0.0, "linear": MODEL, "angle": 2 * MODEL}[family.kind]
        found += [(one.score + extra, family, one) for one in reader.readings(known)[:6]]
    found.sort(key=lambda one: one[0])
    score, family, best = found[0]
    share = FITTED_SHARE if any(cause.free for cause in best.causes) else NAMED_SHARE
    if best.rest > share * error:
        return plain
    named = list(_sized(best, family, right, pendulum, rows, truth))
    left = rows.positions - _positions(best.program, pendulum, rows)
    corrected = float(np.linalg.norm(left, axis=1).max())
    named = list(_loose(named, corrected))
    simple = {cause.stage for cause in best.causes} <= {"gravity", "model"}
    result = None
    if simple and corrected <= allowed_m and not rows.conventions:
        result = _model(family.kind, best, corrected, float(np.linalg.norm(rows.positions - truth, axis=1).max()))
    return Explanation(rows.conventions, tuple(named), result, corrected)


def _sample(count: int) -> Array:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded, np.arange(min(count, ROWS // 4))]).astype(np.int64))


def _rms(difference: Array) -> float:
    return float(np.linalg.norm(difference)) / math.sqrt(len(difference))


def _families(
    rows: Rows, right: Program, pendulum: Pendulum, frequency: float, floor: float
) -> Iterator[_Family]:
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
        yield _Family(kind, _fit_of(phasors, rest, rows.times, right), seen)
    sphere = _sphere(rows, right, pendulum, phasors_of_best, best, floor)
    if sphere is not None:
        yield _Family("sphere", sphere, rows.positions)


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
        if rest < floor:
            linear = guess.copy()
            linear[5] = -phasors.square.real
            linear[9:11] = phasors.speed.real, phasors.speed.imag
            apart = pendulum.rows(linear, rows.times, 2) - rows.positions[:, :2]
            if not _rms(apart) < 30 * floor:
                return None
    best = None
    for guess in guesses:
        for free in (range(12), range(len(NAMES))):
            fit = fit_pendulum(
                pendulum, rows.times, rows.positions, guess, scales, tuple(free), max(rows.noise, floor / 100)
            )
            if fit is None or len(fit.slopes) != rows.positions.size:
                break
            if best is None or fit.rest < best.rest or len(fit.free) > len(best.free):
                best = fit
            guess = fit.theta
        if best is not None and best.rest < floor:
            break
    return best


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
    slopes = np.column_stack([slopes, slopes[:, free.index(5)] * (xx + yy) / 2])
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
    best: Reading, family: _Family, right: Program, pendulum: Pendulum, rows: Rows, truth: Array
) -> Iterator[SizedCause]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    changes: list[tuple[str, str, str, object]] = [
        (cause.stage, cause.id, cause.text, cause) for cause in best.causes
    ]
    if family.kind != "sphere":
        changes.append(("model", *MODELS[family.kind], None))
    changes.sort(key=lambda one: ORDER.index(one[0]))
    program, before = right, truth
    for stage, word, text, cause in changes:
        value = None
        if isinstance(cause, Cause):
            program = cause.change(program)
            if cause.free:
                value = best.value(cause)
                program = program.with_input(cause.free, value)
                text = text.format(value=_number(cause, value, right))
        else:
            program = replace(program, kind=family.kind)
        after = _positions(program, pendulum, rows)
        yield SizedCause(word, text, float(np.nanmax(np.linalg.norm(after - before, axis=1))), stage, value)
        before = after


def _loose(named: list[SizedCause], left: float) -> Iterator[SizedCause]:
    """Call an integrator by its name only where that leaves next to nothing; else say that its error is like it.

    An integrator with a variable step moves the frequency and the amplitude as no fixed step does: numbers that were
    fitted beside it and do less than it are part of the same error.
    """
    size = max((cause.size_m for cause in named if cause.stage == "integrator"), default=0.0)
    loose = size > 0 and left > CLEAN * size
    for cause in named:
        if loose and cause.stage == "integrator":
            text = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"
            yield replace(cause, id="integrator_loose", text=text, value=None)
        elif not (loose and cause.value is not None and cause.size_m < size):
            yield cause


def _number(cause: Cause, value: float, right: Program) -> str:
    unit = {"g": " m/s²", "length": " m", "latitude": " degrees", "drag": " 1/s", "step": " s", "x": " m", "y": " m",
            "vx": " m/s", "vy": " m/s"}.get(cause.free, "")  # fmt: skip
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
