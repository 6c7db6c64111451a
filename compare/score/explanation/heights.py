"""The vertical of a file: z down, z from the lowest point, another axis, or no height of a bob on its cord."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention
from .rows import Rows

OFF = 1e-7  # of the cord: a distance from the suspension that changes by more is said
SLIGHT = 1e-9  # and by more than this, heights are left out
ALIKE = 0.05  # of the cord: heights nearer than this to a bob's are a bob's


def heights(rows: Rows, length: float) -> Rows:
    """Find the vertical: another column, upside down, from the lowest point; or no height of a sphere at all."""
    p = rows.positions
    if p.shape[1] < 3:
        return rows
    for scale, order, signs, shift in _vertical(length):
        column = (p[:, order[2]] / scale * signs[2]) - shift
        plane = p[:, order[:2]] / scale
        square = plane[:, 0] ** 2 + plane[:, 1] ** 2
        if (square >= length * length).any():
            continue
        on_sphere = -np.sqrt(length * length - square)
        if np.abs(column - on_sphere).max() > ALIKE * length:
            continue
        flat = float(np.ptp(column)) < 1e-3 * float(np.ptp(on_sphere))
        reach = np.sqrt(square + column * column)
        drift = float(np.ptp(reach))
        if scale == 1 and order == (0, 1, 2) and signs[2] == 1 and shift == 0:
            if flat or drift > max(20 * rows.noise, OFF * length):
                return _without_height(rows, flat, reach)
            if drift > max(20 * rows.noise, SLIGHT * length):  # no matter of its own, but no height to fit either
                return replace(rows, positions=np.ascontiguousarray(p[:, :2]))
            return rows
        text = {
            (1, 0.0): "", (-1, 0.0): "counts z downwards", (1, length): "counts z from the lowest point",
            (-1, -length): "counts z from the lowest point, downwards", (-1, length): "counts z downwards",
        }.get((signs[2], shift), "")  # fmt: skip
        word = "z_down" if signs[2] < 0 else "z_from_lowest"
        found = []
        if text:
            found.append(Convention(word, text, float(np.abs(column - p[:, order[2]] / scale).max())))
        if order != (0, 1, 2):
            vertical = "xyz"[order[2]]
            found.append(Convention("vertical_is_not_z", f"calls the vertical {vertical}", length))
        if flat or drift > max(20 * rows.noise, OFF * length):
            return _without_height(replace(rows, conventions=(*rows.conventions, *found)), flat, reach)
        if scale != 1:
            continue
        right = np.column_stack([plane, column])
        return replace(rows, positions=right, conventions=(*rows.conventions, *found))
    return _without_height(rows, False)


def _vertical(length: float) -> Iterator[tuple[float, tuple[int, int, int], tuple[int, int, int], float]]:
    for order in ((0, 1, 2), (0, 2, 1), (2, 0, 1), (1, 2, 0)):
        for sign, shift in ((1, 0.0), (-1, 0.0), (1, length), (-1, length)):
            yield 1.0, order, (1, 1, sign), shift


def _without_height(rows: Rows, flat: bool, reach: Array | None = None) -> Rows:
    """Leave the heights out of the explanation: they are not those of a bob on its cord."""
    found, cord = rows.conventions, None
    if flat:
        found = (*found, Convention("z_constant", "gives z a constant: its bob does not rise as it swings"))
    elif reach is not None:
        drift, cord = float(np.ptp(reach)), float(reach.mean())
        text = "does not keep |r| = l: a spring for a cord, or an integrator that leaves the sphere"
        found = (*found, Convention("off_the_sphere", text, drift))
    return replace(rows, positions=np.ascontiguousarray(rows.positions[:, :2]), conventions=found, cord=cord)
