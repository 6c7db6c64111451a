"""Declarations by id: a file put into a folder of them is found, and imported when an id is first looked up."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, Protocol, TypeVar

from ..errors import unknown


class Declaration(Protocol):
    """Anything with an id."""

    @property
    def id(self) -> str:
        """Its name on the command line."""


D = TypeVar("D", bound=Declaration)


class Registry(Mapping[str, D]):
    """Declarations by id, in the order of `group`, then of the files' names, then as they stand in the file.

    Args:
        package: name of the package whose files declare.
        variable: name of the tuple of declarations in each file; files without it declare nothing.
        what: what is declared, for messages.
        group: sorts the declarations before their files' names do.
    """

    def __init__(self, package: str, variable: str, what: str, group: Callable[[D], Any]) -> None:
        self._package, self._variable, self._what, self._group = package, variable, what, group

    @cached_property
    def _by_id(self) -> dict[str, D]:
        names = sorted(module.name for module in iter_modules(import_module(self._package).__path__))
        modules = [import_module(f"{self._package}.{name}") for name in names]
        declared: list[D] = [one for module in modules for one in getattr(module, self._variable, ())]
        by_id = {one.id: one for one in sorted(declared, key=self._group)}
        if len(by_id) < len(declared):
            raise ValueError(f"two files of {self._package} declare the same id")
        return by_id

    def __getitem__(self, word: str) -> D:
        if word not in self._by_id:
            article = "an" if self._what[0] in "aeiou" else "a"
            raise unknown(
                self._what, word, f"the id of {article} {self._what}", self._by_id, "`foucault methods` lists them."
            )
        return self._by_id[word]

    def get(self, word: str, default: Any = None) -> Any:
        """Return a declaration, or the default where there is none of that id."""
        return self._by_id.get(word, default)

    def __contains__(self, word: object) -> bool:
        return word in self._by_id

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_id)

    def __len__(self) -> int:
        return len(self._by_id)

    def __repr__(self) -> str:
        return f"{len(self)} {self._what}s: {', '.join(self)}"
