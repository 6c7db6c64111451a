"""TRUSTED. The ends of a box of inputs; the files of ranges, read back and compared with what was proved."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ...scenes.inputs import Inputs
from .balls import demand
from .course import FINISHED
from .printed import DECIMAL, PLAIN, RELEASES, asked, document, lines_of, single_and_other
from .shapes import XDOT, Interval, ProvedBox

GRID, TRANSITS = ("x", "y", "z", "vx", "vy", "vz"), ("t", "x", "y", "z", "vy", "ax")
PASSAGES = ("t", *GRID)


def check_ranges(texts: Mapping[str, str], proved: ProvedBox) -> None:
    """Demand that ranges.json and both tables state what was proved, or less, and of just this box."""
    said = document(texts["ranges.json"])
    found = proved.zeros.get(XDOT, ())
    sections = {word: zeros for word, zeros in proved.zeros.items() if word != XDOT}
    inputs, times = asked(said)
    ends = (end_of(inputs, said["uncertain"], side) for side in (-1, 1))
    demand(
        proved in FINISHED and (inputs, *ends) == proved.box and times == proved.times,
        "the proof is of other inputs",
    )
    demand(said["level"] == said["scene"]["run"]["level"] == "enclosed", "misprint: the level")
    check_rows(
        texts["grid.csv"], ["t"], GRID, ([t, *x] for t, x in zip(times, proved.states, strict=True))
    )
    # a table without transits is not one of which none was looked for
    looked_for = XDOT in proved.zeros or proved.still
    demand(
        (said["scene"]["run"]["transits"] == "true") == looked_for,
        "misprint: whether transits were looked for",
    )
    ones, others = check_zeros(texts["transits.csv"], TRANSITS, found, said["possible"], times[-1])
    words = [*sections]
    header, *parts = lines_of(texts["sections.csv"]) if words else [["section"]]
    right = header[0] == "section" and sorted(parts, key=lambda part: words.index(part[0])) == parts
    demand(right and [*said.get("sections", {})] == words, "misprint: other sections")
    for word, zeros in sections.items():
        own = [header, *(part for part in parts if part[0] == word)]
        text = "".join(",".join(line[1:]) + "\n" for line in own)
        check_zeros(text, PASSAGES, zeros, said["sections"][word], times[-1])
    if said["period_s"] is not None:
        sure = [z for z in ones if all(z.t.high < x.t.low for x in others)]
        swings = (len(sure) - 1) // 2
        demand(swings > 0, "misprint: a period where transits are undecided")
        first, last = sure[0].t, sure[2 * swings].t
        mean = Interval((last.low - first.high) / swings, (last.high - first.low) / swings)
        low, high = said["period_s"]
        demand(holds(low, high, mean), "misprint: the period")
    counts = {"grid": len(times), "transits": len(ones), "possible": len(others)}
    demand(said["counts"] == counts, "misprint: the counts")


def check_zeros(
    text: str, names: tuple[str, ...], found: Any, possible: Any, end: Fraction
) -> tuple[Any, Any]:
    """Demand that a table has the single zeros, and that the possible ones are listed; return both."""
    ones, others = single_and_other(found)
    rows = ([k, z.direction, *(getattr(z, name) for name in names)] for k, z in enumerate(ones, 1))
    check_rows(text, ["k", "direction"], names, rows)
    for z, part in zip(others, possible, strict=True):
        until = Interval(max(z.t.low, Fraction(0)), min(z.t.high, end))
        demand(
            holds(part["from_s"], part["to_s"], until) and part["parity"] == z.parity,
            "misprint: a possible zero",
        )
    return ones, others


def end_of(inputs: Inputs, uncertain: Mapping[str, str], side: int) -> Inputs:
    """Return inputs with half of a width added to each that is uncertain, or taken from it with `side` -1."""
    off = {
        name.partition(".")[2]: side * Fraction(width.removeprefix("±"))
        for name, width in uncertain.items()
    }
    kind = "position" if inputs.position else "angles"
    release = zip(RELEASES[kind], getattr(inputs, kind), strict=True)
    changes: dict[str, Any] = {kind: tuple(value + off.pop(name, 0) for name, value in release)}
    if "inverse_flattening" in off:
        changes["flattening"] = 1 / (1 / inputs.flattening + off.pop("inverse_flattening"))
    demand(off.keys() <= {*PLAIN.split()[:-2]}, "misprint: unknown inputs")
    return replace(
        inputs, **changes, **{name: getattr(inputs, name) + half for name, half in off.items()}
    )


def check_rows(
    text: str, plain: list[str], names: tuple[str, ...], rows: Iterable[list[Any]]
) -> None:
    """Demand that a table has these rows: exact numbers, then intervals within those that are printed."""
    header, *lines = lines_of(text)
    demand(
        header == [*plain, *(f"{name}_{end}" for name in names for end in ("low", "high"))],
        "misprint: the header",
    )
    for cells, row in zip(lines, rows, strict=True):
        exact, ends = cells[: len(plain)], cells[len(plain) :]
        right = DECIMAL.issuperset("".join(exact)) and [*map(Fraction, exact)] == row[: len(plain)]
        demand(right, f"misprint: {exact}")
        for low, high, x in zip(ends[::2], ends[1::2], row[len(plain) :], strict=True):
            demand(holds(low, high, x), f"misprint: {low} to {high}")


def holds(low: str, high: str, x: Interval) -> bool:
    """Return whether two decimals enclose an interval."""
    demand(DECIMAL.issuperset(low + high), f"misprint: {low} to {high}")
    return Fraction(low) <= x.low <= x.high <= Fraction(high)
