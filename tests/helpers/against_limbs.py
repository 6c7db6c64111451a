"""Rows solved side by side against limbs at 110 bits: counts and times of transits, states, error estimates."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from random_rows import rows_of

from reference.engines.batch import OK, Batch, Outcomes, Wanted
from reference.engines.registry import engines
from reference.inputs import Inputs
from reference.sweeps.estimate import judged

BITS = 110


@dataclass
class Comparison:
    """What a comparison found: rows in doubt, transits lost or doubled, estimates too small, the worst errors."""

    rows: int = 0
    doubtful: int = 0
    miscounted: list[Inputs] = field(default_factory=list)
    underestimated: list[tuple[Inputs, str, float]] = field(default_factory=list)
    worst_time: float = 0.0  # |ax| times the time's error, over l, in 1/s
    worst_state: float = 0.0  # over l

    def __str__(self) -> str:
        return (
            f"{self.rows} rows, {self.doubtful} in doubt, {len(self.miscounted)} miscounted, "
            f"{len(self.underestimated)} estimates below the error; worst time {self.worst_time:.1e} (|ax|/l), "
            f"worst position {self.worst_state:.1e} of l"
        )


def truth(inputs: Inputs) -> Any:
    """Return a run in limbs, with transits."""
    limbs = engines()["limbs"]
    return limbs.run(limbs.plan(inputs, BITS, (Fraction(0), inputs.t_end), True))


def compare(batch: Batch, many: list[Inputs], estimates: bool = True) -> Comparison:
    """Solve scenes in a batch engine and in limbs, and compare."""
    rows = rows_of(many)
    run = batch.solve(rows, Wanted(times=True))
    estimate = judged(batch, rows, run)[0] if estimates else None
    found = Comparison(rows=len(many))
    for i, inputs in enumerate(many):
        if run.fate[i] != OK:
            found.doubtful += 1
            continue
        _one(found, run, estimate, i, inputs)
    return found


def _one(found: Comparison, run: Outcomes, estimate: Any, i: int, inputs: Inputs) -> None:
    exact, own = truth(inputs), run.transit_row == i
    length = float(inputs.length)
    state = np.array([float(exact.grid[name][-1]) for name in ("x", "y", "z", "vx", "vy", "vz")])
    position = float(np.linalg.norm(run.state[i, :3] - state[:3]))
    found.worst_state = max(found.worst_state, position / length)
    times = exact.transits["t"].astype(float) if exact.transits is not None else np.zeros(0)
    directions = np.array(exact.directions)
    if len(times) != own.sum() or run.transits[i] != len(times) or (run.transit_direction[own] != directions).any():
        found.miscounted.append(inputs)
        return
    late = np.abs(run.transit_t[own] - times)
    if len(times):
        weighted = late * np.abs(exact.transits["ax"].astype(float)) / length
        found.worst_time = max(found.worst_time, float(weighted.max()))
    if estimate is not None:
        if position > estimate.position[i]:
            found.underestimated.append((inputs, "position", position / estimate.position[i]))
        if len(times) and late.max() > estimate.transit[i]:
            found.underestimated.append((inputs, "transit", float(late.max() / estimate.transit[i])))
