"""The input floor: how far rounding a scene's inputs to doubles, and nothing else, moves the bob.

A program in double precision cannot be expected to come closer to the truth than this, however well it computes.
"""

from __future__ import annotations

import hashlib
import json

import numpy as np

from reference import Scene
from reference.numbers.precision import Array
from reference.solver.sensitivity import sensitivity
from reference.system.cache import arrays

TIMES = 577  # in a span, at least half of them up to the end asked for: some in every swing, or hundreds of swings
_FORMAT = "floor 3"  # changes with the content of the cached entries, so that older ones are computed again


def input_floor(scene: Scene, until: float) -> float:
    """Return how far, in m, rounding the decimal inputs to binary64 moves the bob up to a time in s.

    It depends on the scene alone and is the same for every candidate: one cached run serves all ends within a factor
    of two.
    """
    decimal = scene.with_values(["inputs=decimal"])
    document = decimal.model_dump(mode="json")
    parts = [document[key] for key in ("pendulum", "site", "release")]
    times = np.linspace(0.0, _span(float(scene.exact.t_end), until), TIMES) if until > 0 else np.zeros(1)
    recipe = json.dumps([_FORMAT, parts, float(times[-1])], sort_keys=True).encode()

    def make() -> dict[str, Array]:
        moved = sensitivity(decimal, times).rounding()[:, :3]
        return {"largest": np.maximum.accumulate(np.sqrt((moved**2).sum(axis=1)))}

    largest = arrays("floor", f"{hashlib.sha256(recipe).hexdigest()[:32]}.npz", make)["largest"]
    return float(largest[np.searchsorted(times, until)])


def _span(t_end: float, until: float) -> float:
    """Return the scene's span, halved as long as it reaches `until`; `until` itself if that is beyond the span."""
    while t_end / 2 >= until:
        t_end /= 2
    return max(t_end, until)
