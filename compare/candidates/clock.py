"""Times shown by a clock: hours:minutes:seconds, with or without a date, or seconds since 1970."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, date, datetime, timedelta
from fractions import Fraction

from reference import InputError

from .text import CLOCK, MOMENT

DAY_S = 86400
UNIX = (1_000_000_000, 4_000_000_000)  # seconds since 1970 of the years 2001 to 2096
HOW = "Write seconds since the release, or hours:minutes:seconds."


def seconds_of(text: str, where: str) -> Fraction:
    """Return the time on a clock in s: since midnight, or, with a date, since 1970.

    Raises:
        InputError: it is no clock's text, or two numbers alone, which may be hours and minutes.
    """
    moment = MOMENT.fullmatch(text)
    if moment is not None:
        return _since_1970(moment, where)
    clock = CLOCK.fullmatch(text)
    if clock is None:
        raise InputError(where, text[:40], "a time in the form of the first row", HOW)
    hours, minutes, seconds = clock.groups()
    if hours is None and not {".", ","} & {*seconds}:
        advice = "Are these hours and minutes, or minutes and seconds?"
        raise InputError(where, text[:40], "hours:minutes:seconds", advice)
    return _of_day(hours or "0", minutes, seconds)


def _since_1970(moment: re.Match[str], where: str) -> Fraction:
    """Return the time of a date and hours:minutes:seconds, in s since 1970.

    Raises:
        InputError: there is no such date.
    """
    year, month, day, hours, minutes, seconds, sign, zone_hours, zone_minutes = moment.groups()
    try:
        days = (date(int(year), int(month), int(day)) - date(1970, 1, 1)).days
    except ValueError:
        raise InputError(where, moment[0][:40], "a date that exists", HOW) from None
    zone_s = 0
    if sign:
        zone_s = (int(zone_hours) * 60 + int(zone_minutes)) * 60
    if sign == "-":
        zone_s = -zone_s
    return days * DAY_S - zone_s + _of_day(hours, minutes, seconds)


def _of_day(hours: str, minutes: str, seconds: str) -> Fraction:
    return 3600 * int(hours) + 60 * int(minutes) + Fraction(seconds.replace(",", "."))


def decimal(seconds: Fraction) -> str:
    """Return a number of seconds with finitely many decimals as text, exactly."""
    digits = 0
    while (seconds * 10**digits).denominator != 1:
        digits += 1
    whole = abs(int(seconds * 10**digits))
    text = f"{whole:0{digits + 1}d}"
    point = len(text) - digits
    sign = "-" if seconds < 0 else ""
    return f"{sign}{text[:point]}.{text[point:]}" if digits else f"{sign}{text}"


def shown(seconds: float) -> str:
    """Return the time on a clock for people, with the date if it counts from 1970."""
    text = f"{seconds:.10g} s" if abs(seconds) < 1e9 else f"{seconds:.14g} s"
    if not UNIX[0] <= seconds < UNIX[1]:
        return text
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=int(seconds))
    return f"{text} since 1970, {moment:%Y-%m-%d %H:%M:%S} UTC"


def counted_from(first: Fraction, times: Sequence[Fraction]) -> list[str]:
    """Return times in s since the first of them, as exact decimals."""
    return [decimal(time - first) for time in times]
