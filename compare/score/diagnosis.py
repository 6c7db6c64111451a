"""Find the likely reason for a candidate's error: named mistakes are tried, and single inputs are fitted.

A hypothesis is offered only if it explains nearly all of the error. A named mistake is tried on a short part of the
run first, then on longer ones: the error that remains in a part is a lower bound of the error that remains in the
whole, so giving up early loses nothing. A single input is fitted by Gauss-Newton, from the early rows to all of them:
as its shift may be large, the model itself is run with the shifted input.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
import numpy.typing as npt

from reference import FoucaultError, Scene
from reference.engines.variants import Variants
from reference.inputs import Inputs
from reference.precision import Array
from reference.solver.sensitivity import Sensitivity, sensitivity, with_value

from ..candidates.candidate import Candidate
from ..rhs.constants import constants_in_double
from .errors import TrajectoryErrors
from .hypotheses import hypotheses

EXPLAINED = 0.99  # share of the root mean square error that a hypothesis has to explain to be offered
SURE = 0.9999  # share that a named mistake has to explain to be accepted without fitting any input
ROWS = 1500  # rows of the candidate that are used at most: half evenly spaced, half crowding towards the release
WINDOWS = tuple(4.0**-k for k in range(7, -1, -1))  # parts of the run in which an input is fitted, one after the other
TRIALS = (1 / 64, 1 / 8, 1.0)  # parts of the run on which a named mistake is tried
STEPS = 3  # Gauss-Newton steps in each window
NAMED_FIRST = 10.0  # a named mistake is preferred to a fitted input whose residual is smaller by up to this factor
AS_MUCH = 2.0  # hypotheses with up to this many times the smallest residual are reported as equally good
RESOLVED = 1e-6  # residuals below this part of the error are rounding noise
BEYOND = 30.0  # an input that makes the pendulum this many times faster is implausible, and slow to simulate
SMALL = 0.25  # of the cord length: a bob that comes this near to the suspension's height makes no small swings
UNITS = {
    "length": "m", "drag": "1/s", "latitude": "degrees", "altitude": "m", "gravity": "m/s²", "rotation_rate": "rad/s",
    "equatorial_radius": "m", "inverse_flattening": "", "x": "m", "y": "m", "vx": "m/s", "vy": "m/s",
    "angle": "degrees", "azimuth": "degrees", "angle_rate": "degrees/s", "azimuth_rate": "degrees/s",
}  # fmt: skip
_UNSOLVABLE = (FoucaultError, ValueError, ArithmeticError)  # the scene cannot be solved, so no program ran it


@dataclass(frozen=True)
class Diagnosis:
    """The likely reason for a candidate's error.

    Attributes:
        id: the mistake's word, or the input's name in the scene file.
        explained: share of the root mean square error that is gone with it, over the rows that were used.
        text: a sentence.
        shift: for an input, how far it seems to be off, in its unit; else None.
        also: ids of the hypotheses that explain as much, so that these rows cannot tell which it is.
    """

    id: str
    explained: float
    text: str
    shift: float | None = None
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Explanation:
    """A hypothesis that explains enough; `residual` is the share of the error that remains with it."""

    id: str
    residual: float
    phrase: str
    shift: float | None = None


def diagnose(candidate: Candidate, errors: TrajectoryErrors, scene: Scene) -> Diagnosis | None:
    """Return the mistake that explains at least 99 % of the error, or None.

    Args:
        candidate: the trajectory that is off.
        errors: of all its rows.
        scene: in the reading that it was scored in.
    """
    case = _Case.of(candidate, errors, scene)
    if not case.size:
        return None
    named = list(case.named_mistakes())
    if min((one.residual for one in named), default=1.0) < 1 - SURE:
        return _likeliest(named)
    return _likeliest(named + list(case.fitted_inputs()))


def _likeliest(explanations: list[_Explanation]) -> Diagnosis | None:
    """Choose: named mistakes come first and in their order, unless another hypothesis has a much smaller residual."""
    if not explanations:
        return None
    least = max(RESOLVED, min(one.residual for one in explanations))
    named = [one for one in explanations if one.shift is None and one.residual <= NAMED_FIRST * least]
    best = (named or [one for one in explanations if one.residual <= AS_MUCH * least])[0]
    others = [one for one in explanations if one is not best and one.residual <= AS_MUCH * max(RESOLVED, best.residual)]
    also = "".join(f" Or it {one.phrase}, which explains as much." for one in others)
    text = f"It seems that your program {best.phrase}: that explains {_percent(1 - best.residual)}.{also}"
    return Diagnosis(best.id, 1 - best.residual, text, best.shift, tuple(one.id for one in others))


def _sample(count: int) -> npt.NDArray[np.int64]:
    """Return the numbers of the rows to use, of `count` rows."""
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded]).astype(np.int64))


@dataclass(frozen=True)
class _Case:
    """The rows used, and the tools to test hypotheses on them."""

    scene: Scene
    times: Array
    observed: Array
    truth: Array
    columns: list[int]
    size: float
    model: Variants

    @classmethod
    def of(cls, candidate: Candidate, errors: TrajectoryErrors, scene: Scene) -> _Case:
        rows = _sample(len(errors.t))
        names = [name for name in ("x", "y", "z") if name in candidate.columns]
        observed = np.column_stack([errors.components[name][rows] for name in names])
        times, truth = errors.t[rows], errors.truth.states[rows]
        if times[0] > 0:
            times = np.concatenate([[0.0], times])
            observed, truth = (np.vstack([part[:1], part]) for part in (observed, truth))
            observed[0] = 0
            truth[0] = np.nan  # this row is never used
        columns = ["xyz".index(name) for name in names]
        return cls(scene, times, observed, truth, columns, float(np.linalg.norm(observed)), Variants())

    def rows_until(self, part: float) -> int:
        """Count the rows in the first part of the run."""
        return int(np.searchsorted(self.times, part * self.times[-1], side="right"))

    def residual(self, displacement: Array) -> float:
        """Return the error that remains in the first rows if the truth is displaced, over the whole error."""
        observed = self.observed[: len(displacement)]
        remainder = np.linalg.norm((observed - displacement[:, self.columns])[self._first :])
        return float(remainder) / self.size

    @property
    def _first(self) -> int:
        """Number of the first row to use: 1 if the candidate has no row at t = 0 and one was put there, else 0."""
        return int(np.isnan(self.truth[0, 0]))

    def named_mistakes(self) -> Iterator[_Explanation]:
        """Yield the named mistakes that explain enough."""
        small = float(np.nanmax(self.truth[:, 2])) < -SMALL * float(self._inputs.length)
        for hypothesis in hypotheses(self.scene, self.model, approximations=small):
            try:
                residual = self._residual_of(hypothesis.states)
            except _UNSOLVABLE:
                continue
            if residual <= 1 - EXPLAINED:
                yield _Explanation(hypothesis.id, residual, hypothesis.phrase)

    def _residual_of(self, states: Callable[[Array], Array]) -> float:
        residual = 0.0
        for part in TRIALS:
            until = self.rows_until(part)
            if until > 1 or part == 1:
                residual = self.residual(states(self.times[:until]) - self.truth[:until])
            if residual > 1 - EXPLAINED:
                break
        return residual

    def fitted_inputs(self) -> Iterator[_Explanation]:
        """Yield the inputs that, shifted, explain enough."""
        start = next((n for n in map(self.rows_until, WINDOWS) if n > 2 and self.observed[:n].any()), None)
        if start is None:
            return
        response = sensitivity(self.scene, self.times[:start])
        for name in response.values:
            try:
                explanation = self._fit(name, response)
            except _UNSOLVABLE:
                continue
            if explanation is not None:
                yield explanation

    def _fit(self, name: str, response: Sensitivity) -> _Explanation | None:
        value, shift, residual = response.values[name], Fraction(0), 1.0
        derivative, displacement = response.derivative(name), np.zeros((len(response.times), 6))
        windows = [n for n in map(self.rows_until, WINDOWS) if n >= len(response.times)]
        for i, until in enumerate(windows):
            if i:
                derivative = self._derivative(name, value + shift, derivative, until)
                displacement = self._displacement(name, value + shift, until)
            for _ in range(STEPS):
                change = self._gauss_newton(derivative, displacement)
                shift += Fraction(change)
                displacement = self._displacement(name, value + shift, until)
                if not abs(change) > 1e-6 * abs(float(shift)):
                    break
            residual = self.residual(displacement)
            if residual > 1 - EXPLAINED:
                return None
        key = name.split(".")[1]
        offset = f"{float(shift):+.4g} {UNITS[key]}".rstrip()
        phrase = f"takes {name} to be {float(value + shift):.10g} and not {float(value):.10g} ({offset})"
        return _Explanation(name, residual, phrase, float(shift))

    def _gauss_newton(self, derivative: Array, displacement: Array) -> float:
        """Return the change of the input that a linear least-squares fit asks for."""
        direction = derivative[self._first :, self.columns].ravel()
        remainder = (self.observed[: len(displacement)] - displacement[:, self.columns])[self._first :].ravel()
        weight = float(direction @ direction)
        return float(direction @ remainder) / weight if weight else 0.0

    def _displacement(self, name: str, value: Fraction, until: int) -> Array:
        """Subtract the run with the scene's own input, in double as well, so that the errors of both runs cancel."""
        return self._run(name, value, until) - self._baseline[:until]

    def _derivative(self, name: str, value: Fraction, before: Array, until: int) -> Array:
        """Return the derivative at another value, by central differences of the model."""
        size = float(np.abs(before).max())
        nudge = Fraction(1e-5 / size if size else 1e-6)
        ahead, behind = (self._run(name, value + side * nudge, until) for side in (1, -1))
        return (ahead - behind) / (2 * float(nudge))

    def _run(self, name: str, value: Fraction, until: int) -> Array:
        changed = with_value(self._inputs, name, value)
        if _overall_rate(changed) > BEYOND * (_overall_rate(self._inputs) + 1 / (1 + float(self.times[-1]))):
            raise ValueError("much faster than the scene")
        return self.model.states(changed, self.times[:until])

    @cached_property
    def _inputs(self) -> Inputs:
        return self.scene.exact

    @cached_property
    def _baseline(self) -> Array:
        return self.model.states(self._inputs, self.times)


def _overall_rate(inputs: Inputs) -> float:
    """Add up the rates in 1/s at which anything happens: swing, rotation, drag, and the release."""
    k = constants_in_double(inputs)
    speed = inputs.position[2:] if inputs.position is not None else inputs.angles[2:] if inputs.angles else ()
    release_rate = max((abs(float(part)) for part in speed), default=0.0) / (
        k.length if inputs.position is not None else 57.3
    )
    return math.sqrt(math.hypot(k.pull[1], k.pull[2])) + float(abs(k.rate) + abs(k.drag)) + release_rate


def _percent(share: float) -> str:
    return f"{100 * share:.4g} % of the error" if share < 0.99995 else "all but 0.01 % of the error"
