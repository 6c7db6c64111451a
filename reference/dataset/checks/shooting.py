"""Shoot from every row of a grid to the next in limbs, through the transits between, and compare where it arrives.

How far it may be off is what the bounds on a row spread to by the next one: nothing needs to be known of the motion
before, so that this also judges rows of a chaotic scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import groupby, pairwise
from typing import Any

import numpy as np

from ...engines.limbs.restarts import runs_from
from ...engines.limbs.size import LEAST_PREC, MOST_PREC
from ...engines.plan import Run
from ...model.constants import constants
from ...model.force import acceleration
from ...numbers.columns import GRID, POSITION, TRANSITS
from ...numbers.precision import GUARD_BITS, Array, bits_of, context, to_fraction, to_mpf
from ..files import Files
from .completion import deep, depth, vertical_velocity
from .propagation import spreads

LINEAR = 1e-3  # of l: errors above this do not spread in proportion
BLOCK = 2048  # rows whose errors are spread side by side
SLACK = 1.01


def impossible(files: Files) -> str:
    """Return why a dataset cannot be judged in this way, or nothing."""
    if any(files.manifest.bound("grid", name) > LINEAR * files.scene.exact.length for name in GRID[:3]):
        return "its bounds are so wide that nobody can tell how they spread"
    return f"it takes more than {MOST_PREC} bits" if _prec(files) > MOST_PREC else ""


def _prec(files: Files) -> int:
    return max(LEAST_PREC, bits_of(files.manifest.digits) + GUARD_BITS // 2)


def problems(files: Files, seek: bool) -> Iterator[str]:
    """Yield a sentence for every row, and, if `seek`, every transit, that is not where the row before leads to.

    Raises:
        IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
    """
    prec = _prec(files)
    states, times = list(files.tables["grid.csv"].numbers(GRID)), files.scene.exact.grid
    bounds = [files.manifest.bound("grid", name) for name in GRID]
    last, most = _spreads(files, states, times)
    ctx = context(prec + GUARD_BITS)
    starts = (_completed(files, state, ctx) for state in states[:-1])
    restarts = ((start, (Fraction(0), b - a)) for start, (a, b) in zip(starts, pairwise(times), strict=True))
    runs = runs_from(files.scene.exact, prec, restarts, seek)
    found: list[tuple[Fraction, int, dict[str, Fraction], Array]] = []
    for i, run in enumerate(runs):
        for j, name in enumerate(GRID):
            off = abs(run.grid.exact(name)[-1] - states[i + 1][j])
            if off > bounds[j] + Fraction(last[i, j] * SLACK):
                where = f"grid.csv: t = {float(times[i + 1]):.17g}: {name} is off by {float(off):.2g}"
                yield f"{where} from where the row before leads to, its bound is {float(bounds[j]):.2g}"
        found += [(times[i] + t, direction, zero, most[i]) for t, direction, zero in _zeros(run)]
    if seek:
        yield from _transits(files, found, times)


def _spreads(files: Files, states: list[list[Fraction]], times: list[Fraction]) -> tuple[Array, Array]:
    """Return the errors that the bounds on each row spread to by the next row, and the largest until then."""
    rows = np.array([[float(value) for value in state] for state in states[:-1]])
    bounds = np.array([float(files.manifest.bound("grid", name)) for name in GRID])
    last: list[Array] = []
    most: list[Array] = []
    at = 0
    for span, group in groupby(float(b - a) for a, b in pairwise(times)):
        count = len(list(group))
        for first in range(at, at + count, BLOCK):
            block = rows[first : min(first + BLOCK, at + count)]
            for part, spread in zip((last, most), spreads(files.scene.exact, block, bounds, span), strict=True):
                part.append(spread)
        at += count
    return np.concatenate(last), np.concatenate(most)


def _completed(files: Files, state: list[Fraction], ctx: Any) -> list[Fraction]:
    """Return a state with z and vz as they follow from the others, where they follow well."""
    length = files.scene.exact.length
    x, y, z, vx, vy = state[:5]
    if not deep(z, length):
        return state
    z = depth(x, y, length, 1 if z > 0 else -1, lambda square: to_fraction(ctx.sqrt(to_mpf(square, ctx))))
    return [x, y, z, vx, vy, vertical_velocity(x, y, z, vx, vy)]


def _zeros(run: Run) -> Iterator[tuple[Fraction, int, dict[str, Fraction]]]:
    """Yield time, direction and numbers of each zero of xdot."""
    if run.transits is not None:
        columns = {name: run.transits.exact(name) for name in TRANSITS}
        for i, direction in enumerate(run.directions):
            yield columns["t"][i], direction, {name: column[i] for name, column in columns.items()}


def _transits(
    files: Files, found: list[tuple[Fraction, int, dict[str, Fraction], Array]], times: list[Fraction]
) -> Iterator[str]:
    """Compare the zeros found with the transits; one near a row may be found on both sides of it, or on neither."""
    sheet, k = files.tables["transits.csv"], constants(files.scene.exact, context(GUARD_BITS)).converted(float)
    printed = list(sheet.numbers(("t", "direction", "x", "y", "z", "vy", "bound")))
    edges, place = np.array([float(t) for t in times]), 0
    for t, direction, zero, spread in found:
        n = tuple(float(zero[name]) / k.length for name in POSITION)
        v = (0.0, float(zero["vy"]) / k.length, -n[1] * float(zero["vy"]) / k.length / n[2] if n[2] else 0.0)
        rates = [abs(rate) * k.length for rate in (*v, *acceleration(n, v, k))]
        late = SLACK * spread[3] / rates[3] if rates[3] else np.inf
        near_row = bool(np.min(np.abs(edges - float(t))) <= late)
        if place and near_row and abs(printed[place - 1][0] - t) <= Fraction(late) + printed[place - 1][-1]:
            continue  # found from the row before as well
        if place == len(printed) or abs(printed[place][0] - t) > Fraction(late) + printed[place][-1]:
            if not near_row:
                yield f"transits.csv: there is a transit at t = {float(t):.17g}, transit {place + 1} is another or none"
                return
            continue
        row = printed[place]
        place += 1
        if row[1] != direction:
            yield f"transits.csv: transit {place}: its direction is {direction:+d}"
        for name, number, j in zip(("x", "y", "z", "vy"), row[2:6], (0, 1, 2, 4), strict=True):
            off = abs(number - zero[name])  # ax follows from these: see `physics`
            if off > files.manifest.bound("transits", name) + Fraction(SLACK * (spread[j] + rates[j] * late)):
                yield f"transits.csv: transit {place}: {name} is off by {float(off):.2g}"
    if place < len(printed):
        yield f"transits.csv: transit {place + 1} at t = {float(printed[place][0]):.17g} s is none of the motion's"
