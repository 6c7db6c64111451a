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

from .system.imports import lazy

__getattr__, __dir__, __all__ = lazy(__name__)
