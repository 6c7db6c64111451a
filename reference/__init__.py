"""Reference solver of the Foucault pendulum: golden datasets of the full Lagrangian, with a bound on every number.

>>> import reference
>>> paris = reference.load_scene("paris")
>>> solution = reference.solve(paris, t_end="60", digits=20)
>>> len(solution.transits.values)
7
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .errors import DatasetError, FoucaultError, InputError, IntegrationError, UnreachableError
from .scene import Scene, load_scene, parse_scene
from .shipped import scene_ids

if TYPE_CHECKING:
    from .dataset.read import Golden, load
    from .engines.trajectory import integrate, trajectory
    from .solver.solution import Solution
    from .solver.solve import solve

__all__ = [
    "DatasetError",
    "FoucaultError",
    "Golden",
    "InputError",
    "IntegrationError",
    "Scene",
    "Solution",
    "UnreachableError",
    "integrate",
    "load",
    "load_scene",
    "parse_scene",
    "scene_ids",
    "solve",
    "trajectory",
]

_LAZY = {
    "Golden": "dataset.read",
    "Solution": "solver.solution",
    "integrate": "engines.trajectory",
    "load": "dataset.read",
    "solve": "solver.solve",
    "trajectory": "engines.trajectory",
}


def __getattr__(name: str) -> Any:
    """Import the solver and the reader at their first use: `foucault --help` needs neither."""
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_LAZY[name]}", __name__), name)
