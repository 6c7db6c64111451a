"""Error measures of a trajectory against the truth, as the field counts them.

Errors are differences of numbers that may agree to more digits than a double holds: both sides come as a
double and what it lacks, and the difference is taken of both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from reference import Scene
from reference.constants import constants
from reference.dense import Dense
from reference.mechanics import invariant
from reference.precision import context
from reference.scene import Inputs
from reference.solution import Array

from .candidate import COLUMNS, Candidate
from .ellipse import EllipseErrors, ellipse_errors

ENVELOPES = 40  # parts of the run whose largest error makes the curve that growth is fitted to


@dataclass(frozen=True)
class Errors:
    """A candidate's errors at its own times.

    Attributes:
        t: times in s, shape (rows,).
        components: candidate minus truth per column that the candidate has, in m or m/s.
        position: distance from the truth in m over the position columns that it has, shape (rows,).
        bound_m: how far the truth itself may be off.
        amplitude_m: the truth's largest distance from the vertical, the scale of the digits.
    """

    t: Array = field(repr=False)
    components: dict[str, Array] = field(repr=False)
    position: Array = field(repr=False)
    truth: Dense = field(repr=False)
    bound_m: float
    amplitude_m: float

    @property
    def max_m(self) -> float:
        """The largest position error in m."""
        return float(self.position.max())

    @property
    def rms_m(self) -> float:
        """The root mean square of the position errors in m."""
        top = self.max_m
        return top * math.sqrt(float(np.mean((self.position / top) ** 2))) if top else 0.0

    @property
    def end_m(self) -> float:
        """The position error at the last row in m."""
        return float(self.position[-1])

    @property
    def digits(self) -> float:
        """mescd, mixed error significant correct digits: -log10 of the largest error over the amplitude.

        Never more than the truth's bound allows.
        """
        return -math.log10(max(self.max_m, self.bound_m) / self.amplitude_m)

    @property
    def scd(self) -> float:
        """Significant correct digits at the end: -log10 of the largest relative error of x and y there."""
        relative = [
            max(abs(float(self.components[name][-1])), self.bound_m) / abs(float(self.truth.states[-1, i]))
            for i, name in enumerate(("x", "y"))
            if self.truth.states[-1, i]
        ]
        return -math.log10(max(relative)) if relative else 0.0

    @property
    def worst(self) -> tuple[int, str]:
        """Row and component of the largest single error in position."""
        row = int(np.argmax(self.position))
        return row, max(
            (name for name in ("x", "y", "z") if name in self.components),
            key=lambda name: abs(float(self.components[name][row])),
        )

    @property
    def growth(self) -> float | None:
        """The exponent p of error ∝ t^p, fitted to the largest error in equal parts of log t; None if too few rows."""
        kept = (self.t > 0) & (self.position > self.bound_m)
        if kept.sum() < 4 or self.t[kept][-1] < 4 * self.t[kept][0]:
            return None
        t, error = self.t[kept], np.maximum.accumulate(self.position[kept])
        edges = np.geomspace(t[0], t[-1], ENVELOPES)
        at = np.unique(np.searchsorted(t, edges, side="right") - 1)
        return float(np.polyfit(np.log(t[at]), np.log(error[at]), 1)[0]) if len(at) > 2 else None

    def ellipse(self, rest: tuple[float, float]) -> EllipseErrors:
        """Turn of the swing plane and delay; `rest` is x, y of the rest position in m."""
        error = np.column_stack([self.components["x"], self.components["y"]])
        return ellipse_errors(self.t, self.truth.states, error, rest)


def errors_of(candidate: Candidate, truth: Dense) -> Errors:
    """Subtract the truth, evaluated at the candidate's times, from the candidate."""
    components = {}
    for i, name in enumerate(COLUMNS):
        if name in candidate.columns:
            difference = (candidate.columns[name] - truth.states[:, i]) - truth.rest[:, i]
            components[name] = difference + candidate.rest[name] if name in candidate.rest else difference
    with np.errstate(over="ignore"):
        position = np.sqrt(sum(components[name] ** 2 for name in ("x", "y", "z") if name in components))
    amplitude = float(np.hypot(truth.states[:, 0], truth.states[:, 1]).max())
    return Errors(candidate.t, components, np.asarray(position), truth, truth.bound_m, amplitude or 1.0)


def drifts(candidate: Candidate, scene: Scene | Inputs) -> dict[str, float]:
    """Largest change of h (m²/s²) from the first row, where there are velocities and no drag, and of |r| - l (m)."""
    inputs = scene.exact if isinstance(scene, Scene) else scene
    found: dict[str, float] = {}
    have = candidate.columns
    k = constants(inputs, context(80)).converted(float)
    if "z" not in have:
        return found
    n = tuple(have[name] / k.length for name in ("x", "y", "z"))
    radius = np.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
    found["length_m"] = float(np.abs((radius - 1) * k.length).max())
    if all(name in have for name in ("vx", "vy", "vz")) and not inputs.drag:
        v = tuple(have[name] / k.length for name in ("vx", "vy", "vz"))
        # R²Ω²/2 is constant and a million times larger than what varies: it is left out, not cancelled
        near = replace(k, axis_distance=0)
        h = invariant(n, v, near) - k.rate**2 * k.axis_distance * (k.cos * n[2] - k.sin * n[1]) * k.length**2
        found["h_m2_s2"] = float(np.abs(h - h[0]).max())
    return found
