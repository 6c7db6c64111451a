"""A slip in a program's force: wrong terms, which are run, and have to pass the tests of a claim.

The accelerations that the rows show propose terms whose coefficients are wrong. The coefficients of
each proposal are fitted to the rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reference.model.constants import Constants
from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import by_differences, gauss_newton
from .accelerations import differentiated, proposed, root_mean_square
from .case import Explanation, FileCase, FileRows, largest
from .claims import graded
from .families import windows
from .forces import TERMS, Place, WrongForce
from .hypotheses import Claim
from .thresholds import NEEDED, RIVAL

_LOW = 0.3  # of the length: farther out, the force is not linear
_NUDGE = 1e-6  # by which velocities and coefficients are moved for a slope, of their sizes
_WINDOWS = 4.0  # ratio of the span of rows that are fitted to the one before
_SHORTEST = 16  # rows in the first of them
_NEWTON = 8  # steps in one window
_GAIN = 0.9  # of the residual before it: a step with a larger one is not taken


def of_slip(
    case: FileCase, rows: FileRows, constants: Constants, without_m: float
) -> Explanation | None:
    """Return the explanation that some terms of a program's force are wrong; None if none passes the tests.

    Args:
        case: some of the rows.
        rows: all of them.
        constants: of the scene's force, as floats.
        without_m: root mean square of the residual in m without a slip.
    """
    best = _simplest(list(_claims(case.in_the_plane(), rows, constants)))
    if best is None:
        return None
    slip = Deviation("slip", f"has a slip: {best.sentence}", best.size_m, "model")
    cause = graded(best, slip, without_m)
    if cause is None:
        return None
    explanation = best.case.explanation((), best.residuals, best.price)
    if cause is slip:
        return replace(explanation, slip=f"I{best.sentence[1:]}.")
    return replace(explanation, causes=(cause,))


def _simplest(claims: Sequence[_SlipClaim]) -> _SlipClaim | None:
    """Return the cheapest claim, unless a dearer one has a far smaller residual; None if another one has other terms.

    In a swing whose x and y keep their ratio, a term with x does what one with y does.
    """
    if not claims:
        return None
    best, *dearer = sorted(claims, key=lambda claim: (claim.price, claim.residual_rms_m))
    for claim in dearer:
        less = RIVAL if claim.price == best.price else NEEDED
        if less * claim.residual_rms_m <= best.residual_rms_m:
            best = claim
    for rival in claims:
        cheap = rival.price <= best.price and rival.residual_rms_m <= RIVAL * best.residual_rms_m
        if cheap and rival.force.places != best.force.places:
            return None
    return best


def _claims(case: FileCase, rows: FileRows, constants: Constants) -> Iterator[_SlipClaim]:
    """Yield the claims that the accelerations of rows propose, each run on the sphere and as a linear model."""
    swing_rate = float(np.linalg.norm(constants.pull)) ** 0.5
    motion = differentiated(rows.times, rows.plane, swing_rate)
    begins = case.rows.starts and case.rows.times[0] == 0
    if (
        motion is None
        or not begins
        or not float(np.abs(motion.state[:2]).max()) < _LOW * constants.length
    ):
        return
    # whatever a program takes g for, a slip is an error beside that
    effective = replace(
        constants, pull=(0.0, 0.0, -constants.gravity), centrifugal=(0.0, 0.0, 0.0, 0.0)
    )
    reading = min(constants, effective, key=lambda k: root_mean_square(motion.errors(k)))
    for coefficients in proposed(motion, reading):
        for kind in ("sphere", "linear"):
            claim = _SlipClaim.fitted(case, WrongForce(reading, kind, coefficients))
            if claim is not None:
                yield claim


@dataclass(frozen=True, eq=False)
class _SlipClaim(Claim):
    """The claim that a program has a slip.

    Attributes:
        force: of the program.
    """

    force: WrongForce

    @classmethod
    def fitted(cls, case: FileCase, force: WrongForce) -> _SlipClaim | None:
        """Return the claim with the coefficients fitted to the rows; None if there is no such motion."""
        times = case.rows.times
        claim = cls(case, case.rows.positions, force)
        for count in windows(times - times[0], _WINDOWS, _SHORTEST, 2 * _SHORTEST):
            claim = claim._fitted_to(count)
        return claim if math.isfinite(claim.residual_rms_m) else None

    def _fitted_to(self, count: int) -> _SlipClaim:
        """Return the claim with its numbers fitted to the first `count` rows."""
        plane = self.case.rows.plane

        def rows_with(numbers: Array) -> Array:
            return self._with(numbers)._rows(count).ravel()

        model = by_differences(rows_with, plane[:count].ravel(), self._nudges)
        numbers, _ = gauss_newton(model, self._numbers, steps=_NEWTON, gain=_GAIN)
        fitted = self._with(numbers)
        return replace(fitted, residuals=plane - fitted._rows(len(plane)))

    @property
    def _numbers(self) -> Array:
        """The numbers that are fitted: the coefficients."""
        return np.array([*self.force.coefficients.values()])

    def _with(self, numbers: Array) -> _SlipClaim:
        """Return the claim with other numbers."""
        return replace(self, force=self.force.with_errors(numbers.tolist()))

    @property
    def _nudges(self) -> Array:
        """By how much each number is moved for its slope."""
        return _NUDGE * np.abs(self._numbers)

    def _rows(self, count: int) -> Array:
        """Return x and y in m of its motion in the first `count` rows."""
        right = self.case.right
        start = np.array([*self.case.rows.plane[0], right.vx, right.vy])
        return self.force.rows(start, self.case.rows.times[:count])

    @property
    def free_numbers(self) -> int:
        """Its coefficients."""
        return len(self.force.coefficients)

    def foreseen(self, count: int) -> Array:
        """Return the residuals in m if the numbers are fitted to the first `count` rows."""
        return self._fitted_to(count).residuals

    @property
    def price(self) -> int:
        """Two for each coefficient, and one for a linear model."""
        return 2 * len(self.force.coefficients) + (self.force.kind == "linear")

    @property
    def size_m(self) -> float:
        """The largest distance in m by which it moves the bob."""
        right = self._with(np.zeros(len(self.force.coefficients)))
        count = len(self.case.rows.times)
        return largest(self._rows(count) - right._rows(count))

    @property
    def sentence(self) -> str:
        """The sentence that names the wrong terms of the force."""
        k = self.force.k
        model = "linear model" if self.force.kind == "linear" else "model"
        reading = "" if k.pull[1] or not k.rate else ", with g as the effective gravity"
        terms = "; ".join(map(self._term, self.force.places))
        work = ". The difference does work, as no Coriolis force does" if self._does_work() else ""
        return f"its accelerations differ from the {model}'s{reading}: {terms}{work}"

    def _term(self, place: Place) -> str:
        """Return the words for a wrong term."""
        equation, term = place
        word = list(TERMS)[term]
        name = "the constant term" if word == "1" else f"the term with {word}"
        right = float(self.force.linear[place])
        value = f"{right + self.force.coefficients[place]:.6g} {TERMS[word]}"
        where = f"in the equation of {'xy'[equation]}, {name}"
        return f"{where} is {value} where the model has {right + 0.0:.6g}"

    def _does_work(self) -> bool:
        """Return whether more of the wrong terms does work along the motion than not."""
        times = self.case.rows.times
        velocities = np.gradient(self.case.rows.plane, times, axis=0).T
        basis = np.vstack([np.ones(len(times)), self.case.rows.plane.T, velocities])
        errors = np.zeros((2, len(times)))
        for (equation, term), coefficient in self.force.coefficients.items():
            errors[equation] += coefficient * basis[term]
        power = np.mean(np.sum(errors * velocities, axis=0))
        most = root_mean_square(errors) * root_mean_square(velocities)
        return bool(math.sqrt(2) * abs(power) > most)
