"""The input of an engine, `Plan`, and its output, `Run`: tables of states and transits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np

from ..model.force import tension
from ..model.start import Start
from ..numbers.columns import STATE
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, NumberType
from ..numbers.table import Table
from ..scenes.inputs import Inputs

Report = Callable[[float], None]  # called with the simulated time reached, in s
Pace = Callable[[int, float], None]  # called with the steps taken and the time reached; raises to end a run

AT_REST = "Where xdot is nothing but rounding, as at rest, there are no transits: run.transits = false."
MOST_TURN = 1.75  # longest step times the swing's frequency: a small swing's series reach further, bounds do not


@dataclass(frozen=True)
class Plan:
    """A run to be done.

    Attributes:
        inputs: the exact inputs of a scene.
        formulation: a name of `model.formulations.FORMULATIONS`.
        number: type to compute in.
        times: times of output in s, increasing, from 0.
        transits: whether to find the zeros of xdot.
        engine: the name of an engine, as `registry.engines` has them.
        other_steps: whether to take other steps than the engine would: for a run that checks one of the same engine.
    """

    inputs: Inputs
    formulation: str
    number: NumberType
    times: tuple[Fraction, ...]
    transits: bool
    engine: str = "heyoka"
    other_steps: bool = False


@dataclass(frozen=True)
class Run:
    """The states and transits of a run, exactly as it computed them, and its cost.

    Attributes:
        plan: the plan that was run.
        grid: `columns.RUN` at each output time, in SI units.
        transits: t and `columns.RUN` at each zero of xdot; None if not asked for, or if xdot is identically zero.
        directions: sign of each crossing of xdot.
        order: order of the Taylor polynomials.
        steps: number of steps.
        terms: elementary operations in the compiled Taylor decomposition.
        compile_s: CPU seconds of compiling.
        cpu_s: CPU seconds of the run without compiling.
    """

    plan: Plan
    grid: Table
    transits: Table | None
    directions: list[int] = field(repr=False)
    order: int
    steps: int
    terms: int
    compile_s: float
    cpu_s: float

    @cached_property
    def tension(self) -> float:
        """Least tension of the cord over l on the grid, in 1/s², computed in double; negative where a rod is pushed."""
        k = Start.of(self.plan.inputs, DOUBLE_BITS + GUARD_BITS).k.converted(float)
        x, y, z, vx, vy, vz = (self.grid[name] / k.length for name in STATE)
        return float(np.min(tension((x, y, z), (vx, vy, vz), k)))
