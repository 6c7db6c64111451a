"""Compare results with the reference: score a program's output, study error against run time, test stability.

>>> import compare
>>> score = compare.assert_agrees("paris", [0.0], [[0.3, 0.4]], tolerance=1e-12)
>>> score.verdict
'agrees'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .candidates.candidate import Candidate
    from .candidates.read import read
    from .score.judge import Score
    from .testing import assert_agrees

__all__ = ["Candidate", "Score", "assert_agrees", "read"]

_LAZY = {
    "Candidate": "candidates.candidate",
    "Score": "score.judge",
    "assert_agrees": "testing",
    "read": "candidates.read",
}


def __getattr__(name: str) -> Any:
    """Import a public name where it is first used."""
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_LAZY[name]}", __name__), name)
