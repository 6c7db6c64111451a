"""TRUSTED. The ends of a box of inputs; the files of ranges, read back and compared with what was proved.

As in section 9 of THEOREM.md for a point, here for a box (section 11): each printed interval has to contain the proven
one. A row of a table is a dictionary by column: exact numbers, and the intervals that were proved.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ...scenes.inputs import Inputs
from .balls import demand
from .course import FINISHED
from .printed import (
    DECIMAL,
    PLAIN,
    RELEASES,
    Row,
    SortedZeros,
    asked,
    document,
    lines_of,
    sorted_zeros,
    without_words,
)
from .shapes import XDOT, Interval, ProvedBox

GRID = ("x", "y", "z", "vx", "vy", "vz")
TRANSITS = ("t", "x", "y", "z", "vy", "ax")
PASSAGES = ("t", *GRID)
NUMBERED = ("k", "direction")  # the exact columns of a table of zeros


def check_ranges(texts: Mapping[str, str], proved: ProvedBox) -> None:
    """Demand that ranges.json and both tables state what was proved, or less, and of just this box."""
    stated = document(texts["ranges.json"])
    inputs, times = asked(stated)
    low = end_of(inputs, stated["uncertain"], -1)
    high = end_of(inputs, stated["uncertain"], 1)
    demand(
        proved in FINISHED and (inputs, low, high) == proved.box and times == proved.times,
        "the proof is of other inputs",
    )
    run = stated["scene"]["run"]
    demand(stated["level"] == run["level"] == "enclosed", "misprint: the level")
    # a table without transits is not one of which none was looked for
    looked_for = XDOT in proved.zeros or proved.still
    demand(
        (run["transits"] == "true") == looked_for,
        "misprint: whether transits were looked for",
    )

    states = [
        {"t": time} | dict(zip(GRID, state, strict=True))
        for time, state in zip(times, proved.states, strict=True)
    ]
    _check_rows(texts["grid.csv"], ["t"], GRID, states)
    transits = sorted_zeros(proved.zeros.get(XDOT, ()))
    _check_zeros(texts["transits.csv"], TRANSITS, transits, stated["possible"], times[-1])
    _check_sections(texts, stated, proved)

    if stated["period_s"] is not None:
        period = _mean_period(transits)
        low_s, high_s = stated["period_s"]
        demand(_holds(low_s, high_s, period), "misprint: the period")
    counts = {
        "grid": len(times),
        "transits": len(transits.single),
        "possible": len(transits.possible),
    }
    demand(stated["counts"] == counts, "misprint: the counts")


def _check_sections(texts: Mapping[str, str], stated: Any, proved: ProvedBox) -> None:
    """Demand that the table of passages has those of just these sections, in their order."""
    sections = {word: zeros for word, zeros in proved.zeros.items() if word != XDOT}
    words = [*sections]
    requested = stated["scene"]["run"].get("sections", "")
    demand(
        [*stated.get("sections", {})] == words and "; ".join(words) == requested,
        "misprint: other sections",
    )
    if not sections:
        return
    header, *lines = lines_of(texts["sections.csv"])
    in_order = sorted(lines, key=lambda line: words.index(line[0])) == lines
    demand(header[0] == "section" and in_order, "misprint: other sections")

    for word, zeros in sections.items():
        text = without_words(header, [line for line in lines if line[0] == word])
        _check_zeros(
            text, PASSAGES, sorted_zeros(zeros), stated["sections"][word], proved.times[-1]
        )


def _mean_period(transits: SortedZeros) -> Interval:
    """Return the mean of the full swings before the first possible transit."""
    certain = [
        zero
        for zero in transits.single
        if all(zero.t.high < other.t.low for other in transits.possible)
    ]
    swings = (len(certain) - 1) // 2
    demand(swings > 0, "misprint: a period where transits are undecided")
    first = certain[0].t
    last = certain[2 * swings].t
    return Interval((last.low - first.high) / swings, (last.high - first.low) / swings)


def _check_zeros(
    text: str, names: tuple[str, ...], zeros: SortedZeros, stated: Any, end: Fraction
) -> None:
    """Demand that a table has the single zeros, and that the possible ones are listed, up to the end."""
    rows = [
        {"k": k, "direction": zero.direction} | {name: getattr(zero, name) for name in names}
        for k, zero in enumerate(zeros.single, 1)
    ]
    _check_rows(text, [*NUMBERED], names, rows)
    for zero, part in zip(zeros.possible, stated, strict=True):
        until = Interval(max(zero.t.low, Fraction(0)), min(zero.t.high, end))
        inside = _holds(part["from_s"], part["to_s"], until)  # (9.4)
        demand(inside and part["parity"] == zero.parity, "misprint: a possible zero")


def end_of(inputs: Inputs, uncertain: Mapping[str, str], side: int) -> Inputs:
    """Return inputs with half of a width added to each that is uncertain, or taken from it with `side` -1."""
    shifts = {}
    for name, text in uncertain.items():
        half_width = Fraction(text.removeprefix("±"))
        # Lemma 12.4 takes every δ >= 0: a box must not be turned inside out
        demand(half_width >= 0, "misprint: a negative width")
        shifts[name.partition(".")[2]] = side * half_width
    kind = "position" if inputs.position else "angles"
    release = zip(RELEASES[kind], getattr(inputs, kind), strict=True)
    changes: dict[str, Any] = {kind: tuple(q + shifts.pop(name, 0) for name, q in release)}
    if "inverse_flattening" in shifts:
        changes["flattening"] = 1 / (1 / inputs.flattening + shifts.pop("inverse_flattening"))

    # the times of a run are no inputs of the motion
    *plain, _, _ = PLAIN.split()
    demand(shifts.keys() <= {*plain}, "misprint: unknown inputs")
    for name, shift in shifts.items():
        changes[name] = getattr(inputs, name) + shift
    return replace(inputs, **changes)


def _check_rows(text: str, exact: list[str], names: Sequence[str], rows: Iterable[Row]) -> None:
    """Demand that a table has these rows: exact numbers, then intervals within those that are printed."""
    header, *lines = lines_of(text)
    ends = [f"{name}_{end}" for name in names for end in ("low", "high")]
    demand(header == [*exact, *ends], "misprint: the header")
    for line, row in zip(lines, rows, strict=True):
        cells = dict(zip(header, line, strict=True))
        for name in exact:
            right = DECIMAL.issuperset(cells[name]) and Fraction(cells[name]) == row[name]
            demand(right, f"misprint: {cells[name]}")
        for name in names:
            low = cells[f"{name}_low"]
            high = cells[f"{name}_high"]
            demand(_holds(low, high, row[name]), f"misprint: {low} to {high}")


def _holds(low: str, high: str, x: Interval) -> bool:
    """Return whether two decimals enclose an interval."""
    demand(DECIMAL.issuperset(low + high), f"misprint: {low} to {high}")
    return Fraction(low) <= x.low <= x.high <= Fraction(high)
