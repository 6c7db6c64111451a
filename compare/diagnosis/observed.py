"""The observation: how a motion became the columns of a file. Maps are fitted to the right motion.

A column may be a copy of another one, a constant, mirrored, scaled, moved, or some rows late; the
horizontal axes may be scaled, turned or moved together. Each map is applied to the truth, and the
result is compared with the file.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import solved
from .case import AS_IF, EITHER, Explanation, FileCase, largest, rms
from .causes import shortest_decimal
from .claims import has_few_digits
from .phasors import ComplexArray
from .thresholds import ALTERNATIVES, RIVAL, ROWS_A_NUMBER

_LATE_ROWS = (1, -1, 2, -2)  # by which a column may be late
_PRINTED_DIGITS = 10  # of a fitted number at most


@dataclass(frozen=True)
class _ColumnMap:
    """The columns that a named map makes of the truth.

    Attributes:
        id: a stable word.
        text: the end of the sentence "Your file …".
        columns: indices of the columns that it makes.
        positions: these columns in m, shape (rows, columns).
        price: one, and one more for each number that nobody typed.
    """

    id: str
    text: str
    columns: tuple[int, ...]
    positions: Array
    price: int = 1

    def residuals(self, case: FileCase) -> Array:
        """Return the file's columns less its own in m, shape (rows, columns)."""
        return np.asarray(case.rows.positions[:, self.columns] - self.positions)


@dataclass(frozen=True)
class _FittedNumber:
    """A fitted number: its text, to the digits that are known, and its price.

    The price is 0 for a number that somebody may have typed, else 1.
    """

    text: str
    price: int

    @classmethod
    def of(cls, value: float, uncertainty: float) -> _FittedNumber:
        """Return a number with an uncertainty."""
        decimal, _ = shortest_decimal(value, uncertainty)
        price = 0 if has_few_digits(value, uncertainty) else 1
        return cls(f"{decimal:.{_PRINTED_DIGITS}g}", price)


def _maps_of_column(case: FileCase, column: int) -> Iterator[_ColumnMap]:
    """Yield the maps that may have made a column of the file."""
    printed = case.rows.positions[:, column]
    true = case.truth[:, column]
    names = "xyz"[: case.truth.shape[1]]
    name = names[column]

    def mapped(word: str, text: str, values: Array, price: int = 1) -> _ColumnMap:
        return _ColumnMap(f"column_{word}", text, (column,), values.reshape(-1, 1), price)

    if np.ptp(printed) <= case.resolution:
        level = float(np.mean(printed))
        text = f"prints {name} as a constant, {level:.{_PRINTED_DIGITS}g}"
        yield mapped("constant", text, np.full_like(printed, level))

    for other, other_name in enumerate(names):
        if other == column:
            continue
        for sign, prefix in ((1, ""), (-1, "−")):
            text = f"prints {prefix}{other_name} in its column of {name}"
            yield mapped("copied", text, sign * case.truth[:, other])
    yield mapped("mirrored", f"prints −{name} in its column of {name}", -true)

    square = float(true @ true)
    factor = float(true @ printed) / square if square else 0.0
    size = rms(true[:, None])
    # a constant and a mirrored column have words of their own
    if min(abs(factor), abs(factor + 1)) * size > RIVAL * case.resolution:
        uncertainty = _uncertainty_m(case, printed - factor * true) / size
        number = _FittedNumber.of(factor, uncertainty)
        text = f"prints {name} times {number.text}"
        yield mapped("scaled", text, factor * true, 1 + number.price)

    shift = float(np.mean(printed - true))
    number = _FittedNumber.of(shift, _uncertainty_m(case, printed - true - shift))
    text = f"prints {name} with {number.text} m added to it"
    yield mapped("moved", text, true + shift, 1 + number.price)

    for count in _LATE_ROWS:
        if len(printed) <= abs(count) or not _is_even(case):
            continue
        late = "one row" if abs(count) == 1 else f"{abs(count)} rows"
        text = f"prints {name} {late} {'late' if count > 0 else 'early'}"
        yield mapped("late", text, _late(printed, true, count))


def _late(printed: Array, true: Array, count: int) -> Array:
    """Return the true values some rows late; those of rows beyond the ends are as printed."""
    values = printed.copy()
    if count > 0:
        values[count:] = true[:-count]
    else:
        values[:count] = true[-count:]
    return values


def _map_of_plane(word: str, text: str, plane: ComplexArray, price: int) -> _ColumnMap:
    """Return a map of x and y together, with x + iy that it makes."""
    positions = np.column_stack([plane.real, plane.imag])
    return _ColumnMap(f"plane_{word}", text, (0, 1), positions, price)


def _maps_of_plane(case: FileCase) -> Iterator[_ColumnMap]:
    """Yield the maps that may have made x and y together."""
    printed = case.rows.positions[:, :2] @ np.array([1, 1j])
    true = case.truth[:, :2] @ np.array([1, 1j])
    size = rms(true[:, None])
    if not size > 0:
        return
    factor = complex(np.vdot(true, printed) / np.vdot(true, true))
    turn = cmath.phase(factor)

    scaled = factor.real * true
    number = _FittedNumber.of(factor.real, _uncertainty_m(case, printed - scaled) / size)
    text = f"prints x and y times {number.text}"
    yield _map_of_plane("scaled", text, scaled, 1 + number.price)

    turned = true * cmath.exp(1j * turn)
    uncertainty = _uncertainty_m(case, printed - turned) / size
    radians = _FittedNumber.of(turn, uncertainty)
    degrees = _FittedNumber.of(math.degrees(turn), math.degrees(uncertainty))
    angle = f"{degrees.text} degrees" if radians.price else f"{radians.text} rad"
    text = f"prints x and y turned by {angle}, anticlockwise"
    # the angle is typed if it has few digits in one of the units
    yield _map_of_plane("turned", text, turned, 1 + radians.price * degrees.price)

    shift = complex(np.mean(printed - true))
    uncertainty = _uncertainty_m(case, printed - true - shift)
    x = _FittedNumber.of(shift.real, uncertainty)
    y = _FittedNumber.of(shift.imag, uncertainty)
    text = f"prints x and y with {x.text} m and {y.text} m added to them"
    yield _map_of_plane("moved", text, true + shift, 2 + x.price + y.price)

    scaled_and_turned = factor * true
    uncertainty = _uncertainty_m(case, printed - scaled_and_turned) / size
    scale = _FittedNumber.of(abs(factor), uncertainty)
    degrees = _FittedNumber.of(math.degrees(turn), math.degrees(uncertainty))
    text = f"prints x and y times {scale.text} and turned by {degrees.text} degrees, anticlockwise"
    yield _map_of_plane("turned", text, scaled_and_turned, 2 + scale.price + degrees.price)
    yield _similarity(printed, true)


def _similarity(printed: ComplexArray, true: ComplexArray) -> _ColumnMap:
    """Return the map that scales, turns and moves x and y, with four free numbers."""
    factor, shift = solved(np.column_stack([true, np.ones_like(true)]), printed)
    text = (
        f"prints x and y times {abs(factor):.6g}, "
        f"turned by {math.degrees(cmath.phase(factor)):.6g} degrees, "
        f"with {shift.real:.6g} m and {shift.imag:.6g} m added"
    )
    return _map_of_plane("moved", text, factor * true + shift, 8)


def _general_map(case: FileCase) -> _ColumnMap:
    """Return the linear map of x and y, with six free numbers."""
    basis = np.column_stack([case.truth[:, :2], np.ones(len(case.truth))])
    numbers = solved(basis, case.rows.positions[:, :2])
    (a, b, c), (d, e, f) = numbers.T
    x = f"{a:.6g} x {b:+.6g} y {c:+.6g} m"
    y = f"{d:.6g} x {e:+.6g} y {f:+.6g} m"
    text = f"prints a linear map of x and y: {x}, and {y}"
    return _ColumnMap("plane_mapped", text, (0, 1), basis @ numbers, 12)


@dataclass(frozen=True)
class _Choice:
    """The maps chosen for all wrong columns.

    Attributes:
        groups: for each set of columns, the maps that make it equally well; none if no map does.
    """

    groups: tuple[tuple[_ColumnMap, ...], ...]

    @property
    def price(self) -> float:
        """The price of all maps; infinity if some columns have none."""
        if not all(self.groups):
            return math.inf
        return sum(maps[0].price for maps in self.groups)


def of_observation(case: FileCase) -> Explanation | None:
    """Return the explanation that maps of a right program's columns made a file; None if none did.

    The case has the rows as they are printed.
    """
    errors = np.abs(case.rows.positions - case.truth).max(axis=0)
    wrong = [column for column, error in enumerate(errors) if error > case.enough]
    spans_a_swing = float(case.rows.times[-1]) * case.frequency >= 2 * math.pi
    if not wrong or not spans_a_swing:
        return None
    choice = _cheapest_choice(case, wrong)
    if not math.isfinite(choice.price) or ROWS_A_NUMBER * choice.price > len(case.rows.times):
        return None

    residuals = case.rows.positions - case.truth
    certain: list[Deviation] = []
    doubtful: list[Deviation] = []
    for maps in choice.groups:
        columns = maps[0].columns
        size_m = largest(residuals[:, columns])
        residuals[:, columns] = maps[0].residuals(case)
        deviation = _reported(maps, size_m)
        if deviation.stage:
            doubtful.append(deviation)
        else:
            certain.append(deviation)
    explanation = case.explanation(
        tuple(doubtful), largest(residuals), rms(residuals), int(choice.price)
    )
    return replace(explanation, conventions=(*explanation.conventions, *certain))


def _cheapest_choice(case: FileCase, wrong: Sequence[int]) -> _Choice:
    """Return the maps of each wrong column, or those of x and y together if that is cheaper."""
    separate = {column: _best(case, [*_maps_of_column(case, column)]) for column in wrong}
    choice = _Choice(tuple(separate.values()))
    if 0 in wrong and 1 in wrong:
        plane = _best(case, [*_maps_of_plane(case)]) or _best(case, [_general_map(case)])
        vertical = [maps for column, maps in separate.items() if column > 1]
        together = _Choice((plane, *vertical))
        if together.price < choice.price:
            return together
    return choice


def _reported(maps: Sequence[_ColumnMap], size_m: float) -> Deviation:
    """Return what is reported of maps that make the same columns; their effect is a size in m."""
    first = maps[0]
    if first.id == "plane_mapped" or len(maps) > ALTERNATIVES:
        text = f"looks like one that {first.text}"
        return Deviation(f"{AS_IF}.{first.id}", text, size_m, AS_IF)
    if len(maps) == 1:
        return Deviation(first.id, first.text, size_m)
    ids = "|".join(column_map.id for column_map in maps)
    texts = ", or ".join(column_map.text for column_map in maps)
    return Deviation(ids, f"either {texts}", size_m, EITHER)


def _best(case: FileCase, maps: Sequence[_ColumnMap]) -> tuple[_ColumnMap, ...]:
    """Return the cheapest of the maps that make their columns: several if they fit as well."""
    sizes = [max(rms(column_map.residuals(case)), case.resolution) for column_map in maps]
    most_m = RIVAL * min(sizes, default=math.inf)
    near = [
        column_map
        for column_map, size in zip(maps, sizes, strict=True)
        if size <= most_m and np.abs(column_map.residuals(case)).max() <= case.enough
    ]
    price = min((column_map.price for column_map in near), default=0)
    return tuple(column_map for column_map in near if column_map.price == price)


def _uncertainty_m(case: FileCase, residuals: Array) -> float:
    """Return an estimate of the error of a mean in m: the rms residual, or the rounding."""
    return max(rms(residuals[:, None]), case.resolution)


def _is_even(case: FileCase) -> bool:
    """Return whether the rows are evenly spaced."""
    steps = np.diff(case.rows.times)
    return bool(np.ptp(steps) <= 1e-6 * steps[0])
