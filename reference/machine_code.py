"""Machine code that numba keeps on disk: a damaged file or a full disk costs time, never a result.

numba itself unpickles what it finds. Here every file ends with its hash, and says which function, for which types and
which processor, it holds: what was changed, cut short or put in another's place is compiled again.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba.core import caching, ccallback, dispatcher

from .first_use import announce

_HASH_BYTES = 32


class _CheckedFile(caching.IndexDataCacheFile):  # type: ignore[misc]  # numba has no types
    """The files of one function."""

    def save(self, key: Any, data: Any) -> None:
        super().save(key, (self._mark(key), data))

    def load(self, key: Any) -> Any:
        mark, data = super().load(key) or (None, None)
        return data if mark == self._mark(key) else None

    def _mark(self, key: Any) -> Any:
        return self._index_name, self._source_stamp, key

    def _dump(self, item: Any) -> bytes:
        data: bytes = super()._dump(item)
        return data + sha256(data).digest()  # reading ends before it

    def _load_index(self) -> dict[Any, str]:
        try:
            index: dict[Any, str] = super()._load_index()
        except Exception:  # a damaged pickle may raise anything
            return {}
        return index

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        if sha256(data[:-_HASH_BYTES]).digest() != data[-_HASH_BYTES:]:
            raise OSError("damaged")  # numba takes it for a missing file
        return super()._load_data(name)


class _Places(caching.CompileResultCacheImpl):  # type: ignore[misc]
    """Where the files may be; without a home, numba would make a folder named ~ in the working directory."""

    @property
    def _locator_classes(self) -> list[Any]:
        places = [caching.UserProvidedCacheLocator, caching.InTreeCacheLocator]
        return [*places, caching.UserWideCacheLocator] if Path(os.path.expanduser("~")).is_absolute() else places


class _CheckedCache(caching.FunctionCache):  # type: ignore[misc]
    """The cache of one function."""

    _impl_class = _Places

    def __init__(self, function: Any, what: str, seconds: int) -> None:
        super().__init__(function)
        self._what, self._seconds = what, seconds
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, types: Any, target: Any) -> Any:
        code = super().load_overload(types, target)
        if code is None:
            announce(self._what, self._seconds)
        return code

    def save_overload(self, types: Any, code: Any) -> None:
        with suppress(OSError):
            super().save_overload(types, code)


def _cache_of(function: Any, what: str, seconds: int) -> Any:
    try:
        return _CheckedCache(function, what, seconds)
    except (RuntimeError, OSError):  # there is no folder for it that can be written
        return caching.NullCache()


@contextmanager
def kept(what: str = "", seconds: int = 0) -> Iterator[None]:
    """Have functions that are declared meanwhile with `cache=True` use a checked cache.

    Args:
        what: what they are, in the plural, for the line that announces a long compilation; without it there is none.
        seconds: that it takes, about.
    """
    users: tuple[Any, Any] = (dispatcher, ccallback)
    for module in users:
        module.FunctionCache = partial(_cache_of, what=what, seconds=seconds)
    try:
        yield
    finally:
        for module in users:
            module.FunctionCache = caching.FunctionCache
