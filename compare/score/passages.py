"""Score the passages of a section, such as those of a light gate, for exact inputs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from reference import Golden, InputError, Scene
from reference.errors import Described, counted
from reference.model.constants import Constants, constants_in_double
from reference.model.force import rates
from reference.model.sections import form_of
from reference.model.start import Start
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE_BITS, Array
from reference.solver.doubles import TOLERANCE

from ..candidates.candidate import Passages
from ..truth import DIGITS, SILENT, Progress, golden_of, truth_at
from .clock_start import SUBTRACT, Ends, clock_starts, starts_in_words
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
        starts: what the clock may have shown at the release, in s, if all passages are right by
            such a clock alone.
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
        span = f"t = {self.times[0]:.10g} to {self.times[-1]:.10g} of {self.scene.run.t_end} s"
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
    passages: Passages,
    scene: Scene,
    tolerance_m: float | None = None,
    progress: Progress = SILENT,
) -> PassageScore:
    """Score the passages of a section.

    Args:
        passages: their times; those after the scene's end are not judged.
        scene: the problem.
        tolerance_m: largest distance by which the motion may be off; None for `TOLERANCE` times the
            amplitude.
        progress: what is called while the scene is solved.

    Raises:
        InputError: no time lies after t = 0 and before the scene's end.
        UnreachableError: the scene cannot be solved.
    """
    section = passages.section
    assert section is not None
    scene = scene.with_values({"run.sections": section, "run.transits": "false"})
    end_s = float(scene.exact.t_end)
    swing_s = _swing_s(scene)
    judged = passages.times[(passages.times > 0) & (passages.times <= end_s)]
    until_s = float(judged[-1]) if len(judged) else None
    if until_s is None:
        # the truth is needed all the same, to learn what the clock showed at the release
        until_s = min(end_s, float(np.ptp(passages.times)) + swing_s)

    golden = golden_of(scene, DIGITS, progress, until=until_s)
    speed_m_s = float(np.linalg.norm((golden.vx, golden.vy, golden.vz), axis=0).max())
    distance = _Distance.of(section, scene, swing_rate(scene, speed_m_s))
    if tolerance_m is None:
        tolerance_m = TOLERANCE * float(np.hypot(golden.x, golden.y).max())
    if not len(judged):
        starts = _starts_by(golden, passages, distance, tolerance_m)
        raise _nothing_in_the_span(passages, scene, starts)

    judged_passages = replace(passages, times=judged)
    score = _score_by(golden, judged_passages, scene, distance, tolerance_m)
    if score.verdict == "agrees":
        return score

    # by another clock, the last passage may be up to a swing later
    golden = golden_of(scene, DIGITS, progress, until=min(end_s, until_s + swing_s))
    return replace(score, starts=_starts_by(golden, passages, distance, score.allowed_m))


def _score_by(
    golden: Golden, judged: Passages, scene: Scene, distance: _Distance, tolerance_m: float
) -> PassageScore:
    """Return the score of passages within the span by the truth of their section."""
    section = judged.section
    assert section is not None
    truth = golden.sections[section]
    _, slopes = distance(_states(golden, section))
    errors = transit_errors(
        judged.times,
        truth["t"],
        slopes,
        float(judged.times[-1]),
        tolerance_m=tolerance_m,
        away=lambda times: distance(truth_at(golden, times).states)[0],
    )
    bound_s = max(map(float, truth.bound("t")), default=0.0)
    bound_m = float(bound_s * np.abs(slopes).max(initial=0.0))
    return PassageScore(
        judged.name, scene, section, judged.times, errors, tolerance_m, bound_m, golden.level
    )


def _nothing_in_the_span(passages: Passages, scene: Scene, starts: tuple[Ends, ...]) -> InputError:
    """Return the error of passages none of which lies in the scene's span."""
    advice = ""
    if starts:
        advice = (
            f"The passages suggest that the clock showed {starts_in_words(starts)} at the release. "
        )
    if len(passages.times):
        advice += SUBTRACT
    got = Described("no time within the scene's span")
    expected = f"times above 0 and up to {scene.run.t_end} s"
    return InputError(f"{passages.name}: t", got, expected, advice)


def _swing_s(scene: Scene) -> float:
    """Return a little more than a period in s; 0 without gravity."""
    inputs = scene.exact
    return SWING * float(inputs.length / abs(inputs.gravity)) ** 0.5 if inputs.gravity else 0.0


def _states(golden: Golden, section: str) -> Array:
    """Return the states of a dataset's passages, shape (passages, 6)."""
    table = golden.sections[section]
    return np.column_stack([table[column] for column in STATE])


def _starts_by(
    golden: Golden, passages: Passages, distance: _Distance, allowed_m: float
) -> tuple[Ends, ...]:
    """Return what the clock may have shown at the release, in s, if every passage agrees by it."""
    assert passages.section is not None
    exact = [Fraction(repr(float(time))) for time in passages.times]
    if len(set(exact)) < len(exact):
        return ()
    times = golden.sections[passages.section]["t"]
    _, slopes = distance(_states(golden, passages.section))
    intervals = []
    for time, slope in zip(times, np.abs(slopes), strict=True):
        if slope:
            time_s = Fraction(float(time))
            late_s = Fraction(allowed_m / float(slope))
            intervals.append((time_s - late_s, time_s + late_s))
    return tuple(clock_starts(exact, intervals))


@dataclass(frozen=True)
class _Distance:
    """How far the bob is from passing a section, whose form is a·r = d or b·v = 0.

    Attributes:
        a: of a form in the position r, shape (3,); 0 if the form is one in the velocity v.
        b: of a form in the velocity, shape (3,).
        offset_m: d.
        direction: the sign of b·v after a passage; 0 for either.
        omega: the rate in rad/s by which a velocity counts as a distance.
        constants: of the equations of motion.
    """

    a: Array
    b: Array
    offset_m: float
    direction: int
    omega: float
    constants: Constants

    @classmethod
    def of(cls, section: str, scene: Scene, omega: float) -> _Distance:
        """Return the distance from a section of a scene."""
        form = form_of(section, Start.of(scene.exact, DOUBLE_BITS))
        constants = constants_in_double(scene.exact)
        a = np.array([float(number) for number in form.a])
        b = np.array([float(number) for number in form.b])
        offset_m = float(form.d) * float(constants.length)
        return cls(a, b, offset_m, form.direction, omega, constants)

    def __call__(self, states: Array) -> tuple[Array, Array]:
        """Return the distances in m and their rates in m/s of states, shape (rows, 6).

        Where a passage of the other direction is near, the distance is infinite.
        """
        position = states[:, :3]
        velocity = states[:, 3:]
        if self.a.any():
            size = np.linalg.norm(self.a)
            return (position @ self.a - self.offset_m) / size, velocity @ self.a / size

        size = self._velocity_per_distance(position, velocity)
        force = np.column_stack(rates([*states.T], self.constants)[3:])
        far_m = velocity @ self.b / size
        rate_m_s = force @ self.b / size
        return np.where(rate_m_s * self.direction < 0, np.inf, far_m), rate_m_s

    def _velocity_per_distance(self, position: Array, velocity: Array) -> Any:
        """Return the change of b·v in 1/s by which a shift of the motion in m shows."""
        if not self.direction:
            return self.omega * np.linalg.norm(self.b)
        # only what is along the sphere counts, and where that points changes with the place
        length_m = float(self.constants.length)
        aside = np.linalg.norm(np.cross(self.b, position), axis=1)
        down = np.abs(position @ self.b)
        speed = np.linalg.norm(velocity, axis=1)
        return (self.omega * aside + speed * down / length_m) / length_m
