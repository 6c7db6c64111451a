"""The families of models that are fitted to rows: linear, linear in the angle of the cord, and the sphere.

None needs the truth. The best values of `theta`, and how sharply the file determines each of them (`slopes`), are read
by `readings`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import best_change
from .case import EQUAL, FileCase, first_least, rms
from .phasors import ComplexArray, Phasors, as_angles, fit_phasors
from .programs import NAMES, Program, SphericalPendulum, phasors_of, theta_of

# numbers that two phasors tell
LINEAR = ("turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy")
STEPS = 16  # Gauss-Newton steps in one window at most
DAMPING = (0.0, 1e-7, 1e-5, 1e-3)  # of steps, after each that fails
# of the amplitude: how far a nudge moves the rows, for differences that are linear and not noise
SEEN = 1e-6
# in scales: how far a number may be off
WIDTHS = np.array([1e4] * 3 + [1.0] * 3 + [1.0] + [1.0] * 5 + [3.0] * 2)
HOPELESS = 0.05  # of the amplitude: what leaves more in a window is not followed to the next
WINDOWS = 8.0  # ratio of the lengths of one window and the one before


@dataclass(frozen=True)
class FamilyFit:
    """The best theta of a family, what is left, and how the rows answer to each number.

    Attributes:
        kind: of the family: sphere; linear; or angle, linear in the angle.
        theta: the best values, as `NAMES`.
        rest: root mean square of what is left, in m.
        free: indices of the numbers that were fitted.
        slopes: d rows / d theta for these, over sqrt(rows), so that |slopes @ change| is a root mean square in m.
    """

    kind: str
    theta: Array
    rest: float
    free: tuple[int, ...]
    slopes: Array


def fits_of(case: FileCase) -> Iterator[FamilyFit]:
    """Yield the fits of the families: linear, linear in the angle, and the sphere."""
    rows, right = case.rows, case.right
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    best, phasors_of_best = math.inf, None
    for kind in ("linear", "angle"):
        seen = plane if kind == "linear" else as_angles(plane, right.length)
        fitted = fit_phasors(rows.times, seen, case.frequency)
        if fitted is None:
            continue
        phasors, rest = fitted
        if rest < best:
            best, phasors_of_best = rest, phasors
        yield _fit_of(kind, phasors, rest, rows.times, right)
    sphere = _sphere(case, phasors_of_best, best)
    if sphere is not None:
        yield sphere


def _sphere(case: FileCase, phasors: Phasors | None, rest: float) -> FamilyFit | None:
    """Return the best spherical pendulum; None if nothing fits, or the phasors fit and it is plainly another motion."""
    rows, right, floor = case.rows, case.right, case.floor
    nominal = right.theta()
    plane = rows.plane @ np.array([1, 1j])
    guesses = [nominal, nominal.copy()]
    guesses[1][3:6] = 0.0, 0.0, -case.pull
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
            apart = case.pendulum.rows(linear, rows.times, 2) - rows.plane
            if not rms(apart) < 30 * floor:
                return None
    return fit_pendulum(case, case.pendulum, guesses)


def _fit_of(kind: str, phasors: Phasors, rest: float, times: Array, right: Program) -> FamilyFit:
    """Return two phasors as a fit of theta, with the slopes by central differences."""
    theta = np.zeros(len(NAMES))
    theta[11] = right.length
    theta = theta_of(phasors, theta)
    free = tuple(NAMES.index(name) for name in LINEAR)
    omega = abs(phasors.square) ** 0.5
    size = max(abs(phasors.start), abs(phasors.speed) / omega if omega else 0.0) or 1.0
    sizes = {
        2: omega,
        3: omega**2 * size / right.length,
        4: omega**2 * size / right.length,
        5: omega**2,
        6: omega,
    }

    def plane_of(theta: Array) -> ComplexArray:
        return phasors_of(theta, -theta[5], complex(theta[7], theta[8])).at(times)

    columns = []
    for i in free:
        nudge = (
            1e-6
            * sizes.get(i, size * omega if i > 8 else size)
            / (1 + omega * times[-1] * (i in (2, 5, 6)))
        )
        move = nudge * np.eye(len(NAMES))[i]
        slope = (plane_of(theta + move) - plane_of(theta - move)) / (2 * nudge)
        columns.append(slope.view(float))
    slopes = np.column_stack(columns) / math.sqrt(len(times))
    # the centrifugal force's change along the swing makes ω² differ from x to y, which no two phasors do
    xx, yy, *_ = right.gradient_square
    answer = float(np.linalg.norm(slopes[:, free.index(5)]))
    slopes = np.pad(slopes, (0, 1))
    slopes[-1, -1] = answer * abs(xx - yy) / 2
    return FamilyFit(kind, theta, rest, (*free, 12), slopes)


def windows(times: Array, ratio: float, least: int, short: int) -> list[int]:
    """Return numbers of rows from the first on, each span `ratio` times the one before it, the last that of all rows.

    Args:
        times: of the rows in s, from 0 on.
        ratio: of two spans.
        least: rows of a span at least.
        short: rows of a span that is not divided any more.
    """
    ends, span = [len(times)], float(times[-1])
    while span > 0 and ends[-1] > short:
        span /= ratio
        ends.append(max(least, int(np.searchsorted(times, span)) + 1))
    return sorted(set(ends))


def fit_pendulum(
    case: FileCase, pendulum: SphericalPendulum, guesses: Sequence[Array]
) -> FamilyFit | None:
    """Fit theta by Gauss-Newton from the best of some guesses, the span growing; None if nothing fits all rows.

    A number that the rows do not determine stays near its guess: it is held there as loosely as `WIDTHS` says.
    """
    first, *longer = (case.part(count) for count in windows(case.rows.times, WINDOWS, 16, 24))
    small = np.full(len(NAMES), 1e-6)
    fits = [_in_window(first, pendulum, guess, guess, small) for guess in guesses]
    best, guess = _nearest_of_equals(first, fits, guesses)
    size = float(np.abs(case.rows.plane).max())
    for part in longer:
        if not best.rest <= HOPELESS * float(np.abs(part.rows.plane).max()):
            return None
        answers = np.linalg.norm(best.slopes * case.scales, axis=0) * WINDOWS
        nudges = np.clip(SEEN * size / np.maximum(answers, 1e-300), 1e-13, 1e-2)
        # what a short window hardly tells may have been led astray: a guess may be nearer
        starts = [best.theta, *guesses]
        residuals = [_left(part, pendulum, theta) for theta in starts]
        start = starts[first_least(residuals, part.resolution)]
        best = _in_window(part, pendulum, start, guess, nudges)
    return best if best.rest <= HOPELESS * size else None


def _nearest_of_equals(
    case: FileCase, fits: Sequence[FamilyFit], guesses: Sequence[Array]
) -> tuple[FamilyFit, Array]:
    """Return the fit that leaves least, and its guess; of fits that leave as little, the nearest to its guess."""
    enough = EQUAL * max(min(fit.rest for fit in fits), case.resolution)
    equals = [(fit, guess) for fit, guess in zip(fits, guesses, strict=True) if fit.rest <= enough]
    if not equals:
        return fits[0], guesses[0]
    moves = [
        float(np.linalg.norm((fit.theta - guess) / case.scales / WIDTHS)) for fit, guess in equals
    ]
    return equals[first_least(moves)]


def _left(case: FileCase, pendulum: SphericalPendulum, theta: Array) -> float:
    """Return the root mean square in m that a pendulum leaves of rows, infinity where it makes none."""
    rows = case.rows
    left = rms(rows.positions - pendulum.rows(theta, rows.times, rows.positions.shape[1]))
    return left if math.isfinite(left) else math.inf


def _in_window(
    case: FileCase, pendulum: SphericalPendulum, theta: Array, guess: Array, nudges: Array
) -> FamilyFit:
    """Return the best fit of a window: slopes are kept while they serve, a step that fails is tried again, damped.

    One more step is taken from where the residual is rounding: up to it the numbers that rows hardly tell are those of
    the guess, and of chance.
    """
    times, rows, scales = case.rows.times, case.rows.positions, case.scales
    columns = rows.shape[1]
    root = math.sqrt(len(times))
    noise = case.resolution
    slopes, fresh, damping = None, False, list(DAMPING)
    best, least = theta, math.inf
    settled = False
    residual = np.zeros(rows.size)
    for _ in range(STEPS):
        left = (rows - pendulum.rows(theta, times, columns)).ravel()
        size = float(np.linalg.norm(left)) / root
        stuck = not size < 0.5 * least
        if size < max(least, noise):
            best, least, residual = theta, size, left
        if settled:
            break
        settled = least < noise
        if slopes is None or (stuck and not fresh):
            slopes, fresh = pendulum.slopes(best, times, columns, scales, nudges), True
        elif not stuck:
            fresh = False
        elif len(damping) == 1:
            break
        else:
            damping.pop(0)
        if not np.isfinite(slopes).all():
            least = math.inf
            break
        hold = max(noise, 1e-3 * least) * root
        theta = best + scales * _step(slopes, residual, (best - guess) / scales, hold, damping[0])
    if slopes is None:
        slopes = pendulum.slopes(best, times, columns, scales, nudges)
    return FamilyFit("sphere", best, least, tuple(range(len(NAMES))), slopes / scales / root)


def _step(slopes: Array, left: Array, off: Array, noise: float, damping: float) -> Array:
    """Return the change of theta in scales that least squares ask for, each number held near its guess."""
    holds = noise / WIDTHS
    return best_change(
        np.vstack([slopes, np.diag(holds)]), np.concatenate([left, -holds * off]), damping
    )
