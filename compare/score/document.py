"""A score as the JSON document of the command line."""

from __future__ import annotations

import math
from typing import Any

from .judge import Score


def document(made: Score) -> dict[str, Any]:
    """A score as the JSON document of the contract."""
    errors, found = made.errors, made.transits
    row, component = errors.worst
    turn = made.ellipse.largest_turn
    column = made.candidate.columns[component]
    expected = errors.truth.states[row, "xyz".index(component)]
    shown: dict[str, Any] = {
        "scene": made.scene.id,
        "candidate": made.candidate.name,
        "verdict": made.verdict,
        "inputs": made.scene.inputs,
        "why_inputs": made.why_inputs,
        "rows": len(errors.t),
        "covered_s": [float(errors.t[0]), float(errors.t[-1])],
        "max_error_m": errors.max_m,
        "rms_error_m": errors.rms_m,
        "end_error_m": errors.end_m,
        "at_or_below_bound": made.at_bound,
        "digits": errors.digits,
        "scd": errors.scd,
        "mescd": errors.mescd,
        "scale_m": errors.amplitude_m,
        "tolerance_m": made.tolerance_m,
        "input_floor_m": made.input_floor_m,
        "error_over_floor": errors.max_m / made.input_floor_m if made.input_floor_m else None,
        "growth_exponent": errors.growth_exponent,
        "swing_plane_error_deg": None if turn is None else math.degrees(turn),
        "phase_error_s": made.ellipse.largest_delay,
        "h_drift_m2_s2": made.drifts.get("h_m2_s2"),
        "length_drift_m": made.drifts.get("length_m"),
        "worst": {
            "t": float(errors.t[row]),
            "component": component,
            "expected": float(expected),
            "got": float(column[row]),
            "difference": float(errors.components[component][row]),
        },
        "transits": None,
        "reference": {"level": made.golden.manifest.level, "bound_m": errors.bound_m},
        "diagnosis": None,
        "notes": list(made.notes),
    }
    if found is not None:
        shown["transits"] = {
            "matched": found.matched,
            "missed": len(found.missed),
            "extra": len(found.extra),
            "shifted": len(found.shifted(made.allowed_m)),
            "max_error_s": found.max_error_s,
            "max_conditioned_error_m": found.max_conditioned_m,
            "missed_at": found.missed,
            "extra_at": found.extra,
            "undecided_at": found.undecided,
        }
    if made.timing is not None:
        shown["timing"] = vars(made.timing)
    if made.diagnosis is not None:
        shown["diagnosis"] = vars(made.diagnosis)
    return shown
