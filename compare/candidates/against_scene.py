"""Times beyond a scene's end and positions beyond the reach of its cord: the units that they may be in."""

from __future__ import annotations

import numpy as np

from reference import InputError, Scene
from reference.model.start import Start

from .candidate import Candidate, Deviation
from .external import PLACEHOLDER_BITS
from .units import LENGTHS, TIMES

FINER = ("ms", "us", "ns")  # units of time in which a run looks longer than its scene
BEYOND = 1.01  # times the cord: farther out, no rounding and no stretching puts the bob
FAR = 10  # times the scene's span: a run that ends later is rather in another unit than longer
SAME = 1e-3  # relative difference of ratios that count as one scale
WORDS = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "cm": "centimetres", "mm": "millimetres",
         "dm": "decimetres", "um": "micrometres", "km": "kilometres", "ft": "feet", "in": "inches"}  # fmt: skip


def check_times(candidate: Candidate, scene: Scene) -> None:
    """Refuse times beyond the scene's span, and say what they may be.

    Raises:
        InputError: the last time is more than a grid step beyond the scene's end.
    """
    last, end = float(candidate.t[-1]), float(scene.exact.t_end)
    if last <= end + float(scene.exact.grid_step):
        return
    unit = next((word for word in FINER if last * float(TIMES[word]) <= end * (1 + SAME)), None)
    longer = f"--t-end {scene.run.t_end} leaves out later rows, --set run.t_end={last:.10g} makes the scene longer."
    if unit is not None and last > FAR * end:
        seconds = last * float(TIMES[unit])
        longer = f"They look like {WORDS[unit]}: --units {unit} reads them so, and they end at {seconds:.10g} s."
    expected = f"times from 0 to {scene.run.t_end} s"
    raise InputError(f"{candidate.name}: t", f"{last:.10g} at the end", expected, longer)


def beyond_the_cord(candidate: Candidate, scene: Scene) -> Deviation | None:
    """Return what positions that no cord lets the bob reach may be: another unit of length, or pixels; or None."""
    reach = float(np.hypot(candidate.columns["x"], candidate.columns["y"]).max())
    length = float(scene.exact.length)
    if reach <= BEYOND * length:
        return None
    found = f"x and y reach {reach:.4g} and the cord is {scene.pendulum.length} m long"
    scale = _scale(candidate, scene)
    if scale is None:
        return Deviation("beyond_the_cord", f"{found}: pixels, or another unit? Metres are wanted")
    unit = next((word for word, size in LENGTHS.items() if size != 1 and abs(scale * float(size) - 1) < SAME), None)
    times = f"the first row is {scale:.6g} times the release"
    if unit is None:
        return Deviation(
            "scale", f"{found}: {times}; are {scale:.6g} pixels, or of another unit, a metre? Divide by it"
        )
    return Deviation("scale", f"{found}: {times}, so they are {WORDS[unit]}; --units {unit} reads them so")


def _scale(candidate: Candidate, scene: Scene) -> float | None:
    """Return how many times the release the first row is, if it is at t = 0 and in the release's direction."""
    if candidate.t[0] != 0:
        return None
    x, y, _ = (float(part) for part in Start.of(scene.exact, PLACEHOLDER_BITS).position)
    at = complex(candidate.columns["x"][0], candidate.columns["y"][0])
    release = complex(x, y)
    if not release or not at:
        return None
    ratio = at / release
    return abs(ratio) if abs(ratio - abs(ratio)) < SAME * abs(ratio) else None
