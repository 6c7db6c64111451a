"""Match a candidate's transits (xdot = 0) in order with the true ones, and list the missed and the extra ones.

Where the swing plane passes north-south, |ax| at a transit is small and its time is
ill-conditioned. The error of a time is therefore weighted by |ax|/ω, which makes it the distance in
m by which the bob's motion has to be off. An error of the motion within the tolerance may also make
two close transits vanish or appear together: those count as undecided, not as missed or extra.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import Golden, Solution
from reference.dataset.golden import Dense
from reference.numbers.precision import Array
from reference.numbers.zeros import XDOT

from ..truth import by_function, roughly_solved, truth_at
from .errors import TrajectoryErrors, entry, swing_rate

_NAMED = 3  # transits of each kind (missed, extra, shifted) that are listed at most
# extra transits at which the truth is evaluated; if there are more, none is excused
_MOST_EXTRA = 1000


@dataclass(frozen=True, repr=False)
class TransitErrors:
    """Errors of a candidate's transits.

    Attributes:
        errors_s: candidate minus truth for each matched transit, in s.
        conditioned_m: the same errors, each multiplied by |ax|/ω, in m.
        missed: times of the truth's transits that the candidate lacks.
        extra: times of the candidate's transits that the truth lacks.
        at: the truth's times of the matched ones.
        undecided: times of missed and extra ones that a motion within the tolerance may or may not
            have.
    """

    errors_s: Array
    conditioned_m: Array
    missed: list[float]
    extra: list[float]
    at: Array
    undecided: list[float] = field(default_factory=list)

    def __repr__(self) -> str:
        return f"TransitErrors({self.matched} matched, {len(self.missed)} missed, {len(self.extra)} extra)"

    @property
    def matched(self) -> int:
        """Number of matched transits."""
        return len(self.at)

    @property
    def max_error_s(self) -> float:
        """Largest error of a time in s."""
        return float(np.abs(self.errors_s).max()) if self.matched else 0.0

    @property
    def max_conditioned_m(self) -> float:
        """Largest weighted error in m."""
        return float(np.abs(self.conditioned_m).max()) if self.matched else 0.0

    def until(self, end: float) -> TransitErrors:
        """Return those up to a time in s."""
        kept = self.at <= end
        return TransitErrors(
            errors_s=self.errors_s[kept],
            conditioned_m=self.conditioned_m[kept],
            missed=[t for t in self.missed if t <= end],
            extra=[t for t in self.extra if t <= end],
            at=self.at[kept],
        )

    def shifted(self, tolerance_m: float) -> list[tuple[float, float]]:
        """Return times and errors in s of the transits whose weighted error is above a tolerance."""
        off = np.abs(self.conditioned_m) > tolerance_m
        return list(zip(self.at[off].tolist(), self.errors_s[off].tolist(), strict=True))

    def within(self, tolerance_m: float) -> bool:
        """Return whether nothing is missed, extra, or off by more than a tolerance."""
        return not (self.missed or self.extra or self.max_conditioned_m > tolerance_m)

    def lines(
        self, tolerance_m: float, name: str = "transits", weighted: str = "weighted by |ax|"
    ) -> Iterator[str]:
        """Yield the lines for people."""
        worst = (
            f"largest error {self.max_error_s:.3g} s, {weighted}: {self.max_conditioned_m:.3g} m"
        )
        shifted = self.shifted(tolerance_m)
        matched = f"{self.matched} matched"
        if shifted:
            matched = f"{matched} ({len(shifted)} shifted)"
        yield entry(name, f"{matched}, {len(self.missed)} missed, {len(self.extra)} extra", worst)

        if self.missed:
            yield entry("  missed at", _listed_times(self.missed))
        if self.extra:
            yield entry("  extra at", _listed_times(self.extra))
        if self.undecided:
            remark = "a motion within the tolerance may or may not have them"
            yield entry("  undecided at", _listed_times(self.undecided), remark)
        if shifted:
            yield entry("  shifted", _listed(f"{t:.6f} s by {error:.2g} s" for t, error in shifted))

    def document(self, tolerance_m: float) -> dict[str, Any]:
        """Return the JSON document."""
        return {
            "matched": self.matched,
            "missed": len(self.missed),
            "extra": len(self.extra),
            "shifted": len(self.shifted(tolerance_m)),
            "max_error_s": self.max_error_s,
            "max_conditioned_error_m": self.max_conditioned_m,
            "missed_at": self.missed,
            "extra_at": self.extra,
            "undecided_at": self.undecided,
        }


def _listed_times(times: Iterable[float]) -> str:
    """Return the first few times, with … if there are more."""
    return _listed(f"{t:.6f}" for t in times) + " s"


def _listed(texts: Iterable[str]) -> str:
    """Join the first few, with … if there are more."""
    first = list(islice(texts, _NAMED + 1))
    more = " …" if len(first) > _NAMED else ""
    return ", ".join(first[:_NAMED]) + more


def transit_errors(
    times: Array,
    truth: Array,
    slopes: Array,
    until: float,
    *,
    tolerance_m: float = 0.0,
    away: Callable[[Array], Array] | None = None,
) -> TransitErrors:
    """Match a candidate's transits, or passages of a section, with the truth's.

    Args:
        times: the candidate's, in order, in s; of equal ones all but one are extra.
        truth: the truth's times, increasing, in s.
        slopes: how fast the distance from the form's zero grows at these times, in m/s: it weights
            their errors.
        until: end of the candidate's run in s: later zeros are not missed.
        tolerance_m: largest weighted error that counts as none, in m.
        away: returns how far in m the truth is from such a zero at increasing times; without it no
            extra one is excused.
    """
    owner = _owners(times, truth)
    matched = owner >= 0
    errors_s = times[owner[matched]] - truth[matched]
    weight = np.abs(slopes)

    missed = np.flatnonzero(~matched & (truth <= until))
    may_vanish = _vanishing(missed, truth, weight, until, tolerance_m)
    extra = np.setdiff1d(np.arange(len(times)), owner[matched])
    may_appear = _appearing(extra, times, away, tolerance_m)

    undecided = [*truth[missed[may_vanish]].tolist(), *times[extra[may_appear]].tolist()]
    return TransitErrors(
        errors_s=errors_s,
        conditioned_m=errors_s * weight[matched],
        missed=truth[missed[~may_vanish]].tolist(),
        extra=times[extra[~may_appear]].tolist(),
        at=truth[matched],
        undecided=sorted(undecided),
    )


def _owners(times: Array, truth: Array) -> npt.NDArray[np.int64]:
    """Return, for each transit of the truth, the index of the candidate's transit that matches it.

    -1 if none does.
    """
    owner = np.full(len(truth), -1)
    if not len(truth) or not len(times):
        return owner
    window = 0.5 * float(np.median(np.diff(truth, prepend=0.0)))
    if len(times) <= len(truth) and (np.abs(times - truth[: len(times)]) <= window).all():
        owner[: len(times)] = np.arange(len(times))  # one to one, in order, however close a pair
        return owner
    cell = np.searchsorted((truth[1:] + truth[:-1]) / 2, times)
    distance = np.abs(times - truth[cell])
    for i in np.argsort(distance, kind="stable"):
        if distance[i] <= window and owner[cell[i]] < 0:
            owner[cell[i]] = i
    return owner


def _vanishing(
    missed: npt.NDArray[np.int64], truth: Array, weight: Array, until: float, tolerance_m: float
) -> npt.NDArray[np.bool_]:
    """Mark the missed transits that an error within the tolerance takes away in a pair, or moves beyond the end."""
    marked = (until - truth[missed]) * weight[missed] <= tolerance_m
    pairs = np.flatnonzero(np.diff(missed) == 1)
    first = missed[pairs]
    # of the parabola between the two zeros
    depth_m = weight[first] * (truth[first + 1] - truth[first]) / 4
    shallow = pairs[depth_m <= tolerance_m]
    marked[shallow] = True
    marked[shallow + 1] = True
    return marked


def _appearing(
    extra: npt.NDArray[np.int64],
    times: Array,
    away: Callable[[Array], Array] | None,
    tolerance_m: float,
) -> npt.NDArray[np.bool_]:
    """Mark the extra transits at which an error within the tolerance makes the truth pass."""
    if away is None or not 0 < len(extra) <= _MOST_EXTRA:
        return np.zeros(len(extra), dtype=bool)
    # no motion has a transit twice
    doubled = np.isin(times[extra], times[1:][np.diff(times) == 0])
    once, back = np.unique(times[extra], return_inverse=True)
    return (np.abs(away(once)[back]) <= tolerance_m) & ~doubled


def unjudged_transits(golden: Golden | Solution) -> str | None:
    """Return the reason why a candidate's transits cannot be judged, or None."""
    if isinstance(golden, Golden):
        transits = golden.manifest.transits
    elif XDOT in golden.zeros:
        transits = "complete"
    else:
        transits = "xdot is identically zero" if golden.scene.run.transits else "not asked for"

    if transits == "not asked for":
        return "the scene does not look for transits (run.transits), so the candidate's were not judged"
    if transits == "xdot is identically zero":
        return f"{transits}, so the candidate's transits were not judged"
    return None


def _truth(golden: Golden | Solution, times: Array) -> Dense:
    if isinstance(golden, Solution):
        again = roughly_solved(golden.scene, times, False, None)
        assert again is not None  # as before, at other times
        return again[1]
    truth = by_function(golden, times) if golden.function is not None else None
    return truth_at(golden, times) if truth is None else truth


def judged_transits(
    times: Array,
    golden: Golden | Solution,
    errors: TrajectoryErrors,
    tolerance_m: float,
    end_of_run: float | None = None,
) -> TransitErrors:
    """Return the errors of a candidate's transits, except those after the truth's end or undecided by its proof.

    A transit of the truth after the end of the run is left out, unless an error within the
    tolerance moves it into the run.

    Args:
        times: the candidate's transits, in order, in s.
        golden: dataset or solution of the truth.
        errors: of the candidate's rows, or of its transits alone.
        tolerance_m: largest weighted error that counts as none, in m.
        end_of_run: in s; None for the scene's end.
    """
    end = float(golden.scene.exact.t_end)
    end_of_run = end if end_of_run is None else min(end_of_run, end)
    judged = times[times <= end_of_run]  # beyond its end the truth is not known
    if isinstance(golden, Golden):
        for interval in golden.manifest.possible:
            is_open = (judged >= float(interval.from_s)) & (judged <= float(interval.to_s))
            judged = judged[~is_open]

    t = golden.transits["t"]
    ax = golden.transits["ax"]
    # xdot divided by ω is a distance; if nothing swings, ω is 0 and the errors have no weight
    omega = swing_rate(golden.scene, errors.speed_m_s)
    slopes = np.abs(ax) / omega if omega else np.zeros_like(ax)

    def distance(at: Array) -> Array:
        return np.asarray(_truth(golden, at).states[:, 3] / omega)

    kept = (t <= end_of_run) | ((t - end_of_run) * slopes <= tolerance_m)
    until = min(float(errors.t[-1]), end_of_run)
    away = distance if omega else None
    return transit_errors(judged, t[kept], slopes[kept], until, tolerance_m=tolerance_m, away=away)
