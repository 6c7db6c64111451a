"""The truth that a candidate is held against: a golden dataset, shipped or solved now, at the candidate's times."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from reference import Golden, Scene, load
from reference.dense import WITHIN, Dense, dense
from reference.publish import write
from reference.scene import data_root
from reference.solution import Array

from .cache import cache_folder, kept

DIGITS = 22  # of a dataset solved only to judge programs in double
FINE = 2.0**-110  # how near the truth is evaluated for candidates with more digits than a double

Report = Callable[[float], None]


def golden_of(scene: Scene, digits: int = DIGITS, announce: Callable[[str], None] | None = None) -> Golden:
    """The dataset that solves a scene: the one that ships, or one that is solved now and kept in the cache.

    Args:
        scene: whose problem, reading and span are wanted.
        digits: what a new dataset is solved to; transits are found if the scene asks for them.
        announce: told when a scene has to be solved.

    Raises:
        UnreachableError: the scene cannot be solved to the digits.
    """
    for folder in shipped(scene):
        golden = load(folder)
        if solves(golden, scene):
            return golden
    document = scene.with_values([f"run.digits={digits}", "run.level=confirmed"]).model_dump(mode="json")
    problem = {key: document[key] for key in ("inputs", "pendulum", "site", "release", "run")}
    name = hashlib.sha256(json.dumps(problem, sort_keys=True).encode()).hexdigest()[:20]
    folder = cache_folder("golden") / f"{scene.id}-{name}"
    if not folder.exists():
        if announce is not None:
            announce(f"no golden dataset has this problem: solving it to {digits} digits, once")
        from reference import solve

        write(solve(scene.with_values([f"run.digits={digits}", "run.level=confirmed"])), folder)
    return load(folder)


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
    recipe: Any = hashlib.sha256((golden.path / "manifest.json").read_bytes())
    recipe.update(np.ascontiguousarray(times).tobytes() + repr(within).encode())

    def make(path: Path) -> None:
        found = dense(golden, times, within)
        with path.open("wb") as stream:
            np.savez(
                stream, t=found.t, states=found.states, rest=found.rest, bound_m=found.bound_m, number=found.number
            )

    path = kept("dense", f"{recipe.hexdigest()[:32]}.npz", make)
    with np.load(path, allow_pickle=False) as arrays:
        return Dense(arrays["t"], arrays["states"], arrays["rest"], float(arrays["bound_m"]), str(arrays["number"]))
