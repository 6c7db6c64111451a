"""Why a method failed on a scene: one sentence, derived from the measured numbers."""

from __future__ import annotations

import math

from reference.status import Status

from .character import Character
from .row import Row

EXPLICIT_REACH = 3.3  # rate times step up to which an explicit method of order 5 to 8 is stable, about


def reason_of(
    row: Row, status: Status, traits: Character, digits: float | None, requested: float, limit_s: float
) -> str:
    """Return the causes that the numbers point to, the strongest first; empty if the run is right."""
    if status == Status.OK:
        return ""
    if status in (Status.NOT_INSTALLED, Status.REFUSED):
        return row.reason
    causes = [*_causes(row, status, traits)]
    reported = f" It reported: {row.reason.rstrip('.')}." if row.reason and status != Status.OUT_OF_TIME else ""
    if status == Status.OUT_OF_TIME:
        cost = (
            f"the whole span would take about {row.cpu_s:.2g} s; the limit is {limit_s:g} s"
            if row.cpu_s
            else row.reason
        )
        return _sentence([cost, *causes])
    if status == Status.ILL_CONDITIONED and digits is not None:
        return _sentence(
            [
                f"the flow magnifies an error at the release {traits.magnified:.1g} times; the result is off by "
                f"{10 ** (requested - digits):.1g} times what was asked for"
            ]
        )
    if status == Status.SILENTLY_WRONG and digits is not None:
        head = f"success was reported with {max(digits, 0):.1f} digits where {requested:.1f} were asked for"
        return _sentence([head, *(causes or [_accumulated(row)])])
    return _sentence(causes or ["no measured property of the scene explains it"]) + reported


def _causes(row: Row, status: Status, traits: Character) -> list[str]:
    causes = []
    if traits.stiff:
        steps = traits.damping * traits.span / EXPLICIT_REACH
        text = f"stiff: rates up to {traits.damping:.2g}/s, a factor of {traits.ratio:.1g} apart"
        causes.append(f"{text}, so that an explicit method needs about {steps:.1g} steps")
    if row.formulation in ("angles", "lagrangian") and traits.nearest < 1e-3:
        causes.append(
            f"the path passes the vertical within {traits.nearest:.1g} of the length, where the azimuth jumps"
        )
    if row.formulation == "plane" and traits.amplitude > 0.99:
        causes.append("the path reaches the height of the suspension, where x and y do not determine the state")
    if row.formulation == "space" and traits.least_tension < 0:
        text = f"the rod is pushed (least tension {traits.least_tension:.2g}/s²): |r| - l grows exponentially"
        causes.append(text)
    if status != Status.OUT_OF_TIME and traits.magnified > 1e3:
        causes.append(f"the flow amplifies an error at the release {traits.magnified:.1g} times")
    if status == Status.SILENTLY_WRONG and 0 < traits.amplitude < 1e-5 and row.kind != "precision":
        lost = -math.log10(traits.amplitude)
        causes.append(
            f"the amplitude is {traits.amplitude:.1g} of the length: "
            f"cancellation against z ≈ −l costs {lost:.0f} digits"
        )
    return causes


def _accumulated(row: Row) -> str:
    steps = f"{row.steps} steps" if row.steps else "its steps"
    drift = f"; h drifts by {row.h_drift:.1g} of the kinetic energy" if row.h_drift else ""
    return f"the local errors of {steps} add up{drift}"


def _sentence(parts: list[str]) -> str:
    text = "; ".join(part for part in parts if part)
    return text[:1].upper() + text[1:] + "." if text else ""
