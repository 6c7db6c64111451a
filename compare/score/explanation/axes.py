"""The unit of length of a file, and the names of its horizontal axes, by row 0 against the exact release."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention
from .rows import NEAR, Rows, is_release, largest

ROUGHLY = 0.03  # of the distance from the vertical: a release in another unit may be off by this
LENGTHS = (
    (100.0, "centimetres"), (1000.0, "millimetres"), (1e-3, "kilometres"), (1 / 0.3048, "feet"),
    (1 / 0.0254, "inches"),
)  # fmt: skip


def axes(rows: Rows, release: Array, length: float, rename: bool) -> Rows:
    """Find the unit of length and the names of the horizontal axes that make row 0 the release."""
    row = rows.positions[0]
    if is_release(row, release, rows.noise):
        return rows
    if not rows.starts or np.hypot(*row[:2]) == 0:
        return rows
    scales = [(1.0, "")] + [(scale, f"is in {unit}") for scale, unit in LENGTHS]
    scales += [(1 / length, "is in cord lengths (x/l)")]
    for scale, text in scales:
        for order, signs in itertools.product(((0, 1), (1, 0)), ((1, 1), (-1, 1), (1, -1), (-1, -1))):
            if not rename and (order, signs) != ((0, 1), (1, 1)):
                continue
            plane = rows.positions[:, order] / scale * np.array(signs)
            if not is_release(plane[0], release, rows.noise / scale):
                continue
            found = (
                [Convention("unit_of_length", text, largest(rows.positions / scale - rows.positions))] if text else []
            )
            if order != (0, 1) or signs != (1, 1):
                word, sentence = _renamed(order, signs)
                found.append(Convention(word, sentence, largest(plane - rows.positions[:, :2] / scale)))
            right = np.column_stack([plane, rows.positions[:, 2:] / scale])
            if scale != 1 and right.shape[1] == 3:
                right = _scaled_height(right, length)
            changed = (*rows.conventions, *found)
            return replace(rows, positions=right, noise=rows.noise / scale, conventions=changed)
    for scale, text in scales[1:]:
        near = np.abs(row[:2] / scale - release[:2]).max() < ROUGHLY * float(np.hypot(*release[:2]))
        if near:  # another unit, and a release that is a little off
            size = largest(rows.positions / scale - rows.positions)
            right = rows.positions / scale
            right = _scaled_height(right, length) if right.shape[1] == 3 else right
            changed = (*rows.conventions, Convention("unit_of_length", text, size))
            return replace(rows, positions=right, noise=rows.noise / scale, conventions=changed)
    angles = np.arcsin(np.clip(release[:2] / length, -1, 1))
    tilt = math.asin(min(1.0, float(np.hypot(*release[:2])) / length))
    for unit, size in (("degrees", 180 / math.pi), ("radians", 1.0)):
        polar = release[:2] / max(float(np.hypot(*release[:2])), 1e-300) * tilt
        for expected in (angles, polar):
            if np.abs(row[:2] / size - expected).max() <= NEAR * float(np.abs(expected).max()) + 2 * rows.noise / size:
                theta = rows.positions[:, :2] / size
                if expected is polar:
                    radius = np.hypot(theta[:, 0], theta[:, 1])
                    safe = np.where(radius > 0, radius, 1.0)
                    plane = length * theta * np.where(radius > 0, np.sin(radius) / safe, 1.0)[:, None]
                else:
                    plane = length * np.sin(theta)
                found = [
                    Convention("angles", f"gives x and y as angles of the cord in {unit}", float(np.abs(row).max()))
                ]
                noise = rows.noise / size * length
                return replace(rows, positions=plane, noise=noise, conventions=(*rows.conventions, *found))
    return replace(rows, starts=False)


def _renamed(order: tuple[int, int], signs: tuple[int, int]) -> tuple[str, str]:
    if order == (1, 0) and signs == (1, 1):
        return "xy_swapped", "writes north as x and east as y"
    if order == (0, 1):
        return {
            (-1, 1): ("x_west", "has x pointing west instead of east"),
            (1, -1): ("y_south", "has y pointing south instead of north"),
            (-1, -1): ("xy_reversed", "has x pointing west and y pointing south"),
        }[signs]
    words = {1: ("north", "east"), -1: ("south", "west")}
    # x of the scene is signs[0] times the file's y
    return "axes_turned", f"writes {words[signs[1]][0]} as x and {words[signs[0]][1]} as y"


def _scaled_height(positions: Array, length: float) -> Array:
    below = -np.sqrt(np.maximum(length**2 - positions[:, 0] ** 2 - positions[:, 1] ** 2, 0))
    near = np.abs(positions[:, 2] - below).max() < 1e-3 * length
    return positions if near else np.ascontiguousarray(positions[:, :2])
