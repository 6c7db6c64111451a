"""Proofs of `foucault show` for people: tables of intervals, and which input limits them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ..numbers.zeros import XDOT
from ..scenes.scene import unit_of
from .layout import Fact, TextColumn, facts, paragraph, table
from .motion_text import QUANTITIES, left_out_facts
from .passages import passage_name

_NO_PERIOD = "the intervals of these inputs leave it open"
_NOT_EVEN = "Even with all widths divided by 100"


def swing_lines(proved: dict[str, Any]) -> list[str]:
    """Return what is proved of the swing of a scene with exact inputs."""
    if "reason" in proved:
        return facts([("no period", proved["reason"])])
    pairs: list[Fact] = []
    for name, (label, unit) in QUANTITIES.items():
        if proved[name]:
            low, high = proved[name]
            # one below the other, the digits that hold can be seen
            pairs += [(label, f"{low} to"), ("", f"{high} {unit}")]
    return facts([*pairs, *left_out_facts(proved["left_out"])])


def ranges_title(ranges: dict[str, Any]) -> str:
    """Return the heading of what is proved for uncertain inputs."""
    if ranges["over_s"] == ranges["asked_s"]:
        return f"Ranges over {ranges['over_s']} s, proved for all values of the uncertain inputs"
    if "reason" in ranges:
        return "Ranges: nothing is proved"
    return f"Ranges, proved to {ranges['over_s']} s only, for all values of the uncertain inputs"


def ranges_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield what holds for all values of uncertain inputs, and which of them limits it."""
    if "reason" in ranges:
        yield from paragraph(f"{ranges['reason'].capitalize()}.", "  ")
    else:
        yield from _interval_lines(ranges)
    if ranges["limits"]:
        yield ""
        yield from _limit_lines(ranges)
    for name, narrowing in ranges.get("narrowing", {}).items():
        yield ""
        if name == "run":
            yield from _run_lines(ranges, narrowing)
        else:
            yield from _passage_lines(ranges, name, narrowing)


def _interval_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield the table of intervals, and what is left out of it."""
    rows = [*_mean_rows(ranges), *_passage_rows(ranges)]
    if rows:
        names, intervals, estimates = zip(*rows, strict=True)
        columns = [
            TextColumn(["", ""], names, is_number=False),
            TextColumn(["proved", ""], intervals, is_number=False),
        ]
        if any(estimates):
            over = f"(estimate, {ranges['asked_s']} s)"
            columns.append(TextColumn(["to first order", over], estimates, is_number=False))
        yield from table(columns)
    missing = [*left_out_facts(ranges["left_out"]), *_missing_passages(ranges)]
    if not any(ranges[name] for name in ("period_s", "precession_deg_per_h", "full_turn_h")):
        missing.insert(0, ("no period", _NO_PERIOD))
    if missing:
        yield ""
        yield from facts(missing)
    if ranges["useless"]:
        yield ""
        yield from paragraph(
            "useless: the interval contains every precession that the rotation of the site can cause, in either "
            "direction. The proof takes the errors of the first and the last highest point as independent; in one "
            "pendulum they are correlated.",
            "  ",
        )


def _mean_rows(ranges: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield period, precession and full turn, each proved and to first order."""
    estimates = ranges["first_order"]
    for name, (label, unit) in QUANTITIES.items():
        interval = ranges.get(name)
        estimate = _interval(estimates.get(name), unit)
        if interval is None and (name in ranges["left_out"] or not estimate):
            continue
        proved = _interval(interval, unit) or "not decided"
        if name in ranges["useless"]:
            proved = f"useless: {proved}"
        yield label, proved, estimate


def _interval(ends: Sequence[str] | None, unit: str) -> str:
    return f"{ends[0]} to {ends[1]} {unit}" if ends else ""


def _passage_rows(ranges: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the passages that were asked for, or else the first ones."""
    if ranges["passages"]:
        for passage in ranges["passages"]:
            if "t_s" in passage:
                proved = _interval(passage["t_s"], "s")
                if passage["useless"]:
                    proved = f"useless, wider than half a swing: {proved}"
                yield passage_name(passage["section"], passage["number"]), proved, ""
        return
    first = {XDOT: ranges["first_transits_s"], **ranges["first_passages_s"]}
    for word, intervals in first.items():
        for number, interval in enumerate(intervals, 1):
            yield passage_name(word, number), _interval(interval, "s"), ""


def _missing_passages(ranges: dict[str, Any]) -> Iterator[Fact]:
    """Yield passages without an interval, and why; and sections of which none is decided."""
    for passage in ranges["passages"]:
        if "reason" in passage:
            yield passage_name(passage["section"], passage["number"]), passage["reason"]
    for word, intervals in ranges["first_passages_s"].items():
        if not intervals:
            yield word, "no passage is decided"


def _limit_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield how far each input alone moves the period, the largest share first."""
    limits = dict(sorted(ranges["limits"].items(), key=lambda item: -item[1]["share"]))
    yield from paragraph("Which input limits the period, to first order:", "  ")
    widths = [f"{ranges['uncertain'][name]} {unit_of(name)}" for name in limits]
    moves = [f"{float(limit['moves_period_s']):.2g} s" for limit in limits.values()]
    shares = [f"{100 * limit['share']:.1f} %" for limit in limits.values()]
    yield from table(
        [
            TextColumn(["input"], list(limits), is_number=False),
            TextColumn(["half-width"], widths, is_number=False),
            TextColumn(["moves it by"], moves),
            TextColumn(["share"], shares),
        ],
        indent="    ",
    )
    yield ""
    yield from paragraph("Derivatives to the inputs, proved close to their values:", "  ")
    units = [unit_of(name).replace("degrees", "degree") or "1" for name in limits]
    periods = [" to ".join(limit["s_per_unit"]) for limit in limits.values()]
    turns = [" to ".join(limit["deg_per_h_per_unit"] or ["–"]) for limit in limits.values()]
    yield from table(
        [
            TextColumn(["input"], list(limits), is_number=False),
            TextColumn(["per"], units, is_number=False),
            TextColumn(["period, s"], periods),
            TextColumn(["precession, °/h"], turns),
        ],
        keys=2,
        indent="    ",
    )


def _run_lines(ranges: dict[str, Any], narrowing: dict[str, Any]) -> Iterator[str]:
    """Yield which inputs limit how far the proof goes, and what suffices for the whole run."""
    yield from paragraph(
        f"These inputs are too uncertain for a proof over all {ranges['asked_s']} s. "
        "If one of them were known ten times as well:",
        "  ",
    )
    results = [f"{row['holds_s']:.4g} s" for row in narrowing["alone"]]
    yield from _alone_table(narrowing, "proved to", results)
    yield ""
    enough = narrowing["enough"]
    if enough:
        text = f"To prove all {ranges['asked_s']} s, narrow {_widths(enough)}."
    else:
        text = f"{_NOT_EVEN} the proof ends before {ranges['asked_s']} s: make the run shorter (run.t_end)."
    yield from paragraph(text, "  ")


def _passage_lines(ranges: dict[str, Any], name: str, narrowing: dict[str, Any]) -> Iterator[str]:
    """Yield which inputs limit the time of a passage, and what suffices for the width wanted."""
    word, _, number = name.rpartition(" ")
    called = passage_name(word, int(number))
    yield from paragraph(
        f"{called.capitalize()} is proved to ±{narrowing['half_width_s']:.2g} s. "
        "If one input were known ten times as well:",
        "  ",
    )
    results = [f"±{row['half_width_s']:.2g} s" for row in narrowing["alone"]]
    yield from _alone_table(narrowing, "proved to", results)
    if "enough" not in narrowing:
        return
    (wanted,) = [
        passage["wanted_s"]
        for passage in ranges["passages"]
        if (passage["section"], str(passage["number"])) == (word, number)
    ]
    yield ""
    enough = narrowing["enough"]
    if enough is None:
        text = f"{_NOT_EVEN} it is not proved to ±{wanted} s."
    elif enough:
        text = f"To prove it to ±{wanted} s, narrow {_widths(enough)}."
    else:
        text = f"That is within the ±{wanted} s wanted."
    yield from paragraph(text, "  ")


def _alone_table(narrowing: dict[str, Any], head: str, results: Sequence[str]) -> list[str]:
    """Return the inputs, each with a tenth of its width, and what is proved with it."""
    rows = narrowing["alone"]
    widths = [f"{row['width']} {unit_of(row['input'])}" for row in rows]
    return table(
        [
            TextColumn(["input"], [row["input"] for row in rows], is_number=False),
            TextColumn(["half-width"], widths, is_number=False),
            TextColumn([head], results),
        ],
        indent="    ",
    )


def _widths(widths: dict[str, str]) -> str:
    """Return inputs with the widths that they need, in words."""
    texts = [f"{name} to {width} {unit_of(name)}".rstrip() for name, width in widths.items()]
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last
