"""heyoka's own cache of machine code on disk: a damaged one, or none for want of a home, costs time only."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import heyoka as hy

from ...numbers.precision import NumberType

FOLDER = "foucault"  # in heyoka's own: opening a cache takes the longer the more it holds, of whatever program
MOST_BYTES = 1 << 25


def keep_on_disk(number: NumberType) -> None:
    """Have what is compiled from now on kept on disk, where that serves for numbers of this type.

    Beyond hardware numbers the cache never hits, and without a home heyoka has no place for it: it is switched off.
    """
    hy.llvm_state.set_diskcache_enabled(number.hardware and _has_place())


@cache
def _has_place() -> bool:
    """Give the cache a folder of its own, of bounded size; return whether it can be used."""
    place = Path(hy.llvm_state.get_diskcache_path())
    if not place.is_absolute():
        return False
    try:
        hy.llvm_state.set_diskcache_path(place / FOLDER)
        hy.llvm_state.set_diskcache_limit(MOST_BYTES)
    except RuntimeError:  # it cannot be written, or is damaged
        return False
    return True
