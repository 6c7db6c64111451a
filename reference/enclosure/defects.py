"""Defects computed in another process, as those of different steps do not depend on each other. Untrusted."""

from __future__ import annotations

from collections.abc import Sequence
from time import process_time
from typing import Any

from flint import arb, fmpz

from ..process import Parent
from .approximant import polynomials
from .bound import Piece, World
from .shapes import Sizes

Packed = list[tuple[int, int]]  # mantissa and exponent of each bound, as FLINT's numbers cannot be pickled


def compute_defects(parent: Parent, inputs: Any, prec: int) -> None:
    """Run in a child process: for each list of steps, send their packed sizes and the CPU seconds spent on them."""
    world = World(inputs, prec)
    before = process_time()
    for steps in parent:
        rows = [_packed(Piece(world, polynomials(step)).sizes()) for step in steps]
        now = process_time()
        parent((rows, now - before))
        before = now


def _packed(sizes: Sizes) -> Packed:
    return [(int(m), int(e)) for m, e in (x.man_exp() for x in sizes)]


def unpacked(rows: Sequence[Packed]) -> list[Sizes]:
    """Return the sizes that `compute_defects` sent."""
    return [Sizes(*(arb((fmpz(m), fmpz(e))) for m, e in row)) for row in rows]
