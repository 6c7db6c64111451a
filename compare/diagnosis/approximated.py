"""The approximations of the source papers as explanations: each is run, and has to pass the tests of a claim."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from reference import FoucaultError, Scene

from ..approximations import Motion, motions
from ..candidates.candidate import Deviation
from .case import HARMLESS, Explanation, FileCase, NamedModel, largest
from .claims import Alternative, graded, hedged, one_of
from .hypotheses import Claim
from .thresholds import ALTERNATIVES, RIVAL

_PRICE = 2  # of an approximation: a model, and what it is about
_LOW = 0.25  # of the cord: a bob that comes nearer to the suspension's height makes no small swings


@dataclass(frozen=True, eq=False)
class _ApproximationClaim(Claim):
    """The claim that a program solves an approximation.

    Attributes:
        motion: the approximation.
        costs_m: the largest distance in m between it and the full Lagrangian.
    """

    motion: Motion
    costs_m: float

    @property
    def cause(self) -> Deviation:
        """The cause, with the title of the approximation."""
        text = f"solves {self.motion.title} ({self.motion.where}) instead of the full equations"
        return Deviation(self.motion.id, text, self.costs_m, "model")

    @property
    def model(self) -> NamedModel:
        """The model that the file is exact within."""
        return NamedModel(self.motion.id, self.motion.title, self.largest_m, self.costs_m)


def of_approximation(case: FileCase, scene: Scene) -> Explanation | None:
    """Return the explanation that a program solves an approximation; None if no approximation passes the tests."""
    claims = [claim for claim in _claims(case, scene) if graded(claim, claim.cause, case.error)]
    if not claims:
        return None
    least_m = min(claim.residual_rms_m for claim in claims)
    near = [claim for claim in claims if claim.residual_rms_m <= RIVAL * least_m]
    best = near[0]
    cause = graded(best, best.cause, case.error)
    assert cause is not None
    if len(near) > ALTERNATIVES:
        cause = hedged(best.cause)
    elif len(near) > 1:
        alternatives = [Alternative(claim.cause.id, claim.cause.text) for claim in near]
        cause = one_of(alternatives, best.costs_m)
    explanation = case.explanation((cause,), best.residuals, _PRICE)
    plain = all(convention.id in HARMLESS for convention in case.rows.conventions)
    is_model = best.explains and plain and cause.id == best.motion.id
    return replace(explanation, model=best.model) if is_model else explanation


def _claims(case: FileCase, scene: Scene) -> Iterator[_ApproximationClaim]:
    """Yield the approximations of a scene, each compared with the rows."""
    columns = case.rows.positions.shape[1]
    highest = float(case.truth[:, 2].max()) if columns == 3 else -float(scene.exact.length)
    if not highest < -_LOW * float(scene.exact.length):
        return
    for motion in motions().values():
        if motion.refuses(scene) is not None:
            continue
        try:
            positions = motion.trajectory(scene, case.rows.times)[:, :columns]
        except FoucaultError:  # it leaves the sphere, or is not finite
            continue
        costs_m = largest(positions - case.truth)
        yield _ApproximationClaim(case, case.rows.positions - positions, motion, costs_m)
