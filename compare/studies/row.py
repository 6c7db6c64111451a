"""A row of a study: one method at one setting, its status (of a failure too), its errors and its cost."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Self

from reference import FoucaultError, IntegrationError
from reference.status import Status

FAILURES = (FoucaultError, ArithmeticError, ValueError, RuntimeError, MemoryError)


def failure(error: Exception) -> tuple[Status, str]:
    """Return status and reason of a run that raised one of `FAILURES`."""
    if isinstance(error, IntegrationError):
        return Status.GAVE_UP, str(error)
    if isinstance(error, FoucaultError):
        return Status.REFUSED, str(error)
    return Status.GAVE_UP, f"{type(error).__name__}: {error}"


@dataclass(frozen=True)
class Record:
    """A result with a status, among other fields; `dataclasses.asdict` makes its JSON document."""

    @classmethod
    def parsed(cls, document: dict[str, Any]) -> Self:
        """Read a result from its JSON document; keys that it does not have are left out."""
        values = {field.name: document[field.name] for field in fields(cls) if field.name in document}
        return cls(**values | {"status": Status(values["status"])})


@dataclass(frozen=True)
class Row(Record):
    """One method at one setting on a scene: status, errors and cost.

    Attributes:
        method: its id.
        formulation: of the equations of motion.
        setting: step in s, relative tolerance, or bits.
        kind: which of these: "step", "tolerance" or "precision".
        inputs: how the scene's numbers are read: "decimal" or "binary64".
        status: where it is EXTRAPOLATED, only a part of the span was run, up to `reached_t`.
        reason: why it is not OK.
        error_m: largest position error on the grid; None where only a part of it was run.
        end_error_m: position error at the last row reached.
        transit_error_s: largest error of a transit's time, by one Newton step from the state at the true time; None
            also where it is not resolved.
        transit_floor_s: what is resolved of it, as the step begins at the double next to the true time.
        h_drift: largest change of h, over the largest kinetic energy.
        cpu_s: median CPU seconds of the whole span.
        cpu_spread: largest minus smallest over the median.
        compile_s: CPU seconds of imports and compilation.
        rhs_evaluations: number of evaluations of the right-hand side.
        steps: number of steps.
        reached_t: last time reached, in s.
        load: processes for each core that wanted to run when it was measured; None where the system does not tell.
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
        return f"Row({self.method} in {self.formulation} at {self.setting:g}: {self.status}{error}{cost})"

    @property
    def key(self) -> tuple[str, str, float]:
        """The identity of a row within a study."""
        return self.method, self.formulation, self.setting

    @property
    def measured(self) -> bool:
        """True if the whole span was run, to a right end: then the row has a cost and an error."""
        return self.status == Status.OK

    @property
    def failed(self) -> bool:
        """True if it is not known what the whole span costs."""
        return self.status not in (Status.OK, Status.EXTRAPOLATED)
