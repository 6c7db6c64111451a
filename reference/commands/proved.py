"""Proofs that `foucault show` prints: intervals of a scene's swing, also by uncertain inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..dataset.ranges import ends
from ..engines.registry import in_background
from ..numbers.precision import rounded_up
from ..scenes.scene import Scene, unit_of
from ..solver.ranges import Intervals
from ..solver.solve import solve
from ..solver.swing import Swing, left_out, left_out_texts
from ..solver.uncertain import exact_texts, prove_ranges, widths_of
from ..system.workers import Emit

_FIRST = 3  # transits, and passages of each section, that are printed for uncertain inputs
_PROVED_DIGITS = 15  # of the highest points from which period and precession follow
_SWING = {
    "swing_hz": "hz",
    "period_s": "period",
    "precession_deg_per_h": "precession",
    "full_turn_h": "full_turn",
}
_MEAN = ("period_s", "precession_deg_per_h", "full_turn_h")  # of uncertain inputs
# powers of ten by which the widths are smaller for the derivatives
_CLOSER = 6


def proved_swing(scene: Scene) -> dict[str, Any]:
    """Return proven intervals of frequency, period, precession and full turn over the run.

    They follow from the highest points.

    Raises:
        UnreachableError: the level enclosed is out of reach.
    """
    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "false"})
    swing = solve(
        scene, level="enclosed", digits=_PROVED_DIGITS, sections="highest"
    ).swing_or_reason
    proved = {"over_s": scene.run.t_end, **_interval_texts(swing, _SWING)}
    if isinstance(swing, str):
        return {**proved, "reason": swing}
    return {**proved, "left_out": _left_out(swing)}


def _left_out(swing: Swing) -> dict[str, str]:
    """Return what is left out of a swing, and why."""
    return left_out(swing.reason, swing.full_turn is None)


def _interval_texts(swing: Any, names: Iterable[str]) -> dict[str, list[str] | None]:
    """Return intervals of what a swing has, as text; None where one is open."""
    texts = {}
    for name in names:
        interval = getattr(swing, _SWING[name], None)
        texts[name] = list(ends(*interval)) if interval else None
    return texts


def swing_line(proved: dict[str, Any]) -> str:
    """Return in a line what is proved of the swing."""
    title = f"[proved, over {proved['over_s']} s]"
    if "reason" in proved:
        return f"{title} no period: {proved['reason']}"
    texts = [
        f"{name} = {value[0]} to {value[1]}"
        for name, value in proved.items()
        if isinstance(value, list)
    ]
    texts += left_out_texts(proved["left_out"])
    return f"{title} {', '.join(texts)}"


def proved_ranges(scene: Scene, widths: dict[str, str]) -> dict[str, Any]:
    """Return what is proved for uncertain inputs.

    These are intervals of period, precession, full turn, first transits and passages.

    Raises:
        InputError: an input, or a width.
        UnreachableError: the box is too wide.
    """
    words = scene.run.sections or ()
    sections = [*dict.fromkeys((*words, "highest"))]
    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "true"})
    texts = exact_texts(widths_of(scene, widths))
    # in a process of its own: it takes as long as the intervals do
    with in_background(True, _send_limits, scene, texts) as limits:
        ranges = prove_ranges(scene, widths, derivatives=True, sections=sections)
        return {
            "over_s": scene.run.t_end,
            "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
            "period_s": ranges.period and list(ends(*ranges.period)),
            **_interval_texts(ranges.swing, _MEAN[1:]),
            "left_out": _left_out(ranges.swing) if ranges.swing else {},
            "first_transits_s": _first_times(ranges.transits),
            "first_passages_s": {word: _first_times(ranges.sections[word].table) for word in words},
            "possible": len(ranges.possible),
            "limits": limits.result(),
        }


def _first_times(table: Intervals) -> list[list[str]]:
    """Return the intervals of the first times in a table, as text."""
    return [list(ends(*t)) for t in table.exact("t")[:_FIRST]]


def _send_limits(emit: Emit, scene: Scene, uncertain: dict[str, str]) -> None:
    """Send how far each input moves the period, to first order.

    The derivatives are those close to the scene's own inputs.

    The derivatives of period and precession with respect to the input, as intervals, are sent too.
    """
    closer = {name: f"±{width}e-{_CLOSER}" for name, width in uncertain.items()}
    near = prove_ranges(scene, closer, derivatives=True, sections="highest")
    limits = {}
    for name, (move_s, share) in near.shares().items():
        derivative = near.derivative(name)
        period = derivative.period or (move_s, move_s)
        precession = derivative.precession
        limits[name] = {
            "moves_period_s": rounded_up(move_s * 10**_CLOSER),
            "share": share,
            "s_per_unit": list(ends(*period)),
            "deg_per_h_per_unit": precession and list(ends(*precession)),
        }
    emit(limits)


def ranges_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield what holds for all values of uncertain inputs, and which of them limits the period."""
    if "reason" in ranges:
        yield f"[ranges] left out: {ranges['reason']}"
        return
    box = ", ".join(f"{name} {width}" for name, width in ranges["uncertain"].items())
    texts = [*_mean_texts(ranges), *left_out_texts(ranges["left_out"])]
    if not texts:
        texts = ["no period: the intervals of these inputs leave it open"]
    texts += _passage_texts("transit {}", ranges["first_transits_s"])
    for word, passages in ranges["first_passages_s"].items():
        texts += _passage_texts(f"passage {{}} of {word}", passages)
        if not passages:
            texts.append(f"no passage of {word} is decided")
    yield f"[ranges, over {ranges['over_s']} s, proved for every {box}] {', '.join(texts)}"
    yield from _limit_lines(ranges)


def _mean_texts(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield period, precession and full turn, unless all of them are open."""
    if not any(ranges[name] for name in _MEAN):
        return
    for name in _MEAN:
        if name in ranges["left_out"]:
            continue
        if ranges[name]:
            low, high = ranges[name]
            yield f"{name} = {low} to {high}"
        else:
            yield f"{name} is not decided"


def _passage_texts(title: str, intervals: list[list[str]]) -> Iterator[str]:
    """Yield the intervals of the first times; `title` takes the number of each."""
    for k, (low, high) in enumerate(intervals, 1):
        yield f"{title.format(k)} = {low} to {high} s"


def _limit_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield how far each input alone moves the period, the largest share first."""
    limits = sorted(ranges["limits"].items(), key=lambda item: -item[1]["share"])
    if limits:
        yield "which input limits you: what each alone moves the period by, to first order, and its share"
    for name, limit in limits:
        move = f"{limit['moves_period_s']} s, {100 * limit['share']:.1f} %"
        slope = "the period changes by {} to {} s".format(*limit["s_per_unit"])
        if limit["deg_per_h_per_unit"]:
            low, high = limit["deg_per_h_per_unit"]
            slope += f", the precession by {low} to {high} degrees an hour"
        unit = unit_of(name).replace("degrees", "degree")
        if unit:
            slope += f" per {unit}"
        yield f"  {name} {ranges['uncertain'][name]}: {move} ({slope})"
