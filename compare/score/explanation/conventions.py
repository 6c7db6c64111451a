"""Conventions of a file: units, axes, clock and digits, from its numbers and from row 0 against the exact release.

Everything here is a change of the rows alone, which gives them back as a right program would write them. Axes that a
program uses from its release on are no matter of the rows: they stand among the `causes`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from reference.precision import Array

NEAR = 2e-5  # of the distance from the vertical: a row 0 nearer than this to the release is the release
LENGTHS = (
    (100.0, "centimetres"), (1000.0, "millimetres"), (1e-3, "kilometres"), (1 / 0.3048, "feet"),
    (1 / 0.0254, "inches"),
)  # fmt: skip
TIMES = ((60.0, "minutes"), (3600.0, "hours"), (1e-3, "milliseconds"), (86400.0, "days"))
SHIFTS = 3  # rows by which a clock may be off
PARTS = 4  # of a row: programs that write every second or fourth step are off by that


@dataclass(frozen=True)
class Convention:
    """A convention that the rows follow and the scene does not: a stable word and the end of "Your file …"."""

    id: str
    text: str
    size_m: float = 0.0


@dataclass(frozen=True)
class Rows:
    """The rows of a file, made right: times in s, positions in m (x, y and perhaps z), half a unit of its last digit.

    Attributes:
        times: increasing, in s, shape (rows,).
        positions: x, y and perhaps z in m, shape (rows, 2 or 3).
        noise: rounding of the numbers, in m.
        conventions: what was changed.
        starts: whether row 0 is the release.
    """

    times: Array
    positions: Array
    noise: float
    conventions: tuple[Convention, ...] = ()
    starts: bool = True


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
    noise, found = _digits(positions)
    rows = Rows(times, positions, noise, tuple(found))
    rows = _heights(rows, release, length)
    rows = _axes(rows, release, length, rename)
    rows = _clock(rows, release)
    rows = _unit_of_time(rows, frequency)
    return rows if rows.starts else _shifted(rows, release, frequency, length)


def _is_release(row: Array, release: Array, noise: float) -> bool:
    size = max(float(np.hypot(release[0], release[1])), 1e-6 * float(np.abs(release).max()))
    return bool(np.abs(row[:2] - release[:2]).max() <= NEAR * size + 2 * noise)


def _digits(positions: Array) -> tuple[float, list[Convention]]:
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
    exponents = np.floor(np.log10(np.abs(values))) + 1 - digits
    return np.array([float(f"{value:.{digits - 1}e}") for value in values]) if len(exponents) else values


def _heights(rows: Rows, release: Array, length: float) -> Rows:
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
        if np.abs(column - on_sphere).max() > 1e-3 * length:
            continue
        flat = float(np.ptp(column)) < 1e-3 * float(np.ptp(on_sphere))
        if scale == 1 and order == (0, 1, 2) and signs[2] == 1 and shift == 0:
            near = np.abs(column - on_sphere).max() <= max(20 * rows.noise, 0.1 * float(np.ptp(on_sphere)))
            return rows if near and not flat else _without_height(rows, flat)
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
        if flat:
            return _without_height(replace(rows, conventions=(*rows.conventions, *found)), flat)
        if scale != 1:
            continue
        right = np.column_stack([plane, column])
        return replace(rows, positions=right, conventions=(*rows.conventions, *found))
    return _without_height(rows, False)


def _vertical(length: float) -> Iterator[tuple[float, tuple[int, int, int], tuple[int, int, int], float]]:
    for order in ((0, 1, 2), (0, 2, 1), (2, 0, 1), (1, 2, 0)):
        for sign, shift in ((1, 0.0), (-1, 0.0), (1, length), (-1, length)):
            yield 1.0, order, (1, 1, sign), shift


def _without_height(rows: Rows, flat: bool) -> Rows:
    """Leave the heights out of the explanation: they are not those of a bob on its cord."""
    found = rows.conventions
    if flat:
        found = (*found, Convention("z_constant", "gives z a constant: its bob does not rise as it swings"))
    return replace(rows, positions=np.ascontiguousarray(rows.positions[:, :2]), conventions=found)


def _axes(rows: Rows, release: Array, length: float, rename: bool) -> Rows:
    """Find the unit of length and the names of the horizontal axes that make row 0 the release."""
    row = rows.positions[0]
    if _is_release(row, release, rows.noise):
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
            if not _is_release(plane[0], release, rows.noise / scale):
                continue
            found = [Convention("unit_of_length", text, _apart(rows.positions / scale, rows.positions))] if text else []
            if order != (0, 1) or signs != (1, 1):
                word, sentence = _renamed(order, signs)
                found.append(Convention(word, sentence, _apart(plane, rows.positions[:, :2] / scale)))
            right = np.column_stack([plane, rows.positions[:, 2:] / scale])
            if scale != 1 and right.shape[1] == 3:
                right = _scaled_height(right, length)
            changed = (*rows.conventions, *found)
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


def _apart(first: Array, second: Array) -> float:
    return float(np.linalg.norm(first - second, axis=1).max())


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


def _clock(rows: Rows, release: Array) -> Rows:
    """Find rows in reverse order, and a clock that does not start at 0."""
    first, last = (_is_release(rows.positions[i], release, rows.noise) for i in (0, -1))
    if last and not first and len(rows.times) > 2:
        times = rows.times[-1] - rows.times[::-1]
        found = Convention("rows_reversed", "has its rows in reverse order: the release stands last")
        right = rows.positions[::-1].copy()
        found = replace(found, size_m=_apart(right, rows.positions))
        return replace(rows, times=times, positions=right, conventions=(*rows.conventions, found), starts=True)
    if first and rows.times[0] > 0:
        text = f"starts its clock at {rows.times[0]:.10g} s and not at 0"
        found = Convention("clock_offset", text, float(np.hypot(*release[:2])))
        return replace(rows, times=rows.times - rows.times[0], conventions=(*rows.conventions, found), starts=True)
    return rows


def _unit_of_time(rows: Rows, frequency: float) -> Rows:
    """Find the unit of time by the frequency of the swing."""
    from .phasors import fit_phasors

    if not frequency or len(rows.times) < 12:
        return rows
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    some = slice(0, min(len(plane), 400))
    size = float(np.abs(plane).max())
    own = fit_phasors(rows.times[some], plane[some], frequency)
    if own is not None and own[1] < 0.05 * size and 0.5 < abs(own[0].square) ** 0.5 / frequency < 2:
        return rows
    for scale, unit in TIMES:
        found = fit_phasors(rows.times[some] * scale, plane[some], frequency)
        if found is None or found[1] > 0.05 * size:
            continue
        if abs(abs(found[0].square) ** 0.5 / frequency - 1) < 0.1:
            convention = Convention("unit_of_time", f"counts time in {unit}", size)
            return replace(rows, times=rows.times * scale, conventions=(*rows.conventions, convention))
    return rows


def _shifted(rows: Rows, release: Array, frequency: float, length: float) -> Rows:
    """Find a clock that is off, the rows in order or reversed: the fitted motion passes the release some rows away."""
    from .phasors import as_angles, fit_phasors

    if not frequency or len(rows.times) < 12:
        return rows
    goal = as_angles(np.array([complex(release[0], release[1])]), length)[0]
    moving = complex(release[3], release[4])
    span, spacing = float(rows.times[-1]), float(np.median(np.diff(rows.times)))
    found: list[tuple[float, int, bool]] = []
    for backwards in (False, True):
        positions = rows.positions[::-1] if backwards else rows.positions
        times = span - rows.times[::-1] if backwards else rows.times
        fitted = fit_phasors(times, as_angles(positions[:, :2] @ np.array([1, 1j]), length), frequency)
        if fitted is None or fitted[1] > 1e-2 * abs(goal):
            continue
        phasors = fitted[0]
        for many in range(-SHIFTS * PARTS, SHIFTS * PARTS + 1):
            at = phasors.later(many * spacing / PARTS)
            off = abs(at.start - goal) + abs(at.speed - moving) / frequency
            found.append((float(off), many, backwards))
    found.sort(key=lambda one: one[0] + 1e-9 * abs(goal) * abs(one[1]))
    if not found or found[0][0] > 2e-2 * abs(goal):
        return rows
    _, many, backwards = found[0]
    shift = many * spacing / PARTS
    conventions = list(rows.conventions)
    positions, times = rows.positions, rows.times
    if backwards:
        positions, times = positions[::-1].copy(), span - times[::-1]
        size = _apart(positions, rows.positions)
        conventions.append(Convention("rows_reversed", "has its rows in reverse order: the release stands last", size))
    if many:
        count = "one row" if abs(many) == PARTS else f"{Fraction(abs(many), PARTS)} rows"
        word = "late" if many < 0 else "early"
        text = f"has its clock {'ahead of' if many > 0 else 'behind'} its rows by {count} ({abs(shift):.6g} s)"
        size = abs(goal) * min(2.0, frequency * abs(shift))
        conventions.append(Convention(f"rows_{word}", text, float(size)))
    times = times - shift
    kept = times >= 0
    return replace(rows, times=times[kept], positions=positions[kept], conventions=tuple(conventions), starts=True)
