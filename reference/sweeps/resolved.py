"""Some rows of a sweep solved again in many digits: does the truth lie within the errors that were estimated?"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..status import Status
from .promote import promoted
from .request import Request
from .row import STATE_COLUMNS

DIGITS = 28  # at about 110 bits


@dataclass(frozen=True)
class Audit:
    """Findings of an audit: rows solved again, those that were wrong, the largest error over its estimate."""

    rows: int
    wrong: tuple[int, ...]
    worst_ratio: float
    worst_row: int | None

    @property
    def document(self) -> dict[str, Any]:
        """The audit as JSON."""
        return {
            "rows": self.rows, "wrong": list(self.wrong), "worst_ratio": self.worst_ratio, "worst_row": self.worst_row
        }  # fmt: skip


def resolved(request: Request, read: Callable[[int], Mapping[str, Any]]) -> Audit:
    """Solve a sample of the rows again: the request says how many, its hash which.

    Args:
        request: the sweep.
        read: returns the columns of a row.
    """
    ratios = {}
    for number in sample(request):
        row = read(number)
        if row["status"] == Status.OK.value and row["level"] == "computed":
            ratios[number] = worst_ratio(request, number, row)
    wrong = tuple(number for number, ratio in ratios.items() if not ratio <= 1)
    worst = max(ratios, key=lambda number: ratios[number], default=None)
    return Audit(len(ratios), wrong, ratios[worst] if worst is not None else 0.0, worst)


def sample(request: Request) -> list[int]:
    """Return the rows that are solved again, by the hash of the plan."""
    chosen: set[int] = set()
    tries = 0
    while len(chosen) < request.audit:
        text = f"{request.hash}:{tries}".encode()
        chosen.add(int.from_bytes(hashlib.sha256(text).digest()[:8], "big") % request.table.count)
        tries += 1
    return sorted(chosen)


def worst_ratio(request: Request, number: int, row: Mapping[str, Any]) -> float:
    """Return the largest error of a row over its estimate; infinite where its transits are miscounted."""
    truth = promoted(request, number, doubtful=False, level="computed", digits=DIGITS)
    if truth.failure:
        return np.inf
    values, ratios = truth.values, [0.0]
    if "x_m" in row:
        position = [row[name] - values[name] for name in STATE_COLUMNS[:3]]
        velocity = [row[name] - values[name] for name in STATE_COLUMNS[3:]]
        ratios += [
            float(np.linalg.norm(position)) / row["position_error_m"],
            float(np.linalg.norm(velocity)) / row["velocity_error_m_s"],
        ]
    if "transits" in row:
        if row["transits"] != values["transits"]:
            return np.inf
        for name in ("t_first_s", "t_last_s") if row["transits"] else ():
            ratios.append(abs(row[name] - values[name]) / row["transit_error_s"])
        if row["transits"] > 1 and "frequency_hz" in row:
            ratios.append(abs(row["frequency_hz"] - values["frequency_hz"]) / row["frequency_error_hz"])
    return max(ratios)
