"""Period, precession and full turn of a scene for people, with units, one fact on each line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..numbers.precision import digits_that_hold
from .layout import Fact

# what each number of a swing is called, and its unit
QUANTITIES = {
    "swing_hz": ("frequency", "Hz"),
    "period_s": ("period", "s"),
    "precession_deg_per_h": ("precession", "°/h"),
    "full_turn_h": ("full turn", "h"),
}
_ERRORS = {
    "period_s": "period_error_s",
    "precession_deg_per_h": "precession_error_deg_per_h",
    "full_turn_h": "full_turn_error_h",
}


def motion_facts(
    motion: dict[str, Any], ranges: Mapping[str, Sequence[str]] | None = None
) -> Iterator[Fact]:
    """Yield the numbers of a motion, to the digits that their errors justify, and why some are left out.

    Args:
        motion: in the form of --json.
        ranges: for uncertain inputs: the middle of each number's range, and half of its width.
    """
    ranges = ranges or {}
    if "reason" in motion:
        yield "no period", motion["reason"]
        return
    for name, error_name in _ERRORS.items():
        if name not in motion:
            continue
        label, unit = QUANTITIES[name]
        way = ""
        if name == "precession_deg_per_h":
            way = _way(motion[name], motion[error_name], ranges.get(name))
        if name in ranges:
            yield label, f"{' ±'.join(ranges[name])} {unit}{way}"
            continue
        own = f"{_number(motion[name], motion[error_name])} {unit}{way}"
        yield label, f"{own}, of the inputs without their widths" if ranges else own
    yield from left_out_facts(motion["left_out"])


def _number(value: float, error: float) -> str:
    """Return a number with the digits that its error leaves; "0 ± error" if it leaves none."""
    text = digits_that_hold(value, error)
    return f"0 {text}" if text.startswith("±") else text


def _way(rate: float, error: float, plus_minus: Sequence[str] | None) -> str:
    """Return which way the plane turns, seen from above, where that is known.

    Args:
        rate: of the turn, east to north.
        error: of the rate.
        plus_minus: the middle of the range that uncertain inputs leave, and half of its width.
    """
    if plus_minus:
        rate, error = map(float, plus_minus)
    if abs(rate) <= error:
        return ""
    return ", clockwise" if rate < 0 else ", anticlockwise"


def left_out_facts(reasons: dict[str, str]) -> Iterator[Fact]:
    """Yield why numbers are left out, by their names."""
    for name, reason in reasons.items():
        label, _ = QUANTITIES[name]
        yield f"no {label}", reason
