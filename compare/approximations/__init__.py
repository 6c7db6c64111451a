"""The analytic and truncated models of the source papers, by id, each declared in a file of its own.

>>> from compare.approximations import APPROXIMATIONS
>>> from reference import load_scene
>>> APPROXIMATIONS["linear_g"].trajectory(load_scene("paris"), [0.0, 16.4]).shape
(2, 6)

Those of the whole motion come before those of a single number; within each, by file, then in the order of
the file.
"""

from __future__ import annotations

from collections.abc import Mapping

from reference.system.imports import Registry

from .approximation import Approximation, Quantity
from .approximation import Motion as Motion

APPROXIMATIONS: Mapping[str, Approximation] = Registry(
    __name__, "APPROXIMATIONS", "approximation", lambda declared: isinstance(declared, Quantity)
)


def motions() -> dict[str, Motion]:
    """Return the approximations that give a trajectory, by id."""
    return {
        word: declared for word, declared in APPROXIMATIONS.items() if isinstance(declared, Motion)
    }


def quantities() -> dict[str, Quantity]:
    """Return the approximations that give one number, by id."""
    return {
        word: declared
        for word, declared in APPROXIMATIONS.items()
        if isinstance(declared, Quantity)
    }
