"""Golden functions of scenes, made by a proof alone, and how far they are from a run in limbs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from limbs_states import states

from reference.enclosure import Enclosure, enclose
from reference.numbers.columns import STATE
from reference.numbers.function import GoldenFunction
from reference.scenes.scene import Scene, load_scene
from reference.solver.proof_steps import Feed

# of the run in limbs, 40 digits; its states are sums of two doubles, so that they are off by
TRUTH_BITS = 137
TRUTH = 1e-29  # of the length, at most


def proved_function(
    scene: Scene | str, radius: Fraction = Fraction(1, 10**30), engine: str = "limbs"
) -> Enclosure:
    """Prove a scene, without transits, and its golden function."""
    scene = load_scene(scene) if isinstance(scene, str) else scene
    times = tuple(scene.exact.grid)
    feed = Feed(scene.exact, times, engine)
    try:
        return enclose(
            scene.exact,
            times,
            radius=radius,
            approximant=feed,
            zeros=(),
            function=True,
        )
    finally:
        feed.stop()


def evaluator(enclosure: Enclosure) -> GoldenFunction:
    """Return what evaluates the function of a proof."""
    made = enclosure.function
    assert made is not None
    return GoldenFunction.of(made.facts, made.bounds, made.data)


def errors(
    scene: Scene, function: GoldenFunction, times: Any, bits: int = TRUTH_BITS
) -> dict[str, Any]:
    """Return how far each component is from a run in limbs of so many bits, at each of `times`, which increase."""
    high, low = states(scene.exact, times, bits)
    at = function.at(times)
    return {
        name: np.abs((getattr(at, name) - high[:, i]) - low[:, i]) for i, name in enumerate(STATE)
    }


def random_times(function: GoldenFunction, count: int, seed: int = 0) -> Any:
    """Return times: random ones of the span, and the ends of all pieces with the doubles before them."""
    ends = function.times
    before = np.nextafter(ends[1:], 0)
    return np.unique([*np.random.default_rng(seed).uniform(0, ends[-1], count), *ends, *before])
