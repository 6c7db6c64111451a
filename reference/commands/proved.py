"""Proofs that `foucault show` prints: intervals of a scene's swing, and of what uncertain inputs leave."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..dataset.ranges import ends
from ..engines.registry import in_background
from ..numbers.precision import rounded_up
from ..scenes.scene import Scene, unit_of
from ..solver.solve import solve
from ..solver.swing import Swing, left_out, left_out_texts
from ..solver.uncertain import exact_texts, prove_ranges, widths_of
from ..system.workers import Emit

FIRST = 3  # transits, and passages of each section, that are printed for uncertain inputs
PROVED_DIGITS = 15  # of the highest points from which period and precession follow
SWING = {
    "swing_hz": "hz",
    "period_s": "period",
    "precession_deg_per_h": "precession",
    "full_turn_h": "full_turn",
}
MEAN = ("period_s", "precession_deg_per_h", "full_turn_h")  # of uncertain inputs
# powers of ten by which inputs are less uncertain where the derivatives to them are taken
CLOSER = 6


def proved_swing(scene: Scene) -> dict[str, Any]:
    """Return proven intervals of frequency, period, precession and full turn over the run, from its highest points.

    Raises:
        UnreachableError: the level enclosed is out of reach.
    """
    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "false"})
    swing = solve(scene, level="enclosed", digits=PROVED_DIGITS, sections="highest").swing_or_reason
    proved = {"over_s": scene.run.t_end, **_interval_texts(swing, SWING)}
    return proved | (
        {"reason": swing} if isinstance(swing, str) else {"left_out": _left_out(swing)}
    )


def _left_out(swing: Swing) -> dict[str, str]:
    return left_out(swing.reason, swing.full_turn is None)


def _interval_texts(swing: Any, names: Iterable[str]) -> dict[str, list[str] | None]:
    """Return intervals of what a swing has, as text; None where one is open."""
    return {
        name: list(ends(*interval)) if (interval := getattr(swing, SWING[name], None)) else None
        for name in names
    }


def swing_line(proved: dict[str, Any]) -> str:
    """Return in a line what is proved of the swing."""
    if "reason" in proved:
        return f"[proved, over {proved['over_s']} s] no period: {proved['reason']}"
    texts = [
        f"{name} = {value[0]} to {value[1]}"
        for name, value in proved.items()
        if isinstance(value, list)
    ]
    return f"[proved, over {proved['over_s']} s] " + ", ".join(
        [*texts, *left_out_texts(proved["left_out"])]
    )


def proved_ranges(scene: Scene, widths: dict[str, str]) -> dict[str, Any]:
    """Return proven intervals of period, precession, full turn, the first transits and passages, for uncertain inputs.

    Raises:
        InputError: an input, or a width.
        UnreachableError: the box is too wide.
    """
    words = scene.run.sections or ()
    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "true"})
    texts = exact_texts(widths_of(scene, widths))
    # it takes as long as the intervals do
    with in_background(True, _send_limits, scene, texts) as limits:
        ranges = prove_ranges(
            scene, widths, derivatives=True, sections=[*dict.fromkeys((*words, "highest"))]
        )
        tables = {
            "transit": ranges.transits,
            **{word: ranges.sections[word].table for word in words},
        }
        first = {
            word: [list(ends(*t)) for t in table.exact("t")[:FIRST]]
            for word, table in tables.items()
        }
        return {
            "over_s": scene.run.t_end,
            "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
            "period_s": ranges.period and list(ends(*ranges.period)),
            **_interval_texts(ranges.swing, MEAN[1:]),
            "left_out": _left_out(ranges.swing) if ranges.swing else {},
            "first_transits_s": first.pop("transit"),
            "first_passages_s": first,
            "possible": len(ranges.possible),
            "limits": limits.result(),
        }


def _send_limits(emit: Emit, scene: Scene, uncertain: dict[str, str]) -> None:
    """Send how far each input moves the period, to first order: by derivatives close to the scene's own inputs.

    With it go the derivatives of period and precession to the input, as intervals.
    """
    closer = {name: f"±{width}e-{CLOSER}" for name, width in uncertain.items()}
    near = prove_ranges(scene, closer, derivatives=True, sections="highest")
    limits = {}
    for name, (far, share) in near.shares().items():
        derivative, moves = (
            near.derivative(name),
            {"moves_period_s": rounded_up(far * 10**CLOSER), "share": share},
        )
        slopes = {
            "s_per_unit": derivative.period or (far, far),
            "deg_per_h_per_unit": derivative.precession,
        }
        limits[name] = moves | {
            word: slope and list(ends(*slope)) for word, slope in slopes.items()
        }
    emit(limits)


def ranges_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield what holds for all values of uncertain inputs, and which of them limits the period."""
    if "reason" in ranges:
        yield f"[ranges] left out: {ranges['reason']}"
        return
    box = ", ".join(f"{name} {width}" for name, width in ranges["uncertain"].items())
    texts = [
        f"{name} = {ranges[name][0]} to {ranges[name][1]}"
        if ranges[name]
        else f"{name} is not decided"
        for name in MEAN
        if any(ranges[name] for name in MEAN) and name not in ranges["left_out"]
    ]
    texts += left_out_texts(ranges["left_out"])
    texts = texts or ["no period: the intervals of these inputs leave it open"]
    texts += [
        f"transit {k} = {low} to {high} s"
        for k, (low, high) in enumerate(ranges["first_transits_s"], 1)
    ]
    for word, passages in ranges["first_passages_s"].items():
        texts += [
            f"passage {k} of {word} = {low} to {high} s"
            for k, (low, high) in enumerate(passages, 1)
        ]
        texts += [] if passages else [f"no passage of {word} is decided"]
    yield f"[ranges, over {ranges['over_s']} s, proved for every {box}] {', '.join(texts)}"
    limits = sorted(ranges["limits"].items(), key=lambda item: -item[1]["share"])
    if limits:
        yield "which input limits you: what each alone moves the period by, to first order, and its share"
    for name, limit in limits:
        unit = unit_of(name).replace("degrees", "degree")
        moved = f"{limit['moves_period_s']} s, {100 * limit['share']:.1f} %"
        slope = "the period changes by {} to {} s".format(*limit["s_per_unit"])
        if limit["deg_per_h_per_unit"]:
            slope += ", the precession by {} to {} degrees an hour".format(
                *limit["deg_per_h_per_unit"]
            )
        yield f"  {name} {ranges['uncertain'][name]}: {moved} ({slope}{unit and ' per '}{unit})"
