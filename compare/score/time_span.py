"""The span of a candidate's times: up to the end of the comparison, and within that of the scene."""

from __future__ import annotations

from dataclasses import replace

from reference import InputError, Scene
from reference.errors import Described, counted
from reference.numbers.precision import Array

from ..candidates.candidate import Candidate
from ..candidates.clock import shown
from ..candidates.names import LONG_NAMES, TIMES
from .clock_start import SUBTRACT

FINER = ("ms", "us", "ns")  # units of time in which a run looks longer than its scene
FAR = 10  # times the scene's span: a run that ends later is rather in another unit than longer
SAME = 1e-3  # relative difference of ends that count as one


def rows_until(candidate: Candidate, end_s: float) -> Candidate:
    """Return the rows and transits up to a time, with a note if there were later rows.

    Raises:
        InputError: there is no row up to then.
    """
    transits = candidate.transits
    if transits is not None:
        candidate = replace(candidate, transits=transits[transits <= end_s])
    kept = candidate.t <= end_s
    if kept.all():
        return candidate
    if not kept.any():
        expected = f"at least {candidate.t[0]:g} s, the time of the first row"
        raise InputError("t_end", f"{end_s:g}", expected)

    later = counted(int((~kept).sum()), "row")
    note = f"{later} after t = {end_s:g} s ignored, the last at {candidate.t[-1]:g} s"
    return replace(
        candidate,
        t=candidate.t[kept],
        columns={name: column[kept] for name, column in candidate.columns.items()},
        low={name: column[kept] for name, column in candidate.low.items()},
        notes=(*candidate.notes, note),
    )


def check_transits(times: Array, scene: Scene) -> None:
    """Refuse transits that are all beyond the scene's end.

    Raises:
        InputError: they are.
    """
    if len(times) and times[0] > float(scene.exact.t_end):
        got = Described(f"{times[0]:.10g} s as the first time")
        expected = f"times from 0 to {scene.run.t_end} s"
        raise InputError("transits: t", got, expected, SUBTRACT)


def end_of_run(candidate: Candidate, scene: Scene) -> float:
    """Return the time in s at which a run ended: no later transit can be among its own."""
    assert candidate.transits is not None
    end_s = float(scene.exact.t_end)
    last_s = float(candidate.t[-1])
    has_later_transits = len(candidate.transits) > 0 and candidate.transits[-1] > last_s
    if not candidate.positions or has_later_transits:
        return end_s
    return min(last_s, end_s)


def check_end(candidate: Candidate, scene: Scene) -> None:
    """Refuse times beyond the scene's span, and say what they may be.

    Raises:
        InputError: the last time is more than a grid step beyond the scene's end.
    """
    last_s = float(candidate.t[-1])
    if last_s > float(scene.exact.t_end) + float(scene.exact.grid_step):
        expected = f"times from 0 to {scene.run.t_end} s"
        got = Described(f"{last_s:.10g} in the last row")
        raise InputError(f"{candidate.name}: t", got, expected, _advice(candidate, scene))


def _advice(candidate: Candidate, scene: Scene) -> str:
    """Return what to do about times beyond the scene's end: another unit, another clock, or a longer scene."""
    end_s = float(scene.exact.t_end)
    last = float(candidate.t[-1])
    # one row alone says nothing of a clock's start
    first = float(candidate.t[0]) if len(candidate.t) > 1 else 0.0
    span = last - first

    unit = _finer_unit(span, end_s)
    if unit is not None and span > FAR * end_s:
        last_s = last * float(TIMES[unit])
        first_s = first * float(TIMES[unit])
        fits = last_s <= end_s * (1 + SAME)
        where = f"and they end at {last_s:.10g} s" if fits else f"from {shown(first_s)} on"
        return f"They look like {LONG_NAMES[unit]}: --units {unit} reads them so, {where}."

    advice = (
        f"--t-end {scene.run.t_end} leaves out later rows, "
        f"--set run.t_end={last:.10g} makes the scene longer."
    )
    if first > 0 and span <= end_s:
        return f"{advice} Did the clock start before the release? {SUBTRACT}"
    return advice


def _finer_unit(span: float, end_s: float) -> str | None:
    """Return the coarsest unit finer than a second in which a span fits into a scene.

    None if none does.
    """
    for unit in FINER:
        if span * float(TIMES[unit]) <= end_s * (1 + SAME):
            return unit
    return None
