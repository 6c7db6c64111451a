"""Why is a candidate wrong? Named mistakes are tried, and single inputs are fitted; most of the error must go.

A single input is fitted by Gauss-Newton from early rows to all of them: the first steps are those of the
variational equations, and where the shift is large the model itself is run with the shifted input.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
import numpy.typing as npt

from reference import FoucaultError, Scene
from reference.flow import Variants
from reference.scene import Inputs
from reference.sensitivity import Sensitivity, sensitivity, with_value
from reference.solution import Array

from .candidate import Candidate
from .hypotheses import hypotheses
from .metrics import Errors

EXPLAINED = 0.99  # of the root mean square error, below which nothing is offered
ROWS = 1500  # of the candidate that are used: half of them evenly, half crowding towards the release
WINDOWS = tuple(4.0**-k for k in range(7, -1, -1))  # of the run, one after the other
STEPS = 3  # of Gauss-Newton in each
PROMISING = 0.5  # of the error that an input must explain in a window to be followed into the next
NAMED_FIRST = 10.0  # a named mistake is preferred to a fitted shift that leaves up to so much less
UNITS = {
    "length": "m", "drag": "1/s", "latitude": "degrees", "altitude": "m", "gravity": "m/s²", "rotation_rate": "rad/s",
    "equatorial_radius": "m", "inverse_flattening": "", "x": "m", "y": "m", "vx": "m/s", "vy": "m/s",
    "angle": "degrees", "azimuth": "degrees", "angle_rate": "degrees/s", "azimuth_rate": "degrees/s",
}  # fmt: skip


@dataclass(frozen=True)
class Diagnosis:
    """What explains a candidate's error.

    Attributes:
        id: the mistake's word, or the input's name in the scene file.
        explained: share of the root mean square error that is gone with it.
        text: a sentence.
        shift: for an input, how far it seems to be off, in its unit; else None.
    """

    id: str
    explained: float
    text: str
    shift: float | None = None


def diagnose(
    candidate: Candidate, errors: Errors, scene: Scene, report: Callable[[str], None] | None = None
) -> Diagnosis | None:
    """The mistake that explains at least 99 % of the error, or None.

    Args:
        candidate: what came.
        errors: of all its rows.
        scene: in the reading that it was scored in.
        report: told what is tried.
    """
    case = _Case.of(candidate, errors, scene)
    if not case.size:
        return None
    named = _first_of_the_best(case.named(report))
    if named is not None and named.explained > 1 - (1 - EXPLAINED) ** 2:
        return named
    fitted = max(case.fitted(report), key=lambda found: found.explained, default=None)
    best = max((found for found in (named, fitted) if found is not None), key=lambda d: d.explained, default=None)
    if best is None or best.explained < EXPLAINED:
        return None
    if named is not None and 1 - named.explained <= NAMED_FIRST * (1 - best.explained) and named.explained >= EXPLAINED:
        return named
    return best


def _first_of_the_best(found: Iterable[Diagnosis]) -> Diagnosis | None:
    """The likelier mistakes come first: of those that explain about as much, that one."""
    tried = list(found)
    left = min((1 - one.explained for one in tried), default=1.0)
    return next((one for one in tried if 1 - one.explained <= NAMED_FIRST * left), None)


def _looked_at(count: int) -> npt.NDArray[np.int64]:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(np.concatenate([even, crowded]).astype(np.int64))


@dataclass(frozen=True)
class _Case:
    """The rows looked at, and the tools."""

    scene: Scene
    times: Array
    observed: Array
    truth: Array
    columns: list[int]
    size: float
    model: Variants

    @classmethod
    def of(cls, candidate: Candidate, errors: Errors, scene: Scene) -> _Case:
        rows = _looked_at(len(errors.t))
        names = [name for name in ("x", "y", "z") if name in errors.components]
        observed = np.column_stack([errors.components[name][rows] for name in names])
        times, truth = errors.t[rows], errors.truth.states[rows]
        if times[0] > 0:
            times = np.concatenate([[0.0], times])
            observed, truth = (np.vstack([part[:1], part]) for part in (observed, truth))
            observed[0] = 0
        columns = ["xyz".index(name) for name in names]
        return cls(scene, times, observed, truth, columns, float(np.linalg.norm(observed)), Variants())

    def explained(self, states: Array, baseline: Array, until: int | None = None) -> float:
        """Share of the error that goes if the truth is taken to move from `baseline` to `states`."""
        moved = (states - baseline)[:until, self.columns]
        size = float(np.linalg.norm(self.observed[:until]))
        return 1 - float(np.linalg.norm(self.observed[:until] - moved)) / size if size else 0.0

    def named(self, report: Callable[[str], None] | None) -> Iterator[Diagnosis]:
        for guess in hypotheses(self.scene, self.model):
            if report is not None:
                report(guess.id)
            try:
                share = self.explained(guess.states(self.times), self.truth)
            except (FoucaultError, ValueError, ArithmeticError):
                continue  # a mistake that this scene cannot even be solved with was not made
            yield Diagnosis(
                guess.id, share, f"It seems that your program {guess.says}: that explains {_percent(share)}."
            )

    def fitted(self, report: Callable[[str], None] | None) -> Iterator[Diagnosis]:
        response = sensitivity(self.scene, self.times)
        for name in response.values:
            if report is not None:
                report(name)
            try:
                found = self._fit(name, response)
            except (FoucaultError, ValueError, ArithmeticError):
                continue
            if found is not None:
                yield found

    def _fit(self, name: str, response: Sensitivity) -> Diagnosis | None:
        inputs, value = self.scene.exact, response.values[name]
        slope = response.derivative(name)
        shift, share = Fraction(0), 0.0
        for window in WINDOWS:
            until = int(np.searchsorted(self.times, window * self.times[-1], side="right"))
            if until < 3 or not np.linalg.norm(self.observed[:until]):
                continue
            for _ in range(STEPS):
                change = self._step(slope, self._moved(inputs, name, value, shift), until)
                shift += Fraction(change)
                share = self.explained(self.truth + self._moved(inputs, name, value, shift), self.truth, until)
                if not abs(change) > 1e-6 * abs(float(shift)):
                    break
            if share < PROMISING:
                return None
            slope = self._slope(inputs, name, value + shift, slope)
        key = name.split(".")[1]
        off = f"{float(shift):+.4g} {UNITS[key]}".rstrip()
        text = (
            f"It seems that {name} is {float(value + shift):.10g} in your program and not {float(value):.10g} "
            f"({off}): that explains {_percent(share)}."
        )
        return Diagnosis(name, share, text, float(shift))

    def _step(self, slope: Array, moved: Array, until: int) -> float:
        direction = slope[:until, self.columns].ravel()
        left = (self.observed[:until] - moved[:until, self.columns]).ravel()
        weight = float(direction @ direction)
        return float(direction @ left) / weight if weight else 0.0

    def _moved(self, inputs: Inputs, name: str, value: Fraction, shift: Fraction) -> Array:
        """How far the shifted input moves the trajectory; both runs are double, so that their errors go."""
        if not shift:
            return np.zeros_like(self.truth)
        return self.model.states(with_value(inputs, name, value + shift), self.times) - self._baseline

    def _slope(self, inputs: Inputs, name: str, value: Fraction, before: Array) -> Array:
        """The derivative at another value, by central differences of the model."""
        size = float(np.abs(before).max())
        nudge = Fraction(1e-5 / size if size else 1e-6)
        ahead, behind = (
            self.model.states(with_value(inputs, name, value + side * nudge), self.times) for side in (1, -1)
        )
        return (ahead - behind) / (2 * float(nudge))

    @cached_property
    def _baseline(self) -> Array:
        return self.model.states(self.scene.exact, self.times)


def _percent(share: float) -> str:
    return f"{100 * share:.4g} % of the error" if share < 0.99995 else "all but 0.01 % of the error"
