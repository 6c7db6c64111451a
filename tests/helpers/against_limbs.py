"""Rows solved side by side against limbs at 110 bits: counts and times of transits, and every estimate of an error."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from random_rows import rows_of

from reference.engines.batch_interface import OK, Batch, Outcomes, Rows, RunOptions
from reference.engines.registry import engines
from reference.model.algebra import add, cross, dot, scale, subtract
from reference.scenes.inputs import Inputs
from reference.sweeps.estimate import Errors, errors_by_moved_runs
from reference.sweeps.highest_points import DEGREES_PER_HOUR

BITS = 110


@dataclass
class LimbsComparison:
    """What a comparison found: rows in doubt, transits lost or doubled, estimates too small, the worst errors."""

    rows: int = 0
    doubtful: int = 0
    miscounted: list[Inputs] = field(default_factory=list)
    underestimated: list[tuple[Inputs, str, float]] = field(default_factory=list)
    worst: dict[str, float] = field(default_factory=dict)  # error over estimate, by quantity
    worst_time: float = 0.0  # |ax| times the time's error, over l, in 1/s
    worst_state: float = 0.0  # over l

    def __str__(self) -> str:
        ratios = ", ".join(f"{name} {ratio:.2f}" for name, ratio in self.worst.items())
        return (
            f"{self.rows} rows, {self.doubtful} in doubt, {len(self.miscounted)} miscounted, "
            f"{len(self.underestimated)} estimates below the error; worst time {self.worst_time:.1e} (|ax|/l), "
            f"worst position {self.worst_state:.1e} of l; largest error over its estimate: {ratios or 'not told'}"
        )

    def judge(self, inputs: Inputs, name: str, error: float, estimate: float) -> None:
        """Note an error beside its estimate; an estimate that is no number is too small."""
        ratio = error / estimate if estimate > 0 else 0.0 if error == 0 == estimate else np.inf
        self.worst[name] = max(self.worst.get(name, 0.0), ratio)
        if ratio > 1:
            self.underestimated.append((inputs, name, ratio))


def truth(inputs: Inputs, times: tuple[Fraction, ...] = ()) -> Any:
    """Return a run in limbs, with transits; its grid has the release, some times and the end."""
    limbs = engines()["limbs"]
    return limbs.run(limbs.plan(inputs, BITS, (Fraction(0), *times, inputs.t_end), ("xdot",)))


def compare(batch: Batch, many: list[Inputs], estimates: bool = True) -> LimbsComparison:
    """Solve scenes in a batch engine and in limbs, and compare."""
    rows = rows_of(many)
    run = batch.solve(rows, RunOptions(times=True))
    estimate = errors_by_moved_runs(batch, rows, run)[0] if estimates else None
    found = LimbsComparison(rows=len(many))
    for i, inputs in enumerate(many):
        if run.fate[i] != OK:
            found.doubtful += 1
            continue
        _one(found, rows, run, estimate, i, inputs)
    return found


def _one(
    found: LimbsComparison,
    rows: Rows,
    run: Outcomes,
    estimate: Errors | None,
    i: int,
    inputs: Inputs,
) -> None:
    swings = estimate is not None and run.apsides[i] > 1
    seen = (Fraction(run.apsis_first[i]), Fraction(run.apsis_last[i])) if swings else ()
    exact, own = truth(inputs, seen), run.transit_row == i
    length = float(inputs.length)
    state = np.array([exact.grid[name][-1] for name in ("x", "y", "z", "vx", "vy", "vz")])
    gap = run.state[i] - state
    position, velocity = float(np.linalg.norm(gap[:3])), float(np.linalg.norm(gap[3:]))
    found.worst_state = max(found.worst_state, position / length)
    transits = exact.transits
    times = transits["t"] if transits is not None else np.zeros(0)
    directions = np.array(exact.directions)
    if (
        len(times) != own.sum()
        or run.transits[i] != len(times)
        or (run.transit_direction[own] != directions).any()
    ):
        found.miscounted.append(inputs)
        return
    late = np.abs(run.transit_t[own] - times)
    if len(times):
        found.worst_time = max(
            found.worst_time, float((late * np.abs(transits["ax"])).max()) / length
        )
    if estimate is None:
        return
    found.judge(inputs, "position", position, estimate.position[i])
    found.judge(inputs, "velocity", velocity, estimate.velocity[i])
    if len(times):
        found.judge(inputs, "transit", float(late.max()), estimate.transit[i])
    if len(times) > 1:
        instants = transits.exact("t")
        frequency = float(Fraction(len(times) - 1) / (2 * (instants[-1] - instants[0])))
        own_frequency = (len(times) - 1) / (2 * (run.t_last[i] - run.t_first[i]))
        found.judge(inputs, "frequency", abs(own_frequency - frequency), estimate.frequency[i])
    if swings:
        _judge_swing(found, rows, run, estimate, i, exact)


def _judge_swing(
    found: LimbsComparison,
    rows: Rows,
    run: Outcomes,
    estimate: Errors,
    i: int,
    exact: Any,
) -> None:
    """Judge swing frequency, precession and largest angle.

    Half turns and the number of highest points are the run's own; they cannot be off by one unnoticed, as the first and
    the last are judged.
    """
    (first, start, low), (last, end, high) = (_highest(rows, i, exact, place) for place in (1, 2))
    span, own_span = last - first, run.apsis_last[i] - run.apsis_first[i]
    gaps = run.apsides[i] - 1
    inputs = exact.plan.inputs
    found.judge(
        inputs, "swing", abs(float(gaps / (2 * span)) - gaps / (2 * own_span)), estimate.swing[i]
    )
    turn = end - start + np.pi * round((run.turn[i] - (end - start)) / np.pi)
    error = abs(turn / float(span) - run.turn[i] / own_span) * DEGREES_PER_HOUR
    found.judge(inputs, "precession", error, estimate.precession[i])
    release = _angle(_exact(rows.n[i]), _exact(rows.pull[i]))
    # other points may be higher, none may be missed
    missed = max(low, high, release) - run.largest_angle[i]
    found.judge(inputs, "angle", np.degrees(max(missed, 0.0)), estimate.angle[i])


def _highest(rows: Rows, i: int, exact: Any, place: int) -> tuple[Fraction, float, float]:
    """Return time, azimuth and angle of the highest point next to a time of the grid: one step of Newton's method."""
    grid, length = exact.grid, exact.plan.inputs.length
    n, velocity = (
        tuple(grid.exact(name)[place] / length for name in names)
        for names in (("x", "y", "z"), ("vx", "vy", "vz"))
    )
    pull, turn = _exact(rows.pull[i]), _exact(rows.turn[i])
    inertial = add(velocity, cross(turn, n))
    tension = dot(inertial, inertial) + dot(n, pull)
    rate = subtract(subtract(pull, cross(turn, inertial)), scale(tension, n))
    bend = dot(subtract(rate, cross(turn, velocity)), pull)
    late = -dot(velocity, pull) / bend
    at = add(n, scale(late, velocity))
    size = np.hypot(float(pull[1]), float(pull[2]))
    meridian = float(-at[1] * pull[2] + at[2] * pull[1]) / size
    return (
        exact.plan.times[place] + late,
        float(np.arctan2(meridian, float(at[0]))),
        _angle(at, pull),
    )


def _exact(pairs: Any) -> tuple[Fraction, ...]:
    return tuple(Fraction(high) + Fraction(low) for high, low in pairs)


def _angle(n: Any, pull: Any) -> float:
    """Return the angle from the plumb line."""
    return float(np.arctan2(np.linalg.norm(np.array(cross(n, pull), float)), float(dot(n, pull))))
