"""Public names that are imported at their first use, and the answer to a name that does not exist."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import Any

from ..errors import nearest


def lazy(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return the functions `__getattr__` and `__dir__` of a package, which import its names at their first use.

    Args:
        package: the package's own name.
        homes: the module that defines each name, relative to the package.
    """

    def attribute(name: str) -> Any:
        if name in homes:
            return getattr(import_module(f".{homes[name]}", package), name)
        raise no_attribute(f"module {package!r}", name, {*homes, *getattr(sys.modules[package], "__all__", ())})

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return attribute, names


def no_attribute(owner: str, name: str, names: Iterable[str]) -> AttributeError:
    """Return the error for an unknown attribute, which says what there is, the nearest names first."""
    text = f"{owner} has no attribute {name!r}"
    if name.startswith("_"):  # Python itself asks for such names, and wants no advice
        return AttributeError(text)
    known = sorted(names)
    near = nearest(name, known)
    return AttributeError(f"{text}; it has {', '.join([*near, *(one for one in known if one not in near)])}")
