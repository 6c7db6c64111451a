"""A judgement as the JSON document of `foucault score --json`; its keys are part of the command line's contract."""

from __future__ import annotations

import math
from typing import Any

from ..diagnosis import Explanation, Since, explanation_document
from .verdict import REFUSED, Outcome, Score


def of_outcome(outcome: Outcome) -> dict[str, Any]:
    """Return an outcome as a JSON document, or as a row of one of several."""
    if outcome.score is not None:
        return document(outcome.score)
    return {
        "scene": outcome.scene,
        "candidate": outcome.name,
        "verdict": REFUSED,
        "error": str(outcome.error),
    }


def document(score: Score) -> dict[str, Any]:
    """Return a score as a JSON document."""
    errors = score.errors
    transits = score.transits
    turn = score.swing.largest_turn
    floor_m = score.input_floor_m
    readings = [
        {"id": convention.id, "text": convention.text} for convention in score.candidate.conventions
    ]
    fields: dict[str, Any] = {
        "scene": score.scene.id,
        "candidate": score.candidate.name,
        "verdict": score.verdict,
        "inputs": score.scene.inputs,
        "why_inputs": score.why_inputs,
        "rows": len(errors.t),
        "covered": score.covered,
        "covered_s": [float(errors.t[0]), float(errors.t[-1])],
        "max_error_m": errors.max_m,
        "rms_error_m": errors.rms_m,
        "end_error_m": errors.end_m,
        "at_or_below_bound": score.at_bound,
        "digits": errors.digits,
        "scd": errors.scd,
        "mescd": errors.mescd,
        "scale_m": errors.amplitude_m,
        "tolerance_m": score.tolerance_m,
        "input_floor_m": floor_m,
        "error_over_floor": errors.max_m / floor_m if floor_m else None,
        "growth_exponent": errors.growth_exponent,
        "swing_plane_error_deg": None if turn is None else math.degrees(turn),
        "phase_error_s": score.swing.largest_delay,
        "h_drift_m2_s2": score.drifts.get("h_m2_s2"),
        "length_drift_m": score.drifts.get("length_m"),
        "worst": score.worst._asdict(),
        "worst_of_each": {name: worst._asdict() for name, worst in score.worst_of_each.items()},
        "transits": None if transits is None else transits.document(score.allowed_m),
        "reference": {"level": score.golden.level, "bound_m": errors.bound_m},
        "grade": score.grade,
        **explanation_document(score.explanation or Explanation(), readings),
        "baseline": None if score.since is None else _changed(score.since),
        "problem": score.problem,
        "notes": list(score.notes),
    }
    if score.timing is not None:
        fields["timing"] = vars(score.timing)
    if score.experiments is not None:
        fields["experiments"] = score.experiments.document()
    return fields


def _changed(since: Since) -> dict[str, Any]:
    return vars(since) | {"better": since.better, "text": since.text}
