"""Two phasors: the motion of every linear two-dimensional model, fitted to rows; what integrators make of them.

Whatever its rotation, sign, day, release, drag, even its Euler step, such a model moves as

    x + iy = A exp(iγ1 t) + B exp(iγ2 t) + C,

with w'' = -(drag + 2iβ) w' - ω² (w - C), so that γ1 + γ2 = -2β + i drag and γ1 γ2 = -ω². Linear prediction gives first
values of both, Gauss-Newton the best ones; A, B, C are linear.

A Runge-Kutta method multiplies the phasor exp(iγt) by its stability polynomial R(iγh) every step, so that the rows show
the rate log R(iγh)/(ih) in place of γ. Semi-implicit Euler couples position and velocity: its 2 × 2 propagator is used.
Both are exact for linear models, else to leading order.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from reference.numbers.precision import Array

from ..observed.least_squares import gauss_newton, solved

ComplexArray = npt.NDArray[np.complex128]
STEPS = 30  # Gauss-Newton steps at most
GAIN = 0.999  # of what was left: a step that leaves more ends the fit
DOUBLE_ROOT = 1e-8  # of a rate: two that are one are kept apart by this much
OVERFLOW = 1e8  # of the first row: phasors that grow by more are not followed


@dataclass(frozen=True)
class Phasors:
    """Two phasors and a centre, in the unit of the rows; γ in rad/s, with a positive imaginary part for decay."""

    rates: tuple[complex, complex]
    amplitudes: tuple[complex, complex]
    centre: complex

    @classmethod
    def of(
        cls,
        beta: float,
        square: float,
        drag: float,
        centre: complex,
        start: complex,
        speed: complex,
    ) -> Phasors:
        """Return the motion of w'' = -(drag + 2iβ) w' - ω² (w - centre) with w = start, w' = speed at t = 0."""
        half = complex(-beta, drag / 2)
        root = np.sqrt(half * half + square) or DOUBLE_ROOT * (abs(half) or 1.0)
        first, second = complex(half + root), complex(half - root)
        about = start - centre
        a = (speed / 1j - second * about) / (first - second)
        return cls((first, second), (complex(a), complex(about - a)), centre)

    def at(self, times: Array) -> ComplexArray:
        """Return x + iy at the times."""
        (first, second), (a, b) = self.rates, self.amplitudes
        with np.errstate(over="ignore", invalid="ignore"):
            motion: ComplexArray = (
                a * np.exp(1j * first * times) + b * np.exp(1j * second * times) + self.centre
            )
        return motion

    def later(self, time: float) -> Phasors:
        """Return the same motion with its clock started at a time in s."""
        turned = tuple(
            complex(a * np.exp(1j * g * time))
            for a, g in zip(self.amplitudes, self.rates, strict=True)
        )
        return Phasors(self.rates, (turned[0], turned[1]), self.centre)

    @property
    def beta(self) -> float:
        """The vertical rotation rate β in rad/s: Ω sin(latitude) of a right program."""
        return -(self.rates[0] + self.rates[1]).real / 2

    @property
    def drag(self) -> float:
        """The rate at which velocities decay in 1/s."""
        return (self.rates[0] + self.rates[1]).imag

    @property
    def square(self) -> complex:
        """ω², the restoring force per displacement in 1/s²; complex where no model with drag and rotation is behind."""
        return -self.rates[0] * self.rates[1]

    @property
    def start(self) -> complex:
        """Position x + iy at t = 0."""
        return self.amplitudes[0] + self.amplitudes[1] + self.centre

    @property
    def speed(self) -> complex:
        """Velocity at t = 0."""
        return 1j * (self.rates[0] * self.amplitudes[0] + self.rates[1] * self.amplitudes[1])


def fit_phasors(times: Array, rows: ComplexArray, near: float) -> tuple[Phasors, float] | None:
    """Return the best two phasors and the root mean square of what they leave, or None if there are none.

    Args:
        times: increasing, in s, shape (rows,).
        rows: x + iy there.
        near: the angular frequency of the scene in rad/s, which tells aliases apart where rows are sparse.
    """
    if len(times) < 8:
        return None
    best: tuple[Phasors, float] | None = None
    for guess in _guesses(times, rows, near):
        fit = _refined(times, rows, guess)
        if fit is not None and (
            best is None or _better(fit, best, near * near, float(np.abs(rows).max()))
        ):
            best = fit
    return best


def _better(
    fit: tuple[Phasors, float], best: tuple[Phasors, float], square: float, size: float
) -> bool:
    """Return whether a fit is better; of two aliases that fit as well, the one nearer to the scene's ω²."""
    (phasors, rest), (before, least) = fit, best
    if max(rest, least) < 1e-9 * size or 0.5 < rest / least < 2:
        return abs(phasors.square - square) < 0.99 * abs(before.square - square)
    return rest < least


def as_angles(plane: ComplexArray, length: float) -> ComplexArray:
    """Return x + iy with the distance from the vertical replaced by the angle of the cord times l."""
    radius = np.abs(plane)
    safe = np.where(radius > 0, radius, 1.0)
    return np.asarray(
        plane * np.where(radius > 0, length * np.arcsin(np.clip(safe / length, 0, 1)) / safe, 1.0)
    )


def sinc(angle: Array) -> Array:
    """Return sin(angle)/angle: by it the angle of the cord times l becomes the distance from the vertical."""
    safe = np.where(angle > 0, angle, 1.0)
    return np.where(angle > 0, np.sin(safe) / safe, 1.0)


def _guesses(times: Array, rows: ComplexArray, near: float) -> list[tuple[complex, complex]]:
    """Return first values of γ1, γ2: from linear prediction where rows are evenly spaced, and the scene's own."""
    guesses = [(complex(near), complex(-near))]
    steps = np.diff(times)
    even = np.abs(steps - np.median(steps)) < 1e-6 * np.median(steps)
    ends = np.flatnonzero(np.concatenate([[True], ~even, [True]]))
    longest = int(np.argmax(np.diff(ends)))
    evenly = slice(ends[longest], ends[longest + 1])
    part = rows[evenly]
    if len(part) > 8:
        step = float(np.median(np.diff(times[evenly])))
        for skip in (1, max(1, int(0.7 / (near * step))) if near else 1):
            before, here, after = part[: -2 * skip], part[skip:-skip], part[2 * skip :]
            if len(before) < 6:
                continue
            matrix = np.column_stack([here, before, np.ones_like(before)])
            p, q, _ = solved(matrix, after)
            roots = np.roots([1, -p, -q])
            if (np.abs(roots) == 0).any() or not np.isfinite(roots).all():
                continue
            gammas = np.log(roots.astype(complex)) / (1j * step * skip)
            turn = 2 * math.pi / (step * skip)
            for gamma1, gamma2 in (gammas, gammas[::-1]):
                first = gamma1 + turn * round((near - gamma1.real) / turn)
                second = gamma2 + turn * round((-near - gamma2.real) / turn)
                guesses.insert(0, (complex(first), complex(second)))
    return guesses


def _refined(
    times: Array, rows: ComplexArray, guess: tuple[complex, complex]
) -> tuple[Phasors, float] | None:
    """Fit by Gauss-Newton, the span growing so that no turn of the phase is lost."""
    rates: ComplexArray = np.array(guess)
    span = times[-1] - times[0]
    result: tuple[Phasors, float] | None = None
    windows = sorted(
        {max(12, int(np.searchsorted(times, times[0] + span * 4.0**-k)) + 1) for k in range(6)}
    )
    for count in windows:
        t, w = times[:count], rows[:count]
        rates, size = gauss_newton(partial(_left, t, w), rates, steps=STEPS, gain=GAIN)
        if not math.isfinite(size):
            return result
        a, b, centre = solved(_basis(t, rates), w)
        phasors = Phasors(
            (complex(rates[0]), complex(rates[1])), (complex(a), complex(b)), complex(centre)
        )
        result = phasors, size / math.sqrt(len(t))
    return result


def _basis(times: Array, rates: ComplexArray) -> ComplexArray:
    with np.errstate(over="ignore", invalid="ignore"):
        turning: ComplexArray = np.exp(1j * times[:, None] * rates)
    return np.column_stack([turning, np.ones_like(times)])


def _left(
    times: Array, rows: ComplexArray, rates: ComplexArray
) -> tuple[ComplexArray, Callable[[], ComplexArray]]:
    """Return what two phasors leave, and its slopes by their rates, then by A, B and C."""
    basis = _basis(times, rates)
    if not np.isfinite(basis).all() or np.abs(basis).max() > OVERFLOW:
        return np.full_like(rows, np.nan), lambda: basis
    linear = solved(basis, rows)
    return rows - basis @ linear, lambda: np.column_stack(
        [1j * times[:, None] * basis[:, :2] * linear[:2], basis]
    )


@dataclass(frozen=True)
class FixedStepMethod:
    """A fixed-step integrator.

    Attributes:
        id: a short word.
        title: as a person calls it.
        coefficients: of the stability polynomial, one more than its order; empty for the semi-implicit ones.
        kick: of a semi-implicit one, whether the velocity goes first; None for leapfrog.
        late: whether its first two rows are equal, as those of a bob that is let go half a step after row 0.
    """

    id: str
    title: str
    coefficients: tuple[float, ...] = ()
    kick: bool | None = None
    late: bool = False

    @property
    def order(self) -> int:
        """The power of the step that its error goes with."""
        return len(self.coefficients) - 1 if self.coefficients else 2 if self.kick is None else 1

    def computed(self, phasors: Phasors, step: float) -> Phasors:
        """Return the phasors that the rows of a program with this method show; the same if it cannot be told."""

        def shown(rate: complex) -> complex:
            z = 1j * rate * step
            return cmath.log(sum(c * z**n for n, c in enumerate(self.coefficients))) / (1j * step)

        try:
            if not self.coefficients:
                return self._split(phasors, step)
            first, second = phasors.rates
            return Phasors((shown(first), shown(second)), phasors.amplitudes, phasors.centre)
        except (ValueError, ZeroDivisionError, OverflowError, np.linalg.LinAlgError):
            return phasors

    def first_step(
        self, square: float, square_shown: float, drag: float, drag_shown: float
    ) -> float:
        """Return the step in s that the leading error of an oscillator of ω² asks for; 0 if there is none."""
        if square <= 0:
            return 0.0
        omega = math.sqrt(square)
        excess, growth = square_shown / square - 1, (drag - drag_shown) / omega
        order, of_phase = (len(self.coefficients) - 1, 3) if self.coefficients else (2, 12)
        leading = {1: growth, 2: of_phase * excess, 3: -12 * growth, 4: -60 * excess}[order]
        return float(max(leading, 0.0) ** (1 / order)) / omega

    def _split(self, phasors: Phasors, step: float) -> Phasors:
        """Return the modes of one step of w'' = -d w' - q w about the centre, d and q complex."""
        q, d = phasors.square, -1j * (phasors.rates[0] + phasors.rates[1])
        start, speed = phasors.start - phasors.centre, phasors.speed
        if self.late:  # v + h/2 w'' = 0
            speed = q * start * step / 2 / (1 - d * step / 2)

        def stepped(w: complex, v: complex) -> tuple[complex, complex]:
            # leapfrog: half a kick, a drift, half a kick; its Coriolis force is explicit
            if self.kick is None:
                v -= step / 2 * (q * w + d * v)
                w += step * v
                return w, (v - step / 2 * q * w) / (1 + d * step / 2)
            w += 0 if self.kick else step * v
            v -= step * (q * w + d * v)
            return w + (step * v if self.kick else 0), v

        (a, c), (b, e) = stepped(1, 0), stepped(0, 1)  # columns of a step's matrix
        half = (e - a) / 2
        root = cmath.sqrt(half * half + b * c)
        speeds = (half + root) / b, (half - root) / b  # of w = 1 in each mode
        share = (speed - speeds[1] * start) * b / (2 * root)
        rates = [cmath.log(a + b * v) / (1j * step) for v in speeds]
        modes = sorted(
            zip(rates, (share, start - share), strict=True), key=lambda mode: -mode[0].real
        )
        return Phasors((modes[0][0], modes[1][0]), (modes[0][1], modes[1][1]), phasors.centre)


def _taylor(order: int) -> tuple[float, ...]:
    return tuple(1 / math.factorial(n) for n in range(order + 1))


METHODS = (
    FixedStepMethod("semi_implicit_euler", "semi-implicit (symplectic) Euler", kick=True),
    FixedStepMethod(
        "semi_implicit_euler_drift", "semi-implicit (symplectic) Euler, position first", kick=False
    ),
    FixedStepMethod("explicit_euler", "explicit Euler", _taylor(1)),
    FixedStepMethod("leapfrog", "leapfrog (Verlet)"),
    FixedStepMethod(
        "leapfrog_late", "leapfrog (Verlet) from two equal rows, half a step late,", late=True
    ),
    FixedStepMethod("rk2", "a Runge-Kutta method of order 2 (midpoint, Heun)", _taylor(2)),
    FixedStepMethod("rk3", "a Runge-Kutta method of order 3", _taylor(3)),
    FixedStepMethod("rk4", "a Runge-Kutta method of order 4", _taylor(4)),
)
