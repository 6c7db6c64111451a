"""A judgement in lines for people, and as the JSON document of `foucault score --json`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from html import escape
from typing import Any

from reference import FoucaultError, Solution
from reference.status import Status

from ..candidates.candidate import Deviation
from .explanation.case import Explanation
from .scored import Scored, Since
from .transit_matching import entry

REFUSED = Status.REFUSED.value  # the verdict on a candidate that could not be judged


@dataclass(frozen=True, repr=False)
class Score(Scored):
    """The judgement of a candidate.

    Attributes:
        candidate: the trajectory that was judged.
        scene: the problem, its inputs read as decimals or as doubles.
        why_inputs: the reason for that reading.
        golden: the dataset that the truth comes from, or the scene solved to no more than the verdict takes.
        errors: at the candidate's times.
        tolerance_m: largest position error allowed, in m.
        swing: turn of the swing plane and delay.
        drifts: of h and of `|r| - l`, if the candidate has the columns.
        covers: share of the scene's span that was demanded, from 0 to 1.
        as_model: whether agreement as a named model is enough.
        notes: remarks that a reader ought to know.
        transits: errors of its transits, or None.
        timing: run time of the program, or None.
        explanation: the likely reasons for the error; None if they were not looked for.
        experiments: runs of the program with other numbers, and what they measured; None if none were asked for.
        since: the changes since a baseline, if there is one.
    """

    def __repr__(self) -> str:
        return f"Score({self.verdict} with {self.scene.id}: {self.errors.max_m:.2g} m)"

    def __str__(self) -> str:
        """Return what `foucault score` prints."""
        return "\n".join(lines(self))

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"


def lines(score: Scored) -> Iterator[str]:
    """Yield the verdict line by line."""
    errors = score.errors
    yield f"{score.candidate.name} {_verdict(score)} ({_span(score)})"
    if score.since is not None:
        yield f"{score.since.text}."
    if not score.covered:
        yield entry("covers nothing", "no row after t = 0", "the release alone says nothing of the motion")
    elif score.falls_short:
        yield entry("covers too little", percent(score.covered), f"{percent(score.covers)} demanded")
    yield entry("largest error", f"{errors.max_m:.3g} m", _largest(score))
    yield entry("rms, at the end", f"{errors.rms_m:.3g} m, {errors.end_m:.3g} m", _growth(errors.growth_exponent))
    scale = f"largest error over the amplitude {errors.amplitude_m:.4g} m"
    yield entry("digits", _one_decimal(errors.digits), scale)
    mixed = f"relative to the truth; to {errors.amplitude_m:.4g} m, {errors.speed_m_s:.4g} m/s + |truth|"
    yield entry("scd, mescd at end", f"{_one_decimal(errors.scd)}, {_one_decimal(errors.mescd)}", mixed)
    worst = score.worst
    numbers = f"expected {worst.expected:.17g}, got {worst.got:.17g}"
    yield entry("worst", f"{worst.component} at t = {worst.t:.10g} s", numbers)
    each = (f"{name} {abs(row.difference):.2g} {_unit(name)}" for name, row in score.worst_of_each.items())
    yield entry("worst of each", ", ".join(each))
    turn, delay = score.swing.largest_turn, score.swing.largest_delay
    if turn is not None and delay is not None:
        yield entry("swing plane, phase", f"{math.degrees(turn):.3g} degrees, {delay:.3g} s", "fitted")
    if score.drifts:
        words = {"h_m2_s2": "h by {:.3g} m²/s²", "length_m": "|r| - l by {:.3g} m"}
        yield entry("drifts", ", ".join(words[name].format(value) for name, value in score.drifts.items()))
    if score.transits is not None:
        yield from score.transits.lines(score.allowed_m)
    if score.timing is not None:
        timing = score.timing
        how = f"median of {timing.runs} after a warm-up" if timing.warm else "one run, no warm-up"
        yield entry("took", f"{timing.cpu_s:.3g} CPU s, {timing.wall_s:.3g} s", how)
    yield entry("inputs read as", score.scene.inputs, score.why_inputs)
    yield entry("reference", score.golden.level, f"within {errors.bound_m:.2g} m at these times")
    if score.experiments is not None:
        yield from score.experiments.lines()
    told = score.explanation
    if told is not None and (score.experiments is None or told.causes or told.conventions):
        yield from told.lines()
    for convention in score.candidate.conventions:
        yield f"Reading: {convention.text}."
    for note in score.notes:
        yield f"Note: {note}."


def _verdict(score: Scored) -> str:
    if score.grade == score.verdict:
        return f"{score.verdict} with {score.scene.id}"
    assert score.explanation is not None and score.explanation.model is not None
    would_pass = not score.passes and replace(score, as_model=True).passes
    enough = "; --as-model takes that as enough" if would_pass else ""
    return f"agrees with {score.scene.id} as the model: {score.explanation.model.text}{enough}"


def _unit(component: str) -> str:
    return "m/s" if component.startswith("v") else "m"


def percent(share: float) -> str:
    """Return a share to three digits, rounded down: 100 % is all of it."""
    if not share > 0:
        return "0 %"
    percents = 100 * share * (1 + 1e-9)  # 29 and not 28.9 for 0.29
    unit = 10.0 ** (math.floor(math.log10(percents)) - 2)
    return f"{math.floor(percents / unit) * unit:.6g} %"


def _one_decimal(digits: float | None) -> str:
    return "none" if digits is None else f"{round(digits, 1) + 0.0:.1f}"


def _span(score: Scored) -> str:
    t, end = score.errors.t, score.scene.run.t_end
    what = "row" if score.candidate.positions else "transit"
    rows = f"1 {what}" if len(t) == 1 else f"{len(t)} {what}s"
    return f"{rows}, t = {t[0]:.6g} to {t[-1]:.6g} of {end} s: {percent(score.covered)}"


def _largest(score: Scored) -> str:
    errors = score.errors
    if score.at_bound:
        return "at or below the reference's bound"
    allowed = f"tolerance {score.tolerance_m:.3g} m"
    if isinstance(score.golden, Solution):  # the floor takes longer than the verdict: the document has it
        return allowed
    if not score.input_floor_m:
        return f"{allowed}; the inputs are doubles as they stand"
    ratio = errors.max_m / score.input_floor_m
    return f"{allowed}; {ratio:.2g} times the input floor of {score.input_floor_m:.2g} m"


def _growth(exponent: float | None) -> str:
    return "" if exponent is None else f"grows like t^{exponent:.2f}"


def document(score: Scored) -> dict[str, Any]:
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
        "transits": None if transits is None else transits.document(score.allowed_m),
        "reference": {"level": score.golden.level, "bound_m": errors.bound_m},
        "grade": score.grade,
        "conventions": [{"id": convention.id, "text": convention.text} for convention in score.candidate.conventions],
        "model": None,
        "causes": [],
        "corrected": None,
        "slip": None,
        "diagnosis": None,
        "baseline": None if score.since is None else vars(score.since) | {"text": score.since.text},
        "problem": score.problem,
        "notes": list(score.notes),
    }
    if score.timing is not None:
        fields["timing"] = vars(score.timing)
    if score.experiments is not None:
        fields["experiments"] = score.experiments.document()
    if score.explanation is not None:
        fields |= explained(score.explanation, fields["conventions"])
    return fields


def explained(explanation: Explanation, readings: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the keys of the document that an explanation fills; `readings` stand before its conventions."""
    diagnosis, corrected = explanation.diagnosis, explanation.corrected_m
    return {
        "conventions": [*readings, *(_said("your file", convention) for convention in explanation.conventions)],
        "model": None if explanation.model is None else vars(explanation.model),
        "causes": [_said("your program", cause) | _fitted(cause) for cause in explanation.causes],
        "corrected": {"max_error_m": corrected} if math.isfinite(corrected) else None,
        "slip": explanation.slip or None,
        "diagnosis": None if diagnosis is None else vars(diagnosis),
    }


def _said(subject: str, deviation: Deviation) -> dict[str, Any]:
    return {"id": deviation.id, "text": f"{subject} {deviation.text}", "size_m": deviation.size_m}


def _fitted(cause: Deviation) -> dict[str, float | None]:
    numbers = {"value": cause.value, "shift": cause.shift, "uncertainty": cause.uncertainty}
    return {name: number for name, number in numbers.items() if math.isfinite(number or 0.0)}


@dataclass(frozen=True)
class Outcome:
    """The result of judging one candidate: a score, or the reason why there is none.

    Attributes:
        name: of the candidate.
        scene: id of the scene.
        score: None if it could not be judged.
        error: why it could not.
    """

    name: str
    scene: str
    score: Score | None = None
    error: FoucaultError | None = None

    @property
    def verdict(self) -> str:
        """'agrees' (as a model too, where that is enough), 'disagrees' or 'refused'."""
        if self.score is None:
            return REFUSED
        return "agrees" if self.score.passes else self.score.verdict

    @property
    def exit_status(self) -> int:
        """0: agrees, or no worse than its baseline; 1: disagrees, or worse; 2 or 3: could not be judged."""
        return int(not self.score.accepted) if self.score is not None else self.error.exit_status if self.error else 0

    @property
    def since(self) -> Since | None:
        """The changes since a baseline, if there is one."""
        return None if self.score is None else self.score.since

    @property
    def lines(self) -> list[str]:
        """The lines for people, the verdict first; details are indented."""
        if self.score is not None:
            return list(lines(self.score))
        return [f"{self.name} was not judged by {self.scene}: {self.error}"]

    @property
    def main_lines(self) -> list[str]:
        """The lines for people without details."""
        first, *others = self.lines
        return [first, *(line for line in others if not line.startswith("  "))]

    def document(self) -> dict[str, Any]:
        """Return it as a row of the JSON document."""
        if self.score is not None:
            return document(self.score)
        return {"scene": self.scene, "candidate": self.name, "verdict": REFUSED, "error": str(self.error)}
