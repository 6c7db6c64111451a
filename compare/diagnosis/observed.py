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


@dataclass(frozen=True)
class _Column:
    """A column of a file, and the maps that may have made it.

    Attributes:
        case: the file.
        index: of the column.
    """

    case: FileCase
    index: int

    @property
    def names(self) -> str:
        """The names of all columns."""
        return "xyz"[: self.case.truth.shape[1]]

    @property
    def name(self) -> str:
        """Its name."""
        return self.names[self.index]

    @property
    def printed(self) -> Array:
        """Its values in m."""
        return self.case.rows.positions[:, self.index]

    @property
    def true(self) -> Array:
        """The values in m that a right program prints."""
        return self.case.truth[:, self.index]

    def maps(self) -> Iterator[_ColumnMap]:
        """Yield the maps that may have made it."""
        yield from self._constant()
        yield from self._copied()
        text = f"prints −{self.name} in its column of {self.name}"
        yield self._mapped("mirrored", text, -self.true)
        yield from self._scaled()
        yield self._moved()
        yield from self._late()

    def _mapped(self, word: str, text: str, values: Array, price: int = 1) -> _ColumnMap:
        return _ColumnMap(f"column_{word}", text, (self.index,), values.reshape(-1, 1), price)

    def _constant(self) -> Iterator[_ColumnMap]:
        if np.ptp(self.printed) <= self.case.resolution:
            level = float(np.mean(self.printed))
            text = f"prints {self.name} as a constant, {level:.{_PRINTED_DIGITS}g}"
            yield self._mapped("constant", text, np.full_like(self.printed, level))

    def _copied(self) -> Iterator[_ColumnMap]:
        for other, other_name in enumerate(self.names):
            if other == self.index:
                continue
            for sign, prefix in ((1, ""), (-1, "−")):
                text = f"prints {prefix}{other_name} in its column of {self.name}"
                yield self._mapped("copied", text, sign * self.case.truth[:, other])

    def _scaled(self) -> Iterator[_ColumnMap]:
        true = self.true
        square = float(true @ true)
        factor = float(true @ self.printed) / square if square else 0.0
        size = rms(true[:, None])
        # a constant and a mirrored column have words of their own
        if min(abs(factor), abs(factor + 1)) * size > RIVAL * self.case.resolution:
            uncertainty = _uncertainty_m(self.case, self.printed - factor * true) / size
            number = _FittedNumber.of(factor, uncertainty)
            text = f"prints {self.name} times {number.text}"
            yield self._mapped("scaled", text, factor * true, 1 + number.price)

    def _moved(self) -> _ColumnMap:
        shift = float(np.mean(self.printed - self.true))
        residuals = self.printed - self.true - shift
        number = _FittedNumber.of(shift, _uncertainty_m(self.case, residuals))
        text = f"prints {self.name} with {number.text} m added to it"
        return self._mapped("moved", text, self.true + shift, 1 + number.price)

    def _late(self) -> Iterator[_ColumnMap]:
        for count in _LATE_ROWS:
            if len(self.printed) <= abs(count) or not _is_even(self.case):
                continue
            rows = "one row" if abs(count) == 1 else f"{abs(count)} rows"
            text = f"prints {self.name} {rows} {'late' if count > 0 else 'early'}"
            yield self._mapped("late", text, _late(self.printed, self.true, count))


def _late(printed: Array, true: Array, count: int) -> Array:
    """Return the true values some rows late; those of rows beyond the ends are as printed."""
    values = printed.copy()
    if count > 0:
        values[count:] = true[:-count]
    else:
        values[:count] = true[-count:]
    return values


@dataclass(frozen=True)
class _Plane:
    """x + iy of a file, and the maps that may have made x and y together.

    Attributes:
        case: the file.
        printed: its values in m.
        true: the values in m that a right program prints; not all are 0.
    """

    case: FileCase
    printed: ComplexArray
    true: ComplexArray

    @property
    def factor(self) -> complex:
        """The number that fits printed = factor * true best."""
        return complex(np.vdot(self.true, self.printed) / np.vdot(self.true, self.true))

    def maps(self) -> Iterator[_ColumnMap]:
        """Yield the maps that may have made them."""
        yield self._scaled()
        yield self._turned()
        yield self._moved()
        yield self._scaled_and_turned()
        yield self._similar()

    def _mapped(self, word: str, text: str, plane: ComplexArray, price: int) -> _ColumnMap:
        positions = np.column_stack([plane.real, plane.imag])
        return _ColumnMap(f"plane_{word}", text, (0, 1), positions, price)

    def _relative_uncertainty(self, plane: ComplexArray) -> float:
        """Return an estimate of the error of a factor with which a map makes the plane."""
        return _uncertainty_m(self.case, self.printed - plane) / rms(self.true[:, None])

    def _scaled(self) -> _ColumnMap:
        scale = self.factor.real
        plane = scale * self.true
        number = _FittedNumber.of(scale, self._relative_uncertainty(plane))
        return self._mapped(
            "scaled", f"prints x and y times {number.text}", plane, 1 + number.price
        )

    def _turned(self) -> _ColumnMap:
        turn = cmath.phase(self.factor)
        plane = self.true * cmath.exp(1j * turn)
        uncertainty = self._relative_uncertainty(plane)
        radians = _FittedNumber.of(turn, uncertainty)
        degrees = _FittedNumber.of(math.degrees(turn), math.degrees(uncertainty))
        angle = f"{degrees.text} degrees" if radians.price else f"{radians.text} rad"
        text = f"prints x and y turned by {angle}, anticlockwise"
        # the angle is typed if it has few digits in one of the units
        return self._mapped("turned", text, plane, 1 + radians.price * degrees.price)

    def _moved(self) -> _ColumnMap:
        shift = complex(np.mean(self.printed - self.true))
        uncertainty = _uncertainty_m(self.case, self.printed - self.true - shift)
        x = _FittedNumber.of(shift.real, uncertainty)
        y = _FittedNumber.of(shift.imag, uncertainty)
        text = f"prints x and y with {x.text} m and {y.text} m added to them"
        return self._mapped("moved", text, self.true + shift, 2 + x.price + y.price)

    def _scaled_and_turned(self) -> _ColumnMap:
        plane = self.factor * self.true
        uncertainty = self._relative_uncertainty(plane)
        scale = _FittedNumber.of(abs(self.factor), uncertainty)
        turn = math.degrees(cmath.phase(self.factor))
        degrees = _FittedNumber.of(turn, math.degrees(uncertainty))
        scaled = f"prints x and y times {scale.text}"
        text = f"{scaled} and turned by {degrees.text} degrees, anticlockwise"
        return self._mapped("turned", text, plane, 2 + scale.price + degrees.price)

    def _similar(self) -> _ColumnMap:
        """Return the map that scales, turns and moves, with four free numbers."""
        basis = np.column_stack([self.true, np.ones_like(self.true)])
        factor, shift = solved(basis, self.printed)
        text = (
            f"prints x and y times {abs(factor):.6g}, "
            f"turned by {math.degrees(cmath.phase(factor)):.6g} degrees, "
            f"with {shift.real:.6g} m and {shift.imag:.6g} m added"
        )
        return self._mapped("moved", text, factor * self.true + shift, 8)


def _maps_of_plane(case: FileCase) -> list[_ColumnMap]:
    """Return the maps that may have made x and y together."""
    printed = case.rows.positions[:, :2] @ np.array([1, 1j])
    true = case.truth[:, :2] @ np.array([1, 1j])
    if not rms(true[:, None]) > 0:
        return []
    return list(_Plane(case, printed, true).maps())


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
    separate = {column: _best(case, [*_Column(case, column).maps()]) for column in wrong}
    choice = _Choice(tuple(separate.values()))
    if 0 in wrong and 1 in wrong:
        plane = _best(case, _maps_of_plane(case)) or _best(case, [_general_map(case)])
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


def _uncertainty_m(case: FileCase, residuals: Array | ComplexArray) -> float:
    """Return an estimate of the error of a mean in m: the rms residual, or the rounding."""
    return max(rms(residuals[:, None]), case.resolution)


def _is_even(case: FileCase) -> bool:
    """Return whether the rows are evenly spaced."""
    steps = np.diff(case.rows.times)
    return bool(np.ptp(steps) <= 1e-6 * steps[0])
