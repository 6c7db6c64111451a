"""The families of models that are fitted to rows: linear, linear in the angle, and the sphere.

The fits do not use the truth. `readings` takes from them the best values of `theta`, and how
sharply the file determines each of them (`slopes`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import best_change
from .case import EQUAL, FileCase, first_least, rms
from .phasors import ComplexArray, PhasorFit, Phasors, as_angles, fit_phasors
from .programs import NAMES, Program, SphericalPendulum, phasors_of, theta_of

# numbers of theta that two phasors determine
_LINEAR = ("turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy")
_STEPS = 16  # Gauss-Newton steps in one window at most
_DAMPING = (0.0, 1e-7, 1e-5, 1e-3)  # of steps: the next one after each step that fails
# of the amplitude: how far a nudge moves the rows, so that differences are linear and not noise
_SEEN = 1e-6
# in scales: how far each number of theta may be from its guess
_WIDTHS = np.array([1e4] * 3 + [1.0] * 3 + [1.0] + [1.0] * 5 + [3.0] * 2)
# of the amplitude: a fit with a larger residual in a window is not continued in the next
_HOPELESS = 0.05
_WINDOWS = 8.0  # ratio of the length of a window to that of the one before


@dataclass(frozen=True)
class FamilyFit:
    """The best theta of a family, its residual, and how the rows depend on each number.

    Attributes:
        kind: of the family: sphere; linear; or angle, linear in the angle.
        theta: the best values, in the order of `NAMES`.
        residual_rms_m: root mean square of the residuals in m.
        free: indices of the numbers that were fitted.
        slopes: d rows / d theta for these, over sqrt(rows), so that |slopes @ change| is a root
            mean square in m.
    """

    kind: str
    theta: Array
    residual_rms_m: float
    free: tuple[int, ...]
    slopes: Array


def fits_of(case: FileCase) -> Iterator[FamilyFit]:
    """Yield the fits of the families: linear, linear in the angle, and the sphere."""
    rows = case.rows
    length = case.right.length
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    best: PhasorFit | None = None
    for kind in ("linear", "angle"):
        motion = plane if kind == "linear" else as_angles(plane, length)
        fit = fit_phasors(rows.times, motion, case.frequency)
        if fit is None:
            continue
        if fit.residual < (math.inf if best is None else best.residual):
            best = fit
        yield _fit_of(kind, fit, rows.times, case.right)
    sphere = _sphere(case, best)
    if sphere is not None:
        yield sphere


def _sphere(case: FileCase, fit: PhasorFit | None) -> FamilyFit | None:
    """Return the best spherical pendulum.

    None if nothing fits, or if the phasors fit and no pendulum on the sphere moves like them.
    """
    nominal = case.right.theta()
    without_tilt = nominal.copy()
    without_tilt[3:6] = 0.0, 0.0, -case.pull
    guesses = [nominal, without_tilt]
    if fit is None:
        return fit_pendulum(case, case.pendulum, guesses)

    rows = case.rows
    plane = rows.plane @ np.array([1, 1j])
    phasors = fit.phasors
    guess = without_tilt.copy()
    guess[2] = phasors.beta
    # the pull that gives a swing of this width its frequency, to the leading order
    tilt = float(np.abs(plane).max()) / case.right.length
    guess[5] = -phasors.square.real * (1 + tilt**2 / 8)
    guess[7:9] = plane[0].real, plane[0].imag
    if not rows.starts:
        guess[9:11] = phasors.speed.real, phasors.speed.imag

    if fit.residual < 1e-3 * case.floor:
        linear = guess.copy()
        linear[5] = -phasors.square.real
        linear[9:11] = phasors.speed.real, phasors.speed.imag
        difference = case.pendulum.rows(linear, rows.times, 2) - rows.plane
        if not rms(difference) < 30 * case.floor:
            return None
    return fit_pendulum(case, case.pendulum, [guess, *guesses])


def _fit_of(kind: str, fit: PhasorFit, times: Array, right: Program) -> FamilyFit:
    """Return two phasors as a fit of theta, with slopes by central differences."""
    theta = np.zeros(len(NAMES))
    theta[11] = right.length
    theta = theta_of(fit.phasors, theta)
    free = tuple(NAMES.index(name) for name in _LINEAR)
    nudges = _nudges(fit.phasors, float(times[-1]), right.length)

    def plane_of(theta: Array) -> ComplexArray:
        return phasors_of(theta, -theta[5], complex(theta[7], theta[8])).at(times)

    columns = []
    for i in free:
        move = nudges[i] * np.eye(len(NAMES))[i]
        slope = (plane_of(theta + move) - plane_of(theta - move)) / (2 * nudges[i])
        columns.append(slope.view(float))
    slopes = np.column_stack(columns) / math.sqrt(len(times))

    # the gradient of the centrifugal force makes ω² differ from x to y, which two phasors cannot do
    xx, yy, *_ = right.gradient_square
    by_pull = float(np.linalg.norm(slopes[:, free.index(5)]))
    slopes = np.pad(slopes, (0, 1))
    slopes[-1, -1] = by_pull * abs(xx - yy) / 2
    return FamilyFit(kind, theta, fit.residual, (*free, 12), slopes)


def _nudges(phasors: Phasors, span_s: float, length: float) -> dict[int, float]:
    """Return by how much each number of theta that phasors determine is moved for its slope."""
    omega = abs(phasors.square) ** 0.5
    amplitude = max(abs(phasors.start), abs(phasors.speed) / omega if omega else 0.0) or 1.0
    pull = omega**2 * amplitude / length
    sizes = {
        "turn_z": omega,
        "pull_x": pull,
        "pull_y": pull,
        "pull_z": omega**2,
        "drag": omega,
        "x": amplitude,
        "y": amplitude,
        "vx": amplitude * omega,
        "vy": amplitude * omega,
    }
    nudges = {}
    for name, size in sizes.items():
        # the effect of these grows with time
        growth = 1 + omega * span_s if name in ("turn_z", "pull_z", "drag") else 1.0
        nudges[NAMES.index(name)] = 1e-6 * size / growth
    return nudges


def windows(times: Array, ratio: float, least: int, short: int) -> list[int]:
    """Return the numbers of rows in windows that all begin with the first row.

    Each has a span `ratio` times that of the one before; the last has all rows.

    Args:
        times: of the rows in s, from 0 on.
        ratio: of two spans.
        least: the fewest rows of a span.
        short: a span of no more rows is not divided any more.
    """
    counts = [len(times)]
    span_s = float(times[-1])
    while span_s > 0 and counts[-1] > short:
        span_s /= ratio
        counts.append(max(least, int(np.searchsorted(times, span_s)) + 1))
    return sorted(set(counts))


def fit_pendulum(
    case: FileCase, pendulum: SphericalPendulum, guesses: Sequence[Array]
) -> FamilyFit | None:
    """Return the fit of theta by Gauss-Newton from the best of some guesses; None if nothing fits.

    It is fitted in windows of growing span. A number that the rows do not determine stays near
    its guess: it is held there as loosely as `_WIDTHS` says.
    """
    first, *longer = (case.part(count) for count in windows(case.rows.times, _WINDOWS, 16, 24))
    small_nudges = np.full(len(NAMES), 1e-6)
    fits = [_WindowFit(first, pendulum, guess, small_nudges).best(guess) for guess in guesses]
    best, guess = _nearest_of_equals(first, fits, guesses)
    size = float(np.abs(case.rows.plane).max())
    for part in longer:
        if not best.residual_rms_m <= _HOPELESS * float(np.abs(part.rows.plane).max()):
            return None
        effects = np.linalg.norm(best.slopes * case.scales, axis=0) * _WINDOWS
        nudges = np.clip(_SEEN * size / np.maximum(effects, 1e-300), 1e-13, 1e-2)
        # a number that a short window hardly determines may be far off: a guess may be nearer
        starts = [best.theta, *guesses]
        residuals = [_residual_m(part, pendulum, theta) for theta in starts]
        start = starts[first_least(residuals, part.resolution)]
        best = _WindowFit(part, pendulum, guess, nudges).best(start)
    return best if best.residual_rms_m <= _HOPELESS * size else None


def _nearest_of_equals(
    case: FileCase, fits: Sequence[FamilyFit], guesses: Sequence[Array]
) -> tuple[FamilyFit, Array]:
    """Return the fit with the smallest residual, and its guess.

    Of fits with equal residuals, it is the nearest to its guess.
    """
    enough = EQUAL * max(min(fit.residual_rms_m for fit in fits), case.resolution)
    equals = [
        (fit, guess)
        for fit, guess in zip(fits, guesses, strict=True)
        if fit.residual_rms_m <= enough
    ]
    if not equals:
        return fits[0], guesses[0]
    moves = [
        float(np.linalg.norm((fit.theta - guess) / case.scales / _WIDTHS)) for fit, guess in equals
    ]
    return equals[first_least(moves)]


def _residual_m(case: FileCase, pendulum: SphericalPendulum, theta: Array) -> float:
    """Return the root mean square in m of a pendulum's residuals; infinity if theta has no motion."""
    rows = case.rows
    residual_m = rms(rows.positions - pendulum.rows(theta, rows.times, rows.positions.shape[1]))
    return residual_m if math.isfinite(residual_m) else math.inf


@dataclass(frozen=True)
class _WindowFit:
    """A fit of theta to the rows of one window.

    Attributes:
        case: the rows.
        pendulum: runs theta.
        guess: theta near which a number that the rows do not determine stays.
        nudges: in scales, by which numbers are moved for their slopes.
    """

    case: FileCase
    pendulum: SphericalPendulum
    guess: Array
    nudges: Array

    def best(self, theta: Array) -> FamilyFit:
        """Return the best fit from some theta on.

        Slopes are kept as long as they serve; a step that fails is tried again with more damping.
        One more step is taken once the residual is rounding: before it, numbers that the rows
        hardly determine are those of the guess, and of chance.
        """
        # one loop whose state is shared by all its branches
        noise = self.case.resolution
        root = math.sqrt(len(self.case.rows.times))
        damping = list(_DAMPING)
        slopes: Array | None = None
        fresh = False  # whether the slopes are those of the best theta
        settled = False
        best = theta
        least = math.inf
        best_residuals = np.zeros(self.case.rows.positions.size)
        for _ in range(_STEPS):
            residuals = self._residuals(theta)
            size = float(np.linalg.norm(residuals)) / root
            stuck = not size < 0.5 * least
            if size < max(least, noise):
                best = theta
                least = size
                best_residuals = residuals
            if settled:
                break
            settled = least < noise

            if slopes is None or (stuck and not fresh):
                slopes = self._slopes(best)
                fresh = True
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
            theta = best + self._change(slopes, best_residuals, best, hold, damping[0])
        if slopes is None:
            slopes = self._slopes(best)
        free = tuple(range(len(NAMES)))
        return FamilyFit("sphere", best, least, free, slopes / self.case.scales / root)

    def _residuals(self, theta: Array) -> Array:
        rows = self.case.rows
        columns = rows.positions.shape[1]
        return (rows.positions - self.pendulum.rows(theta, rows.times, columns)).ravel()

    def _slopes(self, theta: Array) -> Array:
        """Return d rows / d theta times the scales."""
        rows = self.case.rows
        columns = rows.positions.shape[1]
        return self.pendulum.slopes(theta, rows.times, columns, self.case.scales, self.nudges)

    def _change(
        self, slopes: Array, residuals: Array, theta: Array, hold: float, damping: float
    ) -> Array:
        """Return the least squares change of theta, each number held near its guess.

        `hold` is the weight in m of a number that is one width from its guess.
        """
        holds = hold / _WIDTHS
        offsets = (theta - self.guess) / self.case.scales
        matrix = np.vstack([slopes, np.diag(holds)])
        right = np.concatenate([residuals, -holds * offsets])
        return self.case.scales * best_change(matrix, right, damping)
