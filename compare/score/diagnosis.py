"""Why is a candidate wrong? Named mistakes are tried, and single inputs are fitted; most of the error must go.

A mistake is tried on a short part of the run first, then on a longer one: what it leaves there of the error it
leaves of the whole, and so nothing is lost by giving it up early. A single input is fitted by Gauss-Newton from
early rows to all of them: where its shift is large, the model itself is run with the shifted input.
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
from reference.precision import Array
from reference.scene import Inputs
from reference.solver.sensitivity import Sensitivity, sensitivity, with_value

from ..candidates.candidate import Candidate
from ..rhs.constants import constants_in_double
from .errors import Errors
from .hypotheses import hypotheses

EXPLAINED = 0.99  # of the root mean square error, below which nothing is offered
SURE = 0.9999  # of it, from which a named mistake is not held against fitted inputs
ROWS = 1500  # of the candidate that are used: half of them evenly, half crowding towards the release
WINDOWS = tuple(4.0**-k for k in range(7, -1, -1))  # of the run, one after the other
TRIALS = (1 / 64, 1 / 8, 1.0)  # parts of the run on which a named mistake is tried
STEPS = 3  # of Gauss-Newton in each window
NAMED_FIRST = 10.0  # a named mistake is preferred to a fitted shift that leaves up to so much less
AS_MUCH = 2.0  # what leaves at most so many times as much of the error as the best explains it as well
RESOLVED = 1e-6  # of the error: who leaves less than this is a matter of rounding
BEYOND = 30.0  # an input that makes the pendulum so many times faster is not what was run, and takes as long to try
SMALL = 0.25  # of the cord: a bob that rises so near to the horizontal is nothing for approximations of small swings
UNITS = {
    "length": "m", "drag": "1/s", "latitude": "degrees", "altitude": "m", "gravity": "m/s²", "rotation_rate": "rad/s",
    "equatorial_radius": "m", "inverse_flattening": "", "x": "m", "y": "m", "vx": "m/s", "vy": "m/s",
    "angle": "degrees", "azimuth": "degrees", "angle_rate": "degrees/s", "azimuth_rate": "degrees/s",
}  # fmt: skip
_IMPOSSIBLE = (FoucaultError, ValueError, ArithmeticError)  # a scene that cannot be solved was not what was run


@dataclass(frozen=True)
class Diagnosis:
    """What explains a candidate's error.

    Attributes:
        id: the mistake's word, or the input's name in the scene file.
        explained: share of the root mean square error that is gone with it, over the rows that were looked at.
        text: a sentence.
        shift: for an input, how far it seems to be off, in its unit; else None.
        also: ids of what explains as much, so that these rows cannot tell which it is.
    """

    id: str
    explained: float
    text: str
    shift: float | None = None
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Found:
    id: str
    left: float
    says: str
    shift: float | None = None


def diagnose(candidate: Candidate, errors: Errors, scene: Scene) -> Diagnosis | None:
    """The mistake that explains at least 99 % of the error, or None.

    Args:
        candidate: what came.
        errors: of all its rows.
        scene: in the reading that it was scored in.
    """
    case = _Case.of(candidate, errors, scene)
    if not case.size:
        return None
    named = list(case.named())
    if min((found.left for found in named), default=1.0) < 1 - SURE:
        return _told(named)
    return _told(named + list(case.fitted()))


def _told(found: list[_Found]) -> Diagnosis | None:
    """The likeliest: named mistakes come first and in their order, unless another leaves much less of the error."""
    if not found:
        return None
    least = max(RESOLVED, min(one.left for one in found))
    named = [one for one in found if one.shift is None and one.left <= NAMED_FIRST * least]
    best = (named or [one for one in found if one.left <= AS_MUCH * least])[0]
    others = [one for one in found if one is not best and one.left <= AS_MUCH * max(RESOLVED, best.left)]
    also = "".join(f" Or that it {one.says}, which explains as much." for one in others)
    text = f"It seems that your program {best.says}: that explains {_percent(1 - best.left)}.{also}"
    return Diagnosis(best.id, 1 - best.left, text, best.shift, tuple(one.id for one in others))


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
        names = [name for name in ("x", "y", "z") if name in candidate.columns]
        observed = np.column_stack([errors.components[name][rows] for name in names])
        times, truth = errors.t[rows], errors.truth.states[rows]
        if times[0] > 0:
            times = np.concatenate([[0.0], times])
            observed, truth = (np.vstack([part[:1], part]) for part in (observed, truth))
            observed[0] = 0
            truth[0] = np.nan  # never looked at
        columns = ["xyz".index(name) for name in names]
        return cls(scene, times, observed, truth, columns, float(np.linalg.norm(observed)), Variants())

    def until(self, part: float) -> int:
        """How many rows lie in a part of the run."""
        return int(np.searchsorted(self.times, part * self.times[-1], side="right"))

    def left(self, moved: Array) -> float:
        """What is left of the error in the first rows, over the whole error, if the truth is taken to move so."""
        observed = self.observed[: len(moved)]
        off = np.linalg.norm((observed - moved[:, self.columns])[self._first :])
        return float(off) / self.size

    @property
    def _first(self) -> int:
        """1 if the row at t = 0 was put there and not given."""
        return int(np.isnan(self.truth[0, 0]))

    def named(self) -> Iterator[_Found]:
        """The named mistakes that explain enough."""
        small = float(np.nanmax(self.truth[:, 2])) < -SMALL * float(self._inputs.length)
        for guess in hypotheses(self.scene, self.model, approximations=small):
            try:
                left = self._tried(guess.states)
            except _IMPOSSIBLE:
                continue
            if left <= 1 - EXPLAINED:
                yield _Found(guess.id, left, guess.says)

    def _tried(self, states: Callable[[Array], Array]) -> float:
        left = 0.0
        for part in TRIALS:
            until = self.until(part)
            if until > 1 or part == 1:
                left = self.left(states(self.times[:until]) - self.truth[:until])
            if left > 1 - EXPLAINED:
                break
        return left

    def fitted(self) -> Iterator[_Found]:
        """The inputs that, shifted, explain enough."""
        begun = next((n for n in map(self.until, WINDOWS) if n > 2 and self.observed[:n].any()), None)
        if begun is None:
            return
        response = sensitivity(self.scene, self.times[:begun])
        for name in response.values:
            try:
                found = self._fit(name, response)
            except _IMPOSSIBLE:
                continue
            if found is not None:
                yield found

    def _fit(self, name: str, response: Sensitivity) -> _Found | None:
        value, shift, left = response.values[name], Fraction(0), 1.0
        slope, moved = response.derivative(name), np.zeros((len(response.times), 6))
        windows = [n for n in map(self.until, WINDOWS) if n >= len(response.times)]
        for i, until in enumerate(windows):
            if i:
                slope = self._slope(name, value + shift, slope, until)
                moved = self._moved(name, value + shift, until)
            for _ in range(STEPS):
                change = self._step(slope, moved)
                shift += Fraction(change)
                moved = self._moved(name, value + shift, until)
                if not abs(change) > 1e-6 * abs(float(shift)):
                    break
            left = self.left(moved)
            if left > 1 - EXPLAINED:
                return None
        key = name.split(".")[1]
        off = f"{float(shift):+.4g} {UNITS[key]}".rstrip()
        says = f"takes {name} to be {float(value + shift):.10g} and not {float(value):.10g} ({off})"
        return _Found(name, left, says, float(shift))

    def _step(self, slope: Array, moved: Array) -> float:
        direction = slope[self._first :, self.columns].ravel()
        off = (self.observed[: len(moved)] - moved[:, self.columns])[self._first :].ravel()
        weight = float(direction @ direction)
        return float(direction @ off) / weight if weight else 0.0

    def _moved(self, name: str, value: Fraction, until: int) -> Array:
        """How far an input of that value moves the trajectory; both runs are double, so that their errors go."""
        return self._run(name, value, until) - self._baseline[:until]

    def _slope(self, name: str, value: Fraction, before: Array, until: int) -> Array:
        """The derivative at another value, by central differences of the model."""
        size = float(np.abs(before).max())
        nudge = Fraction(1e-5 / size if size else 1e-6)
        ahead, behind = (self._run(name, value + side * nudge, until) for side in (1, -1))
        return (ahead - behind) / (2 * float(nudge))

    def _run(self, name: str, value: Fraction, until: int) -> Array:
        changed = with_value(self._inputs, name, value)
        if _quickness(changed) > BEYOND * (_quickness(self._inputs) + 1 / (1 + float(self.times[-1]))):
            raise ValueError("beyond what was run")
        return self.model.states(changed, self.times[:until])

    @cached_property
    def _inputs(self) -> Inputs:
        return self.scene.exact

    @cached_property
    def _baseline(self) -> Array:
        return self.model.states(self._inputs, self.times)


def _quickness(inputs: Inputs) -> float:
    """How fast anything happens in 1/s: swing, rotation, drag, and the release."""
    k = constants_in_double(inputs)
    speed = inputs.position[2:] if inputs.position is not None else inputs.angles[2:] if inputs.angles else ()
    moving = max((abs(float(part)) for part in speed), default=0.0) / (
        k.length if inputs.position is not None else 57.3
    )
    return math.sqrt(math.hypot(k.pull[1], k.pull[2])) + float(abs(k.rate) + abs(k.drag)) + moving


def _percent(share: float) -> str:
    return f"{100 * share:.4g} % of the error" if share < 0.99995 else "all but 0.01 % of the error"
