"""Passages of sections by another code: the equations of `enclosure_oracle`, scipy's DOP853, Brent's method."""

from __future__ import annotations

import mpmath as mp
import numpy as np
from enclosure_oracle import acceleration, constants, doubles, truth
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

PER_SWING = 300  # samples between which a sign is looked for
SOON = 1e-7  # of the run: the first of them, as a velocity is zero at rest
WAYS = {"highest": -1, "lowest": 1}
SLACK = 1 + 1e-3  # of bounds: a zero is found by one step of Newton's method


def plumb(inputs):
    """The pull at the pivot, and the rest position in m, by the equations' force alone."""
    s, c, R, length, g, om, _ = constants(inputs)

    def at(x, y, z):
        return (
            om * om * x,
            -om * om * s * (R - s * y + c * z),
            -g + om * om * c * (R - s * y + c * z),
        )

    pull, r = at(0, 0, 0), (mp.mpf(0), mp.mpf(0), -length)
    for _ in range(400):
        f = at(*r)
        size = mp.sqrt(sum(x * x for x in f))
        r = tuple(length * x / size for x in f)
    return pull, r


def form(inputs, word):
    """Return a, b, d of a·r + b·v - d, in m and m/s."""
    kind, _, azimuth = word.partition(" ")
    turn = mp.mpf(azimuth.removesuffix("@0") or 0) * mp.pi / 180
    along, none = (mp.cos(turn), mp.sin(turn), mp.mpf(0)), (mp.mpf(0),) * 3
    if kind == "turn":
        return none, along, mp.mpf(0)
    pull, rest = plumb(inputs)
    if kind != "gate":
        return none, tuple(-x for x in pull), mp.mpf(0)
    down = (0, 0, -1) if word.endswith("@0") else pull
    across = tuple(along[i] * down[j] - along[j] * down[i] for i, j in ((1, 2), (2, 0), (0, 1)))
    d = 0 if word.endswith("@0") else sum(x * y for x, y in zip(across, rest, strict=True))
    return across, none, d


def value(parts, state):
    """Return the form at a state."""
    a, b, d = parts
    return sum(x * y for x, y in zip((*a, *b), state, strict=True)) - d


def found(inputs, words, end):
    """Return of each section its passages in (0, end], each a time and a direction, by DOP853 and Brent's method."""
    rates, first = doubles(inputs)
    end, swing = float(end), 2 * np.pi * float(inputs.length / inputs.gravity) ** 0.5
    run = solve_ivp(
        rates,
        (0, end),
        first,
        method="DOP853",
        rtol=1e-13,
        atol=1e-13 * max(map(abs, first)),
        dense_output=True,
    )
    times = np.linspace(SOON * end, end, int(PER_SWING * max(end / swing, 5)))
    states, passages = run.sol(times), {}
    for word in words:
        a, b, d = (
            [float(x) for x in p] if isinstance(p, tuple) else float(p) for p in form(inputs, word)
        )
        at = lambda t: float(np.dot([*a, *b], run.sol(t)) - d)  # noqa: B023, E731
        values = np.dot([*a, *b], states) - d
        zeros = []
        for i in range(len(times) - 1):
            low, high = values[i], values[i + 1]
            if low * high < 0:
                zeros.append((brentq(at, times[i], times[i + 1], xtol=1e-15), int(np.sign(high))))
            elif (
                i and values[i - 1] * low > 0 and abs(low) < min(abs(values[i - 1]), abs(high))
            ):  # a dip, which may hold a close pair
                side = np.sign(low)
                dip = minimize_scalar(
                    lambda t, side=side, at=at: side * at(t),
                    bounds=(times[i - 1], times[i + 1]),
                    method="bounded",
                )
                if dip.fun < 0:
                    ends = (times[i - 1], dip.x, times[i + 1])
                    for k, way in enumerate((-side, side)):
                        zeros.append((brentq(at, ends[k], ends[k + 1], xtol=1e-15), int(way)))
        way = WAYS.get(word)
        passages[word] = [zero for zero in zeros if way in (None, zero[1])]
    return passages


def outside(inputs, tables):
    """Return the passages whose true time or state, by heyoka in the plain form at 400 bits, is not within its bound.

    `tables` are those of each section, by its word.
    """
    rows = [(word, *row) for word, table in tables.items() for row in rows_of(table)]
    if not rows:
        return []
    wrong, pars = [], None
    with mp.workprec(400):
        rows.sort(key=lambda row: row[1])
        pars, forms = constants(inputs), {word: form(inputs, word) for word in tables}
        for (word, _, bound, *state), true in zip(
            rows, truth(inputs, [row[1] for row in rows]), strict=True
        ):
            numbers, parts = list(map(number, true)), forms[word]
            rates = [*numbers[3:], *acceleration(pars, numbers)]
            late = -value(parts, numbers) / value((*parts[:2], 0), rates)
            if abs(late) > number(bound) * SLACK:
                wrong.append((word, "t", float(late), float(bound)))
            for x, rate, (q, e) in zip(numbers, rates, state, strict=True):
                if abs(x + late * rate - number(q)) > number(e) * SLACK:
                    wrong.append((word, "state"))
    return wrong


def number(x):
    """Return a fraction as mpmath's number."""
    return mp.mpf(x.numerator) / x.denominator


def rows_of(table):
    """Yield of each passage its time, the bound on that, and x to vz, each with its bound."""
    columns = [
        zip(table.exact(name), table.bound(name), strict=True)
        for name in ("x", "y", "z", "vx", "vy", "vz")
    ]
    for t, bound, *state in zip(table.exact("t"), table.bound("t"), *columns, strict=True):
        yield t, bound, *state
