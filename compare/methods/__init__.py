"""Integrators behind one interface (the paper's, this project's, libraries'), each declared in a file of its own.

>>> from compare.methods import METHODS, available
>>> METHODS["rk4"].title
'classical Runge-Kutta, order 4'

A method prepares a problem and returns a function that integrates it, so that the integration can be timed alone:

    problem = Problem.of(reference.load_scene("paris"), "plane")
    work = METHODS["rk4"].prepare(problem, 0.01)    # imports and compiles
    outcome = work()                                # integrates
    outcome.states                                  # x, y, z, vx, vy, vz at problem.times

The ids of all methods are known when one is first looked up: the files are imported then, and a method's library when
it prepares a problem. They are listed by family, then by file, then as they stand in the file.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..registry import Registry
from ..rhs.problem import Problem
from .external import external
from .method import Family, Method, Outcome, Work, available

__all__ = ["EXTERNAL", "METHODS", "Family", "Method", "Outcome", "Problem", "Work", "available", "external"]

EXTERNAL = "external: "  # begins the id of a method that is a command


class _Methods(Registry[Method]):
    """The declared methods; an id that begins with `EXTERNAL` is a command, which needs no declaration."""

    def __getitem__(self, word: str) -> Method:
        if word.startswith(EXTERNAL):
            return external(word.removeprefix(EXTERNAL), name=word)
        return super().__getitem__(word)


METHODS: Mapping[str, Method] = _Methods(__name__, "METHODS", "method", lambda method: [*Family].index(method.family))
