"""The input floor: how far the rounding of a scene's inputs to doubles alone moves the bob.

No program in double can be told from the truth below it, whatever it does.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np

from reference import Scene
from reference.precision import Array
from reference.solver.sensitivity import sensitivity

from ..cache import kept

TIMES = 577  # of a span, at least half of them within what is asked: some in every swing, or hundreds of swings
_MADE = "floor 2"  # changes with what is kept


def input_floor(scene: Scene, until: float) -> float:
    """How far in m the rounding of the decimal inputs to binary64 alone moves the bob up to a time in s.

    What is found is the scene's, whoever is judged: it is kept for all ends within a factor of two.
    """
    decimal = scene.with_values(["inputs=decimal"])
    document = decimal.model_dump(mode="json")
    parts = [document[key] for key in ("pendulum", "site", "release")]
    times = np.linspace(0.0, _span(float(scene.exact.t_end), until), TIMES) if until > 0 else np.zeros(1)
    recipe = json.dumps([_MADE, parts, float(times[-1])], sort_keys=True).encode()

    def make(path: Path) -> None:
        moved = sensitivity(decimal, times).rounding()[:, :3]
        largest = np.maximum.accumulate(np.sqrt((moved**2).sum(axis=1)))
        path.write_text(json.dumps(largest.tolist()))

    def read(path: Path) -> Array:
        return np.asarray(json.loads(path.read_text()), dtype=np.float64).reshape(times.shape)

    largest = kept("floor", f"{hashlib.sha256(recipe).hexdigest()[:32]}.json", make, read)
    return float(largest[np.searchsorted(times, until)])


def _span(t_end: float, until: float) -> float:
    """The scene's span, halved as long as it holds `until`; that itself where a program goes beyond the span."""
    while t_end / 2 >= until:
        t_end /= 2
    return max(t_end, until)
