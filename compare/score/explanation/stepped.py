"""Euler's methods and leapfrog on the sphere, run as a program would: at a fixed step that divides the rows.

What the leading error of a step does to a wide swing is known; what Euler's first order does beside that, leaving the
sphere on its way, is not. So the equations of a program are stepped in the same way, and what that does to the rows is
taken from them before they are read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from reference.model.force import acceleration
from reference.numbers.precision import Array

from ...candidates.candidate import Deviation
from .causes import FITTED, NAMED
from .findings import Explanation
from .fitted import best_of, explanation_of
from .phasors import METHODS
from .programs import Program
from .unexplained import Case, largest, rms

TITLES = {method.id: method.title for method in METHODS if "euler" in method.id or method.id == "leapfrog"}
DRIFT_FIRST = ("semi_implicit_euler_drift", "leapfrog")  # before the kick at the new place
IntArray = npt.NDArray[np.int64]
LONGEST = 15_000  # steps that are run
FINEST = 0.004  # ωh: the shortest step that is tried
SWING = 1.5  # periods at the beginning that tell the step
LIKELY = 3  # steps that are tried on all rows
PLAIN = 0.3  # of what no step at all leaves of the first swing
PASSES = 4  # by which the other causes are found
STEP_LEFT = 1e-3  # of what the steps do that may be left


@dataclass(frozen=True)
class Steps:
    """A method and its number of steps from row to row, with the reading of g that it was found with."""

    method: str
    every: int
    program: Program


def of_steps(case: Case) -> Explanation | None:
    """Return what is known of rows that such a method made on the sphere; None if none did.

    The step's effect is that on a right program at first, then that on the program which the rest is read as.
    """
    rows = replace(case.rows, positions=np.ascontiguousarray(case.rows.plane), cord=None)
    flat = replace(case, rows=rows, truth=case.truth[:, :2])
    for steps in likely_steps(flat):
        program, best, seen, before = steps.program, None, case, math.inf
        for _ in range(PASSES):
            moved = stepped(flat, program, steps)
            effect = moved - flat.positions(program)
            left = rms(rows.positions - moved)
            enough = left <= max(case.floor, STEP_LEFT * rms(effect))
            if not left < before or (enough and (best is not None or program == case.right)):
                break
            before = left
            seen = replace(flat, rows=replace(rows, positions=rows.positions - effect))
            best = best_of(seen, integrators=False, sure=False)
            if best is None or best.reader.right.kind != "sphere":
                break
            program = best.program
        if not enough or program.kind != "sphere":
            continue
        causes = () if best is None else explanation_of(seen, best).causes
        step = float(rows.times[1]) / steps.every
        text = f"integrates with {TITLES[steps.method]} at a step of {step:.3g} s"
        cause = Deviation(f"integrator_{steps.method}", text, largest(effect), "integrator", step, step, 0.0)
        corrected, price = largest(rows.positions - moved), NAMED * len(causes) + FITTED
        return case.explanation((*causes, cause), corrected, left, price)
    return None


def likely_steps(case: Case) -> list[Steps]:
    """Return methods and steps that the first swing looks like, the likeliest first; none for rows not evenly spaced.

    The rows have x and y alone, the first of them evenly spaced from the release on.
    """
    rows, frequency = case.rows, case.frequency
    if len(rows.times) < 8 or rows.times[0] != 0 or not frequency:
        return []
    spacing = float(rows.times[1])
    count = max(6, math.ceil(SWING * 2 * math.pi / frequency / spacing))
    last = rows.times[-1] / spacing
    even = np.abs(rows.times / spacing - np.round(rows.times / spacing)).max() < 1e-6 * last
    most = min(int(spacing * frequency / FINEST), int(LONGEST / last))
    if not even or most < 1 or len(rows.times) <= count or abs(rows.times[count] / spacing - count) > 1e-6:
        return []
    likely: list[tuple[float, Steps]] = []
    plain: list[float] = []
    first = replace(rows, times=rows.times[: count + 1], positions=rows.positions[: count + 1])
    swing = replace(case, rows=first)
    every = np.arange(1, most + 1, dtype=np.int64)
    for gravity in dict.fromkeys((case.right.gravity_reading, "none")):
        program = replace(case.right, gravity_reading=gravity)
        plain.append(float(np.linalg.norm(swing.left(program))))
        for method in TITLES:
            moved = _rows(case, program, method, spacing, every, count)
            apart = np.linalg.norm(moved - first.positions[:, :, None], axis=(0, 1))
            best = int(np.argmin(np.where(np.isfinite(apart), apart, np.inf)))
            near = every[max(best - 1, 0) : best + 2]
            likely += [(float(apart[i - 1]), Steps(method, int(i), program)) for i in near if np.isfinite(apart[i - 1])]
    likely.sort(key=lambda pair: pair[0])
    return [steps for apart, steps in likely[:LIKELY] if apart < PLAIN * min(plain)]


def stepped(case: Case, program: Program, steps: Steps) -> Array:
    """Return x and y in m at the times of the rows, as steps of a program have them, shape (rows, 2)."""
    spacing = float(case.rows.times[1])
    at = np.round(case.rows.times / spacing).astype(int)
    every = np.array([steps.every], dtype=np.int64)
    whole = _rows(case, program, steps.method, spacing, every, int(at[-1]))
    return np.asarray(whole[at, :, 0])


def _rows(case: Case, program: Program, method: str, spacing: float, every: IntArray, count: int) -> Array:
    """Return x and y of row 0, 1, … in m for several numbers of steps a row, shape (rows, 2, numbers)."""
    pendulum, theta = case.pendulum_of(program)
    k = pendulum.constants(theta)
    length, start = float(theta[11]), pendulum.start(theta)
    h = spacing / every if len(every) > 1 else float(spacing / every[0])  # a single one is faster without an array
    place, speed = ([value + 0 * h for value in part] for part in (start[:3], start[3:]))
    rows = np.full((count + 1, 2, len(every)), np.nan)
    rows[0] = np.reshape(place[:2], (2, -1))
    for done in range(1, count * int(every.max()) + 1):
        kick = h
        if method == "leapfrog":
            kick = h / 2
            rates = acceleration(tuple(place), tuple(speed), k)
            speed = [v + kick * a for v, a in zip(speed, rates, strict=True)]
        if method in DRIFT_FIRST:
            place = [p + h * v for p, v in zip(place, speed, strict=True)]
        rates = acceleration(tuple(place), tuple(speed), k)
        before = speed
        speed = [v + kick * a for v, a in zip(speed, rates, strict=True)]
        if method not in DRIFT_FIRST:
            moved = before if method == "explicit_euler" else speed
            place = [p + h * v for p, v in zip(place, moved, strict=True)]
        row = np.flatnonzero((done % every == 0) & (done // every <= count))
        if len(row):
            rows[done // every[row], :, row] = np.reshape(place[:2], (2, -1)).T[row]
    return rows * length
