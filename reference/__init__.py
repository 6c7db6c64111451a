"""Reference solver of the Foucault pendulum: golden datasets of the full Lagrangian, with a bound on every number.

>>> import reference
>>> paris = reference.load_scene("paris")
>>> solution = reference.solve(paris, t_end="60", digits=20)
>>> solution
Solution(paris: enclosed, 20 digits, 2 grid times, 7 transits)
>>> round(float(solution.transits["t"][0]), 6)
8.217792
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .errors import DatasetError, FoucaultError, InputError, IntegrationError, UnreachableError
from .system.imports import lazy

if TYPE_CHECKING:
    from .dataset.golden import Golden, load
    from .dataset.ranges import load_ranges
    from .dataset.write import write
    from .engines.trajectory import integrate, trajectory
    from .numbers.function import GoldenFunction, States
    from .numbers.table import Table
    from .scenes.scene import Scene, load_scene, parse_scene
    from .scenes.shipped import scene_ids
    from .solver.ranges import Intervals, Ranges
    from .solver.solution import Solution
    from .solver.solve import solve
    from .sweeps.sweep import Swept, load_sweep, sweep

__all__ = [
    "DatasetError",
    "FoucaultError",
    "Golden",
    "GoldenFunction",
    "InputError",
    "IntegrationError",
    "Intervals",
    "Ranges",
    "Scene",
    "Solution",
    "States",
    "Swept",
    "Table",
    "UnreachableError",
    "integrate",
    "load",
    "load_ranges",
    "load_scene",
    "load_sweep",
    "parse_scene",
    "scene_ids",
    "solve",
    "sweep",
    "trajectory",
    "write",
]

__getattr__, __dir__ = lazy(
    __name__,
    {
        "dataset.golden": "Golden load",
        "dataset.ranges": "load_ranges",
        "dataset.write": "write",
        "engines.trajectory": "integrate trajectory",
        "numbers.function": "GoldenFunction States",
        "numbers.table": "Table",
        "scenes.scene": "Scene load_scene parse_scene",
        "scenes.shipped": "scene_ids",
        "solver.ranges": "Intervals Ranges",
        "solver.solution": "Solution",
        "solver.solve": "solve",
        "sweeps.sweep": "Swept load_sweep sweep",
    },
)
