"""A row of a study: one method at one setting, its status, its errors and its cost."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

OK, EXTRAPOLATED = "ok", "extrapolated"


@dataclass(frozen=True)
class Row:
    """One method at one setting on a scene: status, errors and cost.

    Attributes:
        method: its id.
        formulation: of the equations of motion.
        setting: step in s, relative tolerance, or bits.
        kind: which of these: "step", "tolerance" or "precision".
        inputs: how the scene's numbers are read: "decimal" or "binary64".
        status: ok; extrapolated (cost of the whole span from a part; the errors are of that part);
            not_installed, gave_up, not_finite, missed_transits, out_of_time, refused.
        reason: why it is not ok.
        error_m: largest position error on the grid.
        end_error_m: position error at the last row reached.
        transit_error_s: largest error of a transit's time, by one Newton step from the state at the true time.
        h_drift: largest change of h, over the largest kinetic energy.
        cpu_s: median CPU seconds of the whole span.
        cpu_spread: largest minus smallest over the median.
        compile_s: CPU seconds of imports and compilation.
        rhs_evaluations: number of evaluations of the right-hand side.
        steps: number of steps.
        reached_t: last time reached, in s.
    """

    method: str
    formulation: str
    setting: float
    kind: str
    inputs: str
    status: str
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

    @property
    def key(self) -> tuple[str, str, float]:
        """The identity of a row within a study."""
        return self.method, self.formulation, self.setting

    @property
    def measured(self) -> bool:
        """True if the row has a cost and an error."""
        return self.status in (OK, EXTRAPOLATED)

    @classmethod
    def parsed(cls, document: dict[str, Any]) -> Row:
        """Read a row from its JSON document."""
        names = {one.name for one in fields(cls)}
        return cls(**{key: value for key, value in document.items() if key in names})
