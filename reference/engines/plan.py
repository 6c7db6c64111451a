"""The input of an engine, `Plan`, and its output, `Run`: states and transits as integers over a power of two."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

from ..precision import NumberType
from ..scene import Inputs

Report = Callable[[float], None]  # called with the simulated time reached, in s


@dataclass(frozen=True)
class Plan:
    """A run to be done.

    Attributes:
        inputs: the exact inputs of a scene.
        formulation: a name of `model.formulations.FORMULATIONS`.
        number: type to compute in; its name tells the engine, see `registry`.
        times: times of output in s, increasing, from 0.
        transits: whether to find the zeros of xdot.
    """

    inputs: Inputs
    formulation: str
    number: NumberType
    times: tuple[Fraction, ...]
    transits: bool


@dataclass(frozen=True)
class Run:
    """The states and transits of a run, as integers over 2**bits, and its cost.

    Attributes:
        plan: the plan that was run.
        bits: exponent of the power of two.
        grid: per output time x, y, z (m), vx, vy, vz (m/s), ax (m/s²).
        zeros: per transit t (s) followed by the same seven; None if not asked for, or if xdot is identically zero.
        directions: sign of each crossing of xdot.
        order: order of the Taylor polynomials.
        steps: number of steps.
        terms: elementary operations in the compiled Taylor decomposition.
        tension: least tension of the cord over l on the grid, 1/s²; negative where a rod is pushed.
        compile_s: CPU seconds of compiling.
        cpu_s: CPU seconds of the run without compiling.
    """

    plan: Plan
    bits: int
    grid: list[tuple[int, ...]] = field(repr=False)
    zeros: list[tuple[int, ...]] | None = field(repr=False)
    directions: list[int] = field(repr=False)
    order: int
    steps: int
    terms: int
    tension: float
    compile_s: float
    cpu_s: float
