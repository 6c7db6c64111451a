"""The header of a report on a machine shared with other work: its load, and how much repeats of a run differ."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from ..studies.row import Row
from ..studies.stability import Cell

BUSY = 1.0  # processes for each core; with more, runs share cores and caches, and the clock of wide vectors is lower
SPREAD = 0.2  # difference of repeated costs over their median; with more, ratios of costs are doubtful


def busy(rows: Sequence[Row | Cell]) -> str:
    """Return the load while rows were measured, and the spread of repeats; and that the machine was busy if it was.

    Rows that were measured earlier, and taken from a journal, count with the load of their time.
    """
    loads = [row.load for row in rows if row.load is not None]
    spreads = [row.cpu_spread for row in rows if isinstance(row, Row) and row.cpu_spread is not None]
    parts = []
    if loads:
        parts.append(f"{median(loads):.1f} processes for each core (median), {max(loads):.1f} at most")
    if spreads:
        parts.append(f"repeats of a run differ by {100 * median(spreads):.0f} % (median), {100 * max(spreads):.0f} %")
        parts[-1] += " at most"
    if not parts:
        return "not known"
    text = "; ".join(parts)
    crowded, uneven = bool(loads) and median(loads) > BUSY, bool(spreads) and median(spreads) > SPREAD
    if not (crowded or uneven):
        return text
    doubt = "ratios of costs drift too, most where vectors are wide (AVX-512)"
    return f"{text}. The machine was busy: {doubt}" if crowded else f"{text}. Costs were uneven: {doubt}"
