"""The step error of an unknown method: other causes are read beside a phase and an amplitude that drift.

In a linear motion the steps of any method make the swing a little too fast or too slow, and let it decay or grow. Other
causes are read from what a drift of phase and amplitude does not change.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from .case import FileCase
from .causes import DRIFT, LIKE_A_DRIFT, VERTICAL, Cause, causes_of, is_like_a_drift
from .families import FamilyFit
from .fitted import TRIED, polished
from .programs import NAMES
from .readings import CauseReading, Reader


def drifting(case: FileCase, near: Sequence[CauseReading]) -> list[CauseReading]:
    """Return readings beside a drift of phase and amplitude, their numbers fitted.

    Args:
        case: the file.
        near: readings without a drift; those of their causes that are not like a drift are tried beside one.
    """
    candidates = [_without_drift(reading) for reading in near]
    readers = {reading.reader.right.kind: reading.reader for reading in reversed(near)}
    for kind, reader in readers.items():
        candidates += _unlike_a_drift(case, kind, reader)
    candidates = [one for one in candidates if not any(map(_is_vertical, one.causes))]
    different: dict[tuple[str, frozenset[str]], CauseReading] = {}
    for reading in candidates:
        texts = frozenset(cause.text for cause in reading.causes)
        different.setdefault((reading.program.kind, texts), reading)
    beside = [_with_drift(reading) for reading in different.values()]
    return [polished(case, reading) for reading in beside if reading is not None]


def _unlike_a_drift(case: FileCase, kind: str, reader: Reader) -> list[CauseReading]:
    """Return the likeliest readings of a family, of causes that are not like a drift."""
    every = causes_of(case, kind)
    catalogue = [one for one in every if not (is_like_a_drift(one.id) or _is_vertical(one))]
    blind = replace(reader, fit=_blind(reader))
    likeliest = blind.readings(catalogue)[:TRIED]
    return [replace(reading, reader=reader) for reading in likeliest]


def instead_of_drift(case: FileCase, reading: CauseReading) -> Iterator[CauseReading]:
    """Yield readings with one number in place of a drift, which may be the same motion."""
    reader = reading.reader
    without = reader.without(reading, DRIFT)
    groups = {cause.group for cause in without.causes}
    for cause in causes_of(case, reading.program.kind):
        if cause.id in LIKE_A_DRIFT and cause.free and cause.group not in groups:
            beside = reader.with_cause(without, cause)
            if beside is not None:
                yield polished(case, beside)


def _is_vertical(cause: Cause) -> bool:
    """Return whether a cause differs from a simpler one by the vertical centrifugal force, which is not seen here."""
    return cause.id in VERTICAL


def _with_drift(reading: CauseReading) -> CauseReading | None:
    """Return a reading beside a drift, fitted to what was fitted to the rows; None if it has too many numbers."""
    beside: CauseReading | None = reading
    for cause in DRIFT:
        if beside is not None:
            beside = beside.reader.with_cause(beside, cause)
    return beside


def _without_drift(reading: CauseReading) -> CauseReading:
    """Return a reading without the causes that are the same motion as a drift."""
    drifting = [cause for cause in reading.causes if is_like_a_drift(cause.id)]
    return reading.reader.without(reading, drifting)


def _blind(reader: Reader) -> FamilyFit:
    """Return a fit to which programs are equally near that differ by a drift alone."""
    fit = reader.fit
    free = list(fit.free)
    pull = np.zeros(len(free))
    for name in ("pull_x", "pull_y", "pull_z"):
        number = NAMES.index(name)
        pull[free.index(number)] = fit.theta[number]
    by_phase = fit.slopes @ pull
    by_amplitude = fit.slopes[:, free.index(NAMES.index("drag"))]
    along, _ = np.linalg.qr(np.column_stack([by_phase, by_amplitude]))
    slopes = fit.slopes - along @ (along.T @ fit.slopes)
    return replace(fit, slopes=slopes)
