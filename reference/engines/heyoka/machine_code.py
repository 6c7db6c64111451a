"""heyoka's own cache of machine code on disk: a damaged one, or none for want of a home, costs time only."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import heyoka as hy

from ...precision import NumberType
from .log import watched_log


@contextmanager
def compiling(number: NumberType) -> Iterator[None]:
    """Compile meanwhile; what heyoka writes to stdout about its cache is not passed on.

    Beyond hardware numbers the cache never hits, and without a home heyoka has no place for it: it is switched off.
    """
    keep_on_disk(number)
    with watched_log():
        yield


def keep_on_disk(number: NumberType) -> None:
    """Have what is compiled from now on kept on disk, where that serves for numbers of this type."""
    hy.llvm_state.set_diskcache_enabled(number.hardware and bool(hy.llvm_state.get_diskcache_path()))
