"""The model's constants in double, each rounded once."""

from __future__ import annotations

from functools import lru_cache

from reference.model.constants import Constants, constants
from reference.numbers.precision import DOUBLE_BITS, GUARD_BITS, context
from reference.scenes.inputs import Inputs


@lru_cache(maxsize=64)
def constants_in_double(inputs: Inputs) -> Constants:
    """Return the constants that follow from a scene's exact inputs."""
    return constants(inputs, context(DOUBLE_BITS + GUARD_BITS)).converted(float)
