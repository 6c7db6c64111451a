"""A slip in a program's force, read from its rows alone.

The slip is a wrong term, or a bob that falls or swings ever wider.

Near its lowest point the bob's acceleration is nearly linear in x, y and their velocities. The
difference of the rows' acceleration from the model's is fitted by such terms, and the largest are
named together with the model's own. The rows have to be close enough to be differentiated twice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from reference import Scene
from reference.model.constants import Constants, constants_in_double
from reference.model.force import acceleration
from reference.numbers.precision import Array

from ..observed.least_squares import solved
from .case import FileRows
from .programs import Program
from .thresholds import RIVAL

# stencils of order 6 for the first and the second derivative
_FIRST = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
_SECOND = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
# of order 4: its difference from the other estimates the error
_COARSE = np.array([-1, 16, -30, 16, -1]) / 12
_LEAST = 30  # rows that can be differentiated
_USUAL = 0.15  # rad of the swing: step between rows that are differentiated
_FARTHEST = 0.5  # rad of the swing: the largest step
_CLEAR = 10.0  # times their own error: accelerations that are wrong
_EXPLAINED = 0.02  # of the mean square: what the terms named may leave
_MOST = 3  # terms that are named
_WORK = 0.2  # of |force| |velocity|: a force that does work
_ALIKE = 0.2  # relative difference of two terms with the same error
_LOW = 0.3  # of the length: farther out, the force is not linear
_TERMS = {"1": "m/s²", "x": "1/s²", "y": "1/s²", "vx": "1/s", "vy": "1/s"}
# equation and name of two terms whose same error is that of one number: g or the length, drag
_ONE_NUMBER = ((("x", "x"), ("y", "y")), (("x", "vx"), ("y", "vy")))
_NUDGE = 1e-6
_PARTS = 4  # of the rows
_GROWN = 2.0  # how many times as far as in the first part a growing motion reaches in the last
_FREELY = (0.5, 2.5)  # of g: range of a fall's mean acceleration, from row 0 to every other row


def slip(rows: FileRows, scene: Scene) -> str:
    """Return a sentence on the part of the force that is wrong; empty if no row shows it."""
    k = constants_in_double(scene.exact)
    swing_rate = float(np.linalg.norm([float(component) for component in k.pull])) ** 0.5
    motion = _differentiated(rows.times, rows.plane, swing_rate)
    if motion is None:
        return ""
    state = motion.state
    if not float(np.abs(state[:2]).max()) < _LOW * k.length:
        return ""
    # whatever a program takes g for, a slip is an error beside that
    effective = replace(k, pull=(0, 0, -k.gravity), centrifugal=(0, 0, 0, 0))
    k = min(
        k, effective, key=lambda constants: _rms(motion.accelerations - _model(state, constants))
    )
    errors = motion.accelerations - _model(state, k)
    size = _rms(errors)
    if not size > _CLEAR * motion.error:
        return ""
    terms = list(_terms(state, errors, k))
    if not terms or _alike(terms):
        return ""

    sentences = "; ".join(term.sentence for term in terms)
    work = ""
    if _does_work(errors, state[2:]):
        work = " The difference does work, as no Coriolis force does."
    reading = "" if k.pull[1] or not k.rate else ", with g as the effective gravity,"
    difference = f"differ from the model's{reading} by {size:.2g} m/s²"
    return f"Its accelerations {difference}: {sentences}.{work}"


def _does_work(errors: Array, velocities: Array) -> bool:
    """Return whether errors of the accelerations do work along the motion."""
    power = np.mean(np.sum(errors * velocities, axis=0))
    return bool(abs(power) > _WORK * 2 * _rms(errors) * _rms(velocities))


def _rms(values: Array) -> float:
    """Return the root mean square of all values."""
    return float(np.sqrt(np.mean(values**2)))


@dataclass(frozen=True)
class _MotionOfRows:
    """The motion that rows show.

    Attributes:
        state: x, y, vx, vy in m and m/s, shape (4, rows).
        accelerations: of x and y in m/s², shape (2, rows).
        error: an estimate of the accelerations' root mean square error in m/s².
    """

    state: Array
    accelerations: Array
    error: float


def _differentiated(times: Array, plane: Array, swing_rate: float) -> _MotionOfRows | None:
    """Return the motion of evenly spaced rows by numerical differentiation.

    None if rows are too few, not evenly spaced, or too far apart for the scene's motion or their
    own. If rows are close to each other only some are used: the others would amplify the rounding.
    """
    steps = np.diff(times)
    if len(times) < _LEAST or not np.ptp(steps) < 1e-6 * steps[0]:
        return None
    if not steps[0] * swing_rate < _FARTHEST:
        return None
    stride = max(1, min(int(_USUAL / (steps[0] * swing_rate)), len(times) // _LEAST))
    h = float(steps[0]) * stride
    plane = plane[::stride]
    velocities = _convolved(plane, _FIRST) / h
    accelerations = _convolved(plane, _SECOND) / h**2
    coarse = _convolved(plane, _COARSE)[:, 1:-1] / h**2
    if h * h * _rms(accelerations) > _rms(plane):  # the bob turns back from row to row
        return None
    state = np.vstack([plane[3:-3].T, velocities])
    return _MotionOfRows(state, accelerations, _rms(accelerations - coarse))


def _convolved(plane: Array, stencil: Array) -> Array:
    """Return a stencil's sums over the rows of x and y, shape (2, rows)."""
    return np.array([np.convolve(column, stencil[::-1], "valid") for column in plane.T])


def _model(state: Array, k: Constants) -> Array:
    """Return the horizontal acceleration of the full model in m/s², shape (2, rows)."""
    x, y, vx, vy = state / k.length
    z = -np.sqrt(1 - x * x - y * y)
    ax, ay, _ = acceleration((x, y, z), (vx, vy, -(x * vx + y * vy) / z), k)
    return np.asarray(np.array([ax, ay]) * k.length)


@dataclass(frozen=True)
class _Term:
    """A term of an equation of motion: its coefficient in the rows, and in the model."""

    equation: str
    name: str
    value: float
    right: float

    @property
    def sentence(self) -> str:
        """What is reported of it."""
        name = "the constant term" if self.name == "1" else f"the term with {self.name}"
        value = f"{self.value:.6g} {_TERMS[self.name]}"
        right = f"{self.right + 0.0:.6g}"
        return f"in the equation of {self.equation}, {name} is {value} where the model has {right}"


def _terms(state: Array, errors: Array, k: Constants) -> Iterator[_Term]:
    """Yield the fewest terms that explain the errors of accelerations; none if they are many."""
    basis = np.vstack([np.ones(state.shape[1]), state])
    scale = np.sqrt(np.mean(basis**2, axis=1))
    scale[scale == 0] = 1.0
    basis /= scale[:, None]
    coefficients = _fewest_coefficients(basis, errors)

    # the model's coefficients, by central differences about the lowest point
    nudges = _NUDGE * np.eye(4)
    slopes = (_model(nudges, k) - _model(-nudges, k)) / (2 * _NUDGE)
    model = np.hstack([_model(np.zeros((4, 1)), k), slopes])
    for (i, j), coefficient in coefficients.items():
        right = float(model[i, j])
        yield _Term("xy"[i], list(_TERMS)[j], right + coefficient / float(scale[j]), right)


def _fewest_coefficients(basis: Array, errors: Array) -> dict[tuple[int, int], float]:
    """Return the coefficients of the fewest terms that explain errors, by equation and term.

    The terms are in the order in which they were chosen, each the one that leaves least. There are
    none if more than `_MOST` are needed.
    """
    candidates = [(i, j) for i in range(2) for j in range(len(_TERMS))]
    total = float(np.sum(errors**2))
    chosen: list[tuple[int, int]] = []
    while len(chosen) < _MOST:
        fits = {}
        for place in candidates:
            if place not in chosen:
                fits[place] = _fit(basis, errors, [*chosen, place])
        best = min(fits, key=lambda place: (fits[place].residual, place))
        chosen.append(best)
        if fits[best].residual < _EXPLAINED * total:
            most = RIVAL**2 * fits[best].residual
            if len(chosen) > 1 and _is_one_number(basis, errors, most):
                return {}
            return {place: fits[best].coefficients[place] for place in chosen}
    return {}


def _is_one_number(basis: Array, errors: Array, most: float) -> bool:
    """Return whether the same error in x and y, of one number, leaves no more than `most`, a sum of squares.

    In a swing whose x and y keep their ratio, a term with x does what one with y does.
    """
    for pair in _ONE_NUMBER:
        places = [("xy".index(equation), list(_TERMS).index(name)) for equation, name in pair]
        fit = _fit(basis, errors, places)
        first, second = fit.coefficients.values()
        if fit.residual <= most and first * second > 0:
            return True
    return False


@dataclass(frozen=True)
class _TermFit:
    """The sum of squares that some terms leave, and their coefficients by equation and term."""

    residual: float
    coefficients: dict[tuple[int, int], float]


def _fit(basis: Array, errors: Array, places: list[tuple[int, int]]) -> _TermFit:
    """Return the fit of errors by the terms at some places."""
    residual = 0.0
    coefficients: dict[tuple[int, int], float] = {}
    for i, values in enumerate(errors):
        terms = [j for equation, j in places if equation == i]
        solution = solved(basis[terms].T, values)
        for j, coefficient in zip(terms, solution, strict=True):
            coefficients[i, j] = float(coefficient)
        residual += float(np.sum((values - solution @ basis[terms]) ** 2))
    return _TermFit(residual, coefficients)


def _alike(terms: list[_Term]) -> bool:
    """Return whether x and y have the same error.

    Then a number, such as g or drag, or the integrator is wrong.
    """
    if {(term.equation, term.name) for term in terms} not in [set(pair) for pair in _ONE_NUMBER]:
        return False
    first, second = (term.value - term.right for term in terms)
    return abs(first - second) < _ALIKE * abs(first)


def falls(rows: FileRows, right: Program) -> str:
    """Return a sentence on the coordinate that falls far below the cord; empty if none does."""
    time = rows.times[1:] - rows.times[0]
    displacements = rows.plane[1:] - rows.plane[0]
    for name, displacement in zip("xy", displacements.T, strict=True):
        pulls = np.abs(2 * displacement / time**2) / right.g
        distance = float(abs(displacement[-1:]).sum())
        free = ((pulls > _FREELY[0]) & (pulls < _FREELY[1])).all()
        if free and distance > _GROWN * right.length:
            fell = f"Its {name} falls by {distance:.3g} m in {time[-1]:.3g} s"
            return (
                f"{fell}, as a body does that no cord holds: "
                f"{name} is its vertical, and its cord pulls too little."
            )
    return ""


def growth(rows: FileRows) -> str:
    """Return a sentence on how fast a motion grows throughout the rows; empty if it does not."""
    if len(rows.times) < 2 * _PARTS:
        return ""
    parts = np.array_split(np.arange(len(rows.times)), _PARTS)
    reach = np.array([float(np.hypot(*rows.plane[part].T).max()) for part in parts])
    if not (reach[1:] > reach[:-1]).all() or not reach[-1] > _GROWN * reach[0]:
        return ""
    between = float(rows.times[parts[-1]].mean() - rows.times[parts[0]].mean())
    fold = between / math.log(reach[-1] / reach[0])
    grows = f"Its motion grows by a factor of e in {fold:.2g} s"
    return f"{grows}: a force does work, or the cord does not hold."
