"""Late imports: public names at first use, declarations of a folder, optional packages."""

from __future__ import annotations

import ast
import os
import sys
from collections import UserDict
from collections.abc import Callable, Iterable
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from pkgutil import get_data, iter_modules
from typing import Any, ClassVar, Protocol, TypeVar

from ..errors import InputError, NotInstalledError, no_attribute, unknown

_PACKAGES = {"flint": "python-flint"}  # that are not named as their modules
# a dependency that pip has for Linux only
_BY_CONDA = {"heyoka": "conda install -c conda-forge heyoka.py"}


def lazy(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package that imports names at first use.

    The names, and the modules that define them, are those that its stub, `__init__.pyi`, imports.
    """
    stub = get_data(package, "__init__.pyi")
    assert stub is not None
    imports = [node for node in ast.parse(stub).body if isinstance(node, ast.ImportFrom)]
    homes = {alias.name: node.module for node in imports for alias in node.names}

    def attribute(name: str) -> Any:
        if name in homes:
            return getattr(import_module(f".{homes[name]}", package), name)
        raise no_attribute(f"module {package!r}", name, homes)

    def names() -> list[str]:
        special = {name for name in vars(sys.modules[package]) if name.startswith("__")}
        return sorted({*homes, *special})

    return attribute, names, sorted(homes)


class Declaration(Protocol):
    """Anything with an id."""

    @property
    def id(self) -> str:
        """Its name on the command line."""


D = TypeVar("D", bound=Declaration)


class Registry(UserDict[str, D]):
    """Declarations by id, in the order of `group`, then of the files' names, then of the file.

    Args:
        package: name of the package whose files declare.
        variable: name of the tuple of declarations in each file; files without it declare nothing.
        what: what is declared, for messages.
        group: sorts the declarations before their files' names do.
    """

    def __init__(self, package: str, variable: str, what: str, group: Callable[[D], Any]) -> None:
        self._package = package
        self._variable = variable
        self._what = what
        self._group = group

    @cached_property
    def data(self) -> dict[str, D]:  # type: ignore[override]
        """The declarations, imported at first use."""
        folder = import_module(self._package).__path__
        declared: list[D] = []
        for name in sorted(module.name for module in iter_modules(folder)):
            module = import_module(f"{self._package}.{name}")
            declared += getattr(module, self._variable, ())
        by_id = {entry.id: entry for entry in sorted(declared, key=self._group)}
        if len(by_id) < len(declared):
            raise ValueError(f"two files of {self._package} declare the same id")
        return by_id

    def get(self, word: str, default: Any = None) -> Any:
        """Return a declaration, or the default where there is none of that id."""
        return self.data.get(word, default)

    def __missing__(self, word: str) -> D:
        article = "an" if self._what[0] in "aeiou" else "a"
        expected = f"the id of {article} {self._what}"
        raise unknown(self._what, word, expected, self.data, "`foucault methods` lists them.")

    def __repr__(self) -> str:
        return f"{len(self)} {self._what}s: {', '.join(self)}"


def missing(modules: Iterable[str]) -> list[str]:
    """Return the modules that are not installed."""
    return [name for name in modules if not _installed(name)]


def needed(module: str, extra: str, field: str, purpose: str, instead: str = "") -> None:
    """Refuse work for which a module is not installed, and say how to install it.

    Args:
        module: its name.
        extra: the extra that has it; "" for a dependency of the base install.
        field: what needs it.
        purpose: what it is needed for.
        instead: what else the user can do.

    Raises:
        InputError: it is not.
    """
    if missing([module]):
        package = _PACKAGES.get(module, module)
        raise NotInstalledError(field, purpose, package, install_command(module, extra), instead)


def install_command(module: str, extra: str) -> str:
    """Return the command that installs a module: by conda, or with its extra; "" if it has neither."""
    by_pip = f"pip install 'foucault-reference[{extra}]'" if extra else ""
    return _BY_CONDA.get(module, by_pip)


def switched_off(modules: Iterable[str]) -> str | None:
    """Return the environment variable that keeps one of the modules from compiling, or None."""
    variable = "NUMBA_DISABLE_JIT"
    is_set = os.environ.get(variable, "0") not in ("", "0")
    return variable if "numba" in modules and is_set else None


def _installed(module: str) -> bool:
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:  # its parent package is missing
        return False
    return spec is not None and spec.origin is not None  # a folder without code has no origin


class OptionalEngine:
    """An engine whose modules are installed by an extra.

    Attributes:
        name: its name on the command line and in datasets: that of its folder.
        requires: modules that must be installed.
        extra: the extra of `pip install 'foucault-reference[…]'` that installs them.
    """

    name: ClassVar[str]
    requires: ClassVar[tuple[str, ...]]
    extra: ClassVar[str]

    @property
    def installed(self) -> bool:
        """Whether the modules it requires are installed and allowed to compile."""
        return not missing(self.requires) and not switched_off(self.requires)

    def check_installed(self) -> None:
        """Raise InputError if it is not installed.

        Raises:
            InputError: it is not.
        """
        without = "The engine heyoka does without"
        variable = switched_off(self.requires)
        if variable:
            raise InputError(
                "--engine", self.name, f"{variable} not to be set", f"Unset it. {without}."
            )
        instead = f". {without}" if self.extra else ""
        for module in self.requires:
            needed(module, self.extra, "--engine", f"the engine {self.name}", instead)
