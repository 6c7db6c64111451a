"""Conventions of a file, corrected in turn: digits, heights, unit of length and axes, clock.

Each function returns the rows as a right program would write them, with what was corrected.
Axes that a program itself computes with, from its release on, belong to the `causes`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..candidates.names import LENGTHS, LONG_NAMES, TIMES
from .case import FileRows, largest, rms
from .phasors import ComplexArray, as_angles, fit_phasors, sinc
from .thresholds import NEEDED

# x, y, z, vx, vy, vz of a right program in m and m/s at times in s from the release on, shape (times, 6)
Truth = Callable[[Array], Array]

# of the distance from the vertical: a row 0 nearer than this to the release is the release
_NEAR = 2e-5
_FLAT = "gives z a constant: its bob does not rise as it swings"
_OFF_THE_SPHERE = (
    "does not keep |r| = l: one of its columns is wrong, its cord is a spring, "
    "or its integrator leaves the sphere"
)
_DOWN = "counts z downwards"
_WRONG_Z = "prints a z that is not the height of a bob at its x and y"
_OFF = 1e-7  # of the cord: a larger change of the distance from the suspension is reported
_SLIGHT = 1e-9  # of the cord: with a larger change than this, heights are ignored
_NO_RISE = 1e-3  # of the bob's: heights that differ by less are constant
_ALIKE = 0.05  # of the cord: how near a column has to be to the bob's heights
_SAME_RISE = 0.1  # of the bob's rise: how near the rise of another column, or of another count, has to be to it
ROUGHLY = 0.03  # of the distance from the vertical: how far a release in another unit may be off
_SINGLE = 1e-6  # of the span: rounding of times in single precision
# of the release's distance: largest residual of phasors that show when a clock began
_ROUGH_FIT = 1e-2
_SHIFTS = 3  # rows by which a clock may be off
_SWINGS = 20  # by which it may start too late
_NEWTON = 4  # steps that fit a shift of the clock
_SHORTEST = 12  # rows that show a frequency
_FIRST = 400  # rows that are used for it
_UNFIT = 0.05  # of the distance from the vertical: the largest residual of two phasors
_SAME_FREQUENCY = 0.1  # relative difference from the scene's, in the right unit of time
_DECAYS = 0.1  # of its frequency: a swing that decays or grows faster shows no unit of time
_UNITS_OF_LENGTH = ("cm", "mm", "km", "ft", "in")
LENGTHS_SAID = {unit: f"is in {LONG_NAMES[unit]}" for unit in _UNITS_OF_LENGTH}
_UNITS_OF_TIME = ("min", "h", "ms", "d")
TIMES_SAID = {unit: f"counts time in {LONG_NAMES[unit]}" for unit in _UNITS_OF_TIME}
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
_FEW = 20  # numbers that show no rounding
_MOST = 13  # decimals or digits: numbers with as many are not rounded
_SHOWN = 8  # different numbers, none of which ends in a zero by accident
# units of the last decimal: numbers that are all farther apart are not rounded to it
_FAR_APART = 10
_PARTS = 4  # of a row: programs that write every second or fourth step are off by such parts
# rows and parts of a row by which a clock is off, in words
_ROWS_SAID = {
    (1, 0): "one row",
    (0, 1): "a quarter of a row",
    (0, 2): "half a row",
    (0, 3): "three quarters of a row",
}
# order of a file's columns by which its third becomes the vertical
_VERTICALS = ((0, 1, 2), (0, 2, 1), (2, 0, 1), (1, 2, 0))
_CORD_LENGTHS = "cord lengths"  # which are angles in radians, roughly
_Axes = tuple[tuple[int, int], tuple[int, int]]
_AS_IN_SCENE: _Axes = ((0, 1), (1, 1))


def _is_release(row: Array, release: Array, noise: float) -> bool:
    """Return whether a row is the release but for its rounding."""
    distance = float(np.hypot(release[0], release[1]))
    size = max(distance, 1e-6 * float(np.abs(release).max()))
    off = np.abs(row[:2] - release[:2]).max()
    return bool(off <= _NEAR * size + 2 * noise)


@dataclass(frozen=True)
class _Rounding:
    """The rounding of some numbers.

    Attributes:
        noise: half a unit of the last digit of the largest of them, in their unit.
        convention: what is reported; None for double precision.
    """

    noise: float
    convention: Deviation | None = None


def digits(rows: FileRows) -> FileRows:
    """Find the rounding of the rows: half a unit of the last digit printed, in the file's unit."""
    of_plane = _rounding_of_plane(rows.plane)
    roundings = [_rounding(rows.positions), of_plane]
    if rows.positions.shape[1] > 2:
        roundings += _rounding_of_heights(rows.positions[:, 2])
    rounding = max(roundings, key=lambda each: each.noise)
    if rounding.convention is None:
        return replace(rows, noise=rounding.noise, plane_noise=rounding.noise)
    return rows.changed(rounding.convention, noise=rounding.noise, plane_noise=of_plane.noise)


def _rounding(columns: Array) -> _Rounding:
    """Return the rounding of the numbers of some columns."""
    values = columns[np.abs(columns) > 0]
    if not len(values):
        return _Rounding(0.0)
    if len(values) < _FEW:
        return _exact(values)
    decimals = _count_of_decimals(values)
    digit_count = _count_of_digits(values)
    if decimals is not None and _are_decimals(values, decimals, digit_count):
        rounding = _few_decimals(values, decimals)
        if rounding is not None:
            return rounding
    return _single_precision(values) or _few_digits(values, digit_count) or _exact(values)


def _rounding_of_plane(plane: Array) -> _Rounding:
    """Return the rounding of x and y, that of the coarser one if they differ; a constant shows none."""
    varied = [column for column in plane.T if len(np.unique(column)) >= _SHOWN]
    return max(map(_rounding, varied or [plane]), key=lambda each: each.noise)


def _rounding_of_heights(values: Array) -> Iterator[_Rounding]:
    """Yield the rounding of a column that may have fewer decimals than the others, if it shows one.

    Few different numbers show it, since a bob rises little.
    """
    different = np.unique(values)
    if len(different) < 2:
        return
    single = _single_precision(values)
    decimals = _count_of_decimals(values)
    if single is not None:
        yield single
    if single is not None or decimals is None:
        return
    unit = 10.0**-decimals
    if np.diff(different).min() > _FAR_APART * unit:
        return
    noise = unit / 2
    text = (
        f"prints {decimals} decimals of z: nothing finer than {noise:g} of its unit can be judged"
    )
    yield _Rounding(noise, Deviation("decimals_of_z", text, noise))


def _exact(values: Array) -> _Rounding:
    """Return the rounding of double precision."""
    return _Rounding(4 * np.finfo(float).eps * float(np.abs(values).max()))


def _count_of_decimals(values: Array) -> int | None:
    """Return the largest number of decimals; None if there are too many to be a rounding."""
    return next((n for n in range(_MOST) if _same(np.round(values, n), values)), None)


def _count_of_digits(values: Array) -> int | None:
    """Return the largest number of significant digits; None if there are too many to be a rounding."""
    some = values[:_FEW]
    for count in range(3, _MOST):
        if _same(_with_digits(some, count), some) and _same(_with_digits(values, count), values):
            return count
    return None


def _are_decimals(values: Array, decimals: int, digit_count: int | None) -> bool:
    """Return whether numbers are rounded to decimals, and not to significant digits.

    `%g` prints small numbers with many decimals and large ones with few.
    """
    if digit_count is None:
        return True
    large = values[np.abs(values) >= 10.0 ** (digit_count - decimals)]
    return len(np.unique(large)) < _SHOWN


def _few_decimals(values: Array, decimals: int) -> _Rounding | None:
    """Return the rounding to decimals; None if the precision of the numbers is no better."""
    least_noise = 1e-12 * float(np.abs(values).max())
    if _in_single_precision(values):
        least_noise = _single_noise(values)
    noise = 0.5 * 10.0**-decimals
    if noise < least_noise:
        return None
    text = f"prints {decimals} decimals: nothing finer than {noise:g} of its unit can be judged"
    return _Rounding(noise, Deviation("decimals", text, noise))


def _single_precision(values: Array) -> _Rounding | None:
    """Return the rounding of single precision; None if the numbers are not in it."""
    if not _in_single_precision(values):
        return None
    noise = _single_noise(values)
    text = f"holds numbers in single precision, good to {noise:.1g} of its unit"
    return _Rounding(noise, Deviation("single_precision", text, noise))


def _few_digits(values: Array, digit_count: int | None) -> _Rounding | None:
    """Return the rounding to some significant digits; None for many."""
    if digit_count is None:
        return None
    size = float(np.abs(values).max())
    noise = 0.5 * 10.0 ** (math.floor(math.log10(size)) + 1 - digit_count)
    text = f"prints {digit_count} digits: nothing finer than {noise:.1g} of its unit can be judged"
    return _Rounding(noise, Deviation("digits", text, noise))


def _single_noise(values: Array) -> float:
    """Return the rounding of the largest of some numbers in single precision."""
    return float(np.abs(values).max()) * float(np.finfo(np.float32).eps)


def _same(rounded: Array, values: Array) -> bool:
    """Return whether rounding leaves values as they are."""
    return bool((np.abs(rounded - values) <= 1e-15 * np.abs(values)).all())


def _with_digits(values: Array, count: int) -> Array:
    """Return values rounded to a number of significant digits."""
    return np.array([float(f"{value:.{count - 1}e}") for value in values])


def _in_single_precision(values: Array) -> bool:
    """Return whether values are numbers of single precision, in full or printed with nine digits.

    C prints nine digits. In a large swing these are as few decimals as in double precision.
    """
    single = values.astype(np.float32).astype(float)
    return _same(single, values) or _same(_with_digits(single, 9), values)


@dataclass(frozen=True)
class _Heights:
    """How a file may count heights.

    Attributes:
        sign: of its vertical, -1 where it points down.
        shift: height in m of its lowest point.
        text: what is reported; empty for heights as in the scene.
    """

    sign: int
    shift: float
    text: str


def heights(rows: FileRows, length: float) -> FileRows:
    """Find the vertical: another column, upside down, or from the lowest point.

    If no column has the heights of a bob on the sphere, heights are left out.
    """
    if rows.positions.shape[1] < 3:
        return rows
    if _keeps_another_cord(rows, length):
        return _unless_coarser(_upwards(rows))
    offset = _offset_of_heights(rows, length)
    if offset:
        side = "high" if offset > 0 else "low"
        text = f"has z {abs(offset):.6g} m too {side} in every row"
        moved = rows.positions - [0.0, 0.0, offset]
        rows = rows.changed(Deviation("z_offset", text, abs(offset)), positions=moved)

    for order, counted in itertools.product(_VERTICALS, _counts_of_heights(length)):
        plane = rows.positions[:, order[:2]]
        on_sphere = _on_sphere(plane, length)
        if on_sphere is None:
            continue
        column = rows.positions[:, order[2]] * counted.sign - counted.shift
        difference = column - on_sphere
        if np.abs(difference).max() > _ALIKE * length:
            continue
        rise = float(np.ptp(on_sphere))
        if float(np.ptp(column)) < _NO_RISE * rise:
            return _with_constant_heights(rows, rise)
        if _are_heights(difference, rise, order, counted, 20 * rows.noise, length):
            return _with_heights(rows, order, counted, length)
    return _without_heights(rows, length)


def _are_heights(
    difference: Array,
    rise: float,
    order: tuple[int, int, int],
    counted: _Heights,
    rounding: float,
    length: float,
) -> bool:
    """Return whether a column holds heights, by its difference from the heights of a bob on the sphere.

    A z as in the scene may differ by any amount. A z counted otherwise has to be near them, and another column has to
    rise and fall with them.
    """
    if order != _VERTICALS[0]:
        return bool(np.ptp(difference) <= _SAME_RISE * rise + rounding)
    if counted.text:
        return bool(
            np.abs(difference).max() <= max(_SAME_RISE * rise, _NO_RISE * length) + rounding
        )
    return True


def _counts_of_heights(length: float) -> tuple[_Heights, ...]:
    """Return the ways in which a file may count heights, that of the scene first."""
    return (
        _Heights(1, 0.0, ""),
        _Heights(-1, 0.0, _DOWN),
        _Heights(1, length, "counts z from the lowest point"),
        _Heights(-1, length, _DOWN),
    )


def _keeps_another_cord(rows: FileRows, length: float) -> bool:
    """Return whether the bob stays on its side of the suspension, at a distance from it that is not the scene's."""
    z = rows.positions[:, 2]
    cord = np.linalg.norm(rows.positions, axis=1)
    same = max(20 * rows.noise, _SLIGHT * length)
    keeps_cord = np.ptp(cord) <= same < np.ptp(z)
    one_side = z.max() < 0 or z.min() > 0
    return bool(keeps_cord and one_side and abs(cord.mean() - length) > same)


def _upwards(rows: FileRows) -> FileRows:
    """Return rows with z upwards, the bob being below the suspension."""
    if rows.positions[0, 2] < 0:
        return rows
    positions = rows.positions * [1.0, 1.0, -1.0]
    size_m = 2 * float(np.abs(positions[:, 2]).max())
    return rows.changed(Deviation("z_down", _DOWN, size_m), positions=positions)


def _with_constant_heights(rows: FileRows, rise: float) -> FileRows:
    """Return rows without their constant height. It is reported, unless rounding hides the rise in m."""
    if rise <= 2 * rows.noise:
        return _flat(rows)
    return _flat(rows.changed(Deviation("z_constant", _FLAT)))


def wrong_heights(convention: Deviation) -> Deviation:
    """Return the convention of a file whose x and y are right: if its bob leaves the sphere, z is wrong."""
    if convention.id != "off_the_sphere":
        return convention
    return Deviation("z_wrong", _WRONG_Z, convention.size_m)


def _without_heights(rows: FileRows, length: float) -> FileRows:
    """Return rows without heights, and report that no column holds them."""
    on_sphere = _on_sphere(rows.plane, length)
    if on_sphere is None:
        return _flat(rows)
    size_m = float(np.abs(rows.positions[:, 2] - on_sphere).max())
    return _flat(rows.changed(Deviation("off_the_sphere", _OFF_THE_SPHERE, size_m)))


def _on_sphere(plane: Array, length: float) -> Array | None:
    """Return the heights of a bob at x and y in m; None if the cord does not reach one of them."""
    square = plane[:, 0] ** 2 + plane[:, 1] ** 2
    if (square >= length * length).any():
        return None
    return np.asarray(-np.sqrt(length * length - square))


def _with_heights(
    rows: FileRows, order: tuple[int, int, int], counted: _Heights, length: float
) -> FileRows:
    """Return rows with heights as in the scene; without heights if the bob leaves the sphere."""
    plane = rows.positions[:, order[:2]]
    printed = rows.positions[:, order[2]]
    column = printed * counted.sign - counted.shift
    corrected = rows
    if counted.text:
        convention_id = "z_down" if counted.sign < 0 else "z_from_lowest"
        size = float(np.abs(column - printed).max())
        corrected = corrected.changed(Deviation(convention_id, counted.text, size))
    if order != _VERTICALS[0]:
        text = f"calls the vertical {'xyz'[order[2]]}"
        corrected = corrected.changed(Deviation("vertical_is_not_z", text, length))

    square = plane[:, 0] ** 2 + plane[:, 1] ** 2
    cord = np.sqrt(square + column * column)
    drift = float(np.ptp(cord))
    if drift > max(20 * rows.noise, _OFF * length):
        off = Deviation("off_the_sphere", _OFF_THE_SPHERE, drift)
        in_order = replace(corrected, positions=np.column_stack([plane, column]))
        return _flat(in_order.changed(off, cord=float(cord.mean())))
    if corrected is not rows:
        return replace(corrected, positions=np.column_stack([plane, column]))
    # a slight drift is not reported, but such heights cannot be fitted either
    if drift > max(20 * rows.noise, _SLIGHT * length):
        return _flat(rows)
    return _unless_coarser(rows)


def _unless_coarser(rows: FileRows) -> FileRows:
    """Return rows with their heights, unless these are rounded by more than x and y."""
    return _flat(rows) if rows.plane_noise < rows.noise else rows


def _offset_of_heights(rows: FileRows, length: float) -> float:
    """Return by how much z is too high in every row, in m.

    It is 0 if heights are right or counted from the lowest point. It is 0 as well if the rows keep
    a distance from the suspension: then their cord may have another length.
    """
    x, y, z = rows.positions.T
    on_sphere = _on_sphere(rows.plane, length)
    if on_sphere is None:
        return 0.0
    same = max(20 * rows.noise, _OFF * length)
    above = z - on_sphere
    offset = float(np.median(above))
    keeps_offset = np.ptp(above) <= same
    keeps_cord = np.ptp(np.sqrt(x * x + y * y + z * z)) <= same
    from_lowest = abs(offset - length) <= same
    return offset if keeps_offset and not keeps_cord and not from_lowest else 0.0


def _flat(rows: FileRows) -> FileRows:
    """Return the rows without heights."""
    plane = np.ascontiguousarray(rows.plane)
    return replace(rows, positions=plane, noise=rows.plane_noise)


@dataclass(frozen=True)
class _UnitOfLength:
    """A unit that a file may use: its number in a metre, and what is reported."""

    per_metre: float
    text: str


_METRES = _UnitOfLength(1.0, "")


def _units_of_length(length: float) -> list[_UnitOfLength]:
    """Return the units in which a file may write lengths, metres first."""
    units = [_METRES]
    for unit, text in LENGTHS_SAID.items():
        units.append(_UnitOfLength(1 / float(LENGTHS[unit]), text))
    for unit in ("cm", "mm"):
        text = f"counts metres as {LONG_NAMES[unit]}"
        units.append(_UnitOfLength(float(LENGTHS[unit]), text))
    units.append(_UnitOfLength(1 / length, "is in cord lengths (x/l)"))
    return units


def axes(
    rows: FileRows, printed: FileRows, release: Array, length: float, rename: bool
) -> FileRows:
    """Find the unit of length and the names of the horizontal axes that make row 0 the release.

    Args:
        rows: of the file, their heights as in the scene.
        printed: the rows as they are printed, of which heights are found again in another unit.
        release: position and velocity of the scene.
        length: of the cord in m.
        rename: whether the horizontal axes may have other names.
    """
    first, last = rows.positions[[0, -1]]
    released = any(_is_release(row, release, rows.plane_noise) for row in (first, last))
    if released or not rows.starts or np.hypot(*first[:2]) == 0:
        return rows

    angles = _from_angles(printed, release, length)
    if angles is not None:
        return angles
    ways = [*AXES_SAID] if rename else [_AS_IN_SCENE]
    for row, unit, way in itertools.product((first, last), _units_of_length(length), ways):
        placed = _placed(row, unit, way)
        if _is_release(placed, release, rows.plane_noise / unit.per_metre):
            return _renamed(_in_metres(rows, printed, unit, length), *way)
    distance = np.hypot(*release[:2])
    for unit, way in _rough_ways(first, release, length, ways):
        placed = _placed(first, unit, way)
        if np.abs(placed - release[:2]).max() < ROUGHLY * distance:
            return _renamed(_in_metres(rows, printed, unit, length), *way)
    return replace(rows, starts=False)


def _placed(row: Array, unit: _UnitOfLength, way: _Axes) -> Array:
    """Return x and y in m of a row in some unit and in some axes."""
    order, signs = way
    return np.asarray(row[[*order]] / unit.per_metre * np.array(signs))


def _rough_ways(
    first: Array, release: Array, length: float, ways: list[_Axes]
) -> Iterator[tuple[_UnitOfLength, _Axes]]:
    """Yield another unit, or other axes, that a file may have whose release is a little off.

    Args:
        first: its first row.
        release: position and velocity of the scene.
        length: of the cord in m.
        ways: axes that it may have.
    """
    for unit in _units_of_length(length):
        # in a unit of about a metre the release alone may be off; and cord lengths are angles, roughly
        if abs(unit.per_metre - 1) >= 3 * ROUGHLY and unit.per_metre != 1 / length:
            yield unit, _AS_IN_SCENE
    # a release that is nearly right may have the right axes
    distance = np.hypot(*release[:2])
    if np.abs(first[:2] - release[:2]).max() >= ROUGHLY * distance:
        for way in ways:
            if way != _AS_IN_SCENE:
                yield _METRES, way


def _from_angles(printed: FileRows, release: Array, length: float) -> FileRows | None:
    """Return positions in m of rows that give angles of the cord; None if they do not, or cord lengths fit better."""
    first = printed.positions[0]
    distance = float(np.hypot(*release[:2]))
    # the angle of each coordinate by itself, that of the cord's projection, or that of the cord towards the bob
    direction = release[:2] / max(distance, 1e-300)
    ways = {
        "separate": np.arcsin(np.clip(release[:2] / length, -1, 1)),
        "projected": np.arctan2(release[:2], -release[2]),
        "polar": direction * math.asin(min(1.0, distance / length)),
        _CORD_LENGTHS: release[:2] / length,
    }
    for unit, size in (("degrees", 180 / math.pi), ("radians", 1.0)):
        offs = {way: np.abs(first[:2] / size - ways[way]).max() for way in ways}
        way = min(offs, key=lambda each: offs[each])
        near = _NEAR * float(np.abs(ways[way]).max()) + 2 * printed.plane_noise / size
        if offs[way] <= near and way != _CORD_LENGTHS:
            plane = _plane_of_angles(printed.plane / size, way, length)
            text = f"gives x and y as angles of the cord in {unit}"
            convention = Deviation("angles", text, float(np.abs(first[:2]).max()))
            plane_noise = printed.plane_noise / size * length
            rows = printed.changed(
                convention,
                positions=np.column_stack([plane, printed.positions[:, 2:]]),
                noise=max(plane_noise, printed.noise),
                plane_noise=plane_noise,
            )
            return heights(rows, length)
    return None


def _plane_of_angles(angles: Array, way: str, length: float) -> Array:
    """Return x and y in m of angles of the cord in rad, counted in one of the ways of `_from_angles`."""
    if way == "separate":
        return np.asarray(length * np.sin(angles))
    if way == "polar":
        return np.asarray(length * angles * sinc(np.hypot(*angles.T))[:, None])
    slopes = np.tan(angles)
    return np.asarray(length * slopes / np.sqrt(1 + (slopes**2).sum(axis=1))[:, None])


def _in_metres(rows: FileRows, printed: FileRows, unit: _UnitOfLength, length: float) -> FileRows:
    """Return the rows in metres, with what is reported of their unit, and their heights found again."""
    if not unit.text:
        return rows
    positions = printed.positions / unit.per_metre
    size_m = largest(positions[:, :2] - printed.plane)
    in_metres = printed.changed(
        Deviation("unit_of_length", unit.text, size_m),
        positions=positions,
        noise=printed.noise / unit.per_metre,
        plane_noise=printed.plane_noise / unit.per_metre,
    )
    return heights(in_metres, length)


def _renamed(rows: FileRows, order: tuple[int, int], signs: tuple[int, int]) -> FileRows:
    """Return the rows with the horizontal axes in another order and with other signs."""
    convention_id, text = AXES_SAID[order, signs]
    if not text:
        return rows
    plane = rows.positions[:, order] * np.array(signs)
    convention = Deviation(convention_id, text, largest(plane - rows.plane))
    return rows.changed(convention, positions=np.column_stack([plane, rows.positions[:, 2:]]))


def clock(rows: FileRows, release: Array) -> FileRows:
    """Find rows in reverse order, and a clock that does not start at 0."""
    begins = _is_release(rows.positions[0], release, rows.plane_noise)
    ends = _is_release(rows.positions[-1], release, rows.plane_noise)
    if ends and not begins and len(rows.times) > 2:
        return replace(_reversed(rows), starts=True)
    if begins and 0 < rows.times[0] < rows.times[-1]:
        return _from_zero(rows, release)
    return rows


def _from_zero(rows: FileRows, release: Array) -> FileRows:
    """Return the rows with a clock that starts at 0."""
    text = f"starts its clock at {rows.times[0]:.10g} s and not at 0"
    convention = Deviation("clock_offset", text, float(np.hypot(*release[:2])))
    return rows.changed(convention, times=rows.times - rows.times[0], starts=True)


def other_conventions(rows: FileRows, release: Array) -> Iterator[FileRows]:
    """Yield the rows as those of other conventions, between which row 0 does not decide."""
    shifts = {"rows_late", "rows_early"}
    as_printed = shifts.isdisjoint(convention.id for convention in rows.conventions)
    if as_printed and 0 < rows.times[0] < rows.times[-1]:
        yield _from_zero(rows, release)  # a clock that starts late, and a release that is off
    x, y = release[:2]
    if abs(abs(x) - abs(y)) <= _NEAR * abs(x):
        signs = (1, 1) if x * y > 0 else (-1, -1)
        yield _renamed(rows, (1, 0), signs)


def _reversed(rows: FileRows) -> FileRows:
    """Return the rows in reverse order, with a clock that runs backwards."""
    positions = rows.positions[::-1].copy()
    text = "has its rows in reverse order: the release stands last"
    convention = Deviation("rows_reversed", text, largest(positions - rows.positions))
    return rows.changed(convention, times=rows.times[-1] - rows.times[::-1], positions=positions)


def unit_of_time(rows: FileRows, frequency: float, length: float) -> FileRows:
    """Find the unit of time by the frequency of the swing."""
    if not frequency or len(rows.times) < _SHORTEST:
        return rows
    swing = _FirstSwings.of(rows, frequency, length)
    as_printed = swing.relative_frequency(1.0)
    if as_printed is not None and 0.5 < as_printed < 2:
        return rows
    spacing = float(np.median(np.diff(rows.times)))
    span = float(rows.times[-1] - rows.times[0])
    for unit, text in TIMES_SAID.items():
        scale = float(TIMES[unit])
        if not spacing * scale * frequency < math.pi < span * scale * frequency:
            # rows farther apart fit several frequencies; over a shorter span they show none
            continue
        scaled = swing.relative_frequency(scale)
        if scaled is not None and abs(scaled - 1) < _SAME_FREQUENCY:
            convention = Deviation("unit_of_time", text, swing.size)
            return rows.changed(convention, times=rows.times * scale)
    return rows


@dataclass(frozen=True)
class _FirstSwings:
    """The first rows, by which the frequency of a swing is known.

    Attributes:
        times: in s.
        plane: x + iy in m, or what small swings would have in their place.
        size: the largest distance from the vertical in all rows, in m.
        frequency: of the scene's swing in rad/s.
    """

    times: Array
    plane: ComplexArray
    size: float
    frequency: float

    @classmethod
    def of(cls, rows: FileRows, frequency: float, length: float) -> _FirstSwings:
        """Return those of some rows."""
        plane = rows.positions[:, 0] + 1j * rows.positions[:, 1]
        if np.abs(plane).max() < length:
            plane = as_angles(plane, length)
        size = float(np.abs(plane).max())
        return cls(rows.times[:_FIRST], plane[:_FIRST], size, frequency)

    def relative_frequency(self, scale: float) -> float | None:
        """Return the frequency of the rows over the scene's, their times multiplied by a scale.

        None if the rows show none.
        """
        fit = fit_phasors(self.times * scale, self.plane, self.frequency)
        if fit is None or fit.residual > _UNFIT * self.size:
            return None
        rate = abs(fit.phasors.square) ** 0.5
        # a part of a wide swing in another unit looks like one that decays, or grows, within it
        return rate / self.frequency if abs(fit.phasors.drag) < _DECAYS * rate else None


def rounded_clock(rows: FileRows, frequency: float) -> FileRows:
    """Undo the rounding of times to single precision.

    If it cannot be undone, the distance that the bob moves meanwhile is added to the noise.
    """
    times = rows.times
    even = np.linspace(times[0], times[-1], len(times))
    error_s = float(np.abs(times - even).max())
    single = any(convention.id == "single_precision" for convention in rows.conventions)
    if not single or error_s > _SINGLE * times[-1]:  # or they are not evenly spaced
        return rows
    spacing_s = float(f"{even[1] - even[0]:.6g}")
    exact = spacing_s * np.arange(len(even)) + even[0]
    if (exact.astype(np.float32) == times.astype(np.float32)).all():
        return replace(rows, times=exact)
    speed = frequency * float(np.abs(rows.plane).max())
    moved_m = error_s * speed
    return replace(rows, noise=rows.noise + moved_m, plane_noise=rows.plane_noise + moved_m)


@dataclass(frozen=True)
class _ReleasePassage:
    """A time at which the fitted motion passes near the release.

    Attributes:
        distance_m: from the release, that of the velocity included.
        parts: the time, in parts of a row.
        rows: in the order that was fitted.
    """

    distance_m: float
    parts: int
    rows: FileRows


def shifted(
    rows: FileRows, release: Array, frequency: float, length: float, in_order: bool, truth: Truth
) -> FileRows:
    """Find a clock that does not start at the release: the fitted motion passes it then.

    The clock may be off by a few rows. If first rows were left out, the release may be some swings before it. Unless
    they are known to be in order, the rows may be reversed.

    Args:
        rows: of the file.
        release: x, y, z, vx, vy, vz of the scene in m and m/s.
        frequency: of the scene's swing in rad/s.
        length: of the cord in m.
        in_order: whether the rows are known to be in order.
        truth: returns the states of the scene at times in s.
    """
    if not frequency or len(rows.times) < _SHORTEST:
        return rows
    reach_m = abs(as_angles(np.array([complex(release[0], release[1])]), length)[0])
    spacing_s = float(np.median(np.diff(rows.times)))
    swing_in_parts = 2 * math.pi / frequency / spacing_s * _PARTS
    orders = [rows] if in_order else [rows, _reversed(rows)]
    near: list[_ReleasePassage] = []
    earlier: list[_ReleasePassage] = []
    for ordered in orders:
        first = -max(math.ceil(_SWINGS * swing_in_parts), _SHIFTS * _PARTS)
        passages = list(_passages(ordered, release, frequency, length, first))
        near += passages[-2 * _SHIFTS * _PARTS - 1 :]
        earlier += _nearest_of_each(passages)
    # of equal ones, the smallest shift
    near.sort(key=lambda passage: passage.distance_m + 1e-9 * reach_m * abs(passage.parts))
    at_release = [one for one in near[:1] if one.distance_m <= 2 * _ROUGH_FIT * reach_m]
    possible = [one for one in earlier if one.distance_m <= 2 * _ROUGH_FIT * reach_m]
    count = math.ceil(swing_in_parts / _PARTS)

    def off_m(passage: _ReleasePassage) -> float:
        return _off_in_first_rows(passage, spacing_s, max(count, _SHORTEST), truth)

    best = min(possible, key=off_m, default=None)
    if best is None or (at_release and not NEEDED * off_m(best) < off_m(at_release[0])):
        best = next(iter(at_release), None)
    if best is None:
        return rows

    shift_s = best.parts * spacing_s / _PARTS
    size_m = reach_m * min(2.0, frequency * abs(shift_s))
    return _from_release(best, shift_s, float(size_m))


def _passages(
    rows: FileRows, release: Array, frequency: float, length: float, first: int
) -> Iterator[_ReleasePassage]:
    """Yield how near the fitted motion is to the release at each part of a row, from the first one on."""
    start = as_angles(np.array([complex(release[0], release[1])]), length)[0]
    speed = complex(release[3], release[4])
    spacing_s = float(np.median(np.diff(rows.times)))
    plane = as_angles(rows.plane @ np.array([1, 1j]), length)
    fit = fit_phasors(rows.times, plane, frequency)
    if fit is None or fit.residual > _ROUGH_FIT * abs(start):
        return
    for parts in range(first, _SHIFTS * _PARTS + 1):
        motion = fit.phasors.later(parts * spacing_s / _PARTS)
        distance_m = abs(motion.start - start) + abs(motion.speed - speed) / frequency
        yield _ReleasePassage(float(distance_m), parts, rows)


def _nearest_of_each(passages: Sequence[_ReleasePassage]) -> Iterator[_ReleasePassage]:
    """Yield the nearest of the times at which the motion passes the release, one of each swing."""
    for before, passage, after in zip(passages, passages[1:], passages[2:], strict=False):
        if before.distance_m > passage.distance_m <= after.distance_m:
            yield passage


def _off_in_first_rows(
    passage: _ReleasePassage, spacing_s: float, count: int, truth: Truth
) -> float:
    """Return the root mean square distance in m of the first rows from the truth, the clock shifted as it fits best.

    The shift is known to a part of a row at first.
    """
    rows = passage.rows
    times = rows.times - passage.parts * spacing_s / _PARTS
    kept = times >= 0
    times = times[kept][:count]
    plane = rows.plane[kept][:count]
    for _ in range(_NEWTON):
        states = truth(times)
        off, speed = plane - states[:, :2], states[:, 3:5]
        change_s = float((off * speed).sum() / (speed**2).sum())
        times = times + max(change_s, -float(times[0]))  # not before the release
    return rms(plane - truth(times)[:, :2])


def _from_release(passage: _ReleasePassage, shift_s: float, size_m: float) -> FileRows:
    """Return the rows from a passage of the release on, their clock shifted to 0 there.

    `size_m` is the effect of the shift.
    """
    rows = passage.rows
    if passage.parts:
        whole, part = divmod(abs(passage.parts), _PARTS)
        distance = _ROWS_SAID.get((whole, part), f"{whole + part / _PARTS:g} rows")
        side = "ahead of" if passage.parts > 0 else "behind"
        text = f"has its clock {side} its rows by {distance} ({abs(shift_s):.6g} s)"
        convention_id = "rows_late" if passage.parts < 0 else "rows_early"
        rows = rows.changed(Deviation(convention_id, text, size_m))
    times = rows.times - shift_s
    kept = times >= 0
    return replace(rows, times=times[kept], positions=rows.positions[kept], starts=True)
