"""Conventions of a file, put right one after the other: digits, heights, the unit of length and the axes, the clock.

Each stage changes the rows alone, and gives them back as a right program would write them. Axes that a program uses
from its release on are no matter of the rows: they stand among the `causes`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention
from .clock import clock, shifted, unit_of_time
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


def digits(positions: Array) -> tuple[float, list[Convention]]:
    """Return half a unit of the last digit printed, in the file's unit, and what is to be said of it."""
    values = positions[np.abs(positions) > 0]
    if not len(values):
        return 0.0, []
    size = float(np.abs(values).max())
    exact = 4 * np.finfo(float).eps * size
    if len(values) < 20:
        return exact, []
    for decimals in range(13):
        if (np.abs(np.round(values, decimals) - values) <= 1e-15 * np.abs(values)).all():
            noise = 0.5 * 10.0**-decimals
            if noise < 1e-12 * size:
                break
            text = f"prints {decimals} decimals: no more than {noise:g} of its unit can be judged"
            return noise, [Convention("decimals", text, noise)]
    single = values.astype(np.float32).astype(float)
    if (single == values).all():
        noise = size * float(np.finfo(np.float32).eps)
        text = f"holds numbers in single precision, good to {noise:.1g} of its unit"
        return noise, [Convention("single_precision", text, noise)]
    for digits in range(3, 13):
        rounded = _significant(values, digits)
        if (np.abs(rounded - values) <= 1e-15 * np.abs(values)).all():
            noise = 0.5 * 10.0 ** (math.floor(math.log10(size)) + 1 - digits)
            text = f"prints {digits} digits: no more than {noise:.1g} of its unit can be judged"
            return noise, [Convention("digits", text, noise)]
    return exact, []


def _significant(values: Array, digits: int) -> Array:
    return np.array([float(f"{value:.{digits - 1}e}") for value in values])


def made_right(
    times: Array, columns: dict[str, Array], release: Array, length: float, frequency: float, rename: bool = True
) -> Rows:
    """Return the rows in the scene's conventions.

    Args:
        times: as in the file.
        columns: x, y and perhaps z as in the file.
        release: x, y, z, vx, vy, vz of the exact release in m and m/s.
        length: of the cord in m.
        frequency: of the scene's swing in rad/s.
        rename: whether the horizontal axes may have each other's names, or point the other way.
    """
    names = [name for name in "xyz" if name in columns]
    positions = np.column_stack([columns[name] for name in names])
    noise, found = digits(positions)
    rows = Rows(times, positions, noise, tuple(found))
    rows = heights(rows, length)
    rows = axes(rows, release, length, rename)
    rows = clock(rows, release)
    rows = unit_of_time(rows, frequency)
    return rows if rows.starts else shifted(rows, release, frequency, length)
