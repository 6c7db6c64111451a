"""Transits of a candidate against the truth's: matched in order, within windows; missed and extra ones named.

A transit where the swing plane passes north-south has a small |ax|, and its time is as ill-conditioned. So an
error of a time is weighed by |ax|/ω: it becomes the distance in m that the bob's motion would have to be off by.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from reference.solution import Array


@dataclass(frozen=True)
class TransitErrors:
    """How a candidate's transits compare.

    Attributes:
        errors_s: candidate minus truth per matched transit.
        conditioned_m: the same times |ax|/ω.
        missed: times of the truth's transits that no transit of the candidate is near.
        extra: times of the candidate's transits that are near none.
        at: times of the matched ones.
    """

    errors_s: Array = field(repr=False)
    conditioned_m: Array = field(repr=False)
    missed: list[float]
    extra: list[float]
    at: Array = field(repr=False)

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


def transit_errors(found: Array, truth: Array, ax: Array, omega: float, until: float) -> TransitErrors:
    """Match a candidate's transits with the truth's.

    Args:
        found: the candidate's times, increasing, in s.
        truth: the truth's times, increasing, in s.
        ax: d²x/dt² there in m/s².
        omega: angular frequency of small swings in rad/s.
        until: where the candidate ends, in s: later transits are not missed.
    """
    spare = 0.0 if not len(truth) else 0.5 * float(np.median(np.diff(truth, prepend=0.0)))
    inside = truth <= until
    windows = _windows(truth, spare)
    owner = np.full(len(truth), -1)
    extra = []
    first = 0
    for i, t in enumerate(found):
        while first < len(truth) and truth[first] + windows[first] < t:
            first += 1
        near = [k for k in range(first, min(first + 2, len(truth))) if abs(truth[k] - t) <= windows[k] and owner[k] < 0]
        if near:
            owner[min(near, key=lambda k: abs(truth[k] - t))] = i
        else:
            extra.append(float(t))
    matched = owner >= 0
    errors = found[owner[matched]] - truth[matched]
    near_end = truth > until - np.minimum(windows, spare)  # a transit at the very end may lie just beyond the last row
    missed = truth[inside & ~matched & ~near_end].tolist()
    weighed = errors * np.abs(ax[matched]) / omega if omega else np.zeros_like(errors)
    return TransitErrors(errors, weighed, missed, extra, truth[matched])


def _windows(truth: Array, spare: float) -> Array:
    """Half the distance to the nearer neighbour, per transit; at most `spare`."""
    gaps = np.diff(truth)
    before = np.concatenate([[np.inf], gaps])
    after = np.concatenate([gaps, [np.inf]])
    nearer: Array = np.minimum(before, after) / 2
    return np.minimum(nearer, spare) if spare else nearer
