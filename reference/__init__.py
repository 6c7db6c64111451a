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

from .system.imports import lazy

if TYPE_CHECKING:
    from .dataset.golden import Golden as Golden
    from .dataset.golden import load as load
    from .dataset.ranges import load_ranges as load_ranges
    from .dataset.ranges import write_ranges as write_ranges
    from .dataset.write import write as write
    from .engines.trajectory import integrate as integrate
    from .engines.trajectory import trajectory as trajectory
    from .errors import DatasetError as DatasetError
    from .errors import FoucaultError as FoucaultError
    from .errors import InputError as InputError
    from .errors import IntegrationError as IntegrationError
    from .errors import UnreachableError as UnreachableError
    from .numbers.function import GoldenFunction as GoldenFunction
    from .numbers.function import States as States
    from .numbers.table import Table as Table
    from .scenes.scene import Scene as Scene
    from .scenes.scene import load_scene as load_scene
    from .scenes.scene import parse_scene as parse_scene
    from .scenes.shipped import scene_ids as scene_ids
    from .solver.ranges import Intervals as Intervals
    from .solver.ranges import Ranges as Ranges
    from .solver.solution import Solution as Solution
    from .solver.solve import solve as solve
    from .solver.uncertain import prove_ranges as prove_ranges
    from .sweeps.scene_swing import EstimatedSwing as EstimatedSwing
    from .sweeps.scene_swing import swing as swing
    from .sweeps.sweep import load_sweep as load_sweep
    from .sweeps.sweep import sweep as sweep
    from .sweeps.swept import Swept as Swept

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "dataset.golden": "Golden load",
        "dataset.ranges": "load_ranges write_ranges",
        "dataset.write": "write",
        "engines.trajectory": "integrate trajectory",
        "errors": "DatasetError FoucaultError InputError IntegrationError UnreachableError",
        "numbers.function": "GoldenFunction States",
        "numbers.table": "Table",
        "scenes.scene": "Scene load_scene parse_scene",
        "scenes.shipped": "scene_ids",
        "solver.ranges": "Intervals Ranges",
        "solver.solution": "Solution",
        "solver.solve": "solve",
        "solver.uncertain": "prove_ranges",
        "sweeps.scene_swing": "EstimatedSwing swing",
        "sweeps.sweep": "Swept load_sweep sweep",
    },
)
