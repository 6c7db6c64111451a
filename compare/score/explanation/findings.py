"""Explanations: the causes of an error, the model that a file is exact within, and the lines that say so."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from ...candidates.candidate import Deviation

HARMLESS = ("z_constant", "decimals", "digits", "single_precision")  # conventions that a model may go with
UNCORRECTED = (*HARMLESS, "off_the_sphere")  # conventions of which nothing is put right
AS_IF = "as_if"  # stage of a number that no person typed: the motion is like that, the cause is not known
BEGIN = "It seems that your program"


@dataclass(frozen=True)
class Diagnosis:
    """The cause that matters most.

    Attributes:
        id: its word.
        explained: share of the root mean square error that is gone with all causes.
        text: all causes in a sentence.
        shift: for a fitted input, how far it is off, in its unit; else None.
        also: ids of the other causes.
    """

    id: str
    explained: float
    text: str
    shift: float | None = None
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class Model:
    """A named simplification that the file is exact within.

    Attributes:
        id: a stable word.
        text: its name.
        exact_to_m: the largest distance in m between the file and it.
        costs_m: the largest distance in m between it and the full Lagrangian.
    """

    id: str
    text: str
    exact_to_m: float
    costs_m: float


@dataclass(frozen=True)
class Explanation:
    """Reasons for an error, and how much of it they explain.

    Attributes:
        conventions: of the rows.
        causes: in the order gravity, model, inputs, release, frame, clock, integrator.
        model: the simplification that the file is exact within, if it is.
        corrected_m: the largest error in m that is left after all of these.
        slip: where none is known, which part of the force is off: a sentence.
        explained: share of the root mean square error that is gone with them.
        score: decades, as in `readings`: of two explanations the lower one is the better.
        allowed_m: distance in m that counts as agreement.
    """

    conventions: tuple[Deviation, ...] = ()
    causes: tuple[Deviation, ...] = ()
    model: Model | None = None
    corrected_m: float = math.nan
    slip: str = ""
    explained: float = 0.0
    score: float = 0.0
    allowed_m: float = math.inf

    @property
    def known(self) -> list[Deviation]:
        """The causes but those that the motion is merely like."""
        return [cause for cause in self.causes if cause.stage != AS_IF]

    @property
    def diagnosis(self) -> Diagnosis | None:
        """The cause that matters most, a simpler model before all; None if none is known."""
        known = sorted(self.known, key=lambda cause: -cause.size_m)
        if not known:
            return None
        models = [cause for cause in known if cause.stage == "model"]
        first = (models or known)[0]
        texts = "; it ".join(cause.text for cause in known)
        others = tuple(cause.id for cause in known if cause is not first)
        return Diagnosis(first.id, self.explained, f"{BEGIN} {texts}.", first.shift, others)

    def lines(self) -> Iterator[str]:
        """Yield what is known, line by line, for people."""
        for convention in self.conventions:
            yield f"Your file {convention.text}."
        begin = f"{BEGIN} "
        if self.model is not None:
            begin = "- "
            yield (
                f"As that model it is exact to {self.model.exact_to_m:.2g} m; "
                f"against the full Lagrangian it is {self.model.costs_m:.3g} m off:"
            )
        elif len(self.causes) > 1:
            begin = "- "
            yield f"{BEGIN} (largest effect first)"
        for cause in sorted(self.causes, key=lambda cause: -cause.size_m):
            yield f"{begin}{cause.text}: {cause.size_m:.3g} m"
        if self.slip:
            yield self.slip
        if self.causes or any(convention.id not in UNCORRECTED for convention in self.conventions):
            these = "this" if len(self.causes) == 1 else "all this"
            left, many = f"With {these} put right, {self.corrected_m:.2g} m are left", self.corrected_m / self.allowed_m
            yield f"{left}, {many:.2g} tolerances: no known mistake explains them." if many > 1 else f"{left}."
        elif not self.slip:
            yield "No mistake known to foucault explains the error."
