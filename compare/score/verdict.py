"""Print a score as lines of text for people."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import islice

from .scored import Score

# nothing to put right
HARMLESS_CONVENTIONS = ("decimals", "digits", "single_precision", "z_constant", "off_the_sphere")
NAMED = 3  # transits of each kind (missed, extra, shifted) that are listed at most


def lines(score: Score) -> Iterator[str]:
    """Yield the verdict line by line."""
    errors = score.errors
    yield f"{score.candidate.name} {_verdict(score)} ({_span(score)})"
    if not score.covered:
        yield from _row("covers nothing", "no row after t = 0", "the release alone says nothing of the motion")
    elif score.falls_short:
        yield from _row("covers too little", percent(score.covered), f"{percent(score.covers)} demanded")
    yield from _row("largest error", f"{errors.max_m:.3g} m", _largest(score))
    yield from _row("rms, at the end", f"{errors.rms_m:.3g} m, {errors.end_m:.3g} m", _growth(errors.growth_exponent))
    scale = f"largest error over the amplitude {errors.amplitude_m:.4g} m"
    yield from _row("digits", _one_decimal(errors.digits), scale)
    mixed = f"relative to the truth; to {errors.amplitude_m:.4g} m, {errors.speed_m_s:.4g} m/s + |truth|"
    yield from _row("scd, mescd at end", f"{_one_decimal(errors.scd)}, {_one_decimal(errors.mescd)}", mixed)
    worst = score.worst
    numbers = f"expected {worst.expected:.17g}, got {worst.got:.17g}"
    yield from _row("worst", f"{worst.component} at t = {worst.t:.10g} s", numbers)
    each = (f"{name} {abs(one.difference):.2g} {_unit(name)}" for name, one in score.worst_of_each.items())
    yield from _row("worst of each", ", ".join(each))
    turn, delay = score.swing.largest_turn, score.swing.largest_delay
    if turn is not None and delay is not None:
        yield from _row("swing plane, phase", f"{math.degrees(turn):.3g} degrees, {delay:.3g} s", "fitted")
    if score.drifts:
        words = {"h_m2_s2": "h by {:.3g} m²/s²", "length_m": "|r| - l by {:.3g} m"}
        yield from _row("drifts", ", ".join(words[name].format(value) for name, value in score.drifts.items()))
    yield from _transit_lines(score)
    if score.timing is not None:
        timing = score.timing
        how = f"median of {timing.runs} after a warm-up" if timing.warm else "one run, no warm-up"
        yield from _row("took", f"{timing.cpu_s:.3g} CPU s, {timing.wall_s:.3g} s", how)
    yield from _row("inputs read as", score.scene.inputs, score.why_inputs)
    yield from _row("reference", f"{score.golden.manifest.level}", f"within {errors.bound_m:.2g} m at these times")
    yield from explanation_lines(score)
    for one in score.candidate.conventions:
        yield f"Reading: {one.text}."
    for note in score.notes:
        yield f"Note: {note}."


def _verdict(score: Score) -> str:
    if score.grade == score.verdict:
        return f"{score.verdict} with {score.scene.id}"
    assert score.explanation is not None and score.explanation.model is not None
    return f"agrees with {score.scene.id} as the model: {score.explanation.model.text}"


def explanation_lines(score: Score) -> Iterator[str]:
    """Yield what is known of the reasons for the error, if they were looked for."""
    found = score.explanation
    if found is None:
        return
    for convention in found.conventions:
        yield f"Your file {convention.text}."
    if found.model is not None:
        yield (
            f"As that model it is exact to {found.model.exact_to_m:.2g} m; "
            f"against the full Lagrangian it is {found.model.costs_m:.3g} m off:"
        )
    elif len(found.causes) > 1:
        yield "It seems that your program, most fundamental first,"
    begin = "- " if found.model is not None or len(found.causes) > 1 else "It seems that your program "
    for cause in found.causes:
        yield f"{begin}{cause.text}: {cause.size_m:.3g} m"
    if found.slip:
        yield found.slip
    if found.causes or any(one.id not in HARMLESS_CONVENTIONS for one in found.conventions):
        yield f"With {'this' if len(found.causes) == 1 else 'all this'} put right, {found.corrected_m:.2g} m are left."
    elif not found.slip:
        yield "No mistake known to foucault explains the error."


def _row(name: str, value: str, remark: str = "") -> Iterator[str]:
    yield f"  {name:19} {value}{f'  ({remark})' if remark else ''}"


def _unit(component: str) -> str:
    return "m/s" if component.startswith("v") else "m"


def percent(share: float) -> str:
    """Return a share to three digits, rounded down: 100 % is all of it."""
    if not share > 0:
        return "0 %"
    percents = 100 * share * (1 + 1e-9)  # 29 and not 28.9 for 0.29
    unit = 10.0 ** (math.floor(math.log10(percents)) - 2)
    return f"{math.floor(percents / unit) * unit:.6g} %"


def _one_decimal(digits: float | None) -> str:
    return "none" if digits is None else f"{round(digits, 1) + 0.0:.1f}"


def _span(score: Score) -> str:
    t, end = score.errors.t, score.scene.run.t_end
    what = "row" if score.candidate.positions else "transit"
    rows = f"1 {what}" if len(t) == 1 else f"{len(t)} {what}s"
    return f"{rows}, t = {t[0]:.6g} to {t[-1]:.6g} of {end} s: {percent(score.covered)}"


def _largest(score: Score) -> str:
    errors = score.errors
    if score.at_bound:
        return "at or below the reference's bound"
    allowed = f"tolerance {score.tolerance_m:.3g} m"
    if not score.input_floor_m:
        return f"{allowed}; the inputs are doubles as they stand"
    ratio = errors.max_m / score.input_floor_m
    return f"{allowed}; {ratio:.2g} times the input floor of {score.input_floor_m:.2g} m"


def _growth(exponent: float | None) -> str:
    return "" if exponent is None else f"grows like t^{exponent:.2f}"


def _transit_lines(score: Score) -> Iterator[str]:
    transits = score.transits
    if transits is None:
        return
    worst = f"largest error {transits.max_error_s:.3g} s, weighted by |ax|: {transits.max_conditioned_m:.3g} m"
    yield from _row(
        "transits", f"{transits.matched} matched, {len(transits.missed)} missed, {len(transits.extra)} extra", worst
    )
    for word, times in (("missed", transits.missed), ("extra", transits.extra)):
        if times:
            yield from _row(f"  {word} at", _listed(f"{t:.6f}" for t in times) + " s")
    if transits.undecided:
        text = _listed(f"{t:.6f}" for t in transits.undecided)
        yield from _row("  undecided at", f"{text} s", "a motion within the tolerance may or may not have them")
    shifted = transits.shifted(score.allowed_m)
    if shifted:
        text = _listed(f"{t:.6f} s by {error:.2g} s" for t, error in shifted)
        yield from _row("  shifted", text, f"{len(shifted)} in all")


def _listed(texts: Iterable[str]) -> str:
    """Join the first few, with … if there are more."""
    first = list(islice(texts, NAMED + 1))
    return ", ".join(first[:NAMED]) + (" …" if len(first) > NAMED else "")
