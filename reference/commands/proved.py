"""Proofs for `foucault show`: intervals of a scene's swing, for exact and for uncertain inputs.

How they are printed: `proved_text`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from ..dataset.ranges import ends
from ..engines.registry import in_background, reports
from ..errors import BoxTooWideError, UnreachableError
from ..scenes.scene import Scene
from ..solver.ranges import Intervals, Ranges
from ..solver.solve import solve
from ..solver.swing import HOUR, Ends, Swing, left_out
from ..solver.uncertain import prove_ranges
from ..system.workers import Emit
from .cautions import gate_across
from .effects import rounded_down
from .estimated_passages import PassageEstimates
from .narrowing import Narrowing, ending_after, ends_before, interval_alone, reach_s
from .passages import (
    LOWEST,
    Asked,
    passage_interval,
    passage_name,
    section_words,
)
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
_PROVABLE_DIGITS = 3  # of the end of a run that is proved
_TOO_UNCERTAIN = "these inputs are too uncertain for a proof"
_NO_SLOPES = {"s_per_unit": None, "deg_per_h_per_unit": None}
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
    scene: Scene,
    widths: dict[str, str],
    asked: Sequence[Asked],
    estimates: dict[str, Any],
    begin: Show,
) -> dict[str, Any]:
    """Return what is proved for uncertain inputs, over as much of the run as the proof reaches.

    These are intervals of period, precession, full turn, first transits and passages, and the
    passages that were asked for; beside them estimates over the whole run. If the inputs are too
    uncertain for a proof of the whole run, or of a passage, `narrowing` tells which the proof needs
    to be narrower.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.
        asked: passages of each section.
        estimates: of period and precession, from `effects_document`.
        begin: begins a piece of work that is shown to the user.
    """
    whole = _without_grid(scene)
    t_end_s = float(whole.run.t_end)
    # a look at the states alone costs little
    holds_s = reach_s(whole, widths, begin(f"{scene.id}: how far a proof reaches", t_end_s))
    ranges = None
    slopes: dict[str, Any] = {}
    if holds_s > 0:
        ranges, slopes = _ranges_and_slopes(whole, widths, holds_s, begin)

    document = _ranges_document(whole, widths, ranges, asked) | estimates
    document["limits"] = {
        name: limit | slopes.get(name, _NO_SLOPES) for name, limit in estimates["limits"].items()
    }
    if slopes:
        document["derivatives_over_s"] = _provable(whole, holds_s).run.t_end
    if LOWEST in section_words(whole):
        document["gate_across"] = gate_across(whole)
    _estimate_passages(whole, widths, asked, document)
    _prove_alone(whole, widths, document, begin)
    narrowing = _narrowing(whole, widths, document, begin)
    if narrowing:
        document["narrowing"] = narrowing
    return document


def _ranges_and_slopes(
    scene: Scene, widths: dict[str, str], holds_s: float, begin: Show
) -> tuple[Ranges | None, dict[str, Any]]:
    """Return the proof, and the derivatives over as much of the run as it was expected to hold for."""
    part = _provable(scene, holds_s)
    end_s = float(part.run.t_end)
    # in a process of its own: it takes as long as the intervals do
    with in_background(True, _send_near, part, widths) as near:
        report = begin(f"{scene.id}: proving", end_s)
        ranges = _as_far_as_it_goes(scene, widths, holds_s, report)
        slopes = near.result(begin(f"{scene.id}: derivatives", end_s))
    return ranges, slopes


def _without_grid(scene: Scene) -> Scene:
    """Return a scene with transits, and with the release and the end as its grid."""
    return scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "true"})


def _ending_at(scene: Scene, t_end: str) -> Scene:
    """Return a scene whose run ends earlier."""
    return _without_grid(scene.with_values({"run.t_end": t_end}))


def _provable(scene: Scene, holds_s: float) -> Scene:
    """Return a scene whose run ends where a proof of it ends."""
    if holds_s < float(scene.run.t_end):
        return _ending_at(scene, rounded_down(holds_s, _PROVABLE_DIGITS))
    return scene


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
    words = scene.run.sections or ()
    sections = list(dict.fromkeys((*words, "highest")))
    for _ in range(_TRIES):
        if holds_s <= 0:
            return None
        part = _provable(scene, holds_s)
        try:
            return prove_ranges(part, widths, derivatives=True, sections=sections, report=report)
        except BoxTooWideError as error:
            # zeros near the end need a little more than states do
            holds_s = min(error.holds_s, 0.95 * float(part.run.t_end))
    return None


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
        passages = [
            _numbered(word, passage) | {"reason": "nothing is proved"}
            for word, passage in _in_each_section(scene, asked)
        ]
        return document | {"reason": _TOO_UNCERTAIN, "passages": passages}
    swing = ranges.swing
    omitted = _left_out(swing) if swing else {}
    useless = ["precession_deg_per_h"] if _says_nothing(scene, swing) else []
    words = scene.run.sections or ()
    passages = [_passage(ranges, word, passage) for word, passage in _in_each_section(scene, asked)]
    return document | {
        "period_s": _texts(ranges.period),
        **_interval_texts(swing, _MEAN[1:]),
        "left_out": omitted,
        "useless": useless,
        "first_transits_s": _first_times(ranges.transits),
        "first_passages_s": {word: _first_times(ranges.sections[word].table) for word in words},
        "possible": len(ranges.possible),
        "passages": passages,
    }


def _in_each_section(scene: Scene, asked: Sequence[Asked]) -> list[tuple[str, Asked]]:
    """Return the passages that were asked for, of each section in turn."""
    return [(word, passage) for word in section_words(scene) for passage in asked]


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


def _numbered(word: str, asked: Asked) -> dict[str, Any]:
    """Return a passage in the form of --json, without a time."""
    passage: dict[str, Any] = {"section": word, "number": asked.number}
    if asked.width_s is not None:
        passage["wanted_s"] = str(float(asked.width_s))
    return passage


def _passage(ranges: Ranges, word: str, asked: Asked) -> dict[str, Any]:
    """Return the interval of a passage in the form of --json, or why there is none."""
    passage = _numbered(word, asked)
    interval = passage_interval(ranges, word, asked.number)
    if isinstance(interval, str):
        return passage | {"reason": interval}
    return passage | _timed(interval, ranges.period)


def _timed(interval: Ends, period: Ends | None) -> dict[str, Any]:
    """Return the time of a passage in the form of --json."""
    # wider than half a swing, it may hold other passages as well
    useless = period is not None and interval.high - interval.low > period.low / 2
    return {"t_s": list(ends(*interval)), "useless": useless}


def _estimate_passages(
    scene: Scene, widths: dict[str, str], asked: Sequence[Asked], document: dict[str, Any]
) -> None:
    """Add to the passages their estimated times, and which inputs limit these."""
    if not document["passages"]:
        return
    period = document["first_order"].get("period_s")
    longest_s = float(period[1]) if period else None
    estimates = PassageEstimates(scene, widths, asked, longest_s)
    asked_passages = _in_each_section(scene, asked)
    for passage, (word, asked_passage) in zip(document["passages"], asked_passages, strict=True):
        estimate = estimates.document(word, asked_passage)
        if "t_s" in passage:
            # what is proved comes, whatever is estimated
            estimate.pop("reason", None)
        passage.update(estimate)


def _prove_alone(
    scene: Scene, widths: dict[str, str], document: dict[str, Any], begin: Show
) -> None:
    """Prove passages again in runs that end just after them, which gives narrower intervals.

    These are the passages that are not proved, or not to the width that was asked for.
    """
    period = document["first_order"].get("period_s")
    own_period = Ends(*map(Fraction, period)) if period else None
    for passage in document["passages"]:
        if not _falls_short(passage):
            continue
        part = ending_after(scene, _latest_s(passage, period))
        word = passage["section"]
        number = passage["number"]
        report = begin(f"{scene.id}: {passage_name(word, number)}", float(part.run.t_end))
        try:
            interval = interval_alone(part, widths, word, number, report)
        except BoxTooWideError as error:
            interval = ends_before(error.holds_s)
        if not isinstance(interval, str):
            narrowest = _both(interval, passage.get("t_s"))
            passage.pop("reason", None)
            passage.update(_timed(narrowest, own_period))
        elif "reason" in passage:
            passage["reason"] = interval


def _falls_short(passage: dict[str, Any]) -> bool:
    """Return whether a passage is in the run, but not proved, or not to the width that was asked for."""
    if "t_s" not in passage:
        return "estimate_s" in passage
    low, high = map(Fraction, passage["t_s"])
    return "wanted_s" in passage and high - low > 2 * Fraction(passage["wanted_s"])


def _both(interval: Ends, other: Sequence[str] | None) -> Ends:
    """Return what is in an interval, and in another one if there is one."""
    if other is None:
        return interval
    low, high = map(Fraction, other)
    return Ends(max(interval.low, low), min(interval.high, high))


def _narrowing(
    scene: Scene, widths: dict[str, str], document: dict[str, Any], begin: Show
) -> dict[str, Any]:
    """Return which inputs to know better: for the passages asked for, or else for the whole run."""
    passages = [
        passage for passage in document["passages"] if "t_s" in passage or "estimate_s" in passage
    ]
    # who asks for passages needs no proof beyond them
    falls_short = document["over_s"] != scene.run.t_end and not document["passages"]
    goals = len(passages) + falls_short
    if not goals:
        return {}
    report = begin(f"{scene.id}: narrower inputs", goals, "proofs")
    narrowing = Narrowing(scene, widths, goals, report)
    by_goal = {}
    for passage in passages:
        name = f"{passage['section']} {passage['number']}"
        until_s = _latest_s(passage, document["first_order"].get("period_s"))
        by_goal[name] = narrowing.for_a_passage(passage, until_s)
    if falls_short:
        by_goal["run"] = narrowing.for_the_run(float(document["over_s"]))
    return by_goal


def _latest_s(passage: dict[str, Any], period_s: Sequence[str] | None) -> Fraction:
    """Return the time by which a passage has come; an estimate where it is not proved.

    Args:
        passage: in the form of --json.
        period_s: the range of the period, to first order.
    """
    if "t_s" in passage:
        return Fraction(passage["t_s"][1])
    own_s = Fraction(passage["estimate_s"])
    if period_s is None:
        return own_s
    shortest_s, longest_s = map(Fraction, period_s)
    # one swing more, as the release is uncertain too
    return own_s * longest_s / shortest_s + longest_s


def _send_near(emit: Emit, scene: Scene, uncertain: dict[str, str]) -> None:
    """Send the derivatives of period and precession with respect to each input, as intervals.

    They are proved close to the scene's own inputs. None is sent if that cannot be proved.
    """
    closer = {name: f"±{width}e-{_CLOSER}" for name, width in uncertain.items()}
    try:
        near = prove_ranges(
            scene, closer, derivatives=True, sections="highest", report=reports(emit)
        )
    except UnreachableError:
        emit({})
        return
    slopes = {}
    for name in uncertain:
        derivative = near.derivative(name)
        slopes[name] = {
            "s_per_unit": _texts(derivative.period),
            "deg_per_h_per_unit": _texts(derivative.precession),
        }
    emit(slopes)
