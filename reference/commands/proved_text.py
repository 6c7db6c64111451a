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
    yield from _interval_lines(ranges)
    yield from _limit_lines(ranges)
    yield from _derivative_lines(ranges)
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
            TextColumn(["proved", f"over {ranges['over_s']} s"], intervals, is_number=False),
        ]
        if any(estimates):
            over = f"over {ranges['estimated_over_s']} s"
            columns.append(TextColumn(["estimate", over], estimates, is_number=False))
        yield from table(columns)
    missing = [*_missing_means(ranges), *_missing_passages(ranges)]
    if missing:
        if rows:
            yield ""
        yield from facts(missing)
    if ranges.get("useless"):
        yield ""
        yield from paragraph(
            "useless: the interval contains every precession that the rotation of the site can cause, in either "
            "direction. The proof takes the errors of the first and the last highest point as independent; in one "
            "pendulum they are correlated.",
            "  ",
        )


def _missing_means(ranges: dict[str, Any]) -> Iterator[Fact]:
    """Yield why period, precession and full turn, or estimates of them, are left out."""
    if "no_estimate" in ranges:
        yield "no estimate", ranges["no_estimate"]
    if "reason" in ranges:  # nothing is proved
        return
    is_open = not any(ranges[name] for name in ("period_s", "precession_deg_per_h", "full_turn_h"))
    # without an estimate there may be no period at all
    if is_open and "no_estimate" not in ranges:
        yield "no period", _NO_PERIOD
    yield from left_out_facts(ranges["left_out"])


def _mean_rows(ranges: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield period, precession and full turn, each proved and as an estimate."""
    estimates = ranges["first_order"]
    for name, (label, unit) in QUANTITIES.items():
        interval = ranges.get(name)
        estimate = _interval(estimates.get(name), unit)
        if interval is None and not estimate:
            continue
        proved = _interval(interval, unit) or "not decided"
        if name in ranges.get("useless", ()):
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
    if "reason" in ranges:  # nothing is proved
        return
    first = {XDOT: ranges["first_transits_s"], **ranges["first_passages_s"]}
    for word, intervals in first.items():
        for number, interval in enumerate(intervals, 1):
            yield passage_name(word, number), _interval(interval, "s"), ""


def _missing_passages(ranges: dict[str, Any]) -> Iterator[Fact]:
    """Yield passages without an interval, and why; and sections of which none is decided."""
    for passage in ranges["passages"]:
        if "reason" in passage:
            yield passage_name(passage["section"], passage["number"]), _unproved(passage)
    for word, intervals in ranges.get("first_passages_s", {}).items():
        if not intervals:
            yield word, "no passage is decided"


def _unproved(passage: dict[str, Any]) -> str:
    """Return the estimated time of a passage that is not proved, if there is one, and the reason."""
    if "estimate_s" not in passage:
        return str(passage["reason"])
    return f"near {passage['estimate_s']:.6g} s, not proved: {passage['reason']}"


def _limit_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield how far each input alone moves the period, the largest share first; nothing without estimates."""
    if "no_estimate" in ranges:
        return
    limits = _by_share(ranges)
    widths = [f"{ranges['uncertain'][name]} {unit_of(name)}" for name in limits]
    moves = [_moved(limit) for limit in limits.values()]
    shares = [f"{100 * limit['share']:.1f} %" for limit in limits.values()]
    yield ""
    yield from paragraph(
        f"Which input limits the period over {ranges['estimated_over_s']} s (estimates, from the motions "
        "with each input at both ends of its width):",
        "  ",
    )
    yield from table(
        [
            TextColumn(["input"], list(limits), is_number=False),
            TextColumn(["half-width"], widths, is_number=False),
            TextColumn(["moves it by"], moves),
            TextColumn(["share"], shares),
        ],
        indent="    ",
    )


def _by_share(ranges: dict[str, Any]) -> dict[str, Any]:
    """Return what is known of each input, the largest share of the period first."""
    return dict(sorted(ranges["limits"].items(), key=lambda item: -(item[1]["share"] or 0)))


def _moved(limit: dict[str, Any]) -> str:
    """Return how far an input moves the period, or below what, where the error leaves no digit."""
    size_s = float(limit["moves_period_s"])
    error_s = float(limit["moves_period_error_s"])
    if size_s < 10 * error_s:
        return f"< {size_s + error_s:.1g} s"
    return f"{size_s:.2g} s"


def _derivative_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield the derivatives of period and precession, as intervals; nothing where none is proved."""
    limits = _by_share(ranges)
    if not any(limit["s_per_unit"] or limit["deg_per_h_per_unit"] for limit in limits.values()):
        return
    units = [unit_of(name).replace("degrees", "degree") or "1" for name in limits]
    periods = [" to ".join(limit["s_per_unit"] or ["–"]) for limit in limits.values()]
    turns = [" to ".join(limit["deg_per_h_per_unit"] or ["–"]) for limit in limits.values()]
    yield ""
    yield from paragraph(
        f"Derivatives to the inputs over {ranges['derivatives_over_s']} s, proved close to their values:",
        "  ",
    )
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
    asked_s = ranges["asked_s"]
    yield from paragraph(
        f"These inputs are too uncertain for a proof over all {asked_s} s. "
        "If one of them were known ten times as well:",
        "  ",
    )
    results = [_rounded(row["holds_s"]) for row in narrowing["alone"]]
    yield from _alone_table(narrowing, "proved to", results)
    yield ""
    enough = narrowing["enough"]
    if enough:
        text = f"To prove all {asked_s} s, narrow {_widths(enough)}."
    else:
        reach = _rounded(narrowing["narrowest_holds_s"])
        text = f"{_NOT_EVEN} the proof ends at {reach}, before {asked_s} s."
    if float(ranges["over_s"]) > 0:
        text += f" With the widths as they are, choose run.t_end = {ranges['over_s']}."
    yield from paragraph(text, "  ")


def _rounded(time_s: float) -> str:
    return f"{time_s:.4g} s"


def _passage_lines(ranges: dict[str, Any], name: str, narrowing: dict[str, Any]) -> Iterator[str]:
    """Yield which inputs limit the time of a passage, and what suffices for the width wanted."""
    word, _, number = name.rpartition(" ")
    called = passage_name(word, int(number)).capitalize()
    half_width_s = narrowing["half_width_s"]
    state = "not proved" if half_width_s is None else f"proved to ±{half_width_s:.2g} s"
    yield from paragraph(
        f"{called} is {state}. If one input were known ten times as well:",
        "  ",
    )
    results = [_half_width(row) for row in narrowing["alone"]]
    yield from _alone_table(narrowing, "proved to", results)
    if "enough" not in narrowing:
        return
    (passage,) = [
        passage
        for passage in ranges["passages"]
        if (passage["section"], str(passage["number"])) == (word, number)
    ]
    wanted = f" to ±{passage['wanted_s']} s" if "wanted_s" in passage else ""
    yield ""
    enough = narrowing["enough"]
    if enough is None:
        text = f"{_NOT_EVEN} it is not proved{wanted}."
    elif enough:
        text = f"To prove it{wanted}, narrow {_widths(enough)}."
    else:
        text = f"That is within the ±{passage['wanted_s']} s wanted."
    yield from paragraph(text, "  ")


def _half_width(row: dict[str, Any]) -> str:
    """Return to what a passage is proved with a narrower input, or where the proof ends before it."""
    if row["half_width_s"] is None:
        return f"not at all, the proof ends at {_rounded(row['holds_s'])}"
    return f"±{row['half_width_s']:.2g} s"


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
