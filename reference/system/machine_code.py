"""Machine code that numba keeps on disk: a damaged file or a full disk costs time, never a result.

numba itself unpickles what it finds. Here every file ends with its hash, and says which function, for which types and
which processor, it holds: what was changed, cut short or put in another's place is compiled again. Of several processes
one compiles a function; the others wait and take what it has kept.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba import njit
from numba.core import caching, ccallback, dispatcher

from .file_lock import Taken, locked
from .first_use import announce

PATIENCE_S = 120.0  # the longest wait for another process that compiles the same function
POLL_S = 0.05
_HASH_BYTES = 32
_turns: dict[Path, ExitStack] = {}  # functions that this process compiles; where that failed, until it is tried again


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

    def __init__(self, function: Any, what: str, seconds: int, sources: str) -> None:
        super().__init__(function)
        self._what, self._seconds, self._sources = what, seconds, sources
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, stamp)
        self._lock = Path(self._cache_path, f"{self._impl.filename_base}.lock")

    def _index_key(self, types: Any, code: Any) -> Any:
        return self._sources, *super()._index_key(types, code)

    def is_missing(self, types: Any, target: Any) -> bool:
        return self._index_key(types, target.codegen()) not in self._cache_file._load_index()

    def load_overload(self, types: Any, target: Any) -> Any:
        code = super().load_overload(types, target)
        if code is None:
            announce(self._what, self._seconds)
            self._begin_turn()
            code = super().load_overload(types, target)  # another process may have compiled it meanwhile
            if code is not None:
                self._end_turn()
        return code

    def save_overload(self, types: Any, code: Any) -> None:
        try:
            with suppress(OSError):
                super().save_overload(types, code)
        finally:
            self._end_turn()

    def _begin_turn(self) -> None:
        """Wait until no other process compiles this function, at most for `PATIENCE_S`: then it is compiled twice."""
        self._end_turn()
        turn, end = _turns.setdefault(self._lock, ExitStack()), time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            try:
                Path(self._cache_path).mkdir(parents=True, exist_ok=True)
                turn.enter_context(locked(self._lock))
            except Taken:
                time.sleep(POLL_S)
            except OSError:  # nothing can be kept there
                return
            else:
                turn.callback(self._lock.unlink, missing_ok=True)
                return

    def _end_turn(self) -> None:
        with suppress(OSError):
            _turns.pop(self._lock, ExitStack()).close()


def _cache_of(function: Any, what: str, seconds: int, sources: str) -> Any:
    try:
        return _CheckedCache(function, what, seconds, sources)
    except (RuntimeError, OSError):  # there is no folder for it that can be written
        return caching.NullCache()


@contextmanager
def kept(what: str = "", seconds: int = 0, sources: str = "") -> Iterator[None]:
    """Have functions that are declared meanwhile with `cache=True` use a checked cache.

    Args:
        what: what they are, in the plural, for the line that announces a long compilation; without it there is none.
        seconds: that it takes, about.
        sources: a hash of the other files that they are made of: numba looks at their own alone.
    """
    users: tuple[Any, Any] = (dispatcher, ccallback)
    for module in users:
        module.FunctionCache = partial(_cache_of, what=what, seconds=seconds, sources=sources)
    try:
        yield
    finally:
        for module in users:
            module.FunctionCache = caching.FunctionCache


def compiled_and_kept(function: Any) -> Any:
    """Compile a function with numba, quickly enough to say nothing, and keep its machine code."""
    with kept():
        return njit(cache=True)(function)


def missing(function: Any, types: Any) -> bool:
    """Return whether a function that was declared under `kept` could have its machine code on disk, but has not."""
    cache = function._cache
    return isinstance(cache, _CheckedCache) and cache.is_missing(types, function.targetctx)
