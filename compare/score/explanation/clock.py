"""The clock of a file: its unit, its start, rows that are late, early or in reverse order."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention
from .phasors import as_angles, fit_phasors
from .rows import Rows, is_release, largest

TIMES = ((60.0, "minutes"), (3600.0, "hours"), (1e-3, "milliseconds"), (86400.0, "days"))
SHIFTS = 3  # rows by which a clock may be off
PARTS = 4  # of a row: programs that write every second or fourth step are off by that


def clock(rows: Rows, release: Array) -> Rows:
    """Find rows in reverse order, and a clock that does not start at 0."""
    first, last = (is_release(rows.positions[i], release, rows.noise) for i in (0, -1))
    if last and not first and len(rows.times) > 2:
        times = rows.times[-1] - rows.times[::-1]
        found = Convention("rows_reversed", "has its rows in reverse order: the release stands last")
        right = rows.positions[::-1].copy()
        found = replace(found, size_m=largest(right - rows.positions))
        return replace(rows, times=times, positions=right, conventions=(*rows.conventions, found), starts=True)
    if first and rows.times[0] > 0:
        text = f"starts its clock at {rows.times[0]:.10g} s and not at 0"
        found = Convention("clock_offset", text, float(np.hypot(*release[:2])))
        return replace(rows, times=rows.times - rows.times[0], conventions=(*rows.conventions, found), starts=True)
    return rows


def unit_of_time(rows: Rows, frequency: float) -> Rows:
    """Find the unit of time by the frequency of the swing."""
    if not frequency or len(rows.times) < 12:
        return rows
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    some = slice(0, min(len(plane), 400))
    size = float(np.abs(plane).max())
    own = fit_phasors(rows.times[some], plane[some], frequency)
    if own is not None and own[1] < 0.05 * size and 0.5 < abs(own[0].square) ** 0.5 / frequency < 2:
        return rows
    for scale, unit in TIMES:
        found = fit_phasors(rows.times[some] * scale, plane[some], frequency)
        if found is None or found[1] > 0.05 * size:
            continue
        if abs(abs(found[0].square) ** 0.5 / frequency - 1) < 0.1:
            convention = Convention("unit_of_time", f"counts time in {unit}", size)
            return replace(rows, times=rows.times * scale, conventions=(*rows.conventions, convention))
    return rows


def shifted(rows: Rows, release: Array, frequency: float, length: float) -> Rows:
    """Find a clock that is off, the rows in order or reversed: the fitted motion passes the release some rows away."""
    if not frequency or len(rows.times) < 12:
        return rows
    goal = as_angles(np.array([complex(release[0], release[1])]), length)[0]
    moving = complex(release[3], release[4])
    span, spacing = float(rows.times[-1]), float(np.median(np.diff(rows.times)))
    found: list[tuple[float, int, bool]] = []
    for backwards in (False, True):
        positions = rows.positions[::-1] if backwards else rows.positions
        times = span - rows.times[::-1] if backwards else rows.times
        fitted = fit_phasors(times, as_angles(positions[:, :2] @ np.array([1, 1j]), length), frequency)
        if fitted is None or fitted[1] > 1e-2 * abs(goal):
            continue
        phasors = fitted[0]
        for many in range(-SHIFTS * PARTS, SHIFTS * PARTS + 1):
            at = phasors.later(many * spacing / PARTS)
            off = abs(at.start - goal) + abs(at.speed - moving) / frequency
            found.append((float(off), many, backwards))
    found.sort(key=lambda one: one[0] + 1e-9 * abs(goal) * abs(one[1]))
    if not found or found[0][0] > 2e-2 * abs(goal):
        return rows
    _, many, backwards = found[0]
    shift = many * spacing / PARTS
    conventions = list(rows.conventions)
    positions, times = rows.positions, rows.times
    if backwards:
        positions, times = positions[::-1].copy(), span - times[::-1]
        size = largest(positions - rows.positions)
        conventions.append(Convention("rows_reversed", "has its rows in reverse order: the release stands last", size))
    if many:
        count = "one row" if abs(many) == PARTS else f"{Fraction(abs(many), PARTS)} rows"
        word = "late" if many < 0 else "early"
        text = f"has its clock {'ahead of' if many > 0 else 'behind'} its rows by {count} ({abs(shift):.6g} s)"
        size = abs(goal) * min(2.0, frequency * abs(shift))
        conventions.append(Convention(f"rows_{word}", text, float(size)))
    times = times - shift
    kept = times >= 0
    return replace(rows, times=times[kept], positions=positions[kept], conventions=tuple(conventions), starts=True)
