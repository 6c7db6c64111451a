"""Ranges of `foucault show` for people: tables of estimates and proofs, and which input limits them.

Those of passages: `passages_text`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..numbers.zeros import XDOT
from ..scenes.scene import unit_of
from .layout import Fact, TextColumn, facts, paragraph, table
from .motion_text import QUANTITIES, left_out_facts
from .passages import passage_name
from .passages_text import (
    NOT_EVEN,
    PROOF_NEEDS,
    gate_hint,
    interval,
    limit_table,
    passage_limit_lines,
    passage_lines,
    passage_proof_lines,
    widths_in_words,
)

_NO_PERIOD = "the intervals of these inputs leave it open"
_TRANSIT = (
    "A transit is a turning point in x. For the lowest point or a light gate use --section, "
    "for other numbers --passage."
)


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
    """Return the heading of what holds for uncertain inputs."""
    if "reason" in ranges:
        return "Ranges: nothing is proved"
    if ranges["over_s"] == ranges["asked_s"]:
        return f"Ranges over {ranges['over_s']} s for all values of the uncertain inputs"
    return f"Ranges for all values of the uncertain inputs, proved to {ranges['over_s']} s only"


def ranges_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield what holds for all values of uncertain inputs, and which of them limits it.

    Estimates stand before proofs.
    """
    if ranges["passages"]:
        yield from passage_lines(ranges)
        yield ""
    yield from _interval_lines(ranges)
    if _has_estimates(ranges):
        yield ""
        yield from paragraph(_use(ranges), "  ")
    if ranges["passages"]:
        yield from passage_limit_lines(ranges)
    else:
        yield from _limit_lines(ranges)
        yield from _derivative_lines(ranges)
    for name, narrowing in ranges.get("narrowing", {}).items():
        yield ""
        if name == "run":
            yield from _run_lines(ranges, narrowing)
        else:
            yield from passage_proof_lines(ranges, name, narrowing)


def _has_estimates(ranges: dict[str, Any]) -> bool:
    """Return whether anything is estimated for uncertain inputs."""
    estimated = ["estimate_range_s" in passage for passage in ranges["passages"]]
    return bool(ranges["first_order"]) or any(estimated)


def _use(ranges: dict[str, Any]) -> str:
    """Return what estimates and proved intervals are, and which to use."""
    text = (
        "Use the estimates to decide what to measure. They add what each input alone changes, at both ends of its "
        "width: the worst case, in which all err in the worst direction at once."
    )
    if "reason" in ranges:
        return text
    if ranges["over_s"] != ranges["asked_s"]:
        text += f" They do not depend on the proof, which ends at {ranges['over_s']} s."
    return (
        f"{text} Use the proved intervals if nobody may doubt the result. They are wider, because a proof loses more "
        "than the inputs change."
    )


def _interval_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield the table of intervals, and what is left out of it."""
    rows = [*_mean_rows(ranges), *_first_rows(ranges)]
    if rows:
        names, estimates, intervals = zip(*rows, strict=True)
        columns = [TextColumn(["", ""], names, is_number=False)]
        if any(estimates):
            over = f"over {ranges['estimated_over_s']} s"
            columns.append(TextColumn(["estimate", over], estimates, is_number=False))
        if "reason" not in ranges:
            over = f"over {ranges['over_s']} s"
            columns.append(TextColumn(["proved", over], intervals, is_number=False))
        yield from table(columns)
    missing = [*_missing_means(ranges), *_missing_sections(ranges)]
    if missing:
        if rows:
            yield ""
        yield from facts(missing)
    if ranges.get("first_transits_s") and not ranges["passages"]:
        yield ""
        yield from paragraph(_TRANSIT, "  ")
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
        yield "no proved period", _NO_PERIOD
    yield from left_out_facts(ranges["left_out"])


def _mean_rows(ranges: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield period, precession and full turn, each as an estimate and proved."""
    estimates = ranges["first_order"]
    for name, (label, unit) in QUANTITIES.items():
        ends = ranges.get(name)
        estimate = interval(estimates.get(name), unit)
        if ends is None and not estimate:
            continue
        proved = interval(ends, unit) or "not decided"
        if name in ranges.get("useless", ()):
            proved = f"useless: {proved}"
        yield label, estimate, proved


def _first_rows(ranges: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the first transits and passages, which are proved, unless others were asked for."""
    if ranges["passages"] or "reason" in ranges:
        return
    first = {XDOT: ranges["first_transits_s"], **ranges["first_passages_s"]}
    for word, intervals in first.items():
        for number, ends in enumerate(intervals, 1):
            name = f"transit {number}" if word == XDOT else passage_name(word, number)
            yield name, "", interval(ends, "s")


def _missing_sections(ranges: dict[str, Any]) -> Iterator[Fact]:
    """Yield sections of which no passage is decided."""
    for word, intervals in ranges.get("first_passages_s", {}).items():
        if not intervals and not ranges["passages"]:
            yield word, f"no passage is decided{gate_hint(ranges, word)}"


def _limit_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield how far each input alone moves the period, the largest share first; nothing without estimates."""
    if "no_estimate" in ranges:
        return
    yield ""
    yield from paragraph(
        f"Which input limits the period over {ranges['estimated_over_s']} s, by estimate:", "  "
    )
    moves = ("moves_period_s", "moves_period_error_s")
    yield from limit_table(ranges["limits"], ranges["uncertain"], moves)


def _by_share(ranges: dict[str, Any]) -> dict[str, Any]:
    """Return what is known of each input, the largest share of the period first."""
    return dict(sorted(ranges["limits"].items(), key=lambda item: -(item[1]["share"] or 0)))


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
        f"{PROOF_NEEDS} these inputs are too uncertain for a proof over all {asked_s} s. "
        "If one of them were known ten times as well:",
        "  ",
    )
    rows = narrowing["alone"]
    widths = [f"{row['width']} {unit_of(row['input'])}" for row in rows]
    yield from table(
        [
            TextColumn(["input"], [row["input"] for row in rows], is_number=False),
            TextColumn(["half-width"], widths, is_number=False),
            TextColumn(["proved to"], [_rounded(row["holds_s"]) for row in rows]),
        ],
        indent="    ",
    )
    yield ""
    enough = narrowing["enough"]
    if enough:
        text = f"To prove all {asked_s} s, narrow {widths_in_words(enough)}."
    else:
        reach = _rounded(narrowing["narrowest_holds_s"])
        text = f"{NOT_EVEN} the proof ends at {reach}, before {asked_s} s."
        if _has_estimates(ranges):
            text += " The estimates still hold."
    if float(ranges["over_s"]) > 0:
        text += (
            f" With the widths as they are, choose run.t_end = {ranges['over_s']}. "
            "How far a proof reaches depends on run.t_end too: often a shorter run is proved further."
        )
    yield from paragraph(text, "  ")


def _rounded(time_s: float) -> str:
    return f"{time_s:.4g} s"
