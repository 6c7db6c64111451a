"""A score in words, for people."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import islice

from .judge import Score

NAMED = 3  # missed, extra or shifted transits that are named each


def lines(made: Score) -> Iterator[str]:
    """The verdict line by line."""
    errors = made.errors
    yield f"{made.candidate.name} {made.verdict} with {made.scene.id} ({_span(made)})"
    yield from _row("largest error", f"{errors.max_m:.3g} m", _largest(made))
    yield from _row("rms, at the end", f"{errors.rms_m:.3g} m, {errors.end_m:.3g} m", _growth(errors.growth_exponent))
    scale = f"largest error over the amplitude {errors.amplitude_m:.4g} m"
    yield from _row("digits", _shown(errors.digits), scale)
    mixed = f"relative to the truth; to {errors.amplitude_m:.4g} m, {errors.speed_m_s:.4g} m/s + |truth|"
    yield from _row("scd, mescd at end", f"{_shown(errors.scd)}, {_shown(errors.mescd)}", mixed)
    row, component = errors.worst
    expected = float(errors.truth.states[row, "xyz".index(component)])
    got = float(made.candidate.columns[component][row])
    yield from _row("worst", f"{component} at t = {errors.t[row]:.10g} s", f"expected {expected:.17g}, got {got:.17g}")
    turn, delay = made.ellipse.largest_turn, made.ellipse.largest_delay
    if turn is not None and delay is not None:
        yield from _row("swing plane, phase", f"{math.degrees(turn):.3g} degrees, {delay:.3g} s", "fitted")
    if made.drifts:
        words = {"h_m2_s2": "h by {:.3g} m²/s²", "length_m": "|r| - l by {:.3g} m"}
        yield from _row("drifts", ", ".join(words[name].format(value) for name, value in made.drifts.items()))
    yield from _transit_lines(made)
    if made.timing is not None:
        took = made.timing
        how = f"median of {took.runs} after a warm-up" if took.warm else "one run, no warm-up"
        yield from _row("took", f"{took.cpu_s:.3g} CPU s, {took.wall_s:.3g} s", how)
    yield from _row("inputs read as", made.scene.inputs, made.why_inputs)
    yield from _row("reference", f"{made.golden.manifest.level}", f"here within {errors.bound_m:.2g} m")
    if made.diagnosis is not None:
        yield made.diagnosis.text
    elif made.looked:
        yield "No single mistake that is known here explains 99 % of the error."
    for note in made.notes:
        yield f"Note: {note}."


def _row(name: str, value: str, remark: str = "") -> Iterator[str]:
    yield f"  {name:19} {value}{f'  ({remark})' if remark else ''}"


def _shown(digits: float | None) -> str:
    return "none" if digits is None else f"{round(digits, 1) + 0.0:.1f}"


def _span(made: Score) -> str:
    t, end = made.errors.t, made.scene.run.t_end
    rows = "1 row" if len(t) == 1 else f"{len(t)} rows"
    return f"{rows}, t = {t[0]:.6g} to {t[-1]:.6g} of {end} s"


def _largest(made: Score) -> str:
    errors = made.errors
    if made.at_bound:
        return "at or below the reference's bound"
    allowed = f"tolerance {made.tolerance_m:.3g} m"
    if not made.input_floor_m:
        return f"{allowed}; the inputs are doubles as they stand"
    ratio = errors.max_m / made.input_floor_m
    return f"{allowed}; {ratio:.2g} times the input floor of {made.input_floor_m:.2g} m"


def _growth(exponent: float | None) -> str:
    return "" if exponent is None else f"grows like t^{exponent:.2f}"


def _transit_lines(made: Score) -> Iterator[str]:
    found = made.transits
    if found is None:
        return
    worst = f"largest error {found.max_error_s:.3g} s, weighed by |ax|: {found.max_conditioned_m:.3g} m"
    yield from _row("transits", f"{found.matched} matched, {len(found.missed)} missed, {len(found.extra)} extra", worst)
    for word, times in (("missed", found.missed), ("extra", found.extra)):
        if times:
            yield from _row(f"  {word} at", _named(f"{t:.6f}" for t in times) + " s")
    if found.undecided:
        shown = _named(f"{t:.6f}" for t in found.undecided)
        yield from _row("  undecided at", f"{shown} s", "a motion within the tolerance may have them or not")
    shifted = found.shifted(made.allowed_m)
    if shifted:
        shown = _named(f"{t:.6f} s by {error:.2g} s" for t, error in shifted)
        yield from _row("  shifted", shown, f"{len(shifted)} in all")


def _named(texts: Iterable[str]) -> str:
    """The first few."""
    first = list(islice(texts, NAMED + 1))
    return ", ".join(first[:NAMED]) + (" …" if len(first) > NAMED else "")
