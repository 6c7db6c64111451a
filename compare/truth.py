"""The truth that a candidate is held against: a golden dataset, shipped or solved now, at the candidate's times."""

from __future__ import annotations

import hashlib
import json
import math
import shutil
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from reference import DatasetError, Golden, InputError, Scene, load
from reference.dataset.dense import WITHIN, Dense, dense
from reference.precision import Array
from reference.scene import data_root

from . import cache

DIGITS = 22  # of a dataset solved only to judge programs in double
MADE = b"dense 3"  # changes with what `reference.dataset.dense` gives, so that older entries are made again
FINE = 2.0**-110  # how near the truth is evaluated for candidates with more digits than a double

Report = Callable[[float], None]


def golden_of(
    scene: Scene,
    digits: int = DIGITS,
    announce: Callable[[str], None] | None = None,
    report: Report | None = None,
    until: float | None = None,
    level: str = "confirmed",
) -> Golden:
    """The dataset that solves a scene: the one that ships, or one that is solved now and kept in the cache.

    Args:
        scene: whose problem, reading and span are wanted.
        digits: what is wanted at least; transits are found if the scene asks for them.
        announce: told when a scene has to be solved.
        report: called with the simulated time reached, in s.
        until: a new dataset need not go further than the first grid time from here on, in s.
        level: of a new dataset.

    Raises:
        UnreachableError: the scene cannot be solved to the digits.
    """
    for folder in shipped(scene):
        golden = _loaded(folder)
        if solves(golden, scene) and golden.manifest.digits >= digits:
            return golden
    wanted = _shortened(scene, until).with_values([f"run.digits={digits}", f"run.level={level}"])
    name = f"{scene.id}-{_problem(wanted)}"
    path = cache.found("golden", name)
    if path is not None:
        try:
            return _loaded(path)
        except (DatasetError, InputError):
            shutil.rmtree(path, ignore_errors=True)  # damaged: solved again
    return _loaded(_solved(wanted, name, announce, report))


def _loaded(folder: Path) -> Golden:
    """A dataset, checked and read again only if one of its files has been touched since this process read it."""
    found = (path.stat() for path in [folder, *sorted(folder.iterdir())]) if folder.is_dir() else ()
    return _read(folder, tuple((one.st_ino, one.st_size, one.st_mtime_ns, one.st_ctime_ns) for one in found))


@lru_cache(maxsize=4)
def _read(folder: Path, _: tuple[tuple[int, ...], ...]) -> Golden:
    return load(folder)


def _shortened(scene: Scene, until: float | None) -> Scene:
    """The scene up to the first grid time that is not before `until`."""
    if until is None:
        return scene
    rows = max(1, math.ceil(Fraction(until) / Fraction(scene.run.grid_step)))
    end = rows * Decimal(scene.run.grid_step)
    return scene.with_values([f"run.t_end={end}"]) if end < Decimal(scene.run.t_end) else scene


def _solved(scene: Scene, name: str, announce: Callable[[str], None] | None, report: Report | None) -> Path:
    from reference import solve
    from reference.dataset.write import write

    folder = cache.writable("golden")
    if announce is not None:
        lasting = "once" if cache.is_lasting(folder) else f"for this run only: {cache.root()} cannot be written"
        announce(f"no golden dataset has the problem of {scene.id}: solving it to {scene.run.digits} digits, {lasting}")
    return write(solve(scene, report=report), folder / name)


def _problem(scene: Scene) -> str:
    """A word for what is solved; names, titles and flags are no part of it."""
    document = scene.model_dump(mode="json")
    problem = {key: document[key] for key in ("inputs", "pendulum", "site", "release", "run")}
    return hashlib.sha256(json.dumps(problem, sort_keys=True).encode()).hexdigest()[:20]


def shipped(scene: Scene) -> list[Path]:
    """Folders of the datasets that come with the project and may solve the scene."""
    reading = "" if scene.inputs == "decimal" else ".binary64"
    folder = data_root() / "golden" / f"{scene.id}{reading}"
    return [folder] if folder.is_dir() else []


def solves(golden: Golden, scene: Scene) -> bool:
    """True if a dataset is of the scene's problem, reading included, and spans its time and its transits."""
    other = golden.scene
    same = all(getattr(other, part) == getattr(scene, part) for part in ("inputs", "pendulum", "site", "release"))
    spans = other.exact.t_end >= scene.exact.t_end
    return same and spans and (other.run.transits or not scene.run.transits)


def truth_at(golden: Golden, times: Array, within: float = WITHIN) -> Dense:
    """The truth at a candidate's times, kept for the next candidate with the same times."""
    recipe: Any = hashlib.sha256(MADE + (golden.path / "manifest.json").read_bytes())
    recipe.update(np.ascontiguousarray(times).tobytes() + repr(within).encode())

    def make(path: Path) -> None:
        found = dense(golden, times, within)
        with path.open("wb") as stream:
            np.savez(stream, t=found.t, states=found.states, low=found.low, bound_m=found.bound_m, number=found.number)

    return cache.kept("dense", f"{recipe.hexdigest()[:32]}.npz", make, _read_dense)


def _read_dense(path: Path) -> Dense:
    with np.load(path, allow_pickle=False) as arrays:
        return Dense(arrays["t"], arrays["states"], arrays["low"], float(arrays["bound_m"]), str(arrays["number"]))
