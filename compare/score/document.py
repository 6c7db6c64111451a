"""Write a score as the JSON document of `foucault score --json`."""

from __future__ import annotations

import math
from typing import Any

from .explanation.findings import Explanation
from .scored import Score


def document(score: Score) -> dict[str, Any]:
    """Return a score as a JSON document; its keys are part of the command line's contract."""
    errors, transits = score.errors, score.transits
    turn = score.swing.largest_turn
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
        "input_floor_m": score.input_floor_m,
        "error_over_floor": errors.max_m / score.input_floor_m if score.input_floor_m else None,
        "growth_exponent": errors.growth_exponent,
        "swing_plane_error_deg": None if turn is None else math.degrees(turn),
        "phase_error_s": score.swing.largest_delay,
        "h_drift_m2_s2": score.drifts.get("h_m2_s2"),
        "length_drift_m": score.drifts.get("length_m"),
        "worst": score.worst._asdict(),
        "worst_of_each": {name: worst._asdict() for name, worst in score.worst_of_each.items()},
        "transits": None,
        "reference": {"level": score.golden.manifest.level, "bound_m": errors.bound_m},
        "grade": score.grade,
        "conventions": [{"id": one.id, "text": one.text} for one in score.candidate.conventions],
        "model": None,
        "causes": [],
        "corrected": None,
        "slip": None,
        "diagnosis": None,
        "notes": list(score.notes),
    }
    if transits is not None:
        fields["transits"] = {
            "matched": transits.matched,
            "missed": len(transits.missed),
            "extra": len(transits.extra),
            "shifted": len(transits.shifted(score.allowed_m)),
            "max_error_s": transits.max_error_s,
            "max_conditioned_error_m": transits.max_conditioned_m,
            "missed_at": transits.missed,
            "extra_at": transits.extra,
            "undecided_at": transits.undecided,
        }
    if score.timing is not None:
        fields["timing"] = vars(score.timing)
    if score.explanation is not None:
        fields |= _explained(score.explanation, fields["conventions"])
    return fields


def _explained(found: Explanation, known: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the keys that an explanation fills."""
    conventions = [{"id": one.id, "text": f"your file {one.text}", "size_m": one.size_m} for one in found.conventions]
    causes = [
        {"id": one.id, "text": f"your program {one.text}", "size_m": one.size_m}
        | {
            key: getattr(one, key)
            for key in ("value", "shift", "uncertainty")
            if math.isfinite(getattr(one, key) or 0.0)
        }
        for one in found.causes
    ]
    diagnosis = found.diagnosis
    return {
        "conventions": [*known, *conventions],
        "model": None if found.model is None else vars(found.model),
        "causes": causes,
        "corrected": {"max_error_m": found.corrected_m} if math.isfinite(found.corrected_m) else None,
        "slip": found.slip or None,
        "diagnosis": None if diagnosis is None else vars(diagnosis),
    }
