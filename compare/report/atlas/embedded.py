"""The numbers and words that a page of the atlas holds, so that its script can judge a file in the browser."""

from __future__ import annotations

import base64
from fractions import Fraction
from typing import Any

import numpy as np

from reference import Golden
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE_BITS, Array

from ...candidates import names, units
from ...observed.position_error import distance
from ...score.errors import swing_rate
from ...score.judge import unjudged_transits


def embedded(golden: Golden) -> dict[str, Any]:
    """Return what `judging.js` needs of a dataset: doubles of its grid and transits in base64, bounds and scales.

    Transits come with the weight |ax|/ω in 1/s·m, by which an error of time becomes one of position.
    """
    inputs, speed = golden.scene.exact, float(distance((golden.vx, golden.vy, golden.vz)).max())
    omega, length = swing_rate(golden.scene, speed), float(inputs.length)
    reason, transits = unjudged_transits(golden), golden.transits
    weight = np.abs(transits["ax"]) / omega if omega else np.zeros(len(transits))
    return {
        "id": golden.manifest.id,
        "t_end": float(inputs.t_end),
        "grid_step": float(inputs.grid_step),
        "amplitude_m": float(np.hypot(golden.x, golden.y).max()) or length,
        "bound_m": float(golden.manifest.bounds.position_m) + length * 2.0**-DOUBLE_BITS,
        "omega": omega,
        "grid": {name: _doubles(golden.grid[name]) for name in ("t", *STATE)},
        "transits": None if reason else {"t": _doubles(transits["t"]), "weight": _doubles(weight)},
        "no_transits": reason,
        "possible": [[float(one.from_s), float(one.to_s)] for one in golden.manifest.possible],
    }


def vocabulary() -> dict[str, Any]:
    """Return the words of headers and units that `reading.js` understands: those of `foucault score`."""
    return {
        "position": names.POSITION.pattern,
        "velocity": names.VELOCITY.pattern,
        "time": sorted(names.TIME),
        "timeUnits": names.TIME_UNITS.pattern,
        "axes": {word: list(axis) for word, axis in names.AXES.items()},
        "directions": {word: list(axis) for word, axis in names.DIRECTIONS.items()},
        "times": _ratios(units.TIMES),
        "lengths": _ratios(units.LENGTHS),
        "words": units.OTHER_WORDS,
        "speeds": units.SHORT_SPEEDS,
    }


def _doubles(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _ratios(sizes: dict[str, Fraction]) -> dict[str, list[int]]:
    return {word: [size.numerator, size.denominator] for word, size in sizes.items()}
