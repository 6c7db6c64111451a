"""Sections as affine forms: a·n + b·n' - d, whose zeros are the moments that are sought; n = r/l, axes x, y, z.

xdot is the form with b along x. A gate lies along an azimuth and the plumb line at the pivot,
through the rest position, or along z through the suspension; its form grows to the left of the
azimuth. The highest points are where the velocity along the plumb line changes from up to down.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..errors import InputError, UnreachableError
from ..numbers.precision import to_mpf
from ..numbers.zeros import XDOT
from ..scenes.inputs import azimuth_of
from .algebra import cross, dot, scale
from .constants import Vector
from .start import Start

_NOTHING: Vector = (0, 0, 0)


class Form(NamedTuple):
    """The form a·n + b·n' - d, and the direction of the zeros that count: +1 where it grows, -1, or 0 for both."""

    a: Vector
    b: Vector
    d: Any
    direction: int = 0


def form_of(word: str, start: Start) -> Form:
    """Return the form whose zeros a word means, in the precision of a scene's start.

    Raises:
        InputError: a gate through the rest position, and the scene has none.
    """
    if word == XDOT:
        return Form(_NOTHING, (1, 0, 0), 0)
    ctx = start.ctx
    angle = to_mpf(azimuth_of(word) / 180, ctx)
    direction = (ctx.cospi(angle), ctx.sinpi(angle), 0)
    try:
        return form_along(word, direction, start.k.pull, lambda: start.rest)
    except UnreachableError:
        raise gate_without_rest(
            word, "so fast a rotation, or weightlessness, leaves none"
        ) from None


def gate_without_rest(word: str, reason: str) -> InputError:
    """Return the error of a gate through a rest position that does not exist, or is not known.

    `reason` says why.
    """
    expected = f"a section that needs no rest position: {reason}"
    advice = (
        f"Write {word}@0 for the plane through the suspension's vertical, or leave this gate out."
    )
    return InputError("run.sections", word, expected, advice)


def direction_of(word: str) -> int:
    """Return the direction of the zeros that count, as in `Form`."""
    return {"highest": -1, "lowest": 1}.get(word, 0)


def form_along(word: str, along: Vector, pull: Vector, rest: Callable[[], Vector]) -> Form:
    """Return the form of a section's word in any number type, from its direction, c and the rest position."""
    kind = word.split()[0]
    if kind == "turn":
        return Form(_NOTHING, along, 0)
    if kind != "gate":
        return Form(_NOTHING, scale(-1, pull), 0, direction_of(word))
    across = (-along[1], along[0], 0) if word.endswith("@0") else cross(along, pull)
    return Form(across, _NOTHING, 0 if word.endswith("@0") else dot(across, rest()))
