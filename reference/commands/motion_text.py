"""Period, precession and full turn of a scene for people, with units, one fact on each line."""

from __future__ import annotations

from collections.abc import Iterator
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


def motion_facts(motion: dict[str, Any]) -> Iterator[Fact]:
    """Yield the numbers of a motion, to the digits that their errors justify, and why some are left out."""
    if "reason" in motion:
        yield "no period", motion["reason"]
        return
    for name, error_name in _ERRORS.items():
        if name not in motion:
            continue
        label, unit = QUANTITIES[name]
        yield label, f"{_number(motion[name], motion[error_name])} {unit}{_way(name, motion)}"
    yield from left_out_facts(motion["left_out"])


def _number(value: float, error: float) -> str:
    """Return a number with the digits that its error leaves; "0 ± error" if it leaves none."""
    text = digits_that_hold(value, error)
    return f"0 {text}" if text.startswith("±") else text


def _way(name: str, motion: dict[str, Any]) -> str:
    """Return which way the plane turns, seen from above, where that is known."""
    if name != "precession_deg_per_h" or abs(motion[name]) <= motion[_ERRORS[name]]:
        return ""
    return ", clockwise" if motion[name] < 0 else ", anticlockwise"


def left_out_facts(reasons: dict[str, str]) -> Iterator[Fact]:
    """Yield why numbers are left out, by their names."""
    for name, reason in reasons.items():
        label, _ = QUANTITIES[name]
        yield f"no {label}", reason
