"""The precision ladder: runs in double up to thousands of bits, which measure how much each further digit costs."""

from __future__ import annotations

import math
from collections.abc import Sequence

from reference import InputError, Scene
from reference.numbers.precision import DOUBLE_BITS

from ..methods import METHODS

SPAN_S = 600  # longer scenes are cut to this, unless an end is given: 512 bits take a thousand times as long as double
MOST_BITS = 4096
SPARE_DIGITS = 8  # digits of the truth beyond those of the finest run

Item = tuple[str, str, float]  # method, formulation, setting


def bits_of(text: str) -> list[int]:
    """Read a comma-separated list of precisions in bits.

    Raises:
        InputError: they are not whole numbers from 53 to 4096.
    """
    try:
        precisions = sorted({int(word) for word in text.split(",")})
    except ValueError:
        precisions = []
    if not precisions or precisions[0] < DOUBLE_BITS or precisions[-1] > MOST_BITS:
        raise InputError(
            "--precisions",
            text,
            f"bits from {DOUBLE_BITS} to {MOST_BITS}, such as 53,64,113,256,512",
            "Separate them by commas.",
        )
    return precisions


def precision_items(bits: Sequence[int], methods: Sequence[str] | None = None) -> list[Item]:
    """List the runs that methods declare for these precisions, those of the processor's number types first.

    Args:
        bits: the precisions, increasing.
        methods: ids; all if None.

    Raises:
        InputError: a method is unknown, or declares no run for these precisions.
    """
    runs = {name: METHODS[name].precision_runs(bits) for name in methods or METHODS}
    without = [name for name in methods or () if not runs[name]]
    if without:
        known = ", ".join(name for name, method in METHODS.items() if method.precision_runs(bits))
        raise InputError("--methods", ", ".join(without), "methods with these --precisions", f"These have: {known}.")
    in_turn = sorted(runs, key=lambda name: METHODS[name].setting == "precision")
    return [(name, *run) for name in in_turn for run in runs[name]]


def precision_scene(scene: Scene, bits: Sequence[int], whole: bool) -> tuple[Scene, int]:
    """Return the scene to measure on, and the digits that its truth needs.

    Args:
        scene: as requested.
        bits: the precisions, increasing.
        whole: whether to keep the scene's whole span.
    """
    digits = math.ceil(bits[-1] * math.log10(2)) + SPARE_DIGITS
    if whole or scene.exact.t_end <= SPAN_S:
        return scene, digits
    return scene.with_values([f"run.t_end={SPAN_S}"]), digits
