"""Boxes of inputs, scenes drawn from them, and what limbs finds of these outside of what is proved for the box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from random import Random
from typing import Any

import mpmath as mp
from enclosure_oracle import scene
from passages import plumb

from reference.enclosure.prove_box import enclose_box
from reference.enclosure.trusted.shapes import Box, ProvedBox
from reference.engines.plan import Run
from reference.engines.registry import engines
from reference.engines.registry import run as limbs_run
from reference.numbers.columns import GRID
from reference.numbers.zeros import XDOT, columns_of
from reference.scenes.inputs import Inputs
from reference.solver.proof_steps import Feed

TRUTH_BITS = 133  # forty digits
WORDS = (XDOT, "highest", "gate 0", "turn 100")
ROUNDING = Fraction(1, 10**30)  # of such a run, in parts of the largest number
NAMES = {
    "position": ("x", "y", "vx", "vy"),
    "angles": ("angle", "azimuth", "angle_rate", "azimuth_rate"),
}
PLAIN = (
    "length",
    "drag",
    "latitude",
    "altitude",
    "gravity",
    "rotation_rate",
    "equatorial_radius",
    "flattening",
)
FAST = {"rotation_rate": "0.7", "equatorial_radius": "5"}

# scene, end in s, halves of widths
BOXES: dict[str, tuple[dict[str, Any], int | Fraction, dict[str, str]]] = {
    "paris": ({}, 300, {"length": "0.001", "gravity": "1e-5", "latitude": "0.001"}),
    "release": ({}, 200, {"x": "0.001", "y": "0.002", "vx": "0.0001", "vy": "0.0002"}),
    "damped": (
        {"length": "10", "drag": "0.01", "x": "0.5", "y": "0.1"},
        100,
        {"length": "0.001", "drag": "1e-4"},
    ),
    "only drag": ({"length": "10", "drag": "0.02", "x": "0.3", "y": "0.1"}, 60, {"drag": "0.001"}),
    "fast": (
        {"length": "3", "angles": ("70", "30", "20", "10"), **FAST},
        2,
        {
            "length": "1e-5",
            "gravity": "1e-5",
            "latitude": "1e-3",
            "rotation_rate": "1e-5",
            "angle": "1e-4",
        }
        | {"azimuth": "1e-4", "angle_rate": "1e-4", "azimuth_rate": "1e-4", "altitude": "1e-3"}
        | {"equatorial_radius": "1e-3", "flattening": "1e-5"},
    ),
    "fast and damped": (
        {"length": "3", "angles": ("20", "30", "20", "10"), "drag": "0.3", **FAST},
        5,
        {"length": "1e-4", "drag": "1e-5", "latitude": "1e-3", "rotation_rate": "1e-5"},
    ),
    "latitude alone": (
        {"rotation_rate": "0.02", "equatorial_radius": "1000"},
        100,
        {"latitude": "0.02"},
    ),
    "rate alone": (
        {"rotation_rate": "0.02", "equatorial_radius": "1000"},
        100,
        {"rotation_rate": "1e-5"},
    ),
    "equator": (
        {"latitude": "0", "rotation_rate": "0.01", "equatorial_radius": "99"},
        100,
        {"latitude": "0.05"},
    ),
    "wide": (
        {"length": "1", "angles": ("60", "30", "0", "0")},
        3,
        {"length": "1e-4", "angle": "1e-3", "gravity": "1e-4"},
    ),
    "very wide": (
        {"length": "1", "angles": ("110", "30", "0", "0")},
        3,
        {"length": "1e-8", "angle": "1e-7"},
    ),
    "pole": (
        {"latitude": "89.9", "x": "0", "y": "1"},
        100,
        {"length": "0.001", "gravity": "1e-4", "latitude": "0.05"},
    ),
    "along the meridian": (
        {"x": "0", "y": "0.5", "rotation_rate": "0.001"},
        60,
        {"length": "0.001", "latitude": "0.1"},
    ),
    "south": (
        {"latitude": "-33.3", "vx": "0.05"},
        100,
        {"length": "0.01", "vx": "1e-4", "latitude": "0.1"},
    ),
    "effective": (
        {"gravity_is": "effective", "x": "1", "y": "0"},
        100,
        {"gravity": "1e-3", "length": "0.01"},
    ),
    "effective, fast": (
        {"gravity_is": "effective", "x": "1", "y": "0.3", "rotation_rate": "0.01"},
        60,
        {"gravity": "1e-3", "latitude": "0.05"},
    ),
    "no turning": ({"rotation_rate": "0"}, 100, {"length": "0.01", "rotation_rate": "1e-5"}),
    # the rest position of each pendulum, through which its gate goes, is another one
    "turning table": (
        {
            "gravity_is": "effective",
            "length": "1",
            "x": "0.1",
            "y": "0",
            "vy": "0.5",
            "rotation_rate": "0.3",
        },
        Fraction(3, 250),
        {"rotation_rate": "0.03"},
    ),
    "turning table, all inputs": (
        {
            "length": "2",
            "x": "0.2",
            "y": "0.05",
            "vy": "0.3",
            "rotation_rate": "0.2",
            "equatorial_radius": "20",
        },
        2,
        {"rotation_rate": "1e-4", "latitude": "0.01", "length": "1e-4"},
    ),
    "1 mm": (
        {"length": "0.001", "x": "0.0001", "y": "0.00002"},
        1,
        {"length": "1e-8", "x": "1e-9"},
    ),
    "10 km": (
        {"length": "10000", "x": "100", "y": "50"},
        1000,
        {"length": "1", "gravity": "1e-4", "vy": "0.01"},
    ),
    # a transit may be later than the next one of another
    "late": ({"rotation_rate": "0", "x": "0.01", "y": "0.003"}, 400, {"length": "1.5"}),
    "tiny box": ({}, 100, {"length": "1e-25", "latitude": "1e-24"}),
}


def box_of(name: str) -> tuple[Box, list[Fraction]]:
    """Return a box by its name, and output times."""
    changes, end, widths = BOXES[name]
    inputs = replace(scene(**changes), t_end=Fraction(end))
    return widened(inputs, widths), [Fraction(end * k, 12) for k in range(13)]


def widened(inputs: Inputs, widths: dict[str, str]) -> Box:
    """Return the box about some inputs."""
    kind = "position" if inputs.position else "angles"
    ends = []
    for side in (-1, 1):
        off = {name: side * Fraction(text) for name, text in widths.items()}
        release = zip(NAMES[kind], getattr(inputs, kind), strict=True)
        changes: dict[str, Any] = {kind: tuple(value + off.get(name, 0) for name, value in release)}
        changes |= {name: getattr(inputs, name) + x for name, x in off.items() if name in PLAIN}
        ends.append(replace(inputs, **changes))
    return Box(inputs, *ends)


def proof_of(box: Box, times: list[Fraction], halves: dict[str, Fraction] | None = None) -> Any:
    """Return the `BoxEnclosure`, by limbs; with derivatives to the inputs whose half-widths are given."""

    def steps(bits: int, end: Fraction) -> Any:
        return Feed(box.inputs, (end,), "limbs", 1)(bits)

    return enclose_box(
        box, times, steps, halves=halves, derivatives=halves is not None, zeros=WORDS
    )


def inputs_of(box: Box) -> dict[str, Fraction]:
    """Return half of the width of every input, by its full name; the flattening's is to be 0."""
    kind = "position" if box.inputs.position else "angles"
    plain = [name for name in PLAIN if name != "flattening" and (name != "drag" or box.inputs.drag)]
    halves = {name: (getattr(box.high, name) - getattr(box.low, name)) / 2 for name in plain}
    release = zip(NAMES[kind], getattr(box.low, kind), getattr(box.high, kind), strict=True)
    halves |= {name: (high - low) / 2 for name, low, high in release}
    sections = {"length": "pendulum", "drag": "pendulum"} | dict.fromkeys(NAMES[kind], "release")
    full = {f"{sections.get(name, 'site')}.{name}": half for name, half in halves.items()}
    return full | {"site.inverse_flattening": Fraction(0)}


def moved(inputs: Inputs, name: str, off: Fraction) -> Inputs:
    """Return inputs with something added to one of them."""
    short = name.partition(".")[2]
    if short == "inverse_flattening":
        return replace(inputs, flattening=1 / (1 / inputs.flattening + off))
    kind = "position" if inputs.position else "angles"
    if short not in NAMES[kind]:
        return replace(inputs, **{short: getattr(inputs, short) + off})
    numbers = zip(NAMES[kind], getattr(inputs, kind), strict=True)
    return replace(
        inputs, **{kind: tuple(value + off * (other == short) for other, value in numbers)}
    )


def wrong_derivatives(found: Any, inputs: Inputs, name: str) -> list[str]:
    """Return which proven derivatives to an input a central difference of two runs of limbs contradicts."""
    value = getattr(inputs, name.partition(".")[2], None)
    off, j = Fraction(1, 10**12) * max(1, abs(value or 0)), found.names.index(name)
    up, down = (truth(moved(inputs, name, side * off), found.proved.times) for side in (1, -1))
    wrong = []

    def check(what: str, high: Fraction, low: Fraction, interval: Any) -> None:
        slope = (high - low) / (2 * off)
        # of the third derivative, too
        slack = ROUNDING * abs(slope) + Fraction(1, 10**20) * abs(slope)
        slack += Fraction(1, 10**24)  # of runs with forty digits, over twice `off`
        if not interval.low - slack <= slope <= interval.high + slack:
            wrong.append(
                f"{name}, {what}: {float(slope)} not in {float(interval.low)} to {float(interval.high)}"
            )

    for i, column in enumerate(GRID):
        pairs = zip(up.grid.exact(column), down.grid.exact(column), found.states, strict=True)
        for k, (high, low, row) in enumerate(pairs):
            check(f"{column} of row {k}", high, low, row[j][i])
    for word, every in found.zeros.items():
        points = [azimuths(run, word) for run in (up, down)]
        for z, led in zip(found.proved.zeros[word], every, strict=True):
            near = [
                [p for p in run if z.t.low - 1000 * off <= p[0] <= z.t.high + 1000 * off]
                for run in points
            ]
            if led.times and all(len(zeros) == 1 for zeros in near):
                (high, turned), (low, before) = near[0][0], near[1][0]
                check(f"{word} at {float(z.t.low)}", high, low, led.times[j])
                if led.azimuths:
                    turn = turned - before
                    turn -= 360 * round(turn / 360)
                    check(
                        f"azimuth of {word} at {float(z.t.low)}", turn, Fraction(0), led.azimuths[j]
                    )
    return wrong


def drawn(box: Box, rng: Random, corner: bool) -> Inputs:
    """Return inputs from a box, at a corner of it or from inside."""

    def pick(low: Fraction, high: Fraction) -> Fraction:
        return (
            rng.choice((low, high))
            if corner
            else low + (high - low) * Fraction(rng.randrange(1001), 1000)
        )

    kind = "position" if box.inputs.position else "angles"
    changes: dict[str, Any] = {
        name: pick(getattr(box.low, name), getattr(box.high, name)) for name in PLAIN
    }
    changes[kind] = tuple(map(pick, getattr(box.low, kind), getattr(box.high, kind)))
    return replace(box.inputs, **changes)


def truth(inputs: Inputs, times: Sequence[Fraction]) -> Run:
    """Return a run by limbs, with 40 digits."""
    limbs = engines()["limbs"]
    return limbs_run(limbs.plan(inputs, TRUTH_BITS, tuple(times), WORDS))


def rows_of(run: Run, word: str) -> list[tuple[Fraction, ...]]:
    """Return the zeros of a word in a run, by its columns: time, position and then others."""
    if word not in run.zeros:
        return []
    return [*zip(*map(run.zeros[word].table.exact, columns_of(word)), strict=True)]


def azimuths(run: Run, word: str = "highest") -> list[tuple[Fraction, Fraction]]:
    """Return the time of each zero of a word, and its azimuth about the run's own plumb line in degrees."""
    found = []
    with mp.workprec(TRUTH_BITS):
        (_, north, up), _ = plumb(run.plan.inputs)
        for t, *place in ((row[0], *row[1:4]) for row in rows_of(run, word)):
            x, y, z = (mp.mpf(q.numerator) / q.denominator for q in place)
            angle = mp.atan2((north * z - up * y) / mp.hypot(north, up), x) * 180 / mp.pi
            found.append((t, Fraction(int(angle * 2**120), 2**120)))
    return found


def outside(proved: ProvedBox, run: Run) -> list[str]:
    """Return what of a run contradicts what is proved: states, zeros that are lost, doubled or elsewhere."""
    found = []
    size = max(run.grid.largest().values())

    def check(what: str, value: Fraction, low: Fraction, high: Fraction) -> None:
        if not low - ROUNDING * size <= value <= high + ROUNDING * size:
            found.append(f"{what} {float(value)} not in [{float(low)}, {float(high)}]")

    for i, name in enumerate(GRID):
        for time, value, state in zip(
            proved.times, run.grid.exact(name), proved.states, strict=True
        ):
            check(f"{name} at {float(time)}:", value, state[i].low, state[i].high)
    for word, zeros in proved.zeros.items():
        columns, rows = columns_of(word), rows_of(run, word)
        directions = run.zeros[word].directions if rows else []
        # which zeros each row may be
        near = [
            [z for z in zeros if z.t.low - ROUNDING <= row[0] <= z.t.high + ROUNDING]
            for row in rows
        ]
        found += [
            f"{word} at {float(row[0])} is lost"
            for row, inside in zip(rows, near, strict=True)
            if not inside
        ]

        # each single zero has a row of its own, but for those that may come after the end
        unused = [*near]
        for z in zeros:
            if z.parity != "one":
                continue
            first = next((k for k, inside in enumerate(unused) if z in inside), None)
            if first is not None:
                unused = unused[first + 1 :]
            elif z.t.high < proved.times[-1]:
                found.append(f"no zero of {word} in {float(z.t.low)} to {float(z.t.high)}")

        # where all are single, rows are those in order, also where their intervals overlap
        if all(z.parity == "one" for z in zeros):
            near = [[z] for z in zeros[: len(rows)]]
            if len(rows) > len(zeros):
                found.append(f"{len(rows)} zeros of {word}, {len(zeros)} proved")
        for row, direction, possible in zip(rows, directions, near, strict=False):
            if [z.parity for z in possible] != ["one"]:
                continue
            for name, value in zip(columns, row, strict=True):
                interval = getattr(possible[0], name)
                check(f"{name} of {word}:", value, interval.low, interval.high)
            if direction != possible[0].direction:
                found.append(f"direction of {word} at {float(row[0])}")
    return found


def widths_over_hulls(proved: ProvedBox, runs: Sequence[Run]) -> dict[str, float]:
    """Return the largest width of each column, over the largest hull of it that runs have."""
    ratios = {}
    for i, name in enumerate(GRID):
        columns = list(zip(*(run.grid.exact(name) for run in runs), strict=True))
        hull = max(max(values) - min(values) for values in columns)
        ratios[name] = (
            float(max(state[i].high - state[i].low for state in proved.states[1:]) / hull)
            if hull
            else 0.0
        )
    return ratios


def ordered(proved: ProvedBox) -> bool:
    """Return whether the zeros of each word follow each other."""
    pairs = (pair for zeros in proved.zeros.values() for pair in pairwise(zeros))
    return all(a.t.low <= b.t.low and a.t.high <= b.t.high for a, b in pairs)


def check_runs(name: str, box: Box, proved: ProvedBox, count: int) -> None:
    """Hold runs that are drawn from a box against what is proved for it, and print how wide that is."""
    rng = Random(name)
    assert any(proved.zeros.values()), "nothing is claimed"
    assert ordered(proved)
    runs = [truth(drawn(box, rng, corner=k % 2 == 0), proved.times) for k in range(count)]
    for run in runs:
        assert outside(proved, run) == []
    ratios = widths_over_hulls(proved, runs)
    counts = ", ".join(f"{len(zeros)} of {word}" for word, zeros in proved.zeros.items())
    print(f"\n{name}: {len(runs)} runs; zeros: {counts}; widths over hulls", end=" ")
    print(", ".join(f"{column} {ratio:.2f}" for column, ratio in ratios.items()))
