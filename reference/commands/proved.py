"""Proofs for `foucault show`: intervals of a scene's swing, for exact and for uncertain inputs.

How they are printed: `proved_text`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from ..dataset.ranges import ends
from ..engines.registry import in_background
from ..errors import BoxTooWideError, UnreachableError
from ..numbers.precision import rounded_up
from ..numbers.zeros import Zeros
from ..scenes.scene import Scene
from ..solver.ranges import Derivative, Intervals, Ranges
from ..solver.solve import solve
from ..solver.swing import HOUR, Ends, Swing, left_out
from ..solver.uncertain import exact_texts, prove_ranges, widths_of
from ..system.workers import Emit
from .narrowing import Narrowing, reach_s
from .passages import Asked, section_words
from .progress import Move, Show

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
_TRIES = 5  # ends of a run that are tried where the inputs are too uncertain for the whole


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
    return {name: _texts(getattr(swing, _SWING[name], None)) for name in names}


def _texts(interval: Any) -> list[str] | None:
    """Return the ends of an interval as text, rounded outward; None if it is open."""
    return list(ends(*interval)) if interval else None


def proved_ranges(
    scene: Scene, widths: dict[str, str], asked: Sequence[Asked], begin: Show
) -> dict[str, Any]:
    """Return what is proved for uncertain inputs, over as much of the run as the proof reaches.

    These are intervals of period, precession, full turn, first transits and passages, and the
    passages that were asked for. If the inputs are too uncertain for the whole run, or for a
    passage, `narrowing` tells which to know better.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input.
        asked: passages of each section.
        begin: begins a piece of work that is shown to the user.

    Raises:
        InputError: an input, or a width.
    """
    texts = exact_texts(widths_of(scene, widths))
    whole = _without_grid(scene)
    # in a process of its own: it takes as long as the intervals do
    with in_background(True, _send_near, whole, texts) as near:
        # a look at the states alone costs little
        holds_s = reach_s(whole, texts)
        report = begin(f"{scene.id}: proving", holds_s)
        ranges = _as_far_as_it_goes(whole, texts, holds_s, report)
        document = _ranges_document(whole, texts, ranges, asked)
        document |= near.result()
    narrowing = _narrowing(whole, texts, document, begin)
    if narrowing:
        document["narrowing"] = narrowing
    return document


def _without_grid(scene: Scene) -> Scene:
    """Return a scene with transits, and with the release and the end as its grid."""
    return scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "true"})


def _ending_at(scene: Scene, t_end: str) -> Scene:
    """Return a scene whose run ends earlier."""
    return _without_grid(scene.with_values({"run.t_end": t_end}))


def _as_far_as_it_goes(
    scene: Scene, widths: dict[str, str], holds_s: float, report: Move
) -> Ranges | None:
    """Return the proof for the whole run, or for as much of it as it holds for; None if for nothing.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input.
        holds_s: up to which time the states can be proved, in s.
        report: called with the simulated time reached, in s.
    """
    sections = [*dict.fromkeys((*(scene.run.sections or ()), "highest"))]
    for _ in range(_TRIES):
        if holds_s <= 0:
            return None
        part = scene
        if holds_s < float(scene.run.t_end):
            part = _ending_at(scene, _rounded_down(holds_s))
        try:
            return prove_ranges(part, widths, derivatives=True, sections=sections, report=report)
        except BoxTooWideError as error:
            # zeros near the end need a little more than states do
            holds_s = min(error.holds_s, 0.95 * float(part.run.t_end))
    return None


def _rounded_down(time_s: float) -> str:
    """Return a time above 0 with three digits."""
    unit = 10.0 ** (math.floor(math.log10(time_s)) - 2)
    return f"{math.floor(time_s / unit) * unit:.3g}"


def _ranges_document(
    scene: Scene, widths: dict[str, str], ranges: Ranges | None, asked: Sequence[Asked]
) -> dict[str, Any]:
    """Return the intervals in the form of --json."""
    document: dict[str, Any] = {
        "over_s": ranges.scene.run.t_end if ranges else "0",
        "asked_s": scene.run.t_end,
        "uncertain": {name: f"±{width}" for name, width in widths.items()},
    }
    if ranges is None:
        return document | {"reason": "these inputs are too uncertain for a proof"}
    swing = ranges.swing
    words = scene.run.sections or ()
    return document | {
        "period_s": _texts(ranges.period),
        **_interval_texts(swing, _MEAN[1:]),
        "left_out": _left_out(swing) if swing else {},
        "useless": ["precession_deg_per_h"] if _says_nothing(scene, swing) else [],
        "first_transits_s": _first_times(ranges.transits),
        "first_passages_s": {word: _first_times(ranges.sections[word].table) for word in words},
        "possible": len(ranges.possible),
        "passages": [_passage(ranges, word, one) for word in section_words(scene) for one in asked],
    }


def _says_nothing(scene: Scene, swing: Swing | None) -> bool:
    """Return whether a precession may be all that the rotation of the site can cause, either way."""
    if swing is None or swing.precession is None:
        return False
    site_deg_per_h = Fraction(math.degrees(abs(scene.exact.rotation_rate)) * HOUR)
    low, high = swing.precession
    return low < -site_deg_per_h < site_deg_per_h < high


def _first_times(table: Intervals) -> list[list[str]]:
    """Return the intervals of the first times in a table, as text."""
    return [list(ends(*t)) for t in table.exact("t")[:_FIRST]]


def _passage(ranges: Ranges, word: str, asked: Asked) -> dict[str, Any]:
    """Return the interval of a passage in the form of --json, or why there is none."""
    passage: dict[str, Any] = {"section": word, "number": asked.number}
    if asked.width_s is not None:
        passage["wanted_s"] = str(float(asked.width_s))
    interval = passage_interval(ranges, word, asked.number)
    if isinstance(interval, str):
        return passage | {"reason": interval}
    passage["t_s"] = list(ends(*interval))
    # wider than half a swing, it may hold other passages as well
    period = ranges.period
    passage["useless"] = period is not None and interval.high - interval.low > period.low / 2
    return passage


def passage_interval(ranges: Ranges, word: str, number: int) -> Ends | str:
    """Return the interval of the time of a passage, or why there is none."""
    zeros: Zeros[Intervals] | None = ranges.zeros.get(word)
    if zeros is None:
        return "the bob stays in the section"
    times = zeros.table.exact("t")
    if any(low < time[0] for low, _, _ in zeros.possible for time in times[number - 1 : number]):
        return "an earlier one is not decided, so that its number is open"
    if number > len(times):
        return f"only {len(times)} are proved in {ranges.scene.run.t_end} s"
    return Ends(*times[number - 1])


def _narrowing(
    scene: Scene, widths: dict[str, str], document: dict[str, Any], begin: Show
) -> dict[str, Any]:
    """Return which inputs to know better: for the passages asked for, and for the whole run."""
    passages = [passage for passage in document.get("passages", ()) if "t_s" in passage]
    falls_short = document["over_s"] != scene.run.t_end
    goals = len(passages) + falls_short
    if not goals:
        return {}
    least_proofs = goals * len(widths)
    narrowing = Narrowing(
        scene, widths, begin(f"{scene.id}: narrower inputs", least_proofs, "proofs")
    )
    found = {}
    for passage in passages:
        name = f"{passage['section']} {passage['number']}"
        found[name] = narrowing.for_a_passage(passage)
    if falls_short:
        found["run"] = narrowing.for_the_run(float(document["over_s"]))
    return found


def _send_near(emit: Emit, scene: Scene, uncertain: dict[str, str]) -> None:
    """Send what the derivatives close to the scene's own inputs tell, to first order.

    `limits`: how far each input moves the period, and the derivatives of period and precession with
    respect to it, as intervals. `first_order`: period and precession for these widths.
    """
    closer = {name: f"±{width}e-{_CLOSER}" for name, width in uncertain.items()}
    try:
        near = prove_ranges(scene, closer, derivatives=True, sections="highest")
    except UnreachableError:
        emit({"limits": {}, "first_order": {}})
        return
    limits = {}
    for name, (move_s, share) in near.shares().items():
        derivative = near.derivative(name)
        period = derivative.period or (move_s, move_s)
        limits[name] = {
            "moves_period_s": rounded_up(move_s * 10**_CLOSER),
            "share": share,
            "s_per_unit": list(ends(*period)),
            "deg_per_h_per_unit": _texts(derivative.precession),
        }
    derivatives = {name: near.derivative(name) for name in uncertain}
    emit({"limits": limits, "first_order": _first_order(near, derivatives, uncertain)})


def _first_order(
    near: Ranges, derivatives: dict[str, Derivative], widths: dict[str, str]
) -> dict[str, list[str]]:
    """Return period and precession for these widths by the derivatives close to the scene's inputs.

    They are estimates: the proof `near` holds for far smaller widths.
    """
    values = {"period_s": near.period}
    slopes = {"period_s": [derivatives[name].period for name in widths]}
    swing = near.swing
    if swing is not None:
        values["precession_deg_per_h"] = swing.precession
        slopes["precession_deg_per_h"] = [derivatives[name].precession for name in widths]
    estimates = {}
    for name, value in values.items():
        if value is None or None in slopes[name]:
            continue
        far = sum(
            Fraction(width) * max(abs(slope.low), abs(slope.high))
            for slope, width in zip(slopes[name], widths.values(), strict=True)
            if slope is not None
        )
        estimates[name] = list(ends(value.low - far, value.high + far))
    return estimates
