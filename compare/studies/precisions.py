"""The precision ladder: what each further digit costs, from double to hundreds of bits."""

from __future__ import annotations

import math
from collections.abc import Sequence

from reference import InputError, Scene
from reference.precision import DOUBLE_BITS, LONG_DOUBLE_BITS

from ..methods import METHODS

SPAN_S = 600  # a longer scene is cut to this, unless an end is given: 512 bits take a thousand times a double's time
MOST_BITS = 4096
SPARE_DIGITS = 8  # of the truth beyond the finest run's own
LIMBS = "limbs"

Item = tuple[str, str, float]


def bits_of(text: str) -> list[int]:
    """The precisions of a comma-separated list, in bits.

    Raises:
        InputError: not whole numbers from 53 on.
    """
    try:
        found = sorted({int(word) for word in text.split(",")})
    except ValueError:
        found = []
    if not found or found[0] < DOUBLE_BITS or found[-1] > MOST_BITS:
        raise InputError(
            "--precisions",
            text,
            f"bits from {DOUBLE_BITS} to {MOST_BITS}, such as 53,64,113,256,512",
            "Commas between.",
        )
    return found


def precision_items(bits: Sequence[int]) -> list[Item]:
    """What to measure: the machine's own types where they are named, MPFR beyond them, and limbs beside it."""
    items: list[Item] = []
    if DOUBLE_BITS in bits:
        items.append(("heyoka_double", "momentum", 2.0 ** (1 - DOUBLE_BITS)))
    if LONG_DOUBLE_BITS in bits:
        items.append(("heyoka_long_double", "momentum", 2.0 ** (1 - LONG_DOUBLE_BITS)))
    items += [("heyoka_real", "momentum", float(prec)) for prec in bits if prec > LONG_DOUBLE_BITS]
    return items + [(LIMBS, "momentum", setting) for setting in METHODS[LIMBS].ladder if setting <= bits[-1]]


def precision_scene(scene: Scene, bits: Sequence[int], whole: bool) -> tuple[Scene, int]:
    """The scene to measure on, and the digits of its truth.

    Args:
        scene: what was asked for.
        bits: the precisions.
        whole: keep the scene's span.
    """
    digits = math.ceil(bits[-1] * math.log10(2)) + SPARE_DIGITS
    if whole or scene.exact.t_end <= SPAN_S:
        return scene, digits
    return scene.with_values([f"run.t_end={SPAN_S}"]), digits
