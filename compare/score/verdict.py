"""A judgement: errors, the allowed error, the verdict that follows, and the lines that report it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import ROUND_DOWN, Context
from functools import cached_property
from html import escape
from typing import Any

import numpy as np

from reference import FoucaultError, Golden, Scene, Solution
from reference.errors import counted
from reference.numbers.columns import VELOCITY
from reference.status import Status

from ..candidates.candidate import COLUMNS, Candidate
from ..candidates.external import Timing
from ..diagnosis import Experiments, Explanation, Since
from .errors import SwingErrors, TrajectoryErrors, Worst, entry
from .input_floor import input_floor
from .transit_matching import TransitErrors

REFUSED = Status.REFUSED.value  # the verdict on a candidate that could not be judged
# a last row within this part of t_end counts as complete: a program that adds up its steps rounds
WHOLE = 1e-6


@dataclass(frozen=True, repr=False)
class Score:
    """The judgement of a candidate.

    Attributes:
        candidate: the trajectory that was judged.
        scene: the problem, its inputs read as decimals or as doubles.
        why_inputs: the reason for that reading.
        golden: the dataset that the truth comes from, or the scene solved as accurately as the
            verdict needs.
        errors: at the candidate's times.
        tolerance_m: largest position error allowed, in m.
        swing: turn of the swing plane and delay.
        drifts: of h and of `|r| - l`, if the candidate has the columns; 0 if rounding hides it.
        covers: share of the scene's span that was demanded, from 0 to 1.
        as_model: whether agreement as a named model is enough.
        notes: remarks that a reader ought to know.
        transits: errors of its transits, or None.
        timing: run time of the program, or None.
        explanation: the likely reasons for the error; None if they were not looked for.
        experiments: runs of the program with other numbers, and what they measured; None if they
            were not requested.
        since: the changes since a baseline, if there is one.
    """

    candidate: Candidate
    scene: Scene
    why_inputs: str
    golden: Golden | Solution
    errors: TrajectoryErrors
    tolerance_m: float
    swing: SwingErrors
    drifts: dict[str, float]
    covers: float
    as_model: bool
    notes: tuple[str, ...]
    transits: TransitErrors | None = None
    timing: Timing | None = None
    explanation: Explanation | None = None
    since: Since | None = None
    experiments: Experiments | None = None

    def __repr__(self) -> str:
        return f"Score({self.verdict} with {self.scene.id}: {self.errors.max_m:.2g} m)"

    def __str__(self) -> str:
        """Return what `foucault score` prints."""
        return "\n".join(lines(self))

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    @cached_property
    def input_floor_m(self) -> float:
        """Distance in m by which rounding the inputs to binary64 moves the bob.

        Computed at the first use.
        """
        return input_floor(self.scene, float(self.candidate.t[-1]))

    @property
    def worst(self) -> Worst:
        """The component in which the largest position error shows most."""
        return self._at(*self.errors.worst)

    @property
    def worst_of_each(self) -> dict[str, Worst]:
        """The largest error of each column."""
        worst = {}
        for name, errors in self.errors.components.items():
            row = int(np.abs(errors).argmax())
            worst[name] = self._at(row, name)
        return worst

    def _at(self, row: int, name: str) -> Worst:
        """Return one number of a row."""
        return Worst(
            t=float(self.errors.t[row]),
            component=name,
            expected=float(self.errors.truth.states[row, COLUMNS.index(name)]),
            got=float(self.candidate.columns[name][row]),
            difference=float(self.errors.components[name][row]),
        )

    @cached_property
    def covered(self) -> float:
        """Share of the scene's span up to the last row, from 0 to 1; for transits alone, up to the next true one."""
        last = float(self.errors.t[-1])
        end = float(self.scene.exact.t_end)
        if not self.candidate.positions:
            later = self.golden.transits["t"]
            later = later[later > last + self.tolerance_m / self.errors.speed_m_s]
            last = float(later[0]) if len(later) else float(self.golden.t[-1])
        return 1.0 if last >= end * (1 - WHOLE) else last / end

    @property
    def falls_short(self) -> bool:
        """True if there is no row after t = 0, or if the rows cover less of the span than demanded."""
        return self.covered < self.covers or not self.covered > 0

    @property
    def allowed_m(self) -> float:
        """Tolerance in m plus the reference's own bound.

        Nothing is judged more finely than the reference is known.
        """
        return self.tolerance_m + self.errors.bound_m

    @property
    def off_path(self) -> bool:
        """True if the largest position error is above `allowed_m`."""
        return self.errors.max_m > self.allowed_m

    @property
    def agrees(self) -> bool:
        """True if no error exceeds `allowed_m` and no transit is missed, extra or left out."""
        met = self.transits is None or self.transits.within(self.allowed_m)
        return met and not (self.off_path or self.falls_short)

    @property
    def verdict(self) -> str:
        """'agrees' or 'disagrees', as in the JSON document."""
        return "agrees" if self.agrees else "disagrees"

    @property
    def grade(self) -> str:
        """'agrees', 'agrees as the model …' where it is exact within a named simplification, or 'disagrees'."""
        model = None if self.explanation is None else self.explanation.model
        if self.agrees or model is None:
            return self.verdict
        return f"agrees as the model: {model.text}"

    @property
    def passes(self) -> bool:
        """True if it agrees, or agrees as a named model and `as_model` says that this is enough."""
        if self.agrees:
            return True
        is_model = self.explanation is not None and self.explanation.model is not None
        is_enough = self.as_model and not self.falls_short and self.transits is None
        return is_model and is_enough

    @property
    def accepted(self) -> bool:
        """True if it passes or, where there is a baseline, if it became no worse."""
        return self.passes if self.since is None else not self.since.worse

    @property
    def problem(self) -> dict[str, Any]:
        """The inputs of the scene as they are written, by section and name."""
        return self.scene.model_dump(include={"pendulum", "site", "release"}, exclude_none=True)

    @property
    def at_bound(self) -> bool:
        """True if the largest error is at or below the reference's own bound."""
        return self.errors.max_m <= self.errors.bound_m


def lines(score: Score) -> Iterator[str]:
    """Yield the verdict line by line."""
    yield f"{score.candidate.name} {_verdict(score)} ({_span(score)})"
    if score.since is not None:
        yield f"{score.since.text}."
    yield from _lines_on_reasons(score)
    yield from _lines_on_coverage(score)
    yield from _lines_on_positions(score)
    yield from _lines_on_velocities(score)
    yield from _lines_on_the_swing(score)
    if score.transits is not None:
        yield from score.transits.lines(score.allowed_m)
    if score.timing is not None:
        yield _line_on_timing(score.timing)
    yield entry("inputs read as", score.scene.inputs, score.why_inputs)
    bound = f"within {score.errors.bound_m:.2g} m at these times"
    yield entry("reference", score.golden.level, bound)
    for convention in score.candidate.conventions:
        yield f"Reading: {convention.text}."
    for note in score.notes:
        yield f"Note: {note}."


def _verdict(score: Score) -> str:
    if score.grade == score.verdict:
        return f"{score.verdict} with {score.scene.id}"
    assert score.explanation is not None and score.explanation.model is not None
    would_pass = not score.passes and replace(score, as_model=True).passes
    enough = "; --as-model takes that as enough" if would_pass else ""
    return f"agrees with {score.scene.id} as the model: {score.explanation.model.text}{enough}"


def _span(score: Score) -> str:
    t = score.errors.t
    rows = counted(len(t), "row" if score.candidate.positions else "transit")
    span = f"t = {t[0]:.10g} to {t[-1]:.10g} of {score.scene.run.t_end} s"
    return f"{rows}, {span}: {percent(score.covered)}"


def _lines_on_coverage(score: Score) -> Iterator[str]:
    """Yield a line if the rows do not reach far enough."""
    if not score.covered:
        remark = "the release alone says nothing of the motion"
        yield entry("covers nothing", "no row after t = 0", remark)
    elif score.falls_short:
        remark = f"{percent(score.covers)} demanded"
        yield entry("covers too little", percent(score.covered), remark)


def _lines_on_positions(score: Score) -> Iterator[str]:
    """Yield lines on the size of the errors, their growth, and the worst numbers."""
    errors = score.errors
    yield entry("largest error", f"{errors.max_m:.3g} m", _allowed(score))
    growth = "" if errors.growth_exponent is None else f"grows like t^{errors.growth_exponent:.2f}"
    yield entry("rms, at the end", f"{errors.rms_m:.3g} m, {errors.end_m:.3g} m", growth)

    size = "the reference's bound" if score.at_bound else "largest error"
    least = "at least " if score.at_bound else ""
    ratio = f"{size} over the amplitude {errors.amplitude_m:.4g} m"
    yield entry("digits", f"{least}{_one_decimal(errors.digits)}", ratio)
    scales = f"relative to the truth; to {errors.amplitude_m:.4g} m, {errors.speed_m_s:.4g} m/s + |truth|"
    scores = f"{_one_decimal(errors.scd)}, {_one_decimal(errors.mescd)}"
    yield entry("scd, mescd at end", scores, scales)

    worst = score.worst
    if worst.expected == worst.got:
        numbers = f"off by {abs(worst.difference):.2g} m"
    else:
        numbers = f"expected {worst.expected:.17g}, got {worst.got:.17g}"
    yield entry("worst", f"{worst.component} at t = {worst.t:.10g} s", numbers)
    of_each = []
    for name, number in score.worst_of_each.items():
        unit = "m/s" if name in VELOCITY else "m"
        of_each.append(f"{name} {abs(number.difference):.2g} {unit}")
    yield entry("worst of each", ", ".join(of_each))


def _allowed(score: Score) -> str:
    """Return what the largest error is compared with."""
    errors = score.errors
    if score.at_bound:
        return "at or below the reference's bound"
    allowed = f"tolerance {score.tolerance_m:.3g} m"
    # the floor takes longer than the verdict: the document has it
    if isinstance(score.golden, Solution):
        return allowed
    if not score.input_floor_m:
        return f"{allowed}; the inputs are exact doubles"
    ratio = errors.max_m / score.input_floor_m
    return f"{allowed}; {ratio:.2g} times the input floor of {score.input_floor_m:.2g} m"


def _lines_on_velocities(score: Score) -> Iterator[str]:
    """Yield a line if the positions agree and velocities are off by more than the same share of their scale."""
    if not score.agrees:
        return
    limit_m_s = score.allowed_m * score.errors.speed_m_s / score.errors.amplitude_m
    fast = []
    for name, number in score.worst_of_each.items():
        if name in VELOCITY and abs(number.difference) > limit_m_s:
            fast.append(name)
    if fast:
        remark = f"{', '.join(fast)} off by more than {limit_m_s:.2g} m/s"
        yield entry("velocities", "not judged", remark)


def _lines_on_the_swing(score: Score) -> Iterator[str]:
    """Yield lines on the fitted turn and delay, and on what should be conserved."""
    turn = score.swing.largest_turn
    delay = score.swing.largest_delay
    if turn is not None and delay is not None:
        fit = f"{math.degrees(turn):.3g} degrees, {delay:.3g} s"
        yield entry("swing plane, phase", fit, "fitted")
    words = {"h_m2_s2": "h by {:.3g} m²/s²", "length_m": "|r| - l by {:.3g} m"}
    drifts = [words[name].format(value) for name, value in score.drifts.items() if value]
    if drifts:
        yield entry("drifts", ", ".join(drifts))


def _line_on_timing(timing: Timing) -> str:
    how = f"median of {timing.runs} after a warm-up" if timing.warm else "one run, no warm-up"
    return entry("took", f"{timing.cpu_s:.3g} CPU s, {timing.wall_s:.3g} s", how)


def _lines_on_reasons(score: Score) -> Iterator[str]:
    """Yield what experiments measured, and the explanation; after experiments only if it has something to say."""
    explanation = score.explanation
    if score.experiments is not None:
        yield from score.experiments.lines()
        if explanation is None or not (explanation.causes or explanation.conventions):
            return
    if explanation is not None:
        yield from explanation.lines()


def percent(share: float) -> str:
    """Return a share in per cent to three digits, rounded down, so that 100 % means all."""
    percents = 100 * share * (1 + 1e-9)  # 29 and not 28.9 for 0.29
    rounded = Context(prec=3, rounding=ROUND_DOWN).create_decimal_from_float(percents)
    return f"{float(rounded):.6g} %"


def _one_decimal(digits: float | None) -> str:
    return "none" if digits is None else f"{round(digits, 1) + 0.0:.1f}"


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
        if self.score is not None:
            return int(not self.score.accepted)
        return self.error.exit_status if self.error is not None else 0

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
