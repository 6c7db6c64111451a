"""The interface of an integrator: each folder beside this file that has an `engine.py` declares one as `ENGINE`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator
from dataclasses import replace
from fractions import Fraction
from typing import ClassVar

from ..numbers.taylor_step import TaylorStep
from ..scenes.inputs import Inputs
from ..system.imports import missing, switched_off
from .plan import Pace, Plan, Report, Run


class Engine(ABC):
    """An integrator of the model that finds the zeros of xdot, in number types of its own.

    Attributes:
        name: its name on the command line and in datasets.
        formulation: the formulation that suits it best; not `space` or `spin`, in which heyoka confirms other runs.
        requires: modules that must be installed.
        extra: the extra of `pip install 'foucault-reference[…]'` that installs them.
        bits: lowest and highest precision that it is chosen for.
        own_process: whether a proof has it compute in a child process; else it costs too little for that.
        start_s: CPU seconds until its first step: of importing what it requires and of loading what it has compiled.
    """

    name: ClassVar[str]
    formulation: ClassVar[str]
    requires: ClassVar[tuple[str, ...]]
    extra: ClassVar[str]
    bits: ClassVar[range]
    own_process: ClassVar[bool]
    start_s: ClassVar[float]

    @property
    def installed(self) -> bool:
        """Whether the modules that it requires are installed, and may compile."""
        return not missing(self.requires) and not switched_off(self.requires)

    @abstractmethod
    def plan(self, inputs: Inputs, prec: int, times: tuple[Fraction, ...], transits: bool) -> Plan:
        """Return the cheapest run with at least `prec` bits."""

    def witness(self, published: Plan, prec: int) -> Plan:
        """Return a run of at most `prec` bits, fewer than those of the published run, and in other steps.

        No number in it may be the published run's by construction, so that their difference tells an error.
        """
        return replace(self.plan(published.inputs, prec, published.times, published.transits), other_steps=True)

    @abstractmethod
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

    @abstractmethod
    def taylor_steps(
        self, inputs: Inputs, times: tuple[Fraction, ...], prec: int, coefficient_bits: int
    ) -> Generator[TaylorStep, None, Run]:
        """Yield the Taylor steps of a run from t = 0 to one step beyond the last time, in order; return the run.

        The run's plan names this engine.

        Args:
            inputs: the exact inputs of a scene.
            times: times of output in s, increasing, from 0.
            prec: precision of the run in bits.
            coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits.
        """

    @abstractmethod
    def expected_s(self, steps: int, prec: int) -> float:
        """Return about how many CPU seconds a run takes that would be `steps` steps in double."""
