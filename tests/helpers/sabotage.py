"""A copy of a trusted module with a fault in it."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any


def sabotaged(old: str, new: str, source: str) -> Any:
    """Return a module of the enclosure with a place of its source replaced."""
    text = Path(source).read_text(encoding="utf-8")
    assert text.count(old) == 1, old
    module = ModuleType(f"reference.enclosure.{Path(source).stem}")
    module.__package__ = "reference.enclosure"
    exec(compile(text.replace(old, new), source, "exec"), module.__dict__)
    return module
