"""A slip in a program's force: a wrong term, or a bob that falls or swings ever wider.

Near its lowest point the bob's acceleration is nearly linear in x, y and their velocities. The
difference of the rows' accelerations from the model's proposes terms whose coefficients are wrong.
Each proposal is run, its coefficients fitted to the rows, and has to pass the tests of a claim. The
rows have to be close enough to be differentiated twice.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np

from reference import FoucaultError
from reference.engines.heyoka.propagator import AutonomousSystem, Propagator
from reference.engines.trajectory import MAX_STEPS
from reference.model.constants import Constants
from reference.model.force import acceleration
from reference.numbers.precision import DOUBLE, Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import by_differences, gauss_newton, solved
from .case import Explanation, FileCase, FileRows, largest
from .claims import tested
from .families import windows
from .hypotheses import Claim
from .programs import Program
from .thresholds import NEEDED, RIVAL

# stencils of order 6 for the first and the second derivative
_FIRST = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
_SECOND = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
_LEAST = 30  # rows that can be differentiated
_USUAL = 0.15  # rad of the swing: step between rows that are differentiated
_FARTHEST = 0.5  # rad of the swing: the largest step
_PROPOSED = 0.02  # of the mean square of the accelerations' errors: what terms leave that are run
_MOST = 3  # terms that are run together
_TRIED = 4  # proposals that are run
_LOW = 0.3  # of the length: farther out, the force is not linear
_TERMS = {"1": "m/s²", "x": "1/s²", "y": "1/s²", "vx": "1/s", "vy": "1/s"}
_PLACES = tuple(itertools.product(range(2), range(len(_TERMS))))  # of a term: equation, and name
_NUDGE = 1e-6  # by which velocities and coefficients are moved for a slope, of their sizes
_WINDOWS = 4.0  # ratio of the span of rows that are fitted to the one before
_SHORTEST = 16  # rows in the first of them
_NEWTON = 8  # steps in one window
_GAIN = 0.9  # of the residual: a step that leaves more is not taken
_PARTS = 4  # of the rows


def of_slip(
    case: FileCase, rows: FileRows, constants: Constants, without_m: float
) -> Explanation | None:
    """Return the explanation that some terms of a program's force are wrong; None if none passes the tests.

    Args:
        case: some of the rows.
        rows: all of them.
        constants: of the scene's force, as floats.
        without_m: root mean square in m that is left without a slip.
    """
    best = _simplest(list(_claims(case.in_the_plane(), rows, constants)))
    if best is None:
        return None
    proposed = Deviation("slip", f"has a slip: {best.sentence}", best.size_m, "model")
    cause = tested(best, proposed, without_m)
    if cause is None:
        return None
    explanation = best.case.explanation((), best.left, best.price)
    if cause is proposed:
        return replace(explanation, slip=f"{best.sentence[0].upper()}{best.sentence[1:]}.")
    return replace(explanation, causes=(cause,))


def _simplest(claims: Sequence[_SlipClaim]) -> _SlipClaim | None:
    """Return the cheapest claim, unless a dearer one leaves far less; None if another one has other terms.

    In a swing whose x and y keep their ratio, a term with x does what one with y does.
    """
    if not claims:
        return None
    best, *dearer = sorted(claims, key=lambda claim: (claim.price, claim.rest))
    for claim in dearer:
        less = RIVAL if claim.price == best.price else NEEDED
        if less * claim.rest <= best.rest:
            best = claim
    for rival in claims:
        cheap = rival.price <= best.price and rival.rest <= RIVAL * best.rest
        if cheap and rival.force.places != best.force.places:
            return None
    return best


def _claims(case: FileCase, rows: FileRows, constants: Constants) -> Iterator[_SlipClaim]:
    """Yield the claims that the accelerations of rows propose, each run on the sphere and as a linear model."""
    swing_rate = float(np.linalg.norm(constants.pull)) ** 0.5
    motion = _differentiated(rows.times, rows.plane, swing_rate)
    if motion is None or not float(np.abs(motion.state[:2]).max()) < _LOW * constants.length:
        return
    # whatever a program takes g for, a slip is an error beside that
    effective = replace(
        constants, pull=(0.0, 0.0, -constants.gravity), centrifugal=(0.0, 0.0, 0.0, 0.0)
    )
    reading = min(constants, effective, key=lambda k: _rms(motion.errors(k)))
    for coefficients in _proposed(motion, reading):
        for kind in ("sphere", "linear"):
            claim = _SlipClaim.fitted(case, _WrongForce(reading, kind, coefficients))
            if claim is not None:
                yield claim


def _rms(values: Array) -> float:
    """Return the root mean square of all values."""
    return float(np.sqrt(np.mean(values**2)))


@dataclass(frozen=True)
class _MotionOfRows:
    """The motion that rows show.

    Attributes:
        state: x, y, vx, vy in m and m/s, shape (4, rows).
        accelerations: of x and y in m/s², shape (2, rows).
    """

    state: Array
    accelerations: Array

    def errors(self, k: Constants) -> Array:
        """Return the accelerations less those of the model in m/s², shape (2, rows)."""
        return np.asarray(self.accelerations - _model(self.state, k))


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
    if h * h * _rms(accelerations) > _rms(plane):  # the bob turns back from row to row
        return None
    state = np.vstack([plane[3:-3].T, velocities])
    return _MotionOfRows(state, accelerations)


def _convolved(plane: Array, stencil: Array) -> Array:
    """Return a stencil's sums over the rows of x and y, shape (2, rows)."""
    return np.array([np.convolve(column, stencil[::-1], "valid") for column in plane.T])


def _model(state: Array, k: Constants) -> Array:
    """Return the horizontal acceleration of the full model in m/s², shape (2, rows)."""
    x, y, vx, vy = state / k.length
    z = -np.sqrt(1 - x * x - y * y)
    ax, ay, _ = acceleration((x, y, z), (vx, vy, -(x * vx + y * vy) / z), k)
    return np.asarray(np.array([ax, ay]) * k.length)


_Place = tuple[
    int, int
]  # 0 for the equation of x, 1 for that of y; and the index of a term in `_TERMS`


@dataclass(frozen=True)
class _Proposal:
    """Errors of coefficients, by place, and the mean square in m²/s⁴ that they leave of the accelerations' errors."""

    coefficients: dict[_Place, float]
    left: float


def _proposed(motion: _MotionOfRows, k: Constants) -> list[dict[_Place, float]]:
    """Return errors of coefficients that explain the accelerations: of the fewest terms, the likeliest first."""
    errors = motion.errors(k)
    most = _PROPOSED * float(np.mean(errors**2))
    for count in range(1, _MOST + 1):
        proposals = [
            _fit(motion.state, errors, places) for places in itertools.combinations(_PLACES, count)
        ]
        proposals.sort(key=lambda proposal: proposal.left)
        if proposals[0].left <= most:
            near = RIVAL**2 * proposals[0].left
            likely = [each.coefficients for each in proposals if each.left <= near]
            return likely[:_TRIED]
    return []


def _fit(state: Array, errors: Array, places: Sequence[_Place]) -> _Proposal:
    """Return the fit of errors by the terms at some places."""
    basis = np.vstack([np.ones(state.shape[1]), state])
    coefficients: dict[_Place, float] = {}
    left = errors.copy()
    for equation in range(2):
        terms = [term for where, term in places if where == equation]
        solution = solved(basis[terms].T, errors[equation])
        left[equation] -= solution @ basis[terms]
        for term, coefficient in zip(terms, solution.tolist(), strict=True):
            coefficients[equation, term] = coefficient
    return _Proposal(coefficients, float(np.mean(left**2)))


@dataclass(frozen=True)
class _WrongForce:
    """A force with some wrong coefficients.

    Attributes:
        k: the constants of the right force.
        kind: sphere, or linear in position and velocity.
        coefficients: their errors by place, in the units of `_TERMS`.
    """

    k: Constants
    kind: str
    coefficients: dict[_Place, float]

    @property
    def places(self) -> list[_Place]:
        """Where the coefficients are."""
        return list(self.coefficients)

    @cached_property
    def linear(self) -> Array:
        """The coefficients of the right force about the lowest point, shape (2, 5)."""
        nudges = _NUDGE * np.eye(4)
        slopes = (_model(nudges, self.k) - _model(-nudges, self.k)) / (2 * _NUDGE)
        return np.hstack([_model(np.zeros((4, 1)), self.k), slopes])

    def with_errors(self, errors: Sequence[float]) -> _WrongForce:
        """Return the force with other errors of the coefficients, in the order of `places`."""
        return replace(self, coefficients=dict(zip(self.coefficients, errors, strict=True)))

    def rows(self, start: Array, times: Array) -> Array:
        """Return x and y in m from a start x, y, vx, vy on, shape (times, 2); NaN where there is no such motion."""
        terms = self.linear.copy() if self.kind == "linear" else np.zeros((2, len(_TERMS)))
        for place, error in self.coefficients.items():
            terms[place] += error
        terms[:, 0] /= self.k.length
        parameters = terms.ravel().tolist()
        if self.kind == "sphere":
            constants = (*self.k.turn, *self.k.pull, *self.k.centrifugal, self.k.drag)
            parameters += map(float, constants)
        since = times - times[0]
        try:
            states = _propagator(self.kind).from_zero(
                (start / self.k.length).tolist(), since, parameters, MAX_STEPS
            )
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), 2), np.nan)
        return np.asarray(states[:, :2] * self.k.length)


_CONSTANTS = 11  # numbers of turn, pull, centrifugal force's gradient and drag


@cache
def _propagator(kind: str) -> Propagator:
    """Return the propagator of x, y, vx, vy over the length.

    The parameters are the coefficients of further terms; on the sphere then turn, pull, centrifugal
    force's gradient and drag.
    """
    count = 2 * len(_TERMS)

    def rates(state: Any, functions: Any, parameters: Any) -> list[Any]:
        x, y, vx, vy = state
        further = []
        for equation in range(2):
            first = equation * len(_TERMS)
            constant, by_x, by_y, by_vx, by_vy = parameters[first : first + len(_TERMS)]
            further.append(constant + by_x * x + by_y * y + by_vx * vx + by_vy * vy)
        if kind == "linear":
            return [vx, vy, *further]
        k = Constants(
            turn=tuple(parameters[count : count + 3]),
            pull=tuple(parameters[count + 3 : count + 6]),
            centrifugal=tuple(parameters[count + 6 : count + 10]),
            drag=parameters[count + 10],
        )
        z = -functions.sqrt(1.0 - x * x - y * y)
        ax, ay, _ = acceleration((x, y, z), (vx, vy, -(x * vx + y * vy) / z), k)
        return [vx, vy, ax + further[0], ay + further[1]]

    parameters = count if kind == "linear" else count + _CONSTANTS
    return Propagator(AutonomousSystem(("x", "y", "vx", "vy"), rates, parameters), DOUBLE)


@dataclass(frozen=True, eq=False)
class _SlipClaim(Claim):
    """The claim that a program has a slip.

    Attributes:
        force: of the program.
        velocity: vx and vy at the first row in m/s.
    """

    force: _WrongForce
    velocity: Array

    @classmethod
    def fitted(cls, case: FileCase, force: _WrongForce) -> _SlipClaim | None:
        """Return the claim with coefficients and velocity fitted to the rows; None if there is no such motion."""
        times = case.rows.times
        first, second, third, *_ = case.rows.plane
        velocity = (4 * second - third - 3 * first) / (times[2] - times[0])
        claim = cls(case, case.rows.positions, force, velocity)
        for count in windows(times - times[0], _WINDOWS, _SHORTEST, 2 * _SHORTEST):
            claim = claim._fitted_to(count)
        return claim if math.isfinite(claim.rest) else None

    def _fitted_to(self, count: int) -> _SlipClaim:
        """Return the claim with its numbers fitted to the first `count` rows."""
        times = self.case.rows.times
        plane = self.case.rows.plane
        numbers = np.array([*self.force.coefficients.values(), *self.velocity])

        def motion(numbers: Array, count: int) -> Array:
            force = self.force.with_errors(numbers[:-2].tolist())
            return force.rows(np.concatenate([plane[0], numbers[-2:]]), times[:count])

        def rows_with(numbers: Array) -> Array:
            return motion(numbers, count).ravel()

        speed = math.sqrt(abs(self.force.k.pull[2])) * float(np.abs(plane).max())
        sizes = [abs(number) for number in self.force.coefficients.values()]
        nudges = _NUDGE * np.array([*sizes, speed, speed])
        model = by_differences(rows_with, plane[:count].ravel(), nudges)
        numbers, _ = gauss_newton(model, numbers, steps=_NEWTON, gain=_GAIN)
        left = plane - motion(numbers, len(times))
        force = self.force.with_errors(numbers[:-2].tolist())
        return replace(self, left=left, force=force, velocity=numbers[-2:])

    @property
    def free_numbers(self) -> int:
        """Its coefficients, and the velocity at the first row."""
        return len(self.force.coefficients) + 2

    def foreseen(self, count: int) -> Array:
        """Return what is left in m if the numbers are fitted to the first `count` rows."""
        return self._fitted_to(count).left

    @property
    def price(self) -> int:
        """Two for each coefficient, and one for a linear model."""
        return 2 * len(self.force.coefficients) + (self.force.kind == "linear")

    @property
    def size_m(self) -> float:
        """The largest distance in m by which it moves the bob."""
        right = self.force.with_errors([0.0] * len(self.force.coefficients))
        start = np.concatenate([self.case.rows.plane[0], self.velocity])
        times = self.case.rows.times
        return largest(self.force.rows(start, times) - right.rows(start, times))

    @property
    def sentence(self) -> str:
        """What is said of it."""
        k = self.force.k
        model = "linear model" if self.force.kind == "linear" else "model"
        reading = "" if k.pull[1] or not k.rate else ", with g as the effective gravity"
        terms = "; ".join(map(self._term, self.force.places))
        work = ". The difference does work, as no Coriolis force does" if self._does_work() else ""
        return f"its accelerations differ from the {model}'s{reading}: {terms}{work}"

    def _term(self, place: _Place) -> str:
        """Return what is said of a term."""
        equation, term = place
        word = list(_TERMS)[term]
        name = "the constant term" if word == "1" else f"the term with {word}"
        right = float(self.force.linear[place])
        value = f"{right + self.force.coefficients[place]:.6g} {_TERMS[word]}"
        where = f"in the equation of {'xy'[equation]}, {name}"
        return f"{where} is {value} where the model has {right + 0.0:.6g}"

    def _does_work(self) -> bool:
        """Return whether the wrong terms do work along the motion."""
        times = self.case.rows.times
        velocities = np.gradient(self.case.rows.plane, times, axis=0).T
        basis = np.vstack([np.ones(len(times)), self.case.rows.plane.T, velocities])
        errors = np.zeros((2, len(times)))
        for (equation, term), coefficient in self.force.coefficients.items():
            errors[equation] += coefficient * basis[term]
        power = np.mean(np.sum(errors * velocities, axis=0))
        return bool(RIVAL * abs(power) > 2 * _rms(errors) * _rms(velocities))


def falls(rows: FileRows, right: Program) -> str:
    """Return a sentence on the coordinate that falls far below the cord; empty if none does."""
    time = rows.times[1:] - rows.times[0]
    displacements = rows.plane[1:] - rows.plane[0]
    for name, displacement in zip("xy", displacements.T, strict=True):
        pulls = np.abs(2 * displacement / time**2) / right.g
        distance = float(abs(displacement[-1:]).sum())
        free = ((pulls > 1 / RIVAL) & (pulls < RIVAL)).all()
        if free and distance > RIVAL * right.length:
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
    if not (reach[1:] > reach[:-1]).all() or not reach[-1] > RIVAL * reach[0]:
        return ""
    between = float(rows.times[parts[-1]].mean() - rows.times[parts[0]].mean())
    fold = between / math.log(reach[-1] / reach[0])
    grows = f"Its motion grows by a factor of e in {fold:.2g} s"
    return f"{grows}: a force does work, or the cord does not hold."
