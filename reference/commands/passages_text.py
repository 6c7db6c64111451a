"""Passages of `foucault show` for people if inputs are uncertain: estimates, what to measure, and proofs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..errors import in_words
from ..scenes.scene import unit_of
from .layout import Fact, TextColumn, enumerated, facts, paragraph, table
from .passages import LOWEST, passage_name

NOT_EVEN = "Even with all widths divided by 100"
PROOF_NEEDS = "Only if you need a proof, which loses more than the inputs change:"


def passage_lines(ranges: dict[str, Any]) -> list[str]:
    """Return when the passages come that were asked for: first the estimates, then what is proved."""
    pairs: list[Fact] = []
    for passage in ranges["passages"]:
        name = passage_name(passage["section"], passage["number"])
        pairs += [(name, text) for text in _about(ranges, passage)]
    return facts(pairs)


def _about(ranges: dict[str, Any], passage: dict[str, Any]) -> Iterator[str]:
    """Yield the estimate of a passage, and what is proved of it."""
    if "estimate_plus_minus_s" in passage:
        middle = " ±".join(passage["estimate_plus_minus_s"])
        yield f"estimate {interval(passage['estimate_range_s'], 's')} ({middle})"
    elif "estimate_s" in passage:
        yield f"estimate near {passage['estimate_s']:.6g} s; {passage['no_estimate_range']}"
    elif "no_estimate" in passage:
        yield f"no estimate: {passage['no_estimate']}"
    if "t_s" in passage:
        useless = "useless, wider than half a swing: " if passage["useless"] else ""
        yield f"proved {useless}{interval(passage['t_s'], 's')}"
    elif "estimate_s" in passage or "no_estimate" in passage:
        yield f"not proved: {passage['reason']}{gate_hint(ranges, passage['section'])}"
    else:
        yield passage["reason"]


def gate_hint(ranges: dict[str, Any], word: str) -> str:
    """Return that a gate across the swing is proved further, of a section that it may stand for."""
    gate = ranges.get("gate_across")
    if word != LOWEST or not gate:
        return ""
    return (
        f'. A proof usually reaches further for --section "{gate}", across the swing, '
        "whose passages are nearly the same"
    )


def interval(ends: Sequence[str] | None, unit: str) -> str:
    """Return an interval with its unit; nothing if it is open."""
    return f"{ends[0]} to {ends[1]} {unit}" if ends else ""


def passage_limit_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield how far each input alone moves the passages that were asked for, and what to measure better."""
    for passage in ranges["passages"]:
        if "limits" not in passage:
            continue
        name = passage_name(passage["section"], passage["number"])
        yield ""
        yield from paragraph(f"Which input limits {name}, by estimate:", "  ")
        moves = ("moves_s", "moves_error_s")
        yield from limit_table(passage["limits"], ranges["uncertain"], moves)
        if "enough_by_estimate" in passage:
            yield ""
            yield from paragraph(_enough(passage), "  ")


def limit_table(
    limits: Mapping[str, Any], widths: Mapping[str, str], moves: tuple[str, str]
) -> list[str]:
    """Return how far each input alone moves a number, the largest share first.

    Args:
        limits: in the form of --json.
        widths: half of the width of each input, with its sign.
        moves: what the move and its error are called there.
    """
    by_share = dict(sorted(limits.items(), key=lambda item: -item[1]["share"]))
    half_widths = [f"{widths[name]} {unit_of(name)}" for name in by_share]
    shares = [f"{100 * limit['share']:.1f} %" for limit in by_share.values()]
    move_key, error_key = moves
    moved = [_moved(float(limit[move_key]), float(limit[error_key])) for limit in by_share.values()]
    return table(
        [
            TextColumn(["input"], list(by_share), is_number=False),
            TextColumn(["half-width"], half_widths, is_number=False),
            TextColumn(["moves it by"], moved),
            TextColumn(["share"], shares),
        ],
        indent="    ",
    )


def _moved(size_s: float, error_s: float) -> str:
    """Return how far an input moves a time, or below what, where the error leaves no digit."""
    if size_s < 10 * error_s:
        return f"< {size_s + error_s:.1g} s"
    return f"±{size_s:.2g} s"


def _enough(passage: dict[str, Any]) -> str:
    """Return which input to measure how well for the wanted width, by estimate."""
    wanted = f"±{passage['wanted_s']} s"
    enough = passage["enough_by_estimate"]
    if enough["is_within"]:
        return f"By estimate it is within {wanted} already: no input has to be measured better."
    wanted_s = float(passage["wanted_s"])
    alone = {}
    too_little = {}
    for name, narrowed in enough["alone"].items():
        if narrowed["width"]:
            alone[name] = narrowed["width"]
        elif float(narrowed["if_exact_half_width_s"]) >= wanted_s:
            too_little[name] = narrowed["if_exact_half_width_s"]
    if alone:
        text = f"By estimate, for {wanted} narrow {in_words(_with_units(alone))}"
        text += ": one of these suffices." if len(alone) > 1 else "."
        if too_little:
            text += f" Alone not enough, even if exact: {enumerated(_reached(too_little))}."
        return text
    text = f"By estimate, no single input suffices for {wanted}"
    text += f", even if exact: {', '.join(_reached(too_little))}." if too_little else "."
    if enough["together"]:
        text += f" Together these suffice: {widths_in_words(enough['together'])}."
    return text


def _reached(half_widths: Mapping[str, str]) -> list[str]:
    """Return inputs, each with half of the width of a passage if it is exact."""
    return [f"{name} (±{half_width} s)" for name, half_width in half_widths.items()]


def widths_in_words(widths: Mapping[str, str]) -> str:
    """Return inputs with the widths that they need, in words."""
    return enumerated(_with_units(widths))


def _with_units(widths: Mapping[str, str]) -> list[str]:
    return [f"{name} to {width} {unit_of(name)}".rstrip() for name, width in widths.items()]


def passage_proof_lines(
    ranges: dict[str, Any], name: str, narrowing: dict[str, Any]
) -> Iterator[str]:
    """Yield which inputs limit the proof of a passage, and what suffices for the width wanted."""
    word, _, number = name.rpartition(" ")
    called = passage_name(word, int(number))
    half_width_s = narrowing["half_width_s"]
    state = "not proved" if half_width_s is None else f"proved to ±{half_width_s:.2g} s"
    yield from paragraph(
        f"{PROOF_NEEDS} {called} is {state}. With one input known ten times as well:", "  "
    )
    pairs = []
    for row in narrowing["alone"]:
        (label,) = _with_units({row["input"]: row["width"]})
        pairs.append((label, _proved_with(row)))
    yield from facts(pairs)
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
        text = f"{NOT_EVEN} it is not proved{wanted}."
        if "estimate_range_s" in passage:
            text += " The estimate still holds."
    elif enough:
        text = f"To prove it{wanted}, narrow {widths_in_words(enough)}."
    else:
        text = f"That is within the ±{passage['wanted_s']} s wanted."
    yield from paragraph(text, "  ")


def _proved_with(row: dict[str, Any]) -> str:
    """Return to what a passage is proved with a narrower input, or why it is not."""
    if row["half_width_s"] is None:
        return f"not proved: {row['reason']}"
    return f"proved to ±{row['half_width_s']:.2g} s"
