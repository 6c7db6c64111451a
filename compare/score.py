"""The oracle's verdict on a candidate: how far off, to how many digits, where worst, and why."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from reference import Golden, Scene
from reference.constants import constants
from reference.dense import WITHIN
from reference.mechanics import rest_position
from reference.precision import context
from reference.sensitivity import sensitivity
from reference.solution import Array

from .cache import kept
from .candidate import Candidate
from .diagnosis import Diagnosis, diagnose
from .ellipse import EllipseErrors
from .external import Timing
from .metrics import Errors, drifts, errors_of
from .transits import TransitErrors, transit_errors
from .truth import DIGITS, FINE, golden_of, truth_at

TOLERANCE = 1e-6  # of the amplitude, where no tolerance is given
FLOOR_TIMES = 289

READINGS = ("auto", "decimal", "binary64")


@dataclass(frozen=True)
class Score:
    """What the oracle says of a candidate.

    Attributes:
        candidate: what was judged.
        scene: in the reading that it was judged in.
        why_inputs: why in that reading.
        golden: the dataset that the truth comes from.
        errors: at the candidate's times.
        tolerance_m: largest position error allowed.
        input_floor_m: how far the rounding of the inputs to binary64 alone moves the bob.
        ellipse: turn of the swing plane and delay.
        drifts: of h and of |r| - l, where the candidate has the columns.
        transits: how its transits compare, or None.
        timing: what the program took, or None.
        diagnosis: what explains the error, or None.
    """

    candidate: Candidate
    scene: Scene
    why_inputs: str
    golden: Golden
    errors: Errors
    tolerance_m: float
    input_floor_m: float
    ellipse: EllipseErrors
    drifts: dict[str, float]
    transits: TransitErrors | None = None
    timing: Timing | None = None
    diagnosis: Diagnosis | None = field(default=None)

    @property
    def agrees(self) -> bool:
        """True if every position and every transit is within the tolerance, and no transit is missed or extra."""
        if self.errors.max_m > self.tolerance_m:
            return False
        found = self.transits
        return found is None or not (found.missed or found.extra or found.max_conditioned_m > self.tolerance_m)

    @property
    def verdict(self) -> str:
        """The word of the contract."""
        return "agrees" if self.agrees else "disagrees"

    @property
    def at_bound(self) -> bool:
        """True if the error is not above what the reference itself may be off by."""
        return self.errors.max_m <= self.errors.bound_m


def score(
    candidate: Candidate,
    scene: Scene,
    *,
    transits: Array | None = None,
    tolerance: float | None = None,
    inputs: str = "auto",
    explain: bool = True,
    announce: Callable[[str], None] | None = None,
) -> Score:
    """Hold a candidate against the truth of a scene.

    Args:
        candidate: its trajectory, at times of its own.
        scene: the problem it claims to solve.
        transits: times of its zeros of xdot in s; those that came with the trajectory if None.
        tolerance: largest position error allowed in m; `TOLERANCE` times the amplitude if None.
        inputs: decimal, binary64, or auto: binary64 for programs whose numbers fit in a double.
        explain: whether to look for the reason where it disagrees.
        announce: told what takes long.

    Raises:
        InputError: a time of the candidate is outside the scene's span.
        UnreachableError: the scene cannot be solved.
    """
    read_as, why = _reading(candidate, scene, inputs)
    golden = golden_of(read_as, scene.run.digits if candidate.extended else DIGITS, announce)
    errors = errors_of(candidate, truth_at(golden, candidate.t, FINE if candidate.extended else WITHIN))
    allowed = TOLERANCE * errors.amplitude_m if tolerance is None else tolerance
    times = candidate.transits if transits is None else transits
    made = Score(
        candidate=candidate,
        scene=read_as,
        why_inputs=why,
        golden=golden,
        errors=errors,
        tolerance_m=allowed,
        input_floor_m=input_floor(scene, float(candidate.t[-1])),
        ellipse=errors.ellipse(_rest(scene)),
        drifts=drifts(candidate, read_as),
        transits=None if times is None else _transits(times, golden, float(candidate.t[-1])),
    )
    if explain and errors.max_m > allowed and not made.at_bound:
        return replace(made, diagnosis=diagnose(candidate, errors, read_as, None))
    return made


def _reading(candidate: Candidate, scene: Scene, inputs: str) -> tuple[Scene, str]:
    if inputs != "auto":
        return scene.with_values([f"inputs={inputs}"]), "as asked"
    if scene.inputs == "binary64":
        return scene, "as the scene says"
    if candidate.extended:
        return scene, "its numbers have more digits than a double: it can hold the decimal inputs"
    return scene.with_values(
        ["inputs=binary64"]
    ), "its numbers are doubles, and so its inputs must have been rounded to doubles"


def _rest(scene: Scene) -> tuple[float, float]:
    ctx = context(80)
    k = constants(scene.exact, ctx)
    try:
        x, y, _ = rest_position(k, ctx)
    except ValueError:
        return 0.0, 0.0
    return float(x * k.length), float(y * k.length)


def _transits(times: Array, golden: Golden, until: float) -> TransitErrors:
    k = constants(golden.scene.exact, context(80)).converted(float)
    omega = math.sqrt(math.hypot(k.pull[1], k.pull[2]))
    truth = golden.transits
    begun = times[times > 0] if len(times) and times[0] == 0 else times  # a release at rest is no transit
    return transit_errors(begun, truth["t"], truth["ax"], omega, until)


def input_floor(scene: Scene, until: float) -> float:
    """How far in m the rounding of the decimal inputs to binary64 alone moves the bob up to a time in s."""
    decimal = scene.with_values(["inputs=decimal"])
    document = decimal.model_dump(mode="json")
    parts = [document[key] for key in ("pendulum", "site", "release")]
    recipe = hashlib.sha256(json.dumps([parts, until], sort_keys=True).encode()).hexdigest()[:32]

    def make(path: Path) -> None:
        times = np.linspace(0.0, until, FLOOR_TIMES) if until > 0 else np.zeros(1)
        moved = sensitivity(decimal, times).rounding()[:, :3]
        path.write_text(repr(float(np.sqrt((moved**2).sum(axis=1)).max())))

    return float(kept("floor", f"{recipe}.txt", make).read_text())


def document(made: Score) -> dict[str, Any]:
    """A score as the JSON document of the contract."""
    errors, found = made.errors, made.transits
    row, component = errors.worst
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
        "scale_m": errors.amplitude_m,
        "tolerance_m": made.tolerance_m,
        "input_floor_m": made.input_floor_m,
        "error_over_floor": errors.max_m / made.input_floor_m if made.input_floor_m else None,
        "growth_exponent": errors.growth,
        "swing_plane_error_deg": float(np.degrees(made.ellipse.largest_turn)),
        "phase_error_s": made.ellipse.largest_delay,
        "h_drift_m2_s2": made.drifts.get("h_m2_s2"),
        "length_drift_m": made.drifts.get("length_m"),
        "worst": {
            "t": float(errors.t[row]),
            "component": component,
            "expected": float(expected),
            "got": float(column[row]),
        },
        "transits": None,
        "reference": {"level": made.golden.manifest.level, "bound_m": errors.bound_m},
        "diagnosis": None,
        "notes": list(made.candidate.notes),
    }
    if found is not None:
        shown["transits"] = {
            "matched": found.matched,
            "missed": len(found.missed),
            "extra": len(found.extra),
            "shifted": len(found.shifted(made.tolerance_m)),
            "max_error_s": found.max_error_s,
            "max_conditioned_error_m": found.max_conditioned_m,
            "missed_at": found.missed,
            "extra_at": found.extra,
        }
    if made.timing is not None:
        shown["timing"] = vars(made.timing)
    if made.diagnosis is not None:
        shown["diagnosis"] = vars(made.diagnosis)
    return shown
