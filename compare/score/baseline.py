"""Say what changed since a baseline: the rows of an earlier version, or the JSON document of their score.

Both versions are explained down to a tenth of what lies between them, or to the tolerance if that is less. What one
explanation has and the other has not is what changed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from reference import InputError
from reference.system.documents import json_document

from ..diagnosis import Since, Version, diagnose, explain_change, explanation_document
from .document import document
from .verdict import REFUSED, WHOLE, Score

SHARE = 0.1  # of a change: what is smaller is no part of it
WOBBLE = 10.0  # times a change: a cause that moves the bob by more has not come with it
ROUNDED = 10.0  # times the input floor: no more than this is no change
FILE = "file"  # key of a document that was read: where it was
NEEDED, EXPECTED = {"scene", "candidate", "verdict"}, "a document of `foucault score --json`"


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
        changed = _since(new, score, baseline, explains)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            "baseline", f"{type(error).__name__} {error}", EXPECTED, "Make it anew."
        ) from None
    # both versions of a program have one name, and so have their files in a suite
    return replace(changed, name=old[FILE]) if isinstance(old, Mapping) and FILE in old else changed


def document_of(path: Path) -> dict[str, Any]:
    """Return the document in a file, with the path under `FILE`.

    Raises:
        InputError: there is no such file, or no JSON document in it.
    """
    try:
        return json_document(path, "baseline") | {FILE: str(path)}
    except FileNotFoundError:
        raise InputError(
            "baseline", str(path), "a file", "`foucault score … --json > FILE` writes one."
        ) from None


def rows_of(document: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """Return the documents of single candidates that a document holds.

    Raises:
        InputError: it is none of `foucault score`.
    """
    rows: Sequence[Mapping[str, Any]] = (
        document["rows"] if isinstance(document.get("rows"), list) else [document]
    )
    if not all(isinstance(row, dict) and row.keys() >= NEEDED for row in rows):
        raise InputError("baseline", "another document", EXPECTED, "Make it anew.")
    return rows


def _row(old: Mapping[str, Any], new: Score) -> Mapping[str, Any] | None:
    """Return the document by the candidate's problem, of several the one of its name; None if there is none of them."""
    rows, problem = rows_of(old), new.problem
    fitting = [
        row
        for row in rows
        if row["scene"] == new.scene.id and row.get("problem", problem) == problem
    ]
    if not fitting and "problem" in old:
        got, expected = (
            f"a score by {old['scene']} with {old['problem']}",
            f"one by {new.scene.id} with {problem}",
        )
        raise InputError("baseline", got, expected, "Judge both by the same inputs.")
    return max(fitting, key=lambda row: bool(row["candidate"] == new.candidate.name), default=None)


def _since(new: Score, old: Score | None, baseline: Mapping[str, Any], explains: bool) -> Since:
    """Return what changed since the document of a baseline, and since its rows if its score is there."""
    # of the span that both have
    end = min(float(baseline["covered_s"][1]), float(new.errors.t[-1])) * (1 + WHOLE)
    before, after = float(baseline["max_error_m"]), _until(new, end)
    apart, level = abs(after - before), min(before, float(baseline["tolerance_m"]))
    if old is not None:
        before, apart, level = _until(old, end), _apart(new, old), 0.0
    differences = [
        *_differences(new, baseline, after - before),
        *_of_transits(new, old, baseline["transits"], end),
    ]
    worse, gains = (
        tuple(text for is_worse, text in differences if is_worse is which)
        for which in (True, False)
    )
    changed = apart > max(new.errors.bound_m, ROUNDED * new.input_floor_m)
    texts, left_m = tuple[str, ...](), None
    allowed = max(min(SHARE * apart, new.tolerance_m), level)
    if changed and explains and new.candidate.positions:
        now = Version(_explained(new, allowed), after)
        then = Version(baseline if old is None else _explained(old, allowed), before)
        texts, left_m = explain_change(then, now, math.inf if old is None else WOBBLE * apart)
    name, complete = str(baseline["candidate"]), left_m is not None and left_m <= allowed
    return Since(
        name, before, after, apart if changed else 0.0, worse, gains, texts, left_m, complete
    )


def _explained(score: Score, allowed_m: float) -> dict[str, Any]:
    """Return the document of an explanation down to a distance in m."""
    return explanation_document(diagnose(score.candidate, score.scene, allowed_m))


def _until(score: Score, end: float) -> float:
    """Return the largest position error in m up to a time in s."""
    return float(score.errors.position[score.errors.t <= end].max(initial=0.0))


def _apart(new: Score, old: Score) -> float:
    """Return the largest distance in m between the rows of two candidates at the times that both have."""
    _, here, there = np.intersect1d(
        new.errors.t.round(9), old.errors.t.round(9), return_indices=True
    )
    if len(here) < 2 or not (new.candidate.positions and old.candidate.positions):
        return abs(new.errors.max_m - old.errors.max_m)
    names = [
        name for name in "xyz" if name in new.candidate.columns and name in old.candidate.columns
    ]
    gaps = [
        new.candidate.columns[name][here] - old.candidate.columns[name][there] for name in names
    ]
    return float(np.linalg.norm(gaps, axis=0).max())


def _differences(
    new: Score, baseline: Mapping[str, Any], more: float
) -> Iterator[tuple[bool, str]]:
    """Yield what changed by more than the tolerance: whether it became worse, and a text."""
    if abs(more) > new.allowed_m:
        size = f"{abs(more):.3g} m {'more' if more > 0 else 'less'}"
        yield more > 0, f"{size}, {abs(more) / new.allowed_m:.2g} tolerances"
    agreed = str(baseline["grade" if new.as_model else "verdict"]).startswith("agrees")
    if agreed != new.passes:
        yield agreed, f"it {'agreed' if agreed else 'disagreed'} before"
    end, last = float(baseline["covered_s"][1]), float(new.errors.t[-1])
    if last < end * (1 - WHOLE):
        yield True, f"it ends at t = {last:.6g} s, and ended at {end:.6g} s"


def _of_transits(
    new: Score, old: Score | None, before: Mapping[str, Any] | None, end: float
) -> Iterator[tuple[bool, str]]:
    """Yield the same of the transits up to a time in s; a document tells the largest error of all that it has."""
    if new.transits is None or not before:
        return
    now = new.transits.until(end).document(0.0)
    if old is not None and old.transits is not None:
        before = old.transits.until(end).document(0.0)
    count, was = (
        sum(t <= end for key in ("missed_at", "extra_at") for t in each[key])
        for each in (now, before)
    )
    if count != was:
        yield count > was, f"of transits {count} are missed or extra, and {was} were"
    off, was_off = (float(each["max_conditioned_error_m"]) for each in (now, before))
    if abs(off - was_off) > new.allowed_m and new.candidate.positions:
        yield (
            off > was_off,
            f"transits are off by {off:.3g} m, weighted by |ax|, and were by {was_off:.3g} m",
        )
