"""Two phasors: the motion of every linear model in the plane, fitted to rows.

Whatever its rotation, sign, day, release, drag, or Euler step, such a model moves as

    x + iy = A exp(iγ1 t) + B exp(iγ2 t) + C,

with w'' = -(drag + 2iβ) w' - ω² (w - C), so that γ1 + γ2 = -2β + i drag and γ1 γ2 = -ω². Linear
prediction gives first values of γ1 and γ2, Gauss-Newton the best ones; A, B, C are linear.

A Runge-Kutta method multiplies the phasor exp(iγt) by its stability polynomial R(iγh) every step,
so that the rows show the rate log R(iγh)/(ih) in place of γ. Semi-implicit Euler couples position
and velocity: its 2 × 2 propagator is used. Both are exact for linear models, and correct to leading
order for others.
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
_STEPS = 30  # Gauss-Newton steps at most
_GAIN = 0.999  # of the residual before it: a step with a larger one ends the fit
_DOUBLE_ROOT = 1e-8  # of a rate: two equal rates are separated by this much
_OVERFLOW = 1e8  # phasors that grow by a larger factor are not fitted


@dataclass(frozen=True)
class Phasors:
    """Two phasors and a centre, in the unit of the rows.

    The rates γ are in rad/s, with a positive imaginary part for decay.
    """

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
        """Return the motion of w'' = -(drag + 2iβ) w' - ω² (w - centre).

        At t = 0, w is start and w' is speed.
        """
        half = complex(-beta, drag / 2)
        root = np.sqrt(half * half + square) or _DOUBLE_ROOT * (abs(half) or 1.0)
        first = complex(half + root)
        second = complex(half - root)
        displacement = start - centre
        a = (speed / 1j - second * displacement) / (first - second)
        return cls((first, second), (complex(a), complex(displacement - a)), centre)

    def at(self, times: Array) -> ComplexArray:
        """Return x + iy at the times."""
        first, second = self.rates
        a, b = self.amplitudes
        with np.errstate(over="ignore", invalid="ignore"):
            motion: ComplexArray = (
                a * np.exp(1j * first * times) + b * np.exp(1j * second * times) + self.centre
            )
        return motion

    def later(self, time: float) -> Phasors:
        """Return the same motion with its clock started at a time in s."""
        first, second = self.rates
        a, b = self.amplitudes
        amplitudes = (
            complex(a * np.exp(1j * first * time)),
            complex(b * np.exp(1j * second * time)),
        )
        return Phasors(self.rates, amplitudes, self.centre)

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
        """ω², the restoring force per displacement in 1/s².

        It is complex if no model with drag and rotation has these rates.
        """
        return -self.rates[0] * self.rates[1]

    @property
    def start(self) -> complex:
        """Position x + iy at t = 0."""
        return self.amplitudes[0] + self.amplitudes[1] + self.centre

    @property
    def speed(self) -> complex:
        """Velocity at t = 0."""
        return 1j * (self.rates[0] * self.amplitudes[0] + self.rates[1] * self.amplitudes[1])


@dataclass(frozen=True)
class PhasorFit:
    """Two phasors, and the root mean square of their residuals, in the unit of the rows."""

    phasors: Phasors
    residual: float


def fit_phasors(times: Array, rows: ComplexArray, frequency: float) -> PhasorFit | None:
    """Return the best two phasors; None if there are none.

    Args:
        times: increasing, in s, shape (rows,).
        rows: x + iy there.
        frequency: of the scene's swing in rad/s, which decides between aliases of sparse rows.
    """
    if len(times) < 8:
        return None
    size = float(np.abs(rows).max())
    best: PhasorFit | None = None
    for guess in _guesses(times, rows, frequency):
        fit = _refined(times, rows, guess)
        if fit is None:
            continue
        if best is None or _is_better(fit, best, frequency * frequency, size):
            best = fit
    return best


def _is_better(fit: PhasorFit, best: PhasorFit, square: float, size: float) -> bool:
    """Return whether a fit is better.

    Of two aliases that fit as well, the one nearer to the scene's ω² is better.
    """
    if max(fit.residual, best.residual) < 1e-9 * size or 0.5 < fit.residual / best.residual < 2:
        distance = abs(fit.phasors.square - square)
        return distance < 0.99 * abs(best.phasors.square - square)
    return fit.residual < best.residual


def as_angles(plane: ComplexArray, length: float) -> ComplexArray:
    """Return x + iy, the distance from the vertical replaced by the angle of the cord times l."""
    radius = np.abs(plane)
    safe = np.where(radius > 0, radius, 1.0)
    arc = length * np.arcsin(np.clip(safe / length, 0, 1))
    return np.asarray(plane * np.where(radius > 0, arc / safe, 1.0))


def sinc(angle: Array) -> Array:
    """Return sin(angle)/angle: the distance from the vertical over the cord's angle times l."""
    safe = np.where(angle > 0, angle, 1.0)
    return np.where(angle > 0, np.sin(safe) / safe, 1.0)


def _guesses(times: Array, rows: ComplexArray, frequency: float) -> list[tuple[complex, complex]]:
    """Return first values of γ1 and γ2: by linear prediction from even rows, then the scene's."""
    guesses = [(complex(frequency), complex(-frequency))]
    part = _longest_even_part(times)
    rows = rows[part]
    if len(rows) <= 8:
        return guesses
    step_s = float(np.median(np.diff(times[part])))
    # of every row, and of rows about 0.7 rad of the swing apart
    strides = (1, max(1, int(0.7 / (frequency * step_s))) if frequency else 1)
    for stride in strides:
        gammas = _predicted_rates(rows, stride, step_s)
        if gammas is None:
            continue
        # of all aliases, those nearest to the scene's frequency
        alias = 2 * math.pi / (step_s * stride)
        for gamma1, gamma2 in (gammas, gammas[::-1]):
            first = gamma1 + alias * round((frequency - gamma1.real) / alias)
            second = gamma2 + alias * round((-frequency - gamma2.real) / alias)
            guesses.insert(0, (complex(first), complex(second)))
    return guesses


def _longest_even_part(times: Array) -> slice:
    """Return the longest part of the rows that is evenly spaced."""
    steps = np.diff(times)
    even = np.abs(steps - np.median(steps)) < 1e-6 * np.median(steps)
    ends = np.flatnonzero(np.concatenate([[True], ~even, [True]]))
    longest = int(np.argmax(np.diff(ends)))
    return slice(ends[longest], ends[longest + 1])


def _predicted_rates(rows: ComplexArray, stride: int, step_s: float) -> ComplexArray | None:
    """Return γ1 and γ2 by linear prediction from evenly spaced rows; None if there are none."""
    before = rows[: -2 * stride]
    here = rows[stride:-stride]
    after = rows[2 * stride :]
    if len(before) < 6:
        return None
    p, q, _ = solved(np.column_stack([here, before, np.ones_like(before)]), after)
    roots = np.roots([1, -p, -q])
    if (np.abs(roots) == 0).any() or not np.isfinite(roots).all():
        return None
    return np.asarray(np.log(roots.astype(complex)) / (1j * step_s * stride))


def _refined(times: Array, rows: ComplexArray, guess: tuple[complex, complex]) -> PhasorFit | None:
    """Return the fit by Gauss-Newton, the span growing so that no turn of the phase is lost."""
    rates: ComplexArray = np.array(guess)
    span_s = times[-1] - times[0]
    spans_s = [span_s * 4.0**-k for k in range(6)]
    counts = {max(12, int(np.searchsorted(times, times[0] + span)) + 1) for span in spans_s}
    fit: PhasorFit | None = None
    for count in sorted(counts):
        t = times[:count]
        w = rows[:count]
        rates, norm = gauss_newton(partial(_residuals, t, w), rates, steps=_STEPS, gain=_GAIN)
        if not math.isfinite(norm):
            return fit
        a, b, centre = solved(_basis(t, rates), w)
        phasors = Phasors(
            (complex(rates[0]), complex(rates[1])), (complex(a), complex(b)), complex(centre)
        )
        fit = PhasorFit(phasors, norm / math.sqrt(len(t)))
    return fit


def _basis(times: Array, rates: ComplexArray) -> ComplexArray:
    """Return exp(iγ1 t), exp(iγ2 t) and 1, shape (times, 3)."""
    with np.errstate(over="ignore", invalid="ignore"):
        turning: ComplexArray = np.exp(1j * times[:, None] * rates)
    return np.column_stack([turning, np.ones_like(times)])


def _residuals(
    times: Array, rows: ComplexArray, rates: ComplexArray
) -> tuple[ComplexArray, Callable[[], ComplexArray]]:
    """Return the residuals of two phasors, and their slopes by the rates, then by A, B and C."""
    basis = _basis(times, rates)
    if not np.isfinite(basis).all() or np.abs(basis).max() > _OVERFLOW:
        return np.full_like(rows, np.nan), lambda: basis
    linear = solved(basis, rows)

    def slopes() -> ComplexArray:
        by_rates = 1j * times[:, None] * basis[:, :2] * linear[:2]
        return np.column_stack([by_rates, basis])

    return rows - basis @ linear, slopes


@dataclass(frozen=True)
class FixedStepMethod:
    """A fixed-step integrator.

    Attributes:
        id: a short word.
        title: the name that people use.
        coefficients: of the stability polynomial, one more than its order; empty for leapfrog and
            semi-implicit Euler.
        kick: of semi-implicit Euler, whether the velocity is updated first; None for others.
        late: whether its first two rows are equal, as if the bob were released half a step after
            row 0.
    """

    id: str
    title: str
    coefficients: tuple[float, ...] = ()
    kick: bool | None = None
    late: bool = False

    @property
    def order(self) -> int:
        """The power of the step with which its error grows."""
        if self.coefficients:
            return len(self.coefficients) - 1
        return 2 if self.kick is None else 1

    def computed(self, phasors: Phasors, step: float) -> Phasors:
        """Return the phasors that the rows of a program with this method show.

        They are the given ones if the method's cannot be computed.
        """
        try:
            if not self.coefficients:
                return self._split(phasors, step)
            first, second = phasors.rates
            rates = (self._shown(first, step), self._shown(second, step))
            return Phasors(rates, phasors.amplitudes, phasors.centre)
        except (ValueError, ZeroDivisionError, OverflowError, np.linalg.LinAlgError):
            return phasors

    def _shown(self, rate: complex, step: float) -> complex:
        """Return log R(iγh)/(ih), the rate that rows show in place of γ."""
        z = 1j * rate * step
        growth = sum(c * z**n for n, c in enumerate(self.coefficients))
        return cmath.log(growth) / (1j * step)

    def first_step(
        self, square: float, square_shown: float, drag: float, drag_shown: float
    ) -> float:
        """Return an estimate of the step in s from its leading error, for an oscillator of ω².

        It is 0 if no step has such an effect.
        """
        if square <= 0:
            return 0.0
        omega = math.sqrt(square)
        excess = square_shown / square - 1
        growth = (drag - drag_shown) / omega
        # (ωh)^order, from the leading error of the frequency or of the amplitude
        if not self.coefficients:
            order = 2
            power = 12 * excess
        else:
            order = len(self.coefficients) - 1
            power = {1: growth, 2: 3 * excess, 3: -12 * growth, 4: -60 * excess}[order]
        return float(max(power, 0.0) ** (1 / order)) / omega

    def _split(self, phasors: Phasors, step: float) -> Phasors:
        """Return the modes of one step of w'' = -d w' - q w about the centre, d and q complex."""
        # one formula: the eigenvalues of a step's matrix, with the letters of the equation
        q = phasors.square
        d = -1j * (phasors.rates[0] + phasors.rates[1])
        start = phasors.start - phasors.centre
        speed = phasors.speed
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

        # a step is the matrix [[a, b], [c, e]] of w and v
        a, c = stepped(1, 0)
        b, e = stepped(0, 1)
        half = (e - a) / 2
        root = cmath.sqrt(half * half + b * c)
        # in each mode, v where w = 1
        first_speed = (half + root) / b
        second_speed = (half - root) / b
        share = (speed - second_speed * start) * b / (2 * root)
        first = (cmath.log(a + b * first_speed) / (1j * step), share)
        second = (cmath.log(a + b * second_speed) / (1j * step), start - share)
        # the larger frequency first
        if second[0].real > first[0].real:
            first, second = second, first
        return Phasors((first[0], second[0]), (first[1], second[1]), phasors.centre)


def _taylor(order: int) -> tuple[float, ...]:
    """Return the stability polynomial of a Runge-Kutta method with as many stages as its order."""
    return tuple(1 / math.factorial(n) for n in range(order + 1))


METHODS = (
    FixedStepMethod("semi_implicit_euler", "semi-implicit (symplectic) Euler", kick=True),
    FixedStepMethod(
        "semi_implicit_euler_drift",
        "semi-implicit (symplectic) Euler that moves the position first",
        kick=False,
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
TITLES = {method.id: method.title for method in METHODS}
