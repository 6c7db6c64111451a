"""Shared by the tests of methods: two short scenes with their truth, from inputs that are doubles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from small_scenes import make_scene

import reference
from compare.methods import METHODS
from compare.methods.rhs.problem import Problem, suited
from compare.methods.rhs.straight_line import FUNCTIONS
from reference import Scene, Solution

SECTIONS = {
    "paris": {"run": {"t_end": "60", "grid_step": "5"}},
    "steep": {
        "pendulum": {"length": "1"},
        "release": {"angle": "80", "azimuth": "20"},
        "run": {"t_end": "20", "grid_step": "2"},
    },
}


@dataclass(frozen=True)
class SolvedCase:
    scene: Scene
    solution: Solution

    @property
    def times(self):
        return [float(t) for t in self.solution.times]

    @property
    def truth(self):
        return np.array(
            [getattr(self.solution, name) for name in ("x", "y", "z", "vx", "vy", "vz")]
        ).T

    def problem(self, name, *, rows=None, formulation=None, kind=Problem):
        word = formulation or suited(self.scene, METHODS[name].formulations)
        return kind.of(self.scene, word, self.times[:rows])


class Counted(Problem):
    """A problem that counts the calls of its right-hand side."""

    @cached_property
    def calls(self):
        return []

    @cached_property
    def rates(self):
        inner = super().rates

        def counting(*arguments):
            self.calls.append(1)
            return inner(*arguments)

        return counting


@cache
def case(name):
    scene = make_scene(name, inputs="binary64", **SECTIONS[name])
    return SolvedCase(scene, reference.solve(scene, digits=40, level="computed", transits=False))


def python_function(program):
    """Return a program of straight-line code as a Python function of floats, not compiled."""
    namespace = {name: getattr(math, name) for name in FUNCTIONS}
    exec(program.source("traced"), namespace)
    return namespace["traced"]
