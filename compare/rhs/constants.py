"""The model's constants in double, each computed in 80 bits and rounded once."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Any

from reference.model.constants import Constants, constants
from reference.precision import context
from reference.scene import Inputs

_BITS = 80  # precision before rounding: 27 bits below a double


@lru_cache(maxsize=64)
def constants_in_double(inputs: Inputs) -> Constants:
    """Return the constants that follow from a scene's exact inputs."""
    return constants(inputs, _context()).converted(float)


@cache
def _context() -> Any:
    return context(_BITS)
