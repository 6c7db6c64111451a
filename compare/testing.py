"""Assert in your own tests that a trajectory agrees with the truth; `fixture.py` provides it as a pytest fixture.

>>> from compare import assert_agrees
>>> score = assert_agrees("paris", [0.0, 60.0], [[0.3, 0.4], [-0.176326733, -0.415867688]], tolerance=1e-8)
>>> score.errors.max_m < 1e-8
True

Two rows say little: with `covers=1` the times have to reach the end of the scene.

>>> score.covered < 0.001
True
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import InputError, Scene
from reference.errors import Described
from reference.numbers.precision import Array
from reference.scenes.scene import AnyScene, as_scene

from .candidates.arrays import candidate_of, real_array
from .candidates.candidate import COLUMNS, Candidate
from .candidates.external import placeholders
from .score.judge import checked_options, judge_with
from .score.verdict import Score, lines


def assert_agrees(
    scene: AnyScene,
    t: npt.ArrayLike,
    states: npt.ArrayLike,
    *,
    tolerance: float | None = None,
    transits: npt.ArrayLike | None = None,
    covers: float = 0.0,
    as_model: bool = False,
    inputs: str = "auto",
    baseline: Score | Mapping[str, Any] | str | Path | None = None,
) -> Score:
    """Assert that positions agree with the truth of a scene, or are no worse than those of an earlier version.

    Args:
        scene: a scene, its id, the path of a TOML file, or nested mappings.
        t: times in s, shape (rows,), increasing.
        states: x, y in m; or x, y, z in m; or these and vx, vy, vz in m/s: shape (rows, 2), (rows,
            3) or (rows, 6).
        tolerance: largest position error allowed, in m; a millionth of the amplitude if None, as in
            `foucault score`.
        transits: times of xdot = 0 in s, if they are to be compared as well.
        covers: share of the scene's span, from 0 to 1, that the times have to reach; 1 is all of
            it.
        as_model: whether agreement as a named simplification of the model is enough.
        inputs: decimal, binary64 or auto, as in `foucault score --inputs`.
        baseline: an earlier version: the path of its file or of its `foucault score --json`
            (.json), or its score. Then it is enough to be no worse than that by more than the
            tolerance.

    Returns:
        The score, with more measures of the error.

    Raises:
        AssertionError: the trajectory disagrees, or has no row after t = 0, or became worse than
            its baseline; the message gives time, component, expected, got, difference, what is
            allowed, what changed, and the causes that were found.
        InputError: an array has the wrong shape, or a number is not finite.
    """
    scene = as_scene(scene)
    candidate = _candidate_of(real_array(states, "states"), real_array(t, "t"))
    options = checked_options(
        tolerance, inputs, t_end=None, covers=covers, as_model=as_model, explain=True
    )
    score = judge_with(options, candidate, scene, transits=transits, baseline=baseline)
    if not score.accepted:
        raise AssertionError(_message(score))
    return score


def _candidate_of(states: Array, times: Array) -> Candidate:
    """Return the candidate of states, one row for each time.

    Raises:
        InputError: the states have another shape.
    """
    if states.ndim == 2 and 1 < states.shape[0] != times.size == states.shape[1]:
        got = Described(f"shape {states.shape} for {times.size} times")
        advice = "Give one row for each time: transpose the array, as in sol.y.T of SciPy."
        raise InputError("states", got, "shape (rows, columns)", advice)
    if states.ndim != 2 or states.shape[1] not in (2, 3, 6):
        expected = "shape (rows, 2), (rows, 3) or (rows, 6)"
        raise InputError("states", Described(f"shape {states.shape}"), expected)
    names = COLUMNS[: states.shape[1]]
    return candidate_of("states", {"t": times, **dict(zip(names, states.T, strict=True))})


@dataclass(frozen=True)
class SceneCase:
    """A scene to test a program with.

    Attributes:
        scene: the problem.
        tolerance: largest position error allowed in m; None for a millionth of the amplitude.
    """

    scene: Scene
    tolerance: float | None = None

    @property
    def inputs(self) -> dict[str, float]:
        """The scene's numbers by the words that `foucault score --run` fills in, such as x0, latitude and t_end."""
        return {
            name: float(word)
            for name, word in placeholders(self.scene).items()
            if name != "gravity_is"
        }

    @property
    def t(self) -> Array:
        """The scene's grid times in s; any others will do."""
        return np.array([float(time) for time in self.scene.exact.grid])

    def assert_agrees(self, t: npt.ArrayLike, states: npt.ArrayLike, **more: Any) -> Score:
        """Assert that a trajectory agrees with the truth, as `assert_agrees` does."""
        return assert_agrees(self.scene, t, states, **{"tolerance": self.tolerance, **more})


def _message(score: Score) -> str:
    """Return the message of a failed assertion: the worst number if it is off, and all that `foucault score` says."""
    if score.off_path:
        worst = score.worst
        head = [
            f"{score.scene.id}: {worst.component} at t = {worst.t!r} s "
            f"(row {score.errors.worst[0] + 1}):",
            f"  expected   {worst.expected!r}",
            f"  got        {worst.got!r}",
            f"  difference {worst.difference:+.3e} m",
            f"  position error {score.errors.max_m:.3e} m, allowed {score.allowed_m:.3e} m",
        ]
    else:
        allowed = f"the {score.allowed_m:.3e} m that are allowed"
        head = [f"{score.scene.id}: every position is within {allowed}, and yet:"]
    return "\n".join([*head, *lines(score)])
