"""The model's constants in doubles, each rounded once."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Any

from reference.model.constants import Constants, constants
from reference.precision import context
from reference.scene import Inputs

_BITS = 80  # of the numbers that are rounded


@lru_cache(maxsize=64)
def constants_in_double(inputs: Inputs) -> Constants:
    """The constants that follow from a scene's exact inputs."""
    return constants(inputs, _context()).converted(float)


@cache
def _context() -> Any:
    return context(_BITS)
