"""The truth at a candidate's times: by a golden function that ships, from a dataset that ships, or solved now."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from reference import (
    DatasetError,
    FoucaultError,
    Golden,
    InputError,
    Scene,
    Solution,
    load,
    load_scene,
)
from reference.dataset.golden import WITHIN, Dense, dense
from reference.model.constants import constants_in_double
from reference.model.force import rates
from reference.numbers.columns import POSITION, STATE, VELOCITY
from reference.numbers.precision import Array
from reference.scenes.shipped import WITHOUT_FUNCTION, data_root
from reference.system import cache

DIGITS = 22  # decimal digits of a dataset that is solved only to judge programs in double
# of the cord length: how near the truth is evaluated for candidates with more digits than a
# double's
FINE = 2.0**-110

# changes with the results of `reference.dataset.golden.dense`, so that older entries are made again
_DENSE_FORMAT = b"dense 6"
_here: dict[str, Path] = {}  # datasets that this process has solved and the cache could not keep

Report = Callable[[float], None]


@dataclass(frozen=True)
class Progress:
    """Callbacks while a scene is solved, which may take long.

    Attributes:
        announce: called with a message before a scene is solved.
        report: called with the simulated time reached, in s.
    """

    announce: Callable[[str], None] | None = None
    report: Report | None = None


SILENT = Progress()


def golden_of(
    scene: Scene,
    digits: int = DIGITS,
    progress: Progress = SILENT,
    *,
    until: float | None = None,
    level: str = "confirmed",
    grid: bool = False,
) -> Golden:
    """Return a dataset that solves a scene: one that ships, or one that is solved now and kept in the cache.

    Args:
        scene: the problem, with its reading of the inputs, its span, and whether transits are
            needed.
        digits: decimal digits needed at least.
        progress: what is called when the scene has to be solved.
        until: end of the span that is needed, in s: a new dataset stops at the first grid time from
            there on.
        level: level of trust of a new dataset.
        grid: whether the dataset's grid up to the scene's end must be the scene's; otherwise any
            grid will do.

    Raises:
        UnreachableError: the scene cannot be solved to the digits.
    """
    ships = shipping(scene)
    if ships is not None and _serves(ships, scene, digits, grid):
        return ships

    problem = _shortened(scene, until).with_values([f"run.digits={digits}", f"run.level={level}"])
    name = _entry_name(scene.id, problem)
    path = _here.get(name) or cache.entry("golden", name)
    if path is not None:
        with suppress(DatasetError, InputError, OSError):
            return _loaded(path)
        cache.discard(path)  # damaged: it is solved again
    return _loaded(_solved(problem, name, progress))


def _serves(golden: Golden, scene: Scene, digits: int, grid: bool) -> bool:
    """Return whether a dataset that solves a scene has the digits, the sections and, if asked for, the grid."""
    if golden.manifest.digits < digits or golden.manifest.alone:
        return False
    if not set(scene.run.sections or ()) <= golden.sections.keys():
        return False
    times = scene.exact.grid
    return not grid or golden.scene.exact.grid[: len(times)] == times


def _entry_name(scene_id: str, problem: Scene) -> str:
    """Return the name in the cache of what solves a problem."""
    inputs = {"inputs", "pendulum", "site", "release", "run"}
    text = json.dumps(problem.model_dump(mode="json", include=inputs), sort_keys=True)
    return f"{scene_id}-{hashlib.sha256(text.encode()).hexdigest()[:20]}"


def _solved(problem: Scene, name: str, progress: Progress) -> Path:
    """Solve a problem and return the folder of its dataset, in the cache if that can keep it."""
    from reference import solve, write
    from reference.solver.choice import need_heyoka

    need_heyoka("score")
    if progress.announce is not None:
        progress.announce(f"{_why_solved(problem)}: solving it to {problem.run.digits} digits")
    solution = solve(problem, report=progress.report)
    path = cache.store("golden", name, lambda path: write(solution, path))
    if path is None:
        path = write(solution, cache.temporary() / name)
        _here[name] = path
    return path


def with_function(scene: Scene) -> Golden | None:
    """Return the dataset that ships with the golden function of a scene, or None."""
    golden = shipping(scene)
    return None if golden is None or golden.function is None else golden


def by_function(golden: Golden, times: Array) -> Dense | None:
    """Return the truth at a candidate's times by the golden function of a dataset.

    None if they go on beyond its end.

    Its rows, where it has them at these times, are known more closely, and are taken. A last time
    that a program has added up may be a little later: the state there follows from its rates.
    """
    if not golden.manifest.alone and set(times.tolist()) <= set(golden.times):
        return dense(golden, times)
    function = golden.function
    assert function is not None
    end_s = function.times[-1]
    at = function.at(np.minimum(times, end_s))
    states = np.array([getattr(at, name) for name in STATE])
    low = np.zeros_like(states)
    bounds = dict(function.bound)
    if function.square is not None:
        states[2], low[2], bounds["z"] = _height(states, golden.scene.exact.length, bounds)
    bound_m = max(bounds[name] for name in POSITION)
    bound_m_s = max(bounds[name] for name in VELOCITY)

    late_s = np.maximum(times - end_s, 0.0)
    if late_s.any():
        slopes = np.array(rates([*states], constants_in_double(golden.scene.exact)))
        length_m = float(golden.scene.exact.length)
        speed_m_s = float(np.abs(slopes[:3]).max())
        pull_m_s2 = float(np.abs(slopes[3:]).max())
        left_out_m = float(late_s.max()) ** 2 * pull_m_s2
        if left_out_m > bound_m:
            return None
        bound_m += left_out_m
        bound_m_s += left_out_m * (math.sqrt(pull_m_s2 / length_m) + speed_m_s / length_m)
        states += late_s * slopes
    return Dense(times, states.T, low.T, bound_m, bound_m_s)


def _height(
    states: Array, length_m: Fraction, bounds: Mapping[str, float]
) -> tuple[Array, Array, float]:
    """Return z, its low part and its bound in m from x and y of a bob below its suspension.

    How far it is above the lowest point is known far better than z in doubles.
    """
    x, y = states[:2]
    near_m = float(length_m)
    aside = x**2 + y**2
    above_lowest = aside / (near_m + np.sqrt(near_m**2 - aside))
    z = above_lowest - near_m
    low = (above_lowest - (z + near_m)) + float(Fraction(near_m) - length_m)
    slope = float((np.abs(x) + np.abs(y)).max() / np.abs(z).min())
    rounding_m = 2.0**-50 * float(above_lowest.max())
    return z, low, slope * max(bounds["x"], bounds["y"]) + rounding_m


def roughly_solved(
    scene: Scene, times: Array, transits: bool, report: Report | None
) -> tuple[Solution, Dense] | None:
    """Return a scene solved cheaply at a candidate's times and on its grid up to them, and the truth at those times.

    None where two cheap runs contradict each other or fail, and where the scene's rows ship.
    """
    ships = shipping(scene)
    if ships is not None and not ships.manifest.alone:
        return None
    from reference.solver.solve import roughly

    exact = [Fraction(t) for t in times.tolist()]
    # as the runs take them
    grid = [Fraction(float(t)) for t in _shortened(scene, float(times[-1])).exact.grid]
    problem = scene if transits else scene.with_values(["run.transits=false"])
    try:
        solution = roughly(problem, {*exact, *grid}, report)
    except (ArithmeticError, FoucaultError):
        return None
    if solution is None:
        return None
    row = {t: i for i, t in enumerate(solution.times)}
    return solution, Dense.of(times, solution.grid, [row[t] for t in exact])


def _loaded(folder: Path) -> Golden:
    """Load a dataset.

    It is checked and read again only if a file has been touched since this process read it.
    """
    paths = [folder, *sorted(folder.iterdir())] if folder.is_dir() else []
    stats = [path.stat() for path in paths]
    touched = [(stat.st_ino, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns) for stat in stats]
    return _read(folder, tuple(touched))


@lru_cache(maxsize=4)
def _read(folder: Path, _: tuple[tuple[int, ...], ...]) -> Golden:
    return load(folder)


def _shortened(scene: Scene, until: float | None) -> Scene:
    """Return the scene up to the first grid time that is not before `until`."""
    if until is None:
        return scene
    rows = max(1, math.ceil(Fraction(until) / Fraction(scene.run.grid_step)))
    end = rows * Decimal(scene.run.grid_step)
    return scene.with_values([f"run.t_end={end}"]) if end < Decimal(scene.run.t_end) else scene


def _why_solved(scene: Scene) -> str:
    """Return why no dataset that ships serves."""
    if scene.run.sections:
        return f"no dataset that ships has the passages of {', '.join(scene.run.sections)} of {scene.id}"
    if scene.inputs == "binary64" and with_function(scene):
        return f"the golden function of {scene.id} is in doubles, and does not decide"
    if scene.id in WITHOUT_FUNCTION and _same_problem(load_scene(scene.id), scene):
        return f"the golden function of {scene.id} does not ship, as it takes {WITHOUT_FUNCTION[scene.id]} MB"
    return f"no golden dataset has the problem of {scene.id}"


def shipping(scene: Scene) -> Golden | None:
    """Return the dataset that ships with the project and solves a scene, or None."""
    reading = "" if scene.inputs == "decimal" else ".binary64"
    folder = data_root() / "golden" / f"{scene.id}{reading}"
    golden = _loaded(folder) if folder.is_dir() else None
    return golden if golden is not None and solves(golden, scene) else None


def solves(golden: Golden, scene: Scene) -> bool:
    """Return True if a dataset has the scene's inputs, reading and span, and the transits that it asks for."""
    other = golden.scene
    same = other.inputs == scene.inputs and _same_problem(other, scene)
    spans = other.exact.t_end >= scene.exact.t_end
    return same and spans and (other.run.transits or not scene.run.transits)


def _same_problem(scene: Scene, other: Scene) -> bool:
    return all(
        getattr(scene, part) == getattr(other, part) for part in ("pendulum", "site", "release")
    )


def truth_at(golden: Golden, times: Array, within: float = WITHIN) -> Dense:
    """Return the truth at a candidate's times.

    It is cached for the next candidate with the same times.
    """
    recipe: Any = hashlib.sha256(_DENSE_FORMAT + (golden.path / "manifest.json").read_bytes())
    recipe.update(np.ascontiguousarray(times).tobytes() + repr(within).encode())

    def make() -> dict[str, Array]:
        truth = dense(golden, times, within)
        return {name: np.array(part) for name, part in vars(truth).items()}

    stored = cache.arrays("dense", f"{recipe.hexdigest()[:32]}.npz", make)
    bound_m = float(stored["bound_m"])
    bound_m_s = float(stored["bound_m_s"])
    return Dense(stored["t"], stored["states"], stored["low"], bound_m, bound_m_s)
