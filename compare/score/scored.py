"""The judgement of a candidate: its errors, what was allowed and the floor of its inputs, the verdict and its grade."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from reference import Golden, Scene, Solution
from reference.numbers.precision import Array
from reference.system.cache import arrays

from ..candidates.candidate import COLUMNS, Candidate
from ..candidates.external import Timing
from ..observed.swing_plane import SwingErrors
from ..truth import floor_of_what_ships
from .errors import TrajectoryErrors
from .experiments.findings import Experiments
from .explanation.case import Explanation
from .transit_matching import TransitErrors

TIMES = 577  # in a span, at least half of them up to the end asked for: some in every swing, or hundreds of swings
_FORMAT = "floor 3"  # changes with the content of the cached entries, so that older ones are computed again


def input_floor(scene: Scene, until: float) -> float:
    """Return how far, in m, rounding the decimal inputs to binary64 moves the bob up to a time in s.

    It depends on the scene alone and is the same for every candidate. Where both motions ship it is their distance;
    else one cached run serves all ends within a factor of two.
    """
    ships = floor_of_what_ships(scene, until)
    if ships is not None:
        return ships
    from reference.solver.sensitivity import sensitivity

    decimal = scene.with_values(["inputs=decimal"])
    document = decimal.model_dump(mode="json")
    parts = [document[key] for key in ("pendulum", "site", "release")]
    times = np.linspace(0.0, _span(float(scene.exact.t_end), until), TIMES) if until > 0 else np.zeros(1)
    recipe = json.dumps([_FORMAT, parts, float(times[-1])], sort_keys=True).encode()

    def make() -> dict[str, Array]:
        moved = sensitivity(decimal, times).rounding()[:, :3]
        return {"largest": np.maximum.accumulate(np.sqrt((moved**2).sum(axis=1)))}

    largest = arrays("floor", f"{hashlib.sha256(recipe).hexdigest()[:32]}.npz", make)["largest"]
    return float(largest[np.searchsorted(times, until)])


def _span(t_end: float, until: float) -> float:
    """Return the scene's span, halved as long as it reaches `until`; `until` itself if that is beyond the span."""
    while t_end / 2 >= until:
        t_end /= 2
    return max(t_end, until)


DOUBT = 3  # times the reference's bound, which each of the three coordinates may be off by
WHOLE = 1e-6  # a last row within this part of t_end counts as complete: a program that adds up its steps rounds


class Worst(NamedTuple):
    """One number of a candidate: its time in s and column, the truth, what it says, and their difference."""

    t: float
    component: str
    expected: float
    got: float
    difference: float


@dataclass(frozen=True)
class Since:
    """The changes since a baseline.

    Attributes:
        name: of the baseline.
        before_m: its largest position error in m, over the span that both have.
        after_m: that of the candidate.
        apart_m: the largest distance in m between both, of a document the difference of their errors; 0 if it is no
            more than rounding.
        worse: what became worse by more than the tolerance; empty if nothing did.
        better: whether it became better by more than the tolerance.
        changes: what came and what went.
        left_m: what they leave of both errors, at most, in m; None if it is not known.
        complete: whether that is all, down to the tolerance or a tenth of `apart_m`.
    """

    name: str
    before_m: float
    after_m: float
    apart_m: float
    worse: tuple[str, ...] = ()
    better: bool = False
    changes: tuple[str, ...] = ()
    left_m: float | None = None
    complete: bool = False

    @property
    def text(self) -> str:
        """All of it in a line."""
        word = "Worse since" if self.worse else "Better since" if self.better else "Since"
        numbers = f"{self.before_m:.3g} → {self.after_m:.3g} m"
        if self.changes:
            left = "not all of it" if self.left_m is None else f"all but {self.left_m:.2g} m"
            rest = "nothing else" if self.complete else f"that explains {left}"
            what = f"{'; '.join(self.changes)}: {numbers}; {rest}"
        elif self.apart_m:
            what = f"{numbers}; what lies between them, {self.apart_m:.2g} m, is no known mistake"
        else:
            what = f"nothing changed, {numbers}"
        return f"{word} {self.name}: {what}{''.join(f'; {reason}' for reason in self.worse)}"


@dataclass(frozen=True, repr=False)
class Scored:
    """The numbers of a judgement, which `Score` names one by one, and what follows from them."""

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

    @cached_property
    def input_floor_m(self) -> float:
        """Distance in m by which rounding the inputs to binary64 moves the bob; computed at the first use."""
        return input_floor(self.scene, float(self.candidate.t[-1]))

    @property
    def worst(self) -> Worst:
        """The component in which the largest position error shows most."""
        return self._at(*self.errors.worst)

    @property
    def worst_of_each(self) -> dict[str, Worst]:
        """The largest error of each column."""
        return {name: self._at(row, name) for name, row in self.errors.worst_rows.items()}

    def _at(self, row: int, name: str) -> Worst:
        expected, got = self.errors.truth.states[row, COLUMNS.index(name)], self.candidate.columns[name][row]
        difference = self.errors.components[name][row]
        return Worst(float(self.errors.t[row]), name, float(expected), float(got), float(difference))

    @cached_property
    def covered(self) -> float:
        """Share of the scene's span up to the last row, from 0 to 1; of transits alone, up to the next true one."""
        last, end = float(self.errors.t[-1]), float(self.scene.exact.t_end)
        if not self.candidate.positions:
            later = self.golden.transits["t"]
            later = later[later > last + self.tolerance_m / self.errors.speed_m_s]
            last = float(later[0]) if len(later) else float(self.golden.t[-1])
        return 1.0 if last >= end * (1 - WHOLE) else last / end

    @property
    def falls_short(self) -> bool:
        """True if it says nothing of the motion, having no row after t = 0, or covers less than is demanded."""
        return self.covered < self.covers or not self.covered > 0

    @property
    def allowed_m(self) -> float:
        """Tolerance in m plus the reference's own bound; nothing is judged more finely than the reference is known."""
        return self.tolerance_m + self.errors.bound_m

    @property
    def off_path(self) -> bool:
        """True if the largest position error is above `allowed_m`."""
        return self.errors.max_m > self.allowed_m

    @property
    def in_doubt(self) -> bool:
        """True if the reference's own error could change the verdict."""
        transits, tolerance = self.transits, self.tolerance_m
        measured = [self.errors.max_m, *([transits.max_conditioned_m] if transits else [])]
        return any(abs(error - tolerance) <= DOUBT * self.errors.bound_m for error in measured)

    @property
    def agrees(self) -> bool:
        """True if nothing is off by more than `allowed_m`, missed, extra or left out."""
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
        return self.verdict if self.agrees or model is None else f"agrees as the model: {model.text}"

    @property
    def passes(self) -> bool:
        """True if it agrees, or agrees as a named model and `as_model` says that this is enough."""
        if self.agrees:
            return True
        modelled = self.explanation is not None and self.explanation.model is not None
        return self.as_model and modelled and not self.falls_short and self.transits is None

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
