"""Score the passages of a section, such as those of a light gate, where all inputs are certain."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from reference import InputError, Scene
from reference.errors import counted
from reference.model.constants import constants_in_double
from reference.model.force import rates
from reference.model.sections import form_of
from reference.model.start import Start
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE_BITS, Array

from ..truth import DIGITS, Report, golden_of, truth_at
from .clock_start import SUBTRACT, TOLERANCE, Ends, clock_starts, starts_in_words
from .errors import entry, swing_rate
from .measured import SWING
from .transit_matching import TransitErrors, transit_errors


@dataclass(frozen=True)
class PassageScore:
    """The errors of passages, and what was allowed.

    Attributes:
        name: of the candidate.
        scene: the problem, its inputs read as they were.
        section: the word of the section.
        times: its passages in s, up to the end of the scene.
        errors: of these times, weighted by how fast the bob passes.
        tolerance_m: largest weighted error allowed, in m.
        bound_m: how well the truth is known, as a distance in m.
        level: that of the truth.
        starts: what the clock may have shown at the release, in s, if all passages are right by such a clock alone.
    """

    name: str
    scene: Scene
    section: str
    times: Array
    errors: TransitErrors
    tolerance_m: float
    bound_m: float
    level: str
    starts: tuple[Ends, ...] = ()

    @property
    def allowed_m(self) -> float:
        """Tolerance in m plus the truth's own bound."""
        return self.tolerance_m + self.bound_m

    @property
    def verdict(self) -> str:
        """'agrees' if no passage is missed, extra, or off by more than `allowed_m`; else 'disagrees'."""
        return "agrees" if self.errors.within(self.allowed_m) else "disagrees"

    def lines(self) -> Iterator[str]:
        """Yield the lines for people, the verdict first."""
        span = f"t = {self.times[0]:.6g} to {self.times[-1]:.6g} of {self.scene.run.t_end} s"
        passages = f"{counted(len(self.times), 'passage')} of {self.section}"
        yield f"{self.name} {self.verdict} with {self.scene.id} ({passages}, {span})"
        yield from self.errors.lines(self.allowed_m, "passages", "as a distance")
        yield entry("tolerance", f"{self.tolerance_m:.3g} m")
        yield entry("inputs read as", self.scene.inputs)
        yield entry("reference", self.level, f"within {self.bound_m:.2g} m")
        if self.starts:
            clock = f"the clock showed {starts_in_words(self.starts)} at the release"
            yield f"Reading: all passages agree if {clock}. {SUBTRACT}"

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        return {
            "scene": self.scene.id,
            "candidate": self.name,
            "verdict": self.verdict,
            "section": self.section,
            "inputs": self.scene.inputs,
            "tolerance_m": self.tolerance_m,
            "transits": self.errors.document(self.allowed_m),
            "reference": {"level": self.level, "bound_m": self.bound_m},
            "clock_at_release_s": [[*map(float, start)] for start in self.starts],
        }


def score_passages(
    name: str,
    times: Array,
    scene: Scene,
    section: str,
    tolerance: float | None = None,
    announce: Callable[[str], None] | None = None,
    report: Report | None = None,
) -> PassageScore:
    """Score the passages of a section.

    Args:
        name: of the candidate.
        times: its passages in s, in order; those after the scene's end are not judged.
        scene: the problem.
        section: its word, such as "gate 30".
        tolerance: largest distance in m by which the motion may be off; if None, `TOLERANCE` times the amplitude.
        announce: called with a message before the scene is solved.
        report: called with the simulated time reached, in s.

    Raises:
        InputError: no time lies after t = 0 and before the scene's end.
        UnreachableError: the scene cannot be solved.
    """
    scene = scene.with_values({"run.sections": section, "run.transits": "false"})
    end = float(scene.exact.t_end)
    judged = times[(times > 0) & (times <= end)]
    until = float(judged[-1]) if len(judged) else min(end, float(np.ptp(times)) + _swing_s(scene))
    golden = golden_of(scene, DIGITS, announce, report, until)
    truth = golden.sections[section]
    speed = float(np.linalg.norm((golden.vx, golden.vy, golden.vz), axis=0).max())
    away = _distances(section, scene, swing_rate(scene, speed))
    _, slopes = away(np.column_stack([truth[column] for column in STATE]))
    allowed = (
        TOLERANCE * float(np.hypot(golden.x, golden.y).max()) if tolerance is None else tolerance
    )
    if not len(judged):
        starts = [*_starts(times, truth, away, allowed)]
        advice = (
            f"By the passages the clock showed {starts_in_words(starts)} at the release. "
            if starts
            else ""
        )
        span = f"times above 0, up to {scene.run.t_end} s"
        raise InputError(
            f"{name}: t",
            "no time in the scene's span",
            span,
            f"{advice}{SUBTRACT if len(times) else ''}",
        )

    def distances(at: Array) -> Array:
        return away(truth_at(golden, at).states)[0]

    errors = transit_errors(
        judged, truth["t"], slopes, float(judged[-1]), tolerance_m=allowed, away=distances
    )
    bound = float(max(map(float, truth.bound("t")), default=0.0) * np.abs(slopes).max(initial=0.0))
    score = PassageScore(name, scene, section, judged, errors, allowed, bound, golden.level)
    if score.verdict == "agrees":
        return score
    golden = golden_of(scene, DIGITS, announce, report, min(end, until + _swing_s(scene)))
    return replace(
        score, starts=tuple(_starts(times, golden.sections[section], away, score.allowed_m))
    )


def _swing_s(scene: Scene) -> float:
    """Return a period in s, and some: before it, the first passage by a stopwatch comes."""
    inputs = scene.exact
    return SWING * float(inputs.length / abs(inputs.gravity)) ** 0.5 if inputs.gravity else 0.0


def _starts(
    times: Array, truth: Any, away: Callable[[Array], tuple[Array, Array]], allowed_m: float
) -> Iterator[Ends]:
    """Yield what the clock may have shown at the release, in s, if every passage agrees by it."""
    _, slopes = away(np.column_stack([truth[column] for column in STATE]))
    intervals = []
    for time, slope in zip(truth["t"], np.abs(slopes), strict=True):
        if slope:
            late_s = Fraction(allowed_m / float(slope))
            intervals.append((Fraction(float(time)) - late_s, Fraction(float(time)) + late_s))
    exact = [Fraction(repr(float(time))) for time in times]
    if len({*exact}) == len(exact):
        yield from clock_starts(exact, intervals)


def _distances(section: str, scene: Scene, omega: float) -> Callable[[Array], tuple[Array, Array]]:
    """Return a function of states, shape (rows, 6), that gives how far the bob is from passing, in m, and its rate.

    A velocity is `omega` times a distance. Where a passage of the other direction is near, it is infinitely far.
    """
    form = form_of(section, Start.of(scene.exact, DOUBLE_BITS))
    k, (a, b) = (
        constants_in_double(scene.exact),
        (np.array([*map(float, part)]) for part in (form.a, form.b)),
    )

    def away(states: Array) -> tuple[Array, Array]:
        position, velocity = states[:, :3], states[:, 3:]
        force = np.column_stack(rates([*states.T], k)[3:])
        if a.any():
            size = np.linalg.norm(a)
            return (position @ a - float(form.d) * float(k.length)) / size, velocity @ a / size
        size = omega * np.linalg.norm(b)
        # only what is along the sphere counts, and where that points changes with the place
        if form.direction:
            aside, down = np.linalg.norm(np.cross(b, position), axis=1), np.abs(position @ b)
            size = (
                omega * aside + np.linalg.norm(velocity, axis=1) * down / float(k.length)
            ) / float(k.length)
        far, rate = velocity @ b / size, force @ b / size
        return np.where(rate * form.direction < 0, np.inf, far), rate

    return away
