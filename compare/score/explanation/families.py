"""The families of models that are fitted to rows: linear, linear in the angle of the cord, and the sphere."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array

from .pendulum import NAMES, Fit, Pendulum, fit_pendulum
from .phasors import Phasors, as_angles, fit_phasors
from .programs import Program
from .rows import Rows, rms

FITTED = {"linear": ("turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy")}


@dataclass(frozen=True)
class Family:
    """A family of models with its fit."""

    kind: str
    fit: Fit


def families_of(rows: Rows, right: Program, pendulum: Pendulum, frequency: float, floor: float) -> Iterator[Family]:
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
        yield Family(kind, _fit_of(phasors, rest, rows.times, right))
    sphere = _sphere(rows, right, pendulum, phasors_of_best, best, floor)
    if sphere is not None:
        yield Family("sphere", sphere)


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
            if not rms(apart) < 30 * floor:
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


def pendulum_of(program: Program, pendulum: Pendulum) -> tuple[Pendulum, Array]:
    """Return the pendulum and the theta of a program, the centrifugal force's change that of its own latitude."""
    theta = program.theta()
    theta[NAMES.index("gradient")] = program.gradient
    return replace(pendulum, square=program.gradient_square), theta


def positions_of(program: Program, pendulum: Pendulum, rows: Rows) -> Array:
    """Return what a program writes, in the rows' columns."""
    if program.kind == "sphere":
        own, theta = pendulum_of(program, pendulum)
        return own.rows(theta, rows.times, rows.positions.shape[1])
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
