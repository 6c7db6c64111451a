"""A row of a study: one method at one setting, with status, cost, and errors against the golden grid."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias, TypeVar

import numpy as np

from reference import FoucaultError, Golden, IntegrationError, Scene
from reference.model.constants import constants, constants_in_double
from reference.model.force import acceleration, invariant
from reference.numbers.precision import Array, context, to_mpf
from reference.status import Status

from ..candidates.candidate import COLUMNS
from ..methods.method import RunOutcome

T = TypeVar("T")
K = TypeVar("K")
ColumnValues: TypeAlias = Array | Sequence[Fraction]  # doubles, or exact numbers
FAILURES = (FoucaultError, ArithmeticError, ValueError, RuntimeError, MemoryError)
UNKNOWN = ""  # formulation of a program or a file: nobody says in which variables it integrates
_H_ROWS = 64  # rows at which h is evaluated
_ROUNDINGS = 8  # of a double, in the difference of two times and in vx over ax
_NUDGE = 1e-6  # of the time in which the motion changes


def failure(error: Exception) -> tuple[Status, str]:
    """Return status and reason of a run that raised one of `FAILURES`."""
    if isinstance(error, FoucaultError):
        return Status.GAVE_UP if isinstance(error, IntegrationError) else Status.REFUSED, str(error)
    return Status.GAVE_UP, f"{type(error).__name__}: {error}"


@dataclass(frozen=True)
class Row:
    """One method at one setting on a scene: status, errors and cost.

    Attributes:
        method: its id.
        formulation: of the equations of motion; UNKNOWN of somebody's program or file.
        setting: step in s, relative tolerance, or bits.
        kind: which of these: "step", "tolerance" or "precision".
        inputs: how the scene's numbers are read: "decimal" or "binary64".
        status: where it is EXTRAPOLATED, only a part of the span was run, up to `reached_t`.
        reason: why it is not OK.
        error_m: largest position error on the grid; None where only a part of it was run.
        end_error_m: position error at the last row reached.
        transit_error_s: largest error of a transit's time, by one Newton step from the state at the
            true time; None also where it is not resolved.
        transit_floor_s: what is resolved of it, as the step begins at the double next to the true
            time.
        h_drift: largest change of h, over the largest kinetic energy.
        cpu_s: median CPU seconds of the whole span.
        cpu_spread: largest minus smallest over the median.
        compile_s: CPU seconds of imports and compilation.
        rhs_evaluations: number of evaluations of the right-hand side.
        steps: number of steps.
        reached_t: last time reached, in s.
        load: processes for each core that wanted to run when it was measured; None where the system
            does not tell.
    """

    method: str
    formulation: str
    setting: float
    kind: str
    inputs: str
    status: Status
    reason: str = ""
    error_m: float | None = None
    end_error_m: float | None = None
    transit_error_s: float | None = None
    h_drift: float | None = None
    cpu_s: float | None = None
    cpu_spread: float | None = None
    compile_s: float | None = None
    rhs_evaluations: int | None = None
    steps: int | None = None
    reached_t: float | None = None
    transit_floor_s: float | None = None
    load: float | None = None

    def __repr__(self) -> str:
        """Return the run, its status, and what was measured of error and cost."""
        error = "" if self.error_m is None else f", {self.error_m:.2g} m"
        cost = "" if self.cpu_s is None else f", {self.cpu_s:.2g} s"
        equations = f" in {self.formulation}" if self.formulation else ""
        return f"Row({self.method}{equations} at {self.setting:g}: {self.status}{error}{cost})"

    @property
    def key(self) -> tuple[str, str, float]:
        """The identity of a row within a study."""
        return self.method, self.formulation, self.setting

    @property
    def measured(self) -> bool:
        """True if the whole span was run successfully: then the row has a cost and an error."""
        return self.status == Status.OK

    @property
    def failed(self) -> bool:
        """True if the cost of the whole span is not known."""
        return self.status not in (Status.OK, Status.EXTRAPOLATED)


@dataclass(frozen=True)
class GridTruth:
    """The golden grid states and transits up to a time, with which a method's run is compared.

    Args:
        golden: of the scene, its inputs read as the methods read them.
        t_end: end of the span in s, a time of the dataset's grid.
    """

    golden: Golden
    t_end: float

    @cached_property
    def times(self) -> Array:
        """Grid times of the span in s."""
        t: Array = self.golden.t
        return np.asarray(t[t <= self.t_end])

    @cached_property
    def exact(self) -> list[list[Fraction]]:
        """Columns x, y, z in m as printed, at the grid times."""
        return [self.golden.exact(name)[: len(self.times)] for name in "xyz"]

    @cached_property
    def transits(self) -> Array:
        """Times of the transits within the span in s."""
        t = self.golden.transits["t"]
        return np.asarray(t[t < self.times[-1]])

    def position_errors(self, outcome: RunOutcome) -> Array:
        """Return the distance from the truth at each row, in m, without cancellation in any number type."""
        errors = []
        for name, truth in zip("xyz", self.exact, strict=True):
            column = _column(outcome, name)
            errors.append(difference(column, truth[: len(column)]))
        return np.asarray(np.linalg.norm(errors, axis=0))

    def transit_errors(self, scene: Scene, outcome: RunOutcome) -> tuple[Array, float]:
        """Return the error of each transit's time in s, and the largest floor of these errors in s.

        The error is estimated by one Newton step from the state at the true time. Its floor is the
        rounding of its terms, and the second-order term that Newton's step leaves out.

        Args:
            scene: its inputs read as the method read them.
            outcome: of a run with output at t = 0 and at `transits`.
        """
        k = constants_in_double(scene.exact)
        n = outcome.states[1:, 0:3] / k.length
        v = outcome.states[1:, 3:6] / k.length
        a = np.array(np.broadcast_arrays(*acceleration(tuple(n.T), tuple(v.T), k))).T

        # the derivative of the acceleration, by central differences
        dt_s = _NUDGE / (1 + np.abs(v).max() + np.abs(a).max())
        ahead = acceleration(tuple((n + dt_s * v).T), tuple((v + dt_s * a).T), k)[0]
        behind = acceleration(tuple((n - dt_s * v).T), tuple((v - dt_s * a).T), k)[0]
        jerk = (ahead - behind) / (2 * dt_s)

        # how far the doubles at which the method has output are from the transits
        exact_times = self.golden.transits.exact("t")[: len(self.transits)]
        offsets_s = difference(self.transits, exact_times)
        vx = np.array([float(number) for number in _column(outcome, "vx")[1:]])
        with np.errstate(divide="ignore", invalid="ignore"):
            errors_s = np.abs(offsets_s - vx / (a[:, 0] * k.length))
            second_order_s = offsets_s**2 * np.abs(jerk / (2 * a[:, 0]))
        second_order_s[~np.isfinite(second_order_s)] = 0.0
        errors_s[~np.isfinite(errors_s)] = np.inf
        floors_s = _ROUNDINGS * np.finfo(float).eps * np.abs(offsets_s) + second_order_s
        return errors_s, float(floors_s.max())


def h_drift(scene: Scene, outcome: RunOutcome) -> float | None:
    """Return the drift of h over the largest kinetic energy, in the precision of the outcome.

    None with drag.
    """
    if scene.exact.drag:
        return None
    # 27 bits beyond a double, or 64 beyond an exact state: h is a small difference of large terms
    ctx = context(80 if outcome.exact is None else outcome.exact.bits + 64)
    k = constants(scene.exact, ctx)
    columns = [_column(outcome, name) for name in COLUMNS]

    def number(value: Fraction | float) -> Any:
        return to_mpf(value, ctx) if isinstance(value, Fraction) else ctx.mpf(float(value))

    values = []
    largest_kinetic = ctx.mpf(0)
    for i in np.unique(np.linspace(0, len(columns[0]) - 1, _H_ROWS).astype(int)):
        state = [number(column[i]) / k.length for column in columns]
        n = tuple(state[:3])
        v = tuple(state[3:])
        values.append(invariant(n, v, k))
        kinetic = sum(component**2 for component in v) * k.length**2 / 2
        largest_kinetic = max(largest_kinetic, kinetic)
    if not largest_kinetic:
        return None
    drift = max(abs(value - values[0]) for value in values)
    return float(drift / largest_kinetic)


def grouped(items: Iterable[T], key: Callable[[T], K]) -> dict[K, list[T]]:
    """Return items by a key, the keys and the items of each in order of appearance."""
    groups: dict[K, list[T]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def difference(a: ColumnValues, b: ColumnValues) -> Array:
    """Return a - b as doubles, shape (rows,); where a number is exact, it is subtracted exactly."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.asarray(a - b)  # the difference of doubles that agree so far is exact
    return np.array([float(Fraction(p) - Fraction(q)) for p, q in zip(a, b, strict=True)])


def _column(outcome: RunOutcome, name: str) -> ColumnValues:
    """Return a column of the states that a run reached, exactly where its numbers are finer than doubles."""
    if outcome.exact is None:
        return outcome.states[:, COLUMNS.index(name)]
    return outcome.exact.exact(name)
