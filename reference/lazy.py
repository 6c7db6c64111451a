"""Public names of a package that are imported at their first use, so that importing the package stays quick."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

NEAR = 0.5  # of difflib's similarity, from 0 to 1: names at least as near stand first


def lazy(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return the functions `__getattr__` and `__dir__` of a package.

    An unknown attribute raises an AttributeError that says which names there are, the nearest ones first.

    Args:
        package: the package's own name.
        homes: the module that defines each name, relative to the package.
    """

    def attribute(name: str) -> Any:
        if name in homes:
            return getattr(import_module(f".{homes[name]}", package), name)
        text = f"module {package!r} has no attribute {name!r}"
        raise AttributeError(text if name.startswith("_") else f"{text}; it has {', '.join(_nearest_first(name))}")

    def _nearest_first(name: str) -> list[str]:
        from difflib import get_close_matches

        public = sorted({*homes, *getattr(sys.modules[package], "__all__", ())})
        near = get_close_matches(name, public, cutoff=NEAR)
        return near + [one for one in public if one not in near]

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return attribute, names
