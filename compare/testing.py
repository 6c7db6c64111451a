"""For others' tests: assert that a trajectory is right, and a pytest fixture that does the same.

>>> from compare import assert_agrees
>>> score = assert_agrees("paris", [0.0], [[0.3, 0.4]], tolerance=1e-12)
>>> score.errors.max_m < 1e-12
True
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from reference import InputError, Scene, load_scene

from .candidates.candidate import COLUMNS, candidate_of
from .candidates.transit_times import checked_transits
from .score.judge import Score, score


def assert_agrees(
    scene: str | Scene,
    t: npt.ArrayLike,
    states: npt.ArrayLike,
    *,
    tolerance: float,
    transits: npt.ArrayLike | None = None,
    inputs: str = "auto",
) -> Score:
    """Assert that positions agree with the truth of a scene.

    Args:
        scene: a scene, its id, or the path of a TOML file.
        t: times in s, shape (rows,), increasing.
        states: x, y or x, y, z in m, or these with vx, vy, vz in m/s: shape (rows, 2), (rows, 3) or (rows, 6).
        tolerance: largest position error allowed, in m.
        transits: times of xdot = 0 in s, to be compared as well.
        inputs: decimal, binary64 or auto, as in `foucault score --inputs`.

    Returns:
        The score, for more to be asked of it.

    Raises:
        AssertionError: with time, component, expected, got, difference and what was allowed.
        InputError: arrays of the wrong shape, or numbers that are not finite.
    """
    rows, times = np.asarray(states), np.asarray(t)
    if rows.ndim != 2 or rows.shape[1] not in (2, 3, 6):
        raise InputError("states", f"shape {rows.shape}", "shape (rows, 2), (rows, 3) or (rows, 6)")
    for name, array in (("t", times), ("states", rows)):
        if array.dtype.kind not in "fiu":
            raise InputError(name, f"dtype {array.dtype}", "real numbers")
    given = {"t": times, **{name: rows[:, i] for i, name in enumerate(COLUMNS[: rows.shape[1]])}}
    found = scene if isinstance(scene, Scene) else load_scene(scene)
    zeros = None if transits is None else checked_transits(np.asarray(transits, dtype=np.float64), "transits")
    made = score(
        candidate_of("states", given),
        found,
        transits=zeros,
        tolerance=tolerance,
        inputs=inputs,
        explain=False,
    )
    if not made.agrees:
        raise AssertionError(message(made))
    return made


def message(made: Score) -> str:
    """What a failed assertion says."""
    errors, found = made.errors, made.transits
    row, component = errors.worst
    expected = float(errors.truth.states[row, "xyz".index(component)])
    got = float(made.candidate.columns[component][row])
    said = [
        f"{made.scene.id}: {component} at t = {float(errors.t[row])!r} s (row {row}):",
        f"  expected   {expected!r}",
        f"  got        {got!r}",
        f"  difference {float(errors.components[component][row]):+.3e} m",
        f"  position error {errors.max_m:.3e} m, allowed {made.allowed_m:.3e} m",
    ]
    if found is not None and (found.missed or found.extra or found.max_conditioned_m > made.allowed_m):
        said.append(f"  transits: {found.matched} matched, missed at {found.missed[:3]}, extra at {found.extra[:3]},")
        said.append(f"  largest error {found.max_error_s:.3e} s, weighed by |ax| {found.max_conditioned_m:.3e} m")
    return "\n".join(said)
