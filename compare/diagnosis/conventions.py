"""Conventions of a file, put right one after the other: digits, heights, the unit of length and the axes, the clock.

Each stage changes the rows alone, and gives them back as a right program would write them. Axes that a program uses
from its release on are no matter of the rows: they stand among the `causes`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..candidates.names import LENGTHS, LONG_NAMES, TIMES
from .case import FileRows, largest
from .phasors import as_angles, fit_phasors, sinc

# of the distance from the vertical: a row 0 nearer than this to the release is the release
NEAR = 2e-5
FLAT = "gives z a constant: its bob does not rise as it swings"
SPRING = "does not keep |r| = l: a spring for a cord, or an integrator that leaves the sphere"
OFF = 1e-7  # of the cord: a distance from the suspension that changes by more is reported
SLIGHT = 1e-9  # and by more than this, heights are left out
ALIKE = 0.05  # of the cord: heights nearer than this to a bob's are a bob's
ROUGHLY = 0.03  # of the distance from the vertical: a release in another unit may be off by this
SINGLE = 1e-6  # of the span: rounding of times in single precision
SHIFTS = 3  # rows by which a clock may be off
DECAYS = 0.1  # of its frequency: a swing that decays, or grows, faster tells no unit of time
LENGTHS_SAID = {unit: f"is in {LONG_NAMES[unit]}" for unit in ("cm", "mm", "km", "ft", "in")}
TIMES_SAID = {unit: f"counts time in {LONG_NAMES[unit]}" for unit in ("min", "h", "ms", "d")}
# order and signs by which a file's horizontal columns become the scene's: x of the scene first
AXES_SAID = {
    ((0, 1), (1, 1)): ("", ""),
    ((0, 1), (-1, 1)): ("x_west", "has x pointing west instead of east"),
    ((0, 1), (1, -1)): ("y_south", "has y pointing south instead of north"),
    ((0, 1), (-1, -1)): ("xy_reversed", "has x pointing west and y pointing south"),
    ((1, 0), (1, 1)): ("xy_swapped", "writes north as x and east as y"),
    ((1, 0), (-1, 1)): ("axes_turned", "writes north as x and west as y"),
    ((1, 0), (1, -1)): ("axes_turned", "writes south as x and east as y"),
    ((1, 0), (-1, -1)): ("axes_turned", "writes south as x and west as y"),
}
PARTS = 4  # of a row: programs that write every second or fourth step are off by that


def is_release(row: Array, release: Array, noise: float) -> bool:
    """Return whether a row is the release but for its rounding."""
    size = max(float(np.hypot(release[0], release[1])), 1e-6 * float(np.abs(release).max()))
    return bool(np.abs(row[:2] - release[:2]).max() <= NEAR * size + 2 * noise)


def digits(rows: FileRows) -> FileRows:
    """Find the rounding of the rows: half a unit of the last digit printed, in the file's unit."""
    values = rows.positions[np.abs(rows.positions) > 0]
    if not len(values):
        return rows
    size = float(np.abs(values).max())
    exact = FileRows(rows.times, rows.positions, 4 * np.finfo(float).eps * size)
    if len(values) < 20:
        return exact

    def same(rounded: Array) -> bool:
        return bool((np.abs(rounded - values) <= 1e-15 * np.abs(values)).all())

    single = values.astype(np.float32).astype(float)
    in_single, single_noise = same(single), size * float(np.finfo(np.float32).eps)
    # printed with nine digits, as C does; those of a large swing have as few decimals as a file in double
    in_single = in_single or same(np.array([float(f"{value:.8e}") for value in single]))
    for decimals in range(13):
        if same(np.round(values, decimals)):
            noise = 0.5 * 10.0**-decimals
            if noise < (single_noise if in_single else 1e-12 * size):
                break
            text = f"prints {decimals} decimals: no more than {noise:g} of its unit can be judged"
            return rows.changed(Deviation("decimals", text, noise), noise=noise)
    if in_single:
        text = f"holds numbers in single precision, good to {single_noise:.1g} of its unit"
        return rows.changed(Deviation("single_precision", text, single_noise), noise=single_noise)
    for count in range(3, 13):
        if same(np.array([float(f"{value:.{count - 1}e}") for value in values])):
            noise = 0.5 * 10.0 ** (math.floor(math.log10(size)) + 1 - count)
            text = f"prints {count} digits: no more than {noise:.1g} of its unit can be judged"
            return rows.changed(Deviation("digits", text, noise), noise=noise)
    return exact


def heights(rows: FileRows, length: float) -> FileRows:
    """Find the vertical: another column, upside down, from the lowest point; or no height of a sphere at all."""
    if rows.positions.shape[1] < 3:
        return rows
    offset = _offset_of_heights(rows, length)
    if offset:
        text = f"has z {abs(offset):.6g} m too {'high' if offset > 0 else 'low'} in every row"
        moved = rows.positions - [0.0, 0.0, offset]
        rows = rows.changed(Deviation("z_offset", text, abs(offset)), positions=moved)
    orders = ((0, 1, 2), (0, 2, 1), (2, 0, 1), (1, 2, 0))
    down = "counts z downwards"
    ways = (
        (1, 0.0, ""),
        (-1, 0.0, down),
        (1, length, "counts z from the lowest point"),
        (-1, length, down),
    )
    for order, (sign, shift, text) in itertools.product(orders, ways):
        plane, printed = rows.positions[:, order[:2]], rows.positions[:, order[2]]
        column = printed * sign - shift
        square = plane[:, 0] ** 2 + plane[:, 1] ** 2
        if (square >= length * length).any():
            continue
        on_sphere = -np.sqrt(length * length - square)
        if np.abs(column - on_sphere).max() > ALIKE * length:
            continue
        right = rows
        if text:
            word = "z_down" if sign < 0 else "z_from_lowest"
            right = right.changed(Deviation(word, text, float(np.abs(column - printed).max())))
        if order != (0, 1, 2):
            right = right.changed(
                Deviation("vertical_is_not_z", f"calls the vertical {'xyz'[order[2]]}", length)
            )
        reach = np.sqrt(square + column * column)
        drift = float(np.ptp(reach))
        if float(np.ptp(column)) < 1e-3 * float(np.ptp(on_sphere)):
            return _flat(rows.changed(Deviation("z_constant", FLAT)))
        if drift > max(20 * rows.noise, OFF * length):
            return _flat(
                right.changed(Deviation("off_the_sphere", SPRING, drift), cord=float(reach.mean()))
            )
        if right is not rows:
            return replace(right, positions=np.column_stack([plane, column]))
        # a slight drift is no matter of its own, but no height to fit either
        return (
            _flat(rows) if drift > max(20 * rows.noise, SLIGHT * length) or rows.relative else rows
        )
    return _flat(rows)


def _offset_of_heights(rows: FileRows, length: float) -> float:
    """Return by how much z is too high in every row, in m; 0 if it is not, or counted from the lowest point.

    It is 0 as well where the rows keep a distance from the suspension: then their cord may have another length.
    """
    x, y, z = rows.positions.T
    square = x * x + y * y
    if (square >= length * length).any():
        return 0.0
    above = z + np.sqrt(length * length - square)
    offset = float(np.median(above))
    same = max(20 * rows.noise, OFF * length)
    reach = np.sqrt(square + z * z)
    if np.ptp(above) > same or np.ptp(reach) <= same or abs(offset - length) <= same:
        return 0.0
    return offset


def _flat(rows: FileRows) -> FileRows:
    """Leave the heights out of the explanation."""
    plane = np.ascontiguousarray(rows.plane)
    finer = float(np.abs(plane).max() / np.abs(rows.positions).max()) if rows.relative else 1.0
    return replace(rows, positions=plane, noise=rows.noise * finer)


def axes(rows: FileRows, release: Array, length: float, rename: bool) -> FileRows:
    """Find the unit of length and the names of the horizontal axes that make row 0 the release."""
    first, last = rows.positions[[0, -1]]
    released = any(is_release(row, release, rows.noise) for row in (first, last))
    if released or not rows.starts or np.hypot(*first[:2]) == 0:
        return rows
    units = [(1.0, ""), *((1 / float(LENGTHS[unit]), text) for unit, text in LENGTHS_SAID.items())]
    units += [
        (float(LENGTHS[unit]), f"counts metres as {LONG_NAMES[unit]}") for unit in ("cm", "mm")
    ]
    units += [(1 / length, "is in cord lengths (x/l)")]
    ways = [*AXES_SAID]
    for row, (scale, text), (order, signs) in itertools.product(
        (first, last), units, ways if rename else ways[:1]
    ):
        if is_release(row[[*order]] / scale * np.array(signs), release, rows.noise / scale):
            return _renamed(_in_metres(rows, scale, text, length), order, signs)
    # another unit or other axes, and a release that is a little off; of a cord of a metre the release alone may be
    near = [(unit, ways[0]) for unit in units if abs(unit[0] - 1) >= 3 * ROUGHLY]
    # else its axes may be right
    if np.abs(first[:2] - release[:2]).max() >= ROUGHLY * np.hypot(*release[:2]):
        near += [(units[0], way) for way in ways[1:] if rename]
    for (scale, text), (order, signs) in near:
        if np.abs(
            first[[*order]] / scale * np.array(signs) - release[:2]
        ).max() < ROUGHLY * np.hypot(*release[:2]):
            return _renamed(_in_metres(rows, scale, text, length), order, signs)
    angles = np.arcsin(np.clip(release[:2] / length, -1, 1))
    tilt = math.asin(min(1.0, float(np.hypot(*release[:2])) / length))
    polar = release[:2] / max(float(np.hypot(*release[:2])), 1e-300) * tilt
    for (unit, size), expected in itertools.product(
        (("degrees", 180 / math.pi), ("radians", 1.0)), (angles, polar)
    ):
        if (
            np.abs(first[:2] / size - expected).max()
            <= NEAR * float(np.abs(expected).max()) + 2 * rows.noise / size
        ):
            theta = rows.plane / size
            plane = length * np.sin(theta)
            if expected is polar:
                plane = length * theta * sinc(np.hypot(theta[:, 0], theta[:, 1]))[:, None]
            text = f"gives x and y as angles of the cord in {unit}"
            convention = Deviation("angles", text, float(np.abs(first).max()))
            return rows.changed(convention, positions=plane, noise=rows.noise / size * length)
    return replace(rows, starts=False)


def _in_metres(rows: FileRows, scale: float, text: str, length: float) -> FileRows:
    """Return the rows over a scale, with what is said of it; as they are where nothing is.

    Heights are left out where they are not those of the cord then.
    """
    if not text:
        return rows
    p = rows.positions / scale
    # whether it keeps the cord was judged in the wrong unit
    kept = tuple(convention for convention in rows.conventions if convention.id != "off_the_sphere")
    rows = replace(rows, conventions=kept)
    convention = Deviation("unit_of_length", text, largest(p - rows.positions))
    made = rows.changed(convention, positions=p, noise=rows.noise / scale)
    if p.shape[1] < 3:
        return made
    below = -np.sqrt(np.maximum(length**2 - p[:, 0] ** 2 - p[:, 1] ** 2, 0))
    return made if np.abs(p[:, 2] - below).max() < 1e-3 * length else _flat(made)


def _renamed(rows: FileRows, order: tuple[int, int], signs: tuple[int, int]) -> FileRows:
    """Return the rows with the horizontal axes in another order and with other signs, and what is said of that."""
    word, text = AXES_SAID[order, signs]
    if not text:
        return rows
    plane = rows.positions[:, order] * np.array(signs)
    convention = Deviation(word, text, largest(plane - rows.plane))
    return rows.changed(convention, positions=np.column_stack([plane, rows.positions[:, 2:]]))


def clock(rows: FileRows, release: Array) -> FileRows:
    """Find rows in reverse order, and a clock that does not start at 0."""
    first, last = (is_release(rows.positions[i], release, rows.noise) for i in (0, -1))
    if last and not first and len(rows.times) > 2:
        return replace(_reversed(rows), starts=True)
    return _from_zero(rows, release) if first and 0 < rows.times[0] < rows.times[-1] else rows


def _from_zero(rows: FileRows, release: Array) -> FileRows:
    """Return the rows with a clock that starts at 0, and what is said of that."""
    text = f"starts its clock at {rows.times[0]:.10g} s and not at 0"
    convention = Deviation("clock_offset", text, float(np.hypot(*release[:2])))
    return rows.changed(convention, times=rows.times - rows.times[0], starts=True)


def other_conventions(rows: FileRows, release: Array) -> Iterator[FileRows]:
    """Yield rows that were made right as those of other conventions between which row 0 does not decide."""
    if 0 < rows.times[0] < rows.times[-1]:  # a clock that starts late, and a release that is off
        yield _from_zero(rows, release)
    if abs(abs(release[0]) - abs(release[1])) <= NEAR * abs(release[0]):
        yield _renamed(rows, (1, 0), (1, 1) if release[0] * release[1] > 0 else (-1, -1))


def _reversed(rows: FileRows) -> FileRows:
    """Return the rows in reverse order, their clock turned round as well, and what is said of that."""
    positions = rows.positions[::-1].copy()
    text = "has its rows in reverse order: the release stands last"
    convention = Deviation("rows_reversed", text, largest(positions - rows.positions))
    return rows.changed(convention, times=rows.times[-1] - rows.times[::-1], positions=positions)


def unit_of_time(rows: FileRows, frequency: float, length: float) -> FileRows:
    """Find the unit of time by the frequency of the swing."""
    if not frequency or len(rows.times) < 12:
        return rows
    plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
    plane = as_angles(plane, length) if np.abs(plane).max() < length else plane
    some = slice(0, min(len(plane), 400))
    size = float(np.abs(plane).max())

    def ratio(scale: float) -> float | None:
        """Return the frequency of the rows over the scene's, their times multiplied by a scale."""
        fitted = fit_phasors(rows.times[some] * scale, plane[some], frequency)
        rate = 0.0 if fitted is None or fitted[1] > 0.05 * size else abs(fitted[0].square) ** 0.5
        # a part of a wide swing in another unit looks like one that dies away, or grows, within it
        return (
            rate / frequency if fitted is not None and abs(fitted[0].drag) < DECAYS * rate else None
        )

    as_printed = ratio(1.0)
    if as_printed is not None and 0.5 < as_printed < 2:
        return rows
    spacing, span = float(np.median(np.diff(rows.times))), float(rows.times[-1] - rows.times[0])
    for unit, text in TIMES_SAID.items():
        scale = float(TIMES[unit])
        if not spacing * scale * frequency < math.pi < span * scale * frequency:
            # farther apart, rows of any frequency look like those of another; closer, they show none
            continue
        scaled = ratio(scale)
        if scaled is not None and abs(scaled - 1) < 0.1:
            return rows.changed(Deviation("unit_of_time", text, size), times=rows.times * scale)
    return rows


def rounded_clock(rows: FileRows, frequency: float) -> FileRows:
    """Undo the rounding of times to single precision, or add to the noise how far the bob moves meanwhile."""
    even = np.linspace(rows.times[0], rows.times[-1], len(rows.times))
    late = float(np.abs(rows.times - even).max())
    single = any(convention.id == "single_precision" for convention in rows.conventions)
    if not single or late > SINGLE * rows.times[-1]:  # else they are not evenly spaced
        return rows
    exact = float(f"{even[1] - even[0]:.6g}") * np.arange(len(even)) + even[0]
    if (exact.astype(np.float32) == rows.times.astype(np.float32)).all():
        return replace(rows, times=exact)
    return replace(rows, noise=rows.noise + late * frequency * float(np.abs(rows.plane).max()))


def shifted(rows: FileRows, release: Array, frequency: float, length: float) -> FileRows:
    """Find a clock that is off, the rows in order or reversed: the fitted motion passes the release some rows away."""
    if not frequency or len(rows.times) < 12:
        return rows
    goal = as_angles(np.array([complex(release[0], release[1])]), length)[0]
    moving = complex(release[3], release[4])
    spacing = float(np.median(np.diff(rows.times)))
    passed: list[tuple[float, int, FileRows]] = []
    for ordered in (rows, _reversed(rows)):
        plane = as_angles(ordered.plane @ np.array([1, 1j]), length)
        fitted = fit_phasors(ordered.times, plane, frequency)
        if fitted is None or fitted[1] > 1e-2 * abs(goal):
            continue
        for parts in range(-SHIFTS * PARTS, SHIFTS * PARTS + 1):
            at = fitted[0].later(parts * spacing / PARTS)
            off = abs(at.start - goal) + abs(at.speed - moving) / frequency
            passed.append((float(off), parts, ordered))
    passed.sort(key=lambda passage: passage[0] + 1e-9 * abs(goal) * abs(passage[1]))
    if not passed or passed[0][0] > 2e-2 * abs(goal):
        return rows
    _, parts, right = passed[0]
    shift = parts * spacing / PARTS
    if parts:
        count = "one row" if abs(parts) == PARTS else f"{Fraction(abs(parts), PARTS)} rows"
        text = f"has its clock {'ahead of' if parts > 0 else 'behind'} its rows by {count} ({abs(shift):.6g} s)"
        size = abs(goal) * min(2.0, frequency * abs(shift))
        right = right.changed(
            Deviation(f"rows_{'late' if parts < 0 else 'early'}", text, float(size))
        )
    times = right.times - shift
    kept = times >= 0
    return replace(right, times=times[kept], positions=right.positions[kept], starts=True)
