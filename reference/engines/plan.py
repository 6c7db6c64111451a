"""The interface of an integrator: `Engine`, with its input, `Plan`, and its output, `Run`.

Each folder beside this file that has an `engine.py` declares an engine as `ENGINE`; its `run.py`
has the functions `run(plan, report, pace)` and `taylor_steps(plan, coefficient_bits)`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from importlib import import_module
from typing import Any, ClassVar

import numpy as np

from ..model.force import tension
from ..model.start import Start
from ..numbers.columns import STATE
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, NumberType, real
from ..numbers.table import Table
from ..numbers.taylor_step import TaylorStep
from ..numbers.zeros import XDOT, Zeros
from ..scenes.inputs import Inputs
from ..system.imports import OptionalEngine

Report = Callable[[float], None]  # called with the simulated time reached, in s
# called with the steps taken and the time reached; raises to end a run
Pace = Callable[[int, float], None]

AT_REST = "If xdot is rounding error only, as for a bob at rest, do not look for transits: run.transits = false."
# longest step times the swing's frequency: a small swing's series reach further, bounds do not
MOST_TURN = 1.75


@dataclass(frozen=True)
class Plan:
    """The specification of a run.

    Attributes:
        inputs: the exact inputs of a scene.
        formulation: a name of `model.formulations.FORMULATIONS`.
        number: type to compute in.
        times: times of output in s, increasing, from 0.
        zeros: words of the zeros that are to be found: `XDOT` for transits, and those of sections.
        engine: the name of an engine, as `registry.engines` has them.
        other_steps: whether to take other steps than the engine would: for a run that checks one of
            the same engine.
    """

    inputs: Inputs
    formulation: str
    number: NumberType
    times: tuple[Fraction, ...]
    zeros: tuple[str, ...] = ()
    engine: str = "heyoka"
    other_steps: bool = False

    @property
    def transits(self) -> bool:
        """Whether to find the zeros of xdot, which an engine does while it runs."""
        return XDOT in self.zeros

    @property
    def sections(self) -> tuple[str, ...]:
        """The words of the sections whose passages are to be found, from the run's Taylor steps."""
        return tuple(word for word in self.zeros if word != XDOT)


@dataclass(frozen=True)
class Run:
    """The states and transits of a run, exactly as it computed them, and its cost.

    Attributes:
        plan: the plan that was run.
        grid: `columns.RUN` at each output time, in SI units.
        order: order of the Taylor polynomials.
        steps: number of steps.
        compile_s: CPU seconds of compiling.
        cpu_s: CPU seconds of the run without compiling.
        zeros: by word, t and at least the columns that are printed; without xdot where that is
            identically zero.
    """

    plan: Plan
    grid: Table
    order: int
    steps: int
    compile_s: float
    cpu_s: float
    zeros: dict[str, Zeros[Table]] = field(default_factory=dict, repr=False)

    @property
    def transits(self) -> Table | None:
        """The zeros of xdot; None if not asked for, or if xdot is identically zero."""
        return self.zeros[XDOT].table if XDOT in self.zeros else None

    @property
    def directions(self) -> list[int]:
        """The sign of each crossing of xdot."""
        return self.zeros[XDOT].directions if XDOT in self.zeros else []

    @cached_property
    def tension(self) -> float:
        """Least tension of the cord over l on the grid, in 1/s²; negative where a rod is pushed.

        It is computed in double.
        """
        k = Start.of(self.plan.inputs, DOUBLE_BITS + GUARD_BITS).k.converted(float)
        x, y, z, vx, vy, vz = (self.grid[name] / k.length for name in STATE)
        return float(np.min(tension((x, y, z), (vx, vy, vz), k)))


class Engine(OptionalEngine, ABC):
    """An integrator of the model that finds the zeros of xdot, in number types of its own.

    Attributes:
        formulation: the formulation that suits it best; not `space` or `spin`, in which heyoka
            confirms other runs.
        bits: lowest and highest precision that it is chosen for.
        own_process: whether a proof has it compute in a child process; else it costs too little for
            that.
        start_s: CPU seconds until its first step: of importing what it requires and of loading what
            it has compiled.
        proof_step_s: CPU seconds that a proof takes for as much of its run as is a step in double.
    """

    formulation: ClassVar[str]
    bits: ClassVar[range]
    own_process: ClassVar[bool]
    start_s: ClassVar[float]
    proof_step_s: ClassVar[float]

    @abstractmethod
    def plan(
        self, inputs: Inputs, prec: int, times: tuple[Fraction, ...], zeros: tuple[str, ...] = ()
    ) -> Plan:
        """Return the cheapest run with at least `prec` bits."""

    def witness(self, published: Plan, prec: int) -> Plan:
        """Return a run in other steps and of at most `prec` bits, fewer than the published run has.

        No number in it may be the published run's by construction, so that their difference tells
        an error.
        """
        plan = self.plan(published.inputs, prec, published.times, published.zeros)
        return replace(plan, other_steps=True)

    @property
    def _code(self) -> Any:
        """The module `run` of its folder, which imports what it requires."""
        return import_module(f".{self.name}.run", __package__)

    def run(self, plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
        """Integrate a plan.

        Args:
            plan: the run to do.
            report: called with the simulated time reached, in s.
            pace: called now and then, to refuse a run that would take too long; not with transits.

        Raises:
            InputError: more bits than the engine has.
            IntegrationError: the integrator stopped, or its transits are in doubt. No numbers then.
        """
        done: Run = self._code.run(plan, report, pace)
        return done

    def taylor_steps(
        self, inputs: Inputs, times: tuple[Fraction, ...], prec: int, coefficient_bits: int
    ) -> Generator[TaylorStep, None, Run]:
        """Yield the Taylor steps of a run, to one step beyond the last time; return the run.

        The run's plan names this engine.

        Args:
            inputs: the exact inputs of a scene.
            times: times of output in s, increasing, from 0.
            prec: precision of the run in bits.
            coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits.
        """
        plan = self.plan(inputs, prec, times)
        if plan.number.hardware:  # a proof's bytes have to be the same on every machine
            plan = replace(plan, number=real(plan.number.prec))
        return self.expanded(plan, coefficient_bits)

    def expanded(self, plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
        """Yield the Taylor steps of a planned run in the same way; transits are not looked for."""
        steps: Generator[TaylorStep, None, Run] = self._code.taylor_steps(plan, coefficient_bits)
        return steps

    @abstractmethod
    def expected_s(self, steps: int, prec: int) -> float:
        """Return an estimate of the CPU seconds of a run that would be `steps` steps in double."""
