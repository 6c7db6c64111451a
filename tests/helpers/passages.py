"""Passages of sections by another code: the equations of `enclosure_oracle`, scipy's DOP853, Brent's method."""

from __future__ import annotations

import mpmath as mp
import numpy as np
from enclosure_oracle import constants, doubles, truth
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

PER_SWING = 300  # samples between which a sign is looked for
WAYS = {"highest": -1, "lowest": 1}


def plumb(inputs):
    """The pull at the pivot, and the rest position in m, by the equations' force alone."""
    s, c, R, length, g, om, _ = constants(inputs)
    at = lambda x, y, z: (om * om * x, -om * om * s * (R - s * y + c * z), -g + om * om * c * (R - s * y + c * z))  # noqa: E731
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
        rates, (0, end), first, method="DOP853", rtol=1e-13, atol=1e-13 * max(map(abs, first)), dense_output=True
    )
    times = np.linspace(0, end, int(PER_SWING * max(end / swing, 5)))
    states, passages = run.sol(times), {}
    for word in words:
        a, b, d = ([float(x) for x in p] if isinstance(p, tuple) else float(p) for p in form(inputs, word))
        at = lambda t: float(np.dot([*a, *b], run.sol(t)) - d)  # noqa: B023, E731
        values = np.dot([*a, *b], states) - d
        zeros = []
        for i in range(1, len(times) - 1):
            low, high = values[i], values[i + 1]
            if low * high < 0:
                zeros.append((brentq(at, times[i], times[i + 1], xtol=1e-15), int(np.sign(high))))
            elif (
                i > 1 and values[i - 1] * low > 0 and abs(low) < min(abs(values[i - 1]), abs(high))
            ):  # a dip, which may hold a close pair
                side = np.sign(low)
                dip = minimize_scalar(lambda t: side * at(t), bounds=(times[i - 1], times[i + 1]), method="bounded")  # noqa: B023
                if dip.fun < 0:
                    ends = (times[i - 1], dip.x, times[i + 1])
                    for k, way in enumerate((-side, side)):
                        zeros.append((brentq(at, ends[k], ends[k + 1], xtol=1e-15), int(way)))
        way = WAYS.get(word)
        passages[word] = [zero for zero in zeros if way in (None, zero[1])]
    return passages


def outside(inputs, word, times, bounds, states):
    """Return the passages whose true time, by heyoka in the plain form at 400 bits, is not within its bound.

    `times` and `bounds` are exact; `states` are rows of pairs (value, bound) for x to vz, at the passage.
    """
    if not times:
        return []
    with mp.workprec(400):
        parts, wrong = form(inputs, word), []
        pars = constants(inputs)
        order = sorted(range(len(times)), key=lambda i: times[i])
        for i, state in zip(order, truth(inputs, [times[i] for i in order]), strict=True):
            numbers = [mp.mpf(x.numerator) / x.denominator for x in state]
            from enclosure_oracle import acceleration

            rate = value((*parts[:2], 0), [*numbers[3:], *acceleration(pars, numbers)])
            late = -value(parts, numbers) / rate
            bound = mp.mpf(bounds[i].numerator) / bounds[i].denominator
            if abs(late) > bound * (1 + mp.mpf(10) ** -3):
                wrong.append((word, "t", i, float(late), float(bound)))
            moved = [x + late * v for x, v in zip(numbers, [*numbers[3:], *acceleration(pars, numbers)], strict=True)]
            for x, (q, e) in zip(moved, states[i], strict=True):
                if abs(x - mp.mpf(q.numerator) / q.denominator) > mp.mpf(e.numerator) / e.denominator * (
                    1 + mp.mpf(10) ** -3
                ):
                    wrong.append((word, "state", i))
        return wrong


def rows_of(table):
    """Return times, their bounds and the states with theirs, of a table of passages."""
    columns = [
        list(zip(table.exact(name), table.bound(name), strict=True)) for name in ("x", "y", "z", "vx", "vy", "vz")
    ]
    return table.exact("t"), table.bound("t"), list(zip(*columns, strict=True))
