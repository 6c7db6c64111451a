"""The truth at a candidate's times: from a golden dataset that ships, or that is solved now and cached."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from reference import DatasetError, Golden, InputError, Scene, load
from reference.dataset.dense import WITHIN, Dense, dense
from reference.numbers.precision import Array
from reference.scenes.shipped import data_root
from reference.system import cache

DIGITS = 22  # decimal digits of a dataset that is solved only to judge programs in double
DENSE_FORMAT = b"dense 5"  # changes with the results of `reference.dataset.dense`, so that older entries are made again
FINE = 2.0**-110  # of the cord length: how near the truth is evaluated for candidates with more digits than a double's

_here: dict[str, Path] = {}  # datasets that this process has solved and the cache could not keep

Report = Callable[[float], None]


def golden_of(
    scene: Scene,
    digits: int = DIGITS,
    announce: Callable[[str], None] | None = None,
    report: Report | None = None,
    until: float | None = None,
    level: str = "confirmed",
    grid: bool = False,
) -> Golden:
    """Return a dataset that solves a scene: one that ships, or one that is solved now and kept in the cache.

    Args:
        scene: the problem, with its reading of the inputs, its span, and whether transits are needed.
        digits: decimal digits needed at least.
        announce: called with a message when the scene has to be solved.
        report: called with the simulated time reached, in s.
        until: end of the span that is needed, in s: a new dataset stops at the first grid time from there on.
        level: level of trust of a new dataset.
        grid: whether the dataset's grid up to the scene's end must be the scene's; otherwise any grid will do.

    Raises:
        UnreachableError: the scene cannot be solved to the digits.
    """
    for folder in shipped(scene):
        golden = _loaded(folder)
        fits = solves(golden, scene) and golden.manifest.digits >= digits
        if fits and not (grid and _grid_until(golden.scene, scene.exact.t_end) != scene.exact.grid):
            return golden
    problem = _shortened(scene, until).with_values([f"run.digits={digits}", f"run.level={level}"])
    name = f"{scene.id}-{_hash_of_problem(problem)}"
    path = _here.get(name) or cache.entry("golden", name)
    if path is not None:
        with suppress(DatasetError, InputError, OSError):
            golden = _loaded(path)
            if _is_of(golden, problem):
                return golden
        cache.discard(path)  # damaged, or another problem's under this name: it is solved again
    return _loaded(_solved(problem, name, announce, report))


def _is_of(golden: Golden, problem: Scene) -> bool:
    """Return True if a dataset is what `solve` gives for a problem: inputs, span, grid, transits, digits and level."""
    manifest = golden.manifest
    reached = manifest.digits == problem.run.digits and manifest.level == problem.run.level
    return reached and _hash_of_problem(golden.scene) == _hash_of_problem(problem)


def _loaded(folder: Path) -> Golden:
    """Load a dataset; it is checked and read again only if a file has been touched since this process read it."""
    stats = (path.stat() for path in [folder, *sorted(folder.iterdir())]) if folder.is_dir() else ()
    return _read(folder, tuple((stat.st_ino, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns) for stat in stats))


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


def _solved(scene: Scene, name: str, announce: Callable[[str], None] | None, report: Report | None) -> Path:
    from reference import solve, write

    if announce is not None:
        announce(f"no golden dataset has the problem of {scene.id}: solving it to {scene.run.digits} digits")
    solution = solve(scene, report=report)
    path = cache.store("golden", name, lambda path: write(solution, path))
    if path is None:
        path = _here[name] = write(solution, cache.temporary() / name)
    return path


def _hash_of_problem(scene: Scene) -> str:
    """Return a hash of the problem that is solved; names, titles and flags do not count."""
    document = scene.model_dump(mode="json")
    problem = {key: document[key] for key in ("inputs", "pendulum", "site", "release", "run")}
    return hashlib.sha256(json.dumps(problem, sort_keys=True).encode()).hexdigest()[:20]


def shipped(scene: Scene) -> list[Path]:
    """Return the folders of the datasets that ship with the project and may solve the scene."""
    reading = "" if scene.inputs == "decimal" else ".binary64"
    folder = data_root() / "golden" / f"{scene.id}{reading}"
    return [folder] if folder.is_dir() else []


def solves(golden: Golden, scene: Scene) -> bool:
    """Return True if a dataset has the scene's inputs and their reading, its span, and transits if it asks for any."""
    other = golden.scene
    same = all(getattr(other, part) == getattr(scene, part) for part in ("inputs", "pendulum", "site", "release"))
    spans = other.exact.t_end >= scene.exact.t_end
    return same and spans and (other.run.transits or not scene.run.transits)


def _grid_until(scene: Scene, t_end: Fraction) -> list[Fraction]:
    return [t for t in scene.exact.grid if t <= t_end]


def truth_at(golden: Golden, times: Array, within: float = WITHIN) -> Dense:
    """Return the truth at a candidate's times; it is cached for the next candidate with the same times."""
    recipe: Any = hashlib.sha256(DENSE_FORMAT + (golden.path / "manifest.json").read_bytes())
    recipe.update(np.ascontiguousarray(times).tobytes() + repr(within).encode())

    def make() -> dict[str, Array]:
        truth = dense(golden, times, within)
        numbers = {name: np.array(getattr(truth, name)) for name in ("bound_m", "bound_m_s", "number")}
        return {"t": truth.t, "states": truth.states, "low": truth.low, **numbers}

    stored = cache.arrays("dense", f"{recipe.hexdigest()[:32]}.npz", make)
    bounds = float(stored["bound_m"]), float(stored["bound_m_s"])
    return Dense(stored["t"], stored["states"], stored["low"], *bounds, str(stored["number"]))
