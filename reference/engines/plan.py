"""What an engine is asked for, `Plan`, and what it gives back, `Run`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

from ..precision import NumberType
from ..scene import Inputs

Report = Callable[[float], None]


@dataclass(frozen=True)
class Plan:
    """What to run: formulation, number type, times of output in s, and whether transits are wanted."""

    inputs: Inputs
    formulation: str
    number: NumberType
    times: tuple[Fraction, ...]
    transits: bool


@dataclass(frozen=True)
class Run:
    """What a run computed, as integers over 2**bits, and what it cost.

    Attributes:
        grid: per output time x, y, z (m), vx, vy, vz (m/s), ax (m/s²).
        zeros: per transit t (s) followed by the same seven; None if transits were not asked for.
        directions: sign of each crossing of xdot.
        terms: elementary operations in the compiled Taylor decomposition.
        tension: least pull of the cord over l on the grid, 1/s²; negative where a rod is pushed.
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
