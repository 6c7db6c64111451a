"""The interface of an integrator: `Method`, its declaration, and `RunOutcome`, the result of a run."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from reference import Scene
from reference.numbers.columns import STATE
from reference.numbers.precision import Array
from reference.numbers.table import Table
from reference.status import Status
from reference.system.imports import install_command, missing, switched_off

from .library import Library
from .rhs.problem import Problem

Setting = Literal["step", "tolerance", "precision"]

# l/g in s² of the pendulum for which ladders of steps are written
PARIS = Fraction("67") / Fraction("9.80665")
# formulations that can be traced to straight-line code
TRACEABLE = ("momentum", "space", "spin", "plane", "angles")
# the same, for methods that do best in `space`
SPACE_FIRST = ("space", "momentum", "spin", "plane", "angles")
# ladder of tolerances of an explicit method of order 8 or so
HIGH_ORDER = (1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
NINE_DIGITS = ((None, 1e-9),)  # the run in `Method.stability` of a method that has a tolerance
TWO_HUNDRED_STEPS = ((None, 1 / 200),)  # the same of one whose step is fixed: steps in a swing


class Family(StrEnum):
    """A group of methods that share a colour and a panel in reports.

    Its value is the panel's title.
    """

    USERS = "yours: --run, --candidates"
    PAPER = "the paper's, fixed step"
    GEOMETRIC = "geometric, fixed step"
    MANY_DIGITS = "many digits"
    HEYOKA = "heyoka, Taylor"
    SCIPY = "SciPy"
    COMPILED = "compiled: C, C++, Fortran"
    REBOUND = "rebound"
    OTHERS = "others"


@dataclass(frozen=True)
class RunOutcome:
    """The result of a run.

    A numerical failure is an outcome too, with its reason and the states before it.

    Attributes:
        status: OK; GAVE_UP if the method stopped by itself; NOT_FINITE if it continued to NaN or
            infinity.
        reached_t: last output time that was reached, in s.
        rows: computes x, y, z in m and vx, vy, vz in m/s at the output times that were reached: an
            array of shape (rows, 6), or a table where the number type is finer than binary64; it is
            called at most once, so that the conversion is not timed with the run.
        reason: why it is not ok, in the library's words if it has any; or its warning.
        steps: number of steps, None if the method does not report it.
        rhs_evaluations: number of evaluations of the right-hand side (None for Taylor methods,
            which make none).
        cpu_s: CPU seconds as measured by the run itself, if another process did the work.
    """

    status: Status
    reached_t: float
    rows: Callable[[], Array | Table] = field(repr=False)
    reason: str = ""
    steps: int | None = None
    rhs_evaluations: int | None = None
    cpu_s: float | None = None

    @cached_property
    def _computed(self) -> Array | Table:
        return self.rows()

    @property
    def exact(self) -> Table | None:
        """The states as computed in a number type finer than binary64; None for binary64."""
        return self._computed if isinstance(self._computed, Table) else None

    @cached_property
    def states(self) -> Array:
        """The states as doubles, shape (rows, 6)."""
        computed = self._computed
        return (
            np.column_stack([computed[name] for name in STATE])
            if isinstance(computed, Table)
            else computed
        )


Work = Callable[[], RunOutcome]


@dataclass(frozen=True, repr=False)
class Method:
    """An integrator.

    Attributes:
        id: its name on the command line.
        title: its name in tables, with the order.
        setting: the quantity that a study varies: `step` in s, `tolerance` (relative), `precision`
            in bits.
        ladder: settings from loose to tight, for the pendulum of Paris; see `settings`.
        source: publication or origin of the code.
        licence: of the code that integrates.
        prepare: imports and compiles everything for a problem and a setting, and returns a function
            that only integrates, which may be called repeatedly.
        formulations: those that it may be used with; the first suits it best, or is the one it was
            written for.
        requires: modules that must be installed.
        native: the library of C or C++ whose headers must be here.
        extra: the extra of `pip install 'foucault-reference[…]'` that installs them; None if
            nothing is needed.
        longest_s: simulated time in s beyond which a run would take unreasonably long.
        order: where it is fixed, proved by the tableau of this project's methods; None where the
            method chooses it.
        family: methods of a family share a colour and a panel in reports.
        number: number type that it computes in, as tables print it.
        stability: the runs of it that `foucault stability` makes, each a formulation (None: the
            first that can describe the motion) and a setting; a step is given as a part of 2π over
            the fastest rate of the scene.
        long_runs: the runs of it over thirty days, each a formulation and a setting.
        precision_runs: the same for `foucault study --precisions`, from the bits that are asked
            for.
    """

    id: str
    title: str
    setting: Setting
    ladder: tuple[float, ...]
    source: str
    licence: str
    prepare: Callable[[Problem, float], Work] = field(repr=False)
    formulations: tuple[str, ...] = TRACEABLE
    requires: tuple[str, ...] = ()
    native: Library | None = None
    extra: str | None = None
    longest_s: float | None = None
    order: int | None = None
    family: Family = Family.OTHERS
    number: str = "double"
    stability: tuple[tuple[str | None, float], ...] = ()
    long_runs: tuple[tuple[str, float], ...] = ()
    precision_runs: Callable[[Sequence[int]], list[tuple[str, float]]] = field(
        default=lambda bits: [], repr=False
    )

    def __repr__(self) -> str:
        return f"Method({self.id}: {self.title})"

    def settings(self, scene: Scene) -> tuple[float, ...]:
        """Return the ladder for a scene: steps in proportion to its period, other settings unchanged.

        The ladder's steps are for the pendulum of Paris; the proportion is rounded to 1, 2 or 5
        times a power of ten.
        """
        inputs = scene.exact
        if self.setting != "step" or not inputs.gravity:
            return self.ladder
        log_ratio = math.log10(float(inputs.length / inputs.gravity / PARIS)) / 2
        power = math.floor(log_ratio)
        ratio = (
            min((1.0, 2.0, 5.0, 10.0), key=lambda x: abs(math.log10(x) - (log_ratio - power)))
            * 10.0**power
        )
        return tuple(float(f"{step * ratio:.6g}") for step in self.ladder)


# a method of a library, which keeps its error below a tolerance
adaptive = partial(Method, setting="tolerance", stability=NINE_DIGITS)


def available(method: Method) -> str | None:
    """Return None if the method can run here, otherwise what is missing and what to do."""
    variable = switched_off(method.requires)
    if variable is not None:
        return f"{variable} is set: unset it"
    absent = missing(method.requires)
    if not absent:
        return None if method.native is None else method.native.missing
    command = install_command(absent[0], method.extra or "")
    advice = f": {command}" if command else ""
    return f"not installed ({', '.join(absent)}){advice}"


def outcome(problem: Problem, states: Array, *, reason: str = "", **fields: Any) -> RunOutcome:
    """Return the outcome of a run in binary64.

    Args:
        problem: as it was integrated.
        states: of the problem's variables at its first output times, shape (rows, variables); a run
            with fewer rows than times has stopped early; rows from the first NaN or infinity on are
            left out.
        reason: the library's own, if it gave one.
        fields: of `RunOutcome`, if the library reports them: `steps`, `rhs_evaluations` and
            `cpu_s`.
    """
    rows = leading(np.isfinite(states).all(axis=1))
    reached_t = float(problem.times[rows - 1]) if rows else 0.0
    status = Status.OK
    if rows < len(states):
        status, reason = (
            Status.NOT_FINITE,
            reason or f"the state is not finite after t = {reached_t:g} s",
        )
    elif rows < len(problem.times):
        status, reason = (
            Status.GAVE_UP,
            reason or f"stopped after t = {reached_t:g} s without giving a reason",
        )
    return RunOutcome(status, reached_t, lambda: problem.cartesian(states[:rows]), reason, **fields)


def leading(flags: npt.ArrayLike) -> int:
    """Return the number of rows before the first whose flag is false."""
    return int(np.argmin(np.append(flags, False)))


def failed(problem: Problem, reason: str) -> RunOutcome:
    """Return the outcome of a run that gave up and produced no state after the first."""
    return outcome(problem, problem.start[None, :], reason=reason)
