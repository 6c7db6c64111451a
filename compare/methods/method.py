"""What every integrator is here: a declaration, and a function that makes a problem ready to be solved."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from reference.scene import Scene

from ..rhs.problem import Array, Problem

Setting = Literal["step", "tolerance", "precision"]
Status = Literal["ok", "gave_up", "not_finite"]

PARIS = Fraction("67") / Fraction("9.80665")  # l/g in s² of the pendulum that ladders of steps are for
TRACEABLE = ("momentum", "space", "spin", "plane", "angles")  # formulations that can become straight-line code
UNITS: dict[Setting, str] = {"step": "s", "tolerance": "relative", "precision": "bits"}


@dataclass(frozen=True)
class Exact:
    """States finer than binary64: x, y, z in m, vx, vy, vz in m/s per row, as integers over 2**bits."""

    bits: int
    rows: list[tuple[int, ...]] = field(repr=False)


@dataclass(frozen=True)
class Outcome:
    """What a run came to. A numerical failure is an outcome too, with its reason and what was reached.

    Attributes:
        status: `ok`; `gave_up` where the method stopped by itself; `not_finite` where it went on to NaN or infinity.
        reason: why it is not ok, in the library's words where it has any; or its warning.
        reached_t: last output time that was reached, in s.
        steps: steps taken, None if the method does not tell.
        rhs_evaluations: evaluations of the right-hand side (for a Taylor method None: it has none).
        cartesian: makes `states`; called at most once, so that conversion is no part of a timed run.
        finer: makes `exact`, for number types finer than binary64.
        cpu_s: CPU seconds as the run itself knows them, where the work was done by another process.
    """

    status: Status
    reason: str
    reached_t: float
    steps: int | None
    rhs_evaluations: int | None
    cartesian: Callable[[], Array] = field(repr=False)
    finer: Callable[[], Exact] | None = field(default=None, repr=False)
    cpu_s: float | None = None

    @cached_property
    def states(self) -> Array:
        """x, y, z in m and vx, vy, vz in m/s at the output times that were reached, shape (rows, 6)."""
        return self.cartesian()

    @cached_property
    def exact(self) -> Exact | None:
        """The same as computed in a finer number type; None for binary64."""
        return None if self.finer is None else self.finer()


Work = Callable[[], Outcome]


@dataclass(frozen=True)
class Method:
    """An integrator.

    Attributes:
        id: the word for it on the command line.
        title: its name, with order.
        setting: what is varied: `step` in s, `tolerance` (relative), `precision` in bits.
        ladder: settings from loose to tight, for the pendulum of Paris; see `settings`.
        source: where the method or its code is from.
        licence: of the code that does the work.
        prepare: makes a problem ready at a setting: everything is imported and compiled when it returns, and the
            call of what it returns is the work alone. It may be called again.
        formulations: those that it may be used with; the first is what it does best or was written for.
        stiff: meant for stiff problems.
        dense: output at many times costs little; other methods shorten their steps to end on output times.
        requires: modules that must be installed.
        extra: what `pip install 'foucault-reference[…]'` brings them; None if nothing is needed.
        longest_s: simulated time beyond which it is not reasonable to run it.
    """

    id: str
    title: str
    setting: Setting
    ladder: tuple[float, ...]
    source: str
    licence: str
    prepare: Callable[[Problem, float], Work] = field(repr=False)
    formulations: tuple[str, ...] = TRACEABLE
    stiff: bool = False
    dense: bool = True
    requires: tuple[str, ...] = ()
    extra: str | None = None
    longest_s: float | None = None

    def settings(self, scene: Scene) -> tuple[float, ...]:
        """The ladder for a scene: steps in proportion to the time of its swing, others as they are.

        The ladder's steps are for the pendulum of Paris; the proportion is rounded to 1, 2 or 5 times a power of ten.
        """
        inputs = scene.exact
        if self.setting != "step" or not inputs.gravity:
            return self.ladder
        slower = math.log10(float(inputs.length / inputs.gravity / PARIS)) / 2
        power = math.floor(slower)
        ratio = min((1.0, 2.0, 5.0, 10.0), key=lambda x: abs(math.log10(x) - (slower - power))) * 10.0**power
        return tuple(float(f"{step * ratio:.6g}") for step in self.ladder)

    @property
    def unit(self) -> str:
        """Unit of the setting."""
        return UNITS[self.setting]


def available(method: Method) -> str | None:
    """None if the method can run here, otherwise what would bring it."""
    missing = [name for name in method.requires if not _installed(name)]
    if not missing:
        return None
    advice = f": pip install 'foucault-reference[{method.extra}]'" if method.extra else ""
    return f"not installed ({', '.join(missing)}){advice}"


def _installed(module: str) -> bool:
    try:
        found = importlib.util.find_spec(module)
    except ModuleNotFoundError:  # the package that it would be in
        return False
    return found is not None and found.origin is not None  # a bare folder has no origin


def outcome(
    problem: Problem, states: Array, *, steps: int | None, rhs_evaluations: int | None, reason: str = ""
) -> Outcome:
    """The outcome of a run in binary64.

    Args:
        problem: what was solved.
        states: of the problem's variables at its first output times, shape (rows, variables); fewer rows than
            times are a run that stopped, rows from the first NaN or infinity on are left out.
        steps: taken.
        rhs_evaluations: counted.
        reason: the library's own, if it gave one.
    """
    finite = np.isfinite(states).all(axis=1)
    rows = len(states) if finite.all() else int(np.argmin(finite))
    reached_t = float(problem.times[rows - 1]) if rows else 0.0
    status: Status = "ok"
    if rows < len(states):
        status, reason = "not_finite", reason or f"the state is not finite after t = {reached_t:g} s"
    elif rows < len(problem.times):
        status, reason = "gave_up", reason or f"stopped after t = {reached_t:g} s without saying why"
    return Outcome(
        status=status,
        reason=reason,
        reached_t=reached_t,
        steps=steps,
        rhs_evaluations=rhs_evaluations,
        cartesian=lambda: problem.cartesian(states[:rows]),
    )


def failed(problem: Problem, reason: str) -> Outcome:
    """A run that gave up and left no more than where it began."""
    return outcome(problem, problem.start[None, :], steps=None, rhs_evaluations=None, reason=reason)
