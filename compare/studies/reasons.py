"""Why a method failed on a scene, in a sentence, from what was measured."""

from __future__ import annotations

import math

from .character import Character
from .row import Row

ROUNDING = 2.0**-53
EXPLICIT_REACH = 3.3  # of the real axis, that an explicit method of order 5 to 8 has per step, about


def reason_of(row: Row, status: str, marks: Character, digits: float | None, asked: float, limit_s: float) -> str:
    """The cause that the numbers point to, the strongest first; empty where nothing is wrong."""
    if status == "ok":
        return ""
    if status in ("not_installed", "refused"):
        return row.reason
    causes = [*_causes(row, status, marks)]
    said = f" It said: {row.reason.rstrip('.')}." if row.reason and status != "out_of_time" else ""
    if status == "out_of_time":
        cost = f"the whole would take about {row.cpu_s:.0f} s; the limit is {limit_s:g} s" if row.cpu_s else row.reason
        return _sentence([cost, *causes])
    if status == "silently_wrong" and digits is not None:
        head = f"success reported with {max(digits, 0):.1f} digits where {asked:.1f} were asked for"
        return _sentence([head, *(causes or [_accumulated(row)])])
    return _sentence(causes or ["nothing in the scene's numbers explains it"]) + said


def _causes(row: Row, status: str, marks: Character) -> list[str]:
    found = []
    if marks.stiff:
        steps = marks.damping * marks.span / EXPLICIT_REACH
        text = f"stiff: rates up to {marks.damping:.2g}/s, {marks.ratio:.1g} apart"
        found.append(f"{text}, so that an explicit method needs about {steps:.1g} steps")
    if row.formulation in ("angles", "lagrangian") and marks.nearest < 1e-3:
        found.append(f"the path passes the vertical within {marks.nearest:.1g} of the length, where the azimuth jumps")
    if row.formulation == "plane" and marks.amplitude > 0.99:
        found.append("the path reaches the height of the suspension, where x and y do not tell the state")
    if row.formulation == "space" and marks.least_tension < 0:
        text = f"the rod is pushed (least tension {marks.least_tension:.2g}/s²): |r| - l grows exponentially"
        found.append(text)
    if status != "out_of_time" and marks.magnified > 1e3:
        found.append(f"the flow magnifies an error at the release {marks.magnified:.1g} times")
    if status == "silently_wrong" and 0 < marks.amplitude < 1e-5 and row.kind != "precision":
        lost = -math.log10(marks.amplitude)
        found.append(
            f"the amplitude is {marks.amplitude:.1g} of the length: rounding beside z = -l costs {lost:.0f} digits"
        )
    return found


def _accumulated(row: Row) -> str:
    steps = f"{row.steps} steps" if row.steps else "its steps"
    drift = f"; h drifts by {row.h_drift:.1g} of the kinetic energy" if row.h_drift else ""
    return f"the local errors of {steps} add up{drift}"


def _sentence(parts: list[str]) -> str:
    text = "; ".join(part for part in parts if part)
    return text[:1].upper() + text[1:] + "." if text else ""
