"""An explanation as part of the JSON document of `foucault score --json`."""

from __future__ import annotations

import math
from typing import Any

from ..candidates.candidate import Deviation
from .case import BEGIN, Explanation

Readings = list[dict[str, Any]]


def explanation_document(
    explanation: Explanation, readings: Readings | None = None
) -> dict[str, Any]:
    """Return the keys of the document that an explanation fills; `readings` stand before its conventions."""
    corrected = explanation.corrected_m
    conventions = [_as_document("your file", convention) for convention in explanation.conventions]
    return {
        "conventions": [*(readings or []), *conventions],
        "model": None if explanation.model is None else vars(explanation.model),
        "causes": [
            _as_document("your program", cause) | _fitted(cause) for cause in explanation.causes
        ],
        "corrected": {"max_error_m": corrected} if math.isfinite(corrected) else None,
        "slip": explanation.slip or None,
        "diagnosis": _summary(explanation),
    }


def _summary(explanation: Explanation) -> dict[str, Any] | None:
    """Return the most important cause and the text of all causes, or None if no cause is known.

    A simpler model comes before any other cause. `explained` is the share of the root mean square error that all causes
    remove, `shift` the error of a fitted input in its own unit, `also` lists the ids of the other causes.
    """
    known = sorted(explanation.known, key=lambda cause: -cause.size_m)
    if not known:
        return None
    first = next((cause for cause in known if cause.stage == "model"), known[0])
    return {
        "id": first.id,
        "explained": explanation.explained,
        "text": f"{BEGIN} {'; it '.join(cause.text for cause in known)}.",
        "shift": first.shift,
        "also": tuple(cause.id for cause in known if cause is not first),
    }


def _as_document(subject: str, deviation: Deviation) -> dict[str, Any]:
    return {"id": deviation.id, "text": f"{subject} {deviation.text}", "size_m": deviation.size_m}


def _fitted(cause: Deviation) -> dict[str, float | None]:
    numbers = {"value": cause.value, "shift": cause.shift, "uncertainty": cause.uncertainty}
    return {name: number for name, number in numbers.items() if math.isfinite(number or 0.0)}
