"""A solved scene: tables of exact numbers, each with a bound, and the runs or the proof that they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from ..engines.plan import Run
from ..precision import Array
from ..scene import Level, Scene
from ..table import Table

GRID_COLUMNS = ("x", "y", "z", "vx", "vy", "vz")
TRANSIT_COLUMNS = ("t", "x", "y", "z", "vy", "ax")
STATE = slice(len(GRID_COLUMNS))  # these columns in a row of a run's grid, which ends with ax
XDOT = GRID_COLUMNS.index("vx")


@dataclass(frozen=True)
class CrossCheck:
    """A run that checks the published numbers, and its largest disagreement with them, in m, m/s and s."""

    formulation: str
    number: str
    order: int
    steps: int
    position_m: Fraction
    velocity_m_s: Fraction
    transit_s: Fraction | None
    cpu_s: float

    @classmethod
    def of(
        cls, witness: Run, grid_gap: Sequence[Fraction], zero_gap: Sequence[tuple[Fraction, ...]] | None
    ) -> CrossCheck:
        """Build from a run and its differences, per grid column and per transit."""
        return cls(
            formulation=witness.plan.formulation,
            number=str(witness.plan.number),
            order=witness.order,
            steps=witness.steps,
            position_m=max(grid_gap[:3]),
            velocity_m_s=max(grid_gap[3:]),
            transit_s=max((row[0] for row in zero_gap), default=Fraction(0)) if zero_gap is not None else None,
            cpu_s=witness.cpu_s,
        )


@dataclass(frozen=True)
class Source:
    """The run that published numbers come from: formulation, number type, order, steps, cost."""

    formulation: str
    number: str
    order: int
    steps: int
    cpu_s: float
    compile_s: float

    @classmethod
    def of(cls, run: Run) -> Source:
        """Build from a run."""
        return cls(run.plan.formulation, str(run.plan.number), run.order, run.steps, run.cpu_s, run.compile_s)


@dataclass(frozen=True)
class Proof:
    """An enclosure: method, size, largest radii in m, m/s and s, and the bits to which its run agrees with it."""

    method: str
    prec: int
    order: int
    steps: int
    position_radius: Fraction
    velocity_radius: Fraction
    transit_radius: Fraction | None
    agreement_bits: int
    cpu_s: dict[str, float]


@dataclass(frozen=True)
class Solution:
    """A solved scene.

    Attributes:
        scene: the scene as solved.
        times: grid times in s, exact.
        grid: x, y, z in m and vx, vy, vz in m/s at those times.
        transits: t in s, x, y, z in m, vy in m/s, ax in m/s² of every zero of xdot; None if not asked for, or if
            xdot is identically zero.
        directions: +1 where xdot goes from - to +, per transit.
        run: the run that the numbers come from.
        checks: runs that agree with it.
        pilot_s: CPU seconds of the pilot runs, which the precision was chosen from.
        proof: the enclosure, at the level enclosed.
        possible: intervals in s, each with a parity, that may hold transits which the proof could not decide.

    `solution.t`, `.x`, `.y`, `.z`, `.vx`, `.vy`, `.vz` are binary64 arrays of shape (rows,).
    """

    scene: Scene
    times: tuple[Fraction, ...]
    grid: Table
    transits: Table | None
    directions: list[int] = field(repr=False)
    run: Source
    checks: tuple[CrossCheck, ...] = ()
    pilot_s: float = 0.0
    proof: Proof | None = None
    possible: tuple[tuple[Fraction, Fraction, str], ...] = ()

    @property
    def level(self) -> Level:
        """Level of trust in the numbers: one of `scene.LEVELS`."""
        return self.scene.run.level

    @property
    def t(self) -> Array:
        """Grid times in s, shape (rows,)."""
        return np.array([float(t) for t in self.times])

    def __getattr__(self, name: str) -> Any:
        """Return a grid column by name."""
        if name in ("x", "y", "z", "vx", "vy", "vz"):
            return self.grid.array(name)
        raise AttributeError(name)
