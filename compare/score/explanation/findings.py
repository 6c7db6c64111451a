"""The findings of an explanation: conventions, sized causes, the model that a file is exact within, what is left."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...candidates.candidate import Convention


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
class SizedCause:
    """A cause with its size.

    Attributes:
        id: a stable word.
        text: the end of the sentence "Your program …".
        size_m: the distance in m by which it moves the bob, on top of those before it.
        stage: gravity, model, input, release, frame, clock or integrator.
        value: a fitted number, in its unit.
        shift: by how much it differs from the scene's.
        uncertainty: of it, from what is left.
    """

    id: str
    text: str
    size_m: float
    stage: str
    value: float | None = None
    shift: float | None = None
    uncertainty: float | None = None


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
    """

    conventions: tuple[Convention, ...] = ()
    causes: tuple[SizedCause, ...] = ()
    model: Model | None = None
    corrected_m: float = math.nan
    slip: str = ""
    explained: float = 0.0
    score: float = 0.0

    @property
    def diagnosis(self) -> Diagnosis | None:
        """The cause that matters most, a simpler model before all; None if none is known."""
        if not self.causes:
            return None
        models = [cause for cause in self.causes if cause.stage == "model"]
        first = (models or sorted(self.causes, key=lambda cause: -cause.size_m))[0]
        texts = "; it ".join(cause.text for cause in self.causes)
        others = tuple(cause.id for cause in self.causes if cause is not first)
        return Diagnosis(first.id, self.explained, f"It seems that your program {texts}.", first.shift, others)
