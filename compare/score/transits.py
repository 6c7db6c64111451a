"""Transits of a candidate against the truth's: matched in order, within windows; missed and extra ones named.

A transit where the swing plane passes north-south has a small |ax|, and its time is as ill-conditioned. So an
error of a time is weighed by |ax|/ω: it becomes the distance in m that the bob's motion would have to be off by.
By the same weight two transits may vanish together, or two appear, without a fault: those are undecided.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from reference.precision import Array

ASKED = 1000  # extra transits at which the truth is evaluated; with more of them none is excused


@dataclass(frozen=True)
class TransitErrors:
    """How a candidate's transits compare.

    Attributes:
        errors_s: candidate minus truth per matched transit.
        conditioned_m: the same times |ax|/ω.
        missed: times of the truth's transits that the candidate lacks.
        extra: times of the candidate's transits that the truth lacks.
        at: times of the matched ones.
        undecided: times of missed and extra ones that a motion within the tolerance may have or not.
    """

    errors_s: Array = field(repr=False)
    conditioned_m: Array = field(repr=False)
    missed: list[float]
    extra: list[float]
    at: Array = field(repr=False)
    undecided: list[float] = field(default_factory=list)

    @property
    def matched(self) -> int:
        """How many were matched."""
        return len(self.at)

    @property
    def max_error_s(self) -> float:
        """The largest error of a time in s."""
        return float(np.abs(self.errors_s).max()) if self.matched else 0.0

    @property
    def max_conditioned_m(self) -> float:
        """The largest weighed error in m."""
        return float(np.abs(self.conditioned_m).max()) if self.matched else 0.0

    def shifted(self, tolerance_m: float) -> list[tuple[float, float]]:
        """Times and errors in s of transits whose weighed error is above a tolerance."""
        off = np.abs(self.conditioned_m) > tolerance_m
        return list(zip(self.at[off].tolist(), self.errors_s[off].tolist(), strict=True))


def transit_errors(
    found: Array,
    truth: Array,
    ax: Array,
    omega: float,
    until: float,
    *,
    tolerance_m: float = 0.0,
    xdot: Callable[[Array], Array] | None = None,
) -> TransitErrors:
    """Match a candidate's transits with the truth's.

    Args:
        found: the candidate's times, increasing, in s.
        truth: the truth's times, increasing, in s.
        ax: d²x/dt² there in m/s².
        omega: angular frequency of the motion in rad/s.
        until: where the candidate ends, in s: later transits are not missed.
        tolerance_m: a weighed error that is no fault, in m.
        xdot: the truth's velocity in m/s at increasing times; without it no extra transit is excused.
    """
    owner = _owners(found, truth)
    matched = owner >= 0
    errors = found[owner[matched]] - truth[matched]
    weight = np.abs(ax) / omega if omega else np.zeros_like(ax)
    missed = np.flatnonzero(~matched & (truth <= until))
    extra = np.setdiff1d(np.arange(len(found)), owner[matched])
    excused = _vanishing(missed, truth, weight, until, tolerance_m)
    spurious = np.zeros(len(extra), dtype=bool)
    if xdot is not None and 0 < len(extra) <= ASKED and omega:
        spurious = np.abs(xdot(found[extra])) / omega <= tolerance_m
    return TransitErrors(
        errors,
        errors * weight[matched],
        truth[missed[~excused]].tolist(),
        found[extra[~spurious]].tolist(),
        truth[matched],
        sorted([*truth[missed[excused]].tolist(), *found[extra[spurious]].tolist()]),
    )


def _owners(found: Array, truth: Array) -> npt.NDArray[np.int64]:
    """Per transit of the truth which of the candidate's is its own; -1 if none."""
    owner = np.full(len(truth), -1)
    if not len(truth) or not len(found):
        return owner
    spare = 0.5 * float(np.median(np.diff(truth, prepend=0.0)))
    first = min(len(found), len(truth))
    if len(found) <= len(truth) and (np.abs(found - truth[:first]) <= spare).all():
        owner[:first] = np.arange(first)  # one to one, in order, however close a pair
        return owner
    cell = np.searchsorted((truth[1:] + truth[:-1]) / 2, found)
    distance = np.abs(found - truth[cell])
    for i in np.argsort(distance, kind="stable"):
        if distance[i] <= spare and owner[cell[i]] < 0:
            owner[cell[i]] = i
    return owner


def _vanishing(
    missed: npt.NDArray[np.int64], truth: Array, weight: Array, until: float, tolerance_m: float
) -> npt.NDArray[np.bool_]:
    """Which missed transits are missed in a pair that a shift within the tolerance takes away, or lie at the end."""
    excused = (until - truth[missed]) * weight[missed] <= tolerance_m
    pairs = np.flatnonzero(np.diff(missed) == 1)
    for i in pairs:
        k = missed[i]
        depth = weight[k] * (truth[k + 1] - truth[k]) / 4  # of the parabola between two zeros of that slope
        if depth <= tolerance_m:
            excused[i] = excused[i + 1] = True
    return excused
