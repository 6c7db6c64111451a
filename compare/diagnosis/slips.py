"""A slip in a program's force, read from its rows alone: a term that is off, or a bob that falls or swings ever wider.

Near its lowest point the bob's acceleration is nearly linear in x, y and their velocities. What the rows have more than
the model is fitted by such terms, and the largest are named beside what the model has in their place. Needs rows close
enough to be differentiated twice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from reference import Scene
from reference.model.constants import Constants, constants_in_double
from reference.model.force import acceleration
from reference.numbers.precision import Array

from ..observed.least_squares import solved
from .case import FileRows
from .programs import Program

FIRST = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60  # stencils of order 6
SECOND = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
# of order 4, whose difference from the other tells the error
COARSE = np.array([-1, 16, -30, 16, -1]) / 12
LEAST = 30  # rows that can be differentiated
USUAL, FARTHEST = 0.15, 0.5  # steps between rows, in radians of the swing
CLEAR = 10.0  # times their own error: accelerations that are off
EXPLAINED = 0.02  # of the mean square that the terms named may leave
MOST = 3  # terms that are named
WORK = 0.2  # of |force| |velocity|: a force that does work
ALIKE = 0.2  # by which two terms that are off alike may differ
LOW = 0.3  # of the length: farther out, the force is not linear
TERMS = {"1": "m/s²", "x": "1/s²", "y": "1/s²", "vx": "1/s", "vy": "1/s"}
NUDGE = 1e-6
# of the rows, and how many times as far as in the first a growing motion reaches in the last
PARTS, GROWN = 4, 2.0
FREELY = 0.5, 2.5  # of g: what a fall's mean acceleration is between, from row 0 to every other


def slip(rows: FileRows, scene: Scene) -> str:
    """Return which part of the force is off, as a sentence; empty if the rows do not tell."""
    k = constants_in_double(scene.exact)
    rate = float(np.linalg.norm([float(part) for part in k.pull])) ** 0.5
    motion = _differentiated(rows.times, rows.plane, rate)
    if motion is None:
        return ""
    state, rates, error = motion
    if not float(np.abs(state[:2]).max()) < LOW * k.length:
        return ""
    # whatever g is taken for, a slip is what is off beside it
    effective = replace(k, pull=(0, 0, -k.gravity), centrifugal=(0, 0, 0, 0))
    k = min(k, effective, key=lambda constants: _size(rates - _model(state, constants)))
    off = rates - _model(state, k)
    size = _size(off)
    if not size > CLEAR * error:
        return ""
    terms = list(_terms(state, off, k))
    if not terms or _alike([(*term[:2], term[2] - term[3]) for term in terms]):
        return ""
    sentences = "; ".join(_sentence(*term) for term in terms)
    power = np.mean(np.sum(off * state[2:], axis=0))
    speed = float(np.sqrt(np.mean(state[2:] ** 2)))
    work = (
        " The difference does work, as no Coriolis force does."
        if abs(power) > WORK * 2 * size * speed
        else ""
    )
    taken = "" if k.pull[1] or not k.rate else ", with g as the effective gravity,"
    return (
        f"Its accelerations differ from the model's{taken} by {size:.2g} m/s²: {sentences}.{work}"
    )


def _size(rates: Array) -> float:
    return float(np.sqrt(np.mean(rates**2)))


def _differentiated(times: Array, plane: Array, rate: float) -> tuple[Array, Array, float] | None:
    """Return x, y, vx, vy, and ax, ay of rows with equal steps, differentiated, and the error of the last in m/s².

    None if rows are too few, or too far apart for the scene's motion or their own, or steps differ. Of rows that are
    close to each other only some are taken: their rounding would be magnified most.
    """
    steps = np.diff(times)
    if len(times) < LEAST or not np.ptp(steps) < 1e-6 * steps[0] or not steps[0] * rate < FARTHEST:
        return None
    stride = max(1, min(int(USUAL / (steps[0] * rate)), len(times) // LEAST))
    h, plane = float(steps[0]) * stride, plane[::stride]
    parts = [
        np.array([np.convolve(q, stencil[::-1], "valid") for q in plane.T])
        for stencil in (FIRST, SECOND, COARSE)
    ]
    speeds, rates, coarse = parts[0] / h, parts[1] / h**2, parts[2][:, 1:-1] / h**2
    if h * h * _size(rates) > _size(plane):  # the bob turns back from row to row
        return None
    return np.vstack([plane[3:-3].T, speeds]), rates, _size(rates - coarse)


def _model(state: Array, k: Constants) -> Array:
    """Return the horizontal acceleration of the full model in m/s², shape (2, rows)."""
    x, y, vx, vy = state / k.length
    z = -np.sqrt(1 - x * x - y * y)
    ax, ay, _ = acceleration((x, y, z), (vx, vy, -(x * vx + y * vy) / z), k)
    return np.asarray(np.array([ax, ay]) * k.length)


def _terms(state: Array, off: Array, k: Constants) -> Iterator[tuple[str, str, float, float]]:
    """Yield equation, term, its coefficient in the rows and in the model: the fewest that leave next to nothing."""
    basis = np.vstack([np.ones(state.shape[1]), state])
    scale = np.sqrt(np.mean(basis**2, axis=1))
    scale[scale == 0] = 1.0
    basis /= scale[:, None]
    places = [(i, j) for i in range(2) for j in range(len(TERMS))]
    chosen: list[tuple[int, int]] = []
    whole = float(np.sum(off**2))
    for _ in range(MOST):
        rest, place = min(
            (_left(basis, off, [*chosen, place])[0], place)
            for place in places
            if place not in chosen
        )
        chosen.append(place)
        if rest < EXPLAINED * whole:
            break
    else:
        return
    fitted = _left(basis, off, chosen)[1]
    nudges = NUDGE * np.eye(4)
    slopes = (_model(nudges, k) - _model(-nudges, k)) / (2 * NUDGE)
    model = np.hstack([_model(np.zeros((4, 1)), k), slopes])
    for i, j in chosen:
        right = float(model[i, j])
        yield "xy"[i], list(TERMS)[j], right + fitted[i, j] / float(scale[j]), right


def _left(
    basis: Array, off: Array, places: list[tuple[int, int]]
) -> tuple[float, dict[tuple[int, int], float]]:
    """Return the sum of squares that some terms leave, and their coefficients."""
    rest = 0.0
    fitted: dict[tuple[int, int], float] = {}
    for i, accelerations in enumerate(off):
        terms = [j for equation, j in places if equation == i]
        solution = solved(basis[terms].T, accelerations)
        fitted |= {(i, j): float(value) for j, value in zip(terms, solution, strict=True)}
        rest += float(np.sum((accelerations - solution @ basis[terms]) ** 2))
    return rest, fitted


def _alike(off: list[tuple[str, str, float]]) -> bool:
    """Return whether x and y are off alike: by a number, such as g or drag, or by the integrator, not by a slip."""
    pairs = ({("x", "x"), ("y", "y")}, {("x", "vx"), ("y", "vy")})
    if {part[:2] for part in off} not in pairs:
        return False
    (_, _, a), (_, _, b) = off
    return abs(a - b) < ALIKE * abs(a)


def _sentence(equation: str, term: str, value: float, right: float) -> str:
    name = "the constant term" if term == "1" else f"the term with {term}"
    return f"in the equation of {equation}, {name} is {value:.6g} {TERMS[term]} where the model has {right + 0.0:.6g}"


def falls(rows: FileRows, right: Program) -> str:
    """Return in a sentence which coordinate falls from row 0 on to far below the cord; empty if none does."""
    time, gone = rows.times[1:] - rows.times[0], rows.plane[1:] - rows.plane[0]
    for name, way in zip("xy", gone.T, strict=True):
        pulls = np.abs(2 * way / time**2) / right.g
        far = float(abs(way[-1:]).sum())
        if ((pulls > FREELY[0]) & (pulls < FREELY[1])).all() and far > GROWN * right.length:
            fell = f"Its {name} falls by {far:.3g} m in {time[-1]:.3g} s, as a body does that no cord holds"
            return f"{fell}: {name} is its vertical, and its cord pulls too little."
    return ""


def growth(rows: FileRows) -> str:
    """Return in a sentence how fast a motion grows; empty if it does not, part by part of the rows."""
    parts = np.array_split(np.arange(len(rows.times)), PARTS)
    if len(rows.times) < 2 * PARTS:
        return ""
    reach = np.array([float(np.hypot(*rows.plane[part].T).max()) for part in parts])
    if not (reach[1:] > reach[:-1]).all() or not reach[-1] > GROWN * reach[0]:
        return ""
    between = float(rows.times[parts[-1]].mean() - rows.times[parts[0]].mean())
    fold = between / math.log(reach[-1] / reach[0])
    return f"Its motion grows by a factor of e in {fold:.2g} s: a force does work, or the cord does not hold."
