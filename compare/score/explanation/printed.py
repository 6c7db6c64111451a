"""How finely the numbers of a file are printed: decimals, digits, or single precision."""

from __future__ import annotations

import math

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention


def digits(positions: Array) -> tuple[float, list[Convention]]:
    """Return half a unit of the last digit printed, in the file's unit, and what is to be said of it."""
    values = positions[np.abs(positions) > 0]
    if not len(values):
        return 0.0, []
    size = float(np.abs(values).max())
    exact = 4 * np.finfo(float).eps * size
    if len(values) < 20:
        return exact, []
    for decimals in range(13):
        if (np.abs(np.round(values, decimals) - values) <= 1e-15 * np.abs(values)).all():
            noise = 0.5 * 10.0**-decimals
            if noise < 1e-12 * size:
                break
            text = f"prints {decimals} decimals: no more than {noise:g} of its unit can be judged"
            return noise, [Convention("decimals", text, noise)]
    single = values.astype(np.float32).astype(float)
    if (single == values).all():
        noise = size * float(np.finfo(np.float32).eps)
        text = f"holds numbers in single precision, good to {noise:.1g} of its unit"
        return noise, [Convention("single_precision", text, noise)]
    for digits in range(3, 13):
        rounded = _significant(values, digits)
        if (np.abs(rounded - values) <= 1e-15 * np.abs(values)).all():
            noise = 0.5 * 10.0 ** (math.floor(math.log10(size)) + 1 - digits)
            text = f"prints {digits} digits: no more than {noise:.1g} of its unit can be judged"
            return noise, [Convention("digits", text, noise)]
    return exact, []


def _significant(values: Array, digits: int) -> Array:
    return np.array([float(f"{value:.{digits - 1}e}") for value in values])
