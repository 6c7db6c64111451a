"""The oracle's verdict on a candidate: how far off, to how many digits, where worst, and why."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from reference import Golden, InputError, Scene
from reference.dataset.dense import WITHIN
from reference.model.constants import constants
from reference.model.force import rest_position
from reference.precision import Array, context

from ..candidates.candidate import Candidate
from ..candidates.external import Timing
from ..rhs.constants import constants_in_double
from ..truth import DIGITS, FINE, Report, golden_of, truth_at
from .diagnosis import Diagnosis, diagnose
from .errors import Errors, drifts, errors_of
from .input_floor import input_floor
from .swing_plane import EllipseErrors
from .transits import TransitErrors, transit_errors

TOLERANCE = 1e-6  # of the amplitude, where no tolerance is given


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
        ellipse: turn of the swing plane and delay.
        drifts: of h and of |r| - l, where the candidate has the columns.
        transits: how its transits compare, or None.
        timing: what the program took, or None.
        diagnosis: what explains the error, or None.
        looked: whether a diagnosis was looked for.
        notes: what a reader ought to know besides.
    """

    candidate: Candidate
    scene: Scene
    why_inputs: str
    golden: Golden
    errors: Errors
    tolerance_m: float
    ellipse: EllipseErrors
    drifts: dict[str, float]
    transits: TransitErrors | None = None
    timing: Timing | None = None
    diagnosis: Diagnosis | None = None
    looked: bool = False
    notes: tuple[str, ...] = ()

    @cached_property
    def input_floor_m(self) -> float:
        """How far the rounding of the inputs to binary64 alone moves the bob in m; computed when it is asked for."""
        return input_floor(self.scene, float(self.candidate.t[-1]))

    @property
    def allowed_m(self) -> float:
        """The tolerance and what the reference itself may be off by: it never judges finer than its own bound."""
        return self.tolerance_m + self.errors.bound_m

    @property
    def off_path(self) -> bool:
        """True if a position is off by more than is allowed."""
        return self.errors.max_m > self.allowed_m

    @property
    def agrees(self) -> bool:
        """True if every position and every transit is within what is allowed, and no transit is missed or extra."""
        found = self.transits
        return not self.off_path and (
            found is None or not (found.missed or found.extra or found.max_conditioned_m > self.allowed_m)
        )

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
    report: Report | None = None,
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
        report: called with the simulated time reached, in s, where the scene has to be solved.

    Raises:
        InputError: a time of the candidate is outside the scene's span, or a tolerance that is not positive.
        UnreachableError: the scene cannot be solved.
    """
    if tolerance is not None and not 0 < tolerance < math.inf:
        raise InputError("tolerance", f"{tolerance:g}", "a positive number of metres")
    read_as, why = _reading(candidate, scene, inputs)
    digits, until = scene.run.digits if candidate.extended else DIGITS, float(candidate.t[-1])
    golden = golden_of(read_as, digits, announce, report, until)
    errors = errors_of(candidate, truth_at(golden, candidate.t, FINE if candidate.extended else WITHIN), golden)
    allowed = TOLERANCE * errors.amplitude_m if tolerance is None else tolerance
    times = candidate.transits if transits is None else transits
    unjudged = None if times is None else _unjudged(golden)
    made = Score(
        candidate=candidate,
        scene=read_as,
        why_inputs=why,
        golden=golden,
        errors=errors,
        tolerance_m=allowed,
        ellipse=errors.ellipse(_rest(scene)),
        drifts=drifts(candidate, read_as),
        transits=None if times is None or unjudged else _transits(times, golden, errors, allowed),
        notes=candidate.notes + ((unjudged,) if unjudged else ()),
    )
    if explain and made.off_path:
        return replace(made, diagnosis=diagnose(candidate, errors, read_as), looked=True)
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


def _unjudged(golden: Golden) -> str | None:
    """Why the candidate's transits cannot be judged, or None."""
    said = golden.manifest.transits
    if said == "not asked for":
        return "the scene asks for no transits (run.transits): the candidate's were not judged"
    return f"{said}: the candidate's transits were not judged" if said == "xdot is identically zero" else None


def _transits(times: Array, golden: Golden, errors: Errors, tolerance_m: float) -> TransitErrors:
    k = constants_in_double(golden.scene.exact)
    omega = max(math.sqrt(math.hypot(k.pull[1], k.pull[2])), errors.speed_m_s / k.length)
    end = float(golden.scene.exact.t_end)
    judged = times[
        (times > 0) & (times <= end)
    ]  # a release at rest is no transit, nor is what the truth has not reached
    for interval in golden.manifest.possible:
        judged = judged[(judged < float(interval.from_s)) | (judged > float(interval.to_s))]
    truth = golden.transits
    return transit_errors(
        judged,
        truth["t"],
        truth["ax"],
        omega,
        min(float(errors.t[-1]), end),
        tolerance_m=tolerance_m,
        xdot=lambda at: truth_at(golden, at).states[:, 3],
    )
