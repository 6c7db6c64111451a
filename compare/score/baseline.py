"""Say what changed since a baseline: the rows of an earlier version, or the JSON document of their score.

Both versions are explained down to a tenth of what lies between them, or to the tolerance if that
is less. What one explanation has and the other has not is what changed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import InputError
from reference.errors import Described
from reference.numbers.columns import POSITION
from reference.numbers.precision import Array
from reference.system.documents import json_document

from ..diagnosis import (
    NOT_SOUGHT,
    ROUNDING,
    Since,
    Version,
    diagnose,
    explain_change,
    explanation_document,
    unexplained,
)
from .document import document
from .verdict import REFUSED, WHOLE, Score

FILE = "file"  # key of a document that was read: where it was

_SHARE = 0.1  # of a change: what is smaller is no part of it
# times a change: unless both versions are explained, a cause that moves the bob by more has not come with it
_WOBBLE = 10.0
_ROUNDED = 10.0  # times the input floor: no more than this is no change
_Indices = npt.NDArray[np.intp]  # of rows
_NEEDED = {"scene", "candidate", "verdict"}  # keys of a document
_EXPECTED = "a document that `foucault score --json` wrote"


def since(new: Score, old: Score | Mapping[str, Any], explains: bool = True) -> Since | None:
    """Return what changed since a baseline; None if it was not judged.

    Args:
        new: the score of the candidate.
        old: that of the baseline, or its document, or one of several candidates.
        explains: whether to look for the reasons.

    Raises:
        InputError: the document is none of a score, or one of another problem.
    """
    score = old if isinstance(old, Score) else None
    try:
        baseline = document(old) if isinstance(old, Score) else _row(old, new)
        if baseline is None or baseline["verdict"] == REFUSED:
            return None
        changes = _since(new, score, baseline, explains)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        got = Described("a document that cannot be read")
        advice = f"Make it again ({type(error).__name__}: {error})."
        raise InputError("baseline", got, _EXPECTED, advice) from None
    # both versions of a program have one name, and so have their files in a suite
    if isinstance(old, Mapping) and FILE in old:
        return replace(changes, name=old[FILE])
    return changes


def document_of(path: Path) -> dict[str, Any]:
    """Return the document in a file, with the path under `FILE`.

    Raises:
        InputError: there is no such file, or no JSON document in it.
    """
    try:
        return json_document(path, "baseline") | {FILE: str(path)}
    except FileNotFoundError:
        advice = "`foucault score … --json > FILE` writes one."
        raise InputError("baseline", str(path), "a file", advice) from None


def rows_of(document: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """Return the documents of single candidates that a document holds.

    Raises:
        InputError: it is none of `foucault score`.
    """
    rows: Sequence[Mapping[str, Any]] = [document]
    if isinstance(document.get("rows"), list):
        rows = document["rows"]
    if not all(isinstance(row, dict) and row.keys() >= _NEEDED for row in rows):
        got = Described("a document of another kind")
        raise InputError("baseline", got, _EXPECTED, "Make it again.")
    return rows


def _row(old: Mapping[str, Any], new: Score) -> Mapping[str, Any] | None:
    """Return the document of the candidate's problem, of several the one of its name.

    None if there is none.

    Raises:
        InputError: the document is that of one candidate, judged by another problem.
    """
    problem = new.problem
    of_problem = []
    for row in rows_of(old):
        if row["scene"] == new.scene.id and row.get("problem", problem) == problem:
            of_problem.append(row)

    if not of_problem and "problem" in old:
        got = Described(f"a score of the scene {old['scene']} with inputs {old['problem']}")
        expected = f"a score of {new.scene.id} with inputs {problem}"
        raise InputError("baseline", got, expected, "Score both with the same inputs.")
    for row in of_problem:
        if row["candidate"] == new.candidate.name:
            return row
    return of_problem[0] if of_problem else None


def _since(new: Score, old: Score | None, baseline: Mapping[str, Any], explains: bool) -> Since:
    """Return what changed since the document of a baseline, and since its rows if its score is there."""
    # of the span that both have
    end_s = min(float(baseline["covered_s"][1]), float(new.errors.t[-1])) * (1 + WHOLE)
    after_m = _largest_until(new, end_s)
    if old is None:
        # their rows are not known, so the distance between them is at least that of their errors
        before_m = float(baseline["max_error_m"])
        apart_m = abs(after_m - before_m)
        level_m = min(before_m, float(baseline["tolerance_m"]))
    else:
        before_m = _largest_until(old, end_s)
        apart_m = _distance(new, old)
        level_m = 0.0

    differences = [
        *_differences(new, baseline, after_m - before_m),
        *_transit_differences(new, old, baseline["transits"], end_s),
    ]
    unchanged_m = max(new.errors.bound_m, _ROUNDED * new.input_floor_m)
    is_changed = apart_m > unchanged_m
    changes: tuple[str, ...] = ()
    left_m = None
    remark = NOT_SOUGHT
    allowed_m = max(min(_SHARE * apart_m, new.tolerance_m), level_m)
    if is_changed and explains and new.candidate.positions:
        now = Version(_explained(new, allowed_m), after_m)
        then = Version(baseline if old is None else _explained(old, allowed_m), before_m)
        both_explained = now.is_explained(allowed_m) and then.is_explained(allowed_m)
        most_m = math.inf if old is None or both_explained else _WOBBLE * apart_m
        changes, left_m = explain_change(then, now, apart_m, most_m)
        remark = unexplained(then, now)
        if old is not None and _differ_by_rounding(new, now, old, then, unchanged_m):
            remark = ROUNDING
    return Since(
        name=str(baseline["candidate"]),
        before_m=before_m,
        after_m=after_m,
        apart_m=apart_m if is_changed else 0.0,
        worse=tuple(text for is_worse, text in differences if is_worse),
        gains=tuple(text for is_worse, text in differences if not is_worse),
        changes=changes,
        left_m=left_m,
        complete=left_m is not None and left_m <= allowed_m,
        unexplained=remark,
    )


def _explained(score: Score, allowed_m: float) -> dict[str, Any]:
    """Return the document of an explanation down to a distance in m."""
    return explanation_document(diagnose(score.candidate, score.scene, allowed_m))


def _largest_until(score: Score, end_s: float) -> float:
    """Return the largest position error in m up to a time in s."""
    return float(score.errors.position[score.errors.t <= end_s].max(initial=0.0))


def _common_rows(new: Score, old: Score) -> tuple[_Indices, _Indices]:
    """Return the indices of the rows of two candidates at the times that both have."""
    _, here, there = np.intersect1d(
        new.errors.t.round(9), old.errors.t.round(9), return_indices=True
    )
    return here, there


def _distance(new: Score, old: Score) -> float:
    """Return the largest distance in m between the rows of two candidates at the times that both have."""
    here, there = _common_rows(new, old)
    if len(here) < 2 or not (new.candidate.positions and old.candidate.positions):
        return abs(new.errors.max_m - old.errors.max_m)

    now = new.candidate.columns
    then = old.candidate.columns
    offsets = [now[name][here] - then[name][there] for name in _common_columns(new, old)]
    return float(np.linalg.norm(offsets, axis=0).max())


def _common_columns(new: Score, old: Score) -> list[str]:
    """Return the names of the columns of positions that two candidates have."""
    both = new.candidate.columns.keys() & old.candidate.columns.keys()
    return [name for name in POSITION if name in both]


def _differ_by_rounding(
    new: Score, now: Version, old: Score, then: Version, unchanged_m: float
) -> bool:
    """Return whether no number of two candidates differs by more than the rounding of both as they are printed.

    Args:
        new: the candidate.
        now: what is known of its file.
        old: the baseline.
        then: what is known of its file.
        unchanged_m: the distance in m that counts as none.
    """
    here, there = _common_rows(new, old)
    if len(here) < 2 or not old.candidate.positions:
        return False
    for name in _common_columns(new, old):
        offset = new.candidate.columns[name][here] - old.candidate.columns[name][there]
        rounding_now = _rounding(new, now, name)[here]
        rounding_then = _rounding(old, then, name)[there]
        if (np.abs(offset) > rounding_now + rounding_then + unchanged_m).any():
            return False
    return True


def _rounding(score: Score, version: Version, name: str) -> Array:
    """Return half a unit of the last digit printed of each number in a column in m; zero if it has many digits."""
    columns = score.candidate.columns
    for convention in version.document["conventions"]:
        if convention["id"] == "decimals" or (convention["id"], name) == ("decimals_of_z", "z"):
            return np.full_like(columns[name], convention["size_m"])
        if convention["id"] == "digits":
            # the convention has the rounding of the largest number of the file
            positions = [columns[other] for other in POSITION if other in columns]
            largest_decade = _decades(np.concatenate(positions)).max()
            decades = _decades(columns[name]) - largest_decade
            return np.asarray(convention["size_m"] * 10.0**decades)
    return np.zeros_like(columns[name])


def _decades(numbers: Array) -> Array:
    """Return the power of ten of the first digit of each number; minus infinity for zero."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.floor(np.log10(np.abs(numbers))))


def _differences(
    new: Score, baseline: Mapping[str, Any], more_m: float
) -> Iterator[tuple[bool, str]]:
    """Yield what changed by more than the tolerance: whether it became worse, and a text."""
    if abs(more_m) > new.allowed_m:
        size = f"{abs(more_m):.3g} m {'more' if more_m > 0 else 'less'}"
        yield more_m > 0, f"{size}, {abs(more_m) / new.allowed_m:.2g} tolerances"

    verdict = baseline["grade" if new.as_model else "verdict"]
    agreed = str(verdict).startswith("agrees")
    if agreed != new.passes:
        yield agreed, f"it {'agreed' if agreed else 'disagreed'} before"

    end_before_s = float(baseline["covered_s"][1])
    end_s = float(new.errors.t[-1])
    if end_s < end_before_s * (1 - WHOLE):
        yield True, f"it ends at t = {end_s:.6g} s, and ended at {end_before_s:.6g} s"


def _transit_differences(
    new: Score, old: Score | None, baseline: Mapping[str, Any] | None, end_s: float
) -> Iterator[tuple[bool, str]]:
    """Yield the same of the transits up to a time in s.

    A document has the largest error of all its transits.
    """
    if new.transits is None or not baseline:
        return
    now = new.transits.until(end_s).document(0.0)
    then = baseline
    if old is not None and old.transits is not None:
        then = old.transits.until(end_s).document(0.0)

    count = _missed_or_extra(now, end_s)
    count_before = _missed_or_extra(then, end_s)
    if count != count_before:
        text = f"of transits {count} are missed or extra, and {count_before} were"
        yield count > count_before, text

    error_m = float(now["max_conditioned_error_m"])
    error_before_m = float(then["max_conditioned_error_m"])
    if abs(error_m - error_before_m) > new.allowed_m and new.candidate.positions:
        text = f"transits are off by {error_m:.3g} m, weighted by |ax|, and were by {error_before_m:.3g} m"
        yield error_m > error_before_m, text


def _missed_or_extra(transits: Mapping[str, Any], end_s: float) -> int:
    """Return how many transits of a document are missed or extra up to a time in s."""
    return sum(t <= end_s for t in [*transits["missed_at"], *transits["extra_at"]])
