"""The observation: how a motion became the columns of a file. Maps are fitted to the right motion.

A column may be a copy of another one, a constant, mirrored, scaled, moved, or some rows late; the
horizontal axes may be scaled, turned or moved together. Each map is applied to the truth, and the
result is compared with the file.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import solved
from .case import Explanation, FileCase, largest, rms
from .causes import shortest_decimal
from .claims import Alternative, graded, hedged, one_of
from .hypotheses import Claim, has_few_digits
from .phasors import ComplexArray
from .thresholds import ALTERNATIVES, RIVAL

_LATE_ROWS = (1, -1, 2, -2)  # by which a column may be late
_PRINTED_DIGITS = 10  # of a fitted number at most


@dataclass(frozen=True)
class _ColumnMap:
    """The columns that a named map makes of the truth.

    Attributes:
        id: a stable word.
        text: the end of the sentence "Your file …".
        columns: indices of the columns that it makes.
        made: `made(count)` returns these columns in m, shape (rows, columns), its numbers fitted to
            the first `count` rows.
        price: one, and one more for each arbitrary number.
    """

    id: str
    text: str
    columns: tuple[int, ...]
    made: Callable[[int], Array]
    price: int = 1

    def residuals(self, case: FileCase, count: int | None = None) -> Array:
        """Return the file's columns less its own in m, its numbers fitted to `count` rows, or to all."""
        positions = case.rows.positions[:, self.columns]
        return np.asarray(positions - self.made(len(positions) if count is None else count))


@dataclass(frozen=True, eq=False)
class _MapClaim(Claim):
    """The claim that a map made some columns; the case has these alone.

    Attributes:
        of: the whole file.
        map: of the truth.
    """

    of: FileCase
    map: _ColumnMap

    @classmethod
    def about(cls, of: FileCase, column_map: _ColumnMap) -> _MapClaim:
        """Return the claim about a file."""
        columns = list(column_map.columns)
        rows = replace(of.rows, positions=of.rows.positions[:, columns])
        case = replace(of, rows=rows, truth=of.truth[:, columns])
        return cls(case, column_map.residuals(of), of, column_map)

    @property
    def free_numbers(self) -> int:
        """Its arbitrary numbers, and which map it is."""
        return self.map.price

    def foreseen(self, count: int) -> Array:
        """Return the residuals in m if its numbers are fitted to the first `count` rows."""
        return self.map.residuals(self.of, count)


@dataclass(frozen=True)
class _FittedNumber:
    """A fitted number: its text, to the digits that are known, and its price.

    The price is 0 for a round number, and 1 for an arbitrary one.
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
        yield self._mapped("mirrored", text, _always(-self.true))
        yield from self._scaled()
        yield self._moved()
        yield from self._late()

    def _mapped(
        self, word: str, text: str, made: Callable[[int], Array], price: int = 1
    ) -> _ColumnMap:
        def column_of(count: int) -> Array:
            return made(count).reshape(-1, 1)

        return _ColumnMap(f"column_{word}", text, (self.index,), column_of, price)

    def _constant(self) -> Iterator[_ColumnMap]:
        if np.ptp(self.printed) <= self.case.resolution:

            def made(count: int) -> Array:
                return np.full_like(self.printed, float(np.mean(self.printed[:count])))

            yield self._mapped("constant", self._text_of_constant(), made)

    def _text_of_constant(self) -> str:
        """Return what is said of a constant column, which rounding may have made."""
        level = float(np.mean(self.printed))
        text = f"prints {self.name} as a constant, {level:.{_PRINTED_DIGITS}g}"
        decimals = max(0, -int(Decimal(f"{level:.{_PRINTED_DIGITS}g}").as_tuple().exponent))
        is_rounded = np.abs(self.true - level).max() <= 0.5 * 10.0**-decimals
        return f"{text}, or with too few digits" if is_rounded else text

    def evident_text(self, others: Iterable[int]) -> str:
        """Return what is said of a column that is a constant, or a copy of another one, by itself; "" for none."""
        if np.ptp(self.printed) <= self.case.resolution:
            return self._text_of_constant()
        for other in others:
            column = self.case.rows.positions[:, other]
            for sign, prefix in ((1, ""), (-1, "−")):
                if np.abs(self.printed - sign * column).max() <= self.case.resolution:
                    return f"prints {prefix}{self.names[other]} in its column of {self.name}"
        return ""

    def _copied(self) -> Iterator[_ColumnMap]:
        for other, other_name in enumerate(self.names):
            if other == self.index:
                continue
            column = self.case.truth[:, other]
            for sign, prefix in ((1, ""), (-1, "−")):
                text = f"prints {prefix}{other_name} in its column of {self.name}"
                yield self._mapped("copied", text, _always(sign * column))

    def _scaled(self) -> Iterator[_ColumnMap]:
        true = self.true
        size = rms(true[:, None])
        if not size:
            return

        def made(count: int) -> Array:
            return _factor(true[:count], self.printed[:count]) * true

        factor = _factor(true, self.printed)
        # a constant and a mirrored column have words of their own
        if min(abs(factor), abs(factor + 1)) * size > RIVAL * self.case.resolution:
            uncertainty = _uncertainty_m(self.case, self.printed - factor * true) / size
            number = _FittedNumber.of(factor, uncertainty)
            text = f"prints {self.name} times {number.text}"
            yield self._mapped("scaled", text, made, 1 + number.price)

    def _moved(self) -> _ColumnMap:
        differences = self.printed - self.true

        def made(count: int) -> Array:
            return self.true + float(np.mean(differences[:count]))

        shift = float(np.mean(differences))
        number = _FittedNumber.of(shift, _uncertainty_m(self.case, differences - shift))
        text = f"prints {self.name} with {number.text} m added to it"
        return self._mapped("moved", text, made, 1 + number.price)

    def _late(self) -> Iterator[_ColumnMap]:
        for count in _LATE_ROWS:
            if len(self.printed) <= abs(count) or not _is_even(self.case):
                continue
            rows = "one row" if abs(count) == 1 else f"{abs(count)} rows"
            text = f"prints {self.name} {rows} {'late' if count > 0 else 'early'}"
            yield self._mapped("late", text, _always(_late(self.printed, self.true, count)))


def _always(values: Array) -> Callable[[int], Array]:
    """Return the values of a map without numbers, to whatever rows it is fitted."""
    return lambda count: values


def _factor(true: Array, printed: Array) -> float:
    """Return the factor that fits printed = factor * true best."""
    square = float(true @ true)
    return float(true @ printed) / square if square else 0.0


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

    def _factor(self, count: int) -> complex:
        """Return the number that fits printed = factor * true best in the first `count` rows."""
        true = self.true[:count]
        square = np.vdot(true, true)
        return complex(np.vdot(true, self.printed[:count]) / square) if square else 0j

    def _shift(self, count: int) -> complex:
        """Return the number that fits printed = true + number best in the first `count` rows."""
        return complex(np.mean(self.printed[:count] - self.true[:count]))

    def maps(self) -> Iterator[_ColumnMap]:
        """Yield the maps that may have made them."""
        yield self._scaled()
        yield self._turned()
        yield self._moved()
        yield self._scaled_and_turned()
        yield self._similar()

    def _mapped(
        self, word: str, text: str, made: Callable[[int], ComplexArray], price: int
    ) -> _ColumnMap:
        def columns_of(count: int) -> Array:
            plane = made(count)
            return np.column_stack([plane.real, plane.imag])

        return _ColumnMap(f"plane_{word}", text, (0, 1), columns_of, price)

    def _uncertainty(self, plane: ComplexArray) -> float:
        """Return an estimate of the error in m of a map that makes the plane."""
        return _uncertainty_m(self.case, self.printed - plane)

    def _relative_uncertainty(self, plane: ComplexArray) -> float:
        """Return an estimate of the error of a factor with which a map makes the plane."""
        return self._uncertainty(plane) / rms(self.true[:, None])

    def _scaled(self) -> _ColumnMap:
        def made(count: int) -> ComplexArray:
            return self._factor(count).real * self.true

        every = len(self.true)
        scale = self._factor(every).real
        number = _FittedNumber.of(scale, self._relative_uncertainty(made(every)))
        text = f"prints x and y times {number.text}"
        return self._mapped("scaled", text, made, 1 + number.price)

    def _turned(self) -> _ColumnMap:
        def made(count: int) -> ComplexArray:
            return self.true * cmath.exp(1j * cmath.phase(self._factor(count)))

        every = len(self.true)
        turn = cmath.phase(self._factor(every))
        uncertainty = self._relative_uncertainty(made(every))
        radians = _FittedNumber.of(turn, uncertainty)
        degrees = _FittedNumber.of(math.degrees(turn), math.degrees(uncertainty))
        angle = f"{degrees.text}°" if radians.price else f"{radians.text} rad"
        text = f"prints x and y turned {_with_sense(angle)}"
        # the angle is round if it is so in one of the units
        return self._mapped("turned", text, made, 1 + radians.price * degrees.price)

    def _moved(self) -> _ColumnMap:
        def made(count: int) -> ComplexArray:
            return self.true + self._shift(count)

        every = len(self.true)
        shift = self._shift(every)
        uncertainty = self._uncertainty(made(every))
        x = _FittedNumber.of(shift.real, uncertainty)
        y = _FittedNumber.of(shift.imag, uncertainty)
        text = f"prints x and y with {x.text} m and {y.text} m added to them"
        return self._mapped("moved", text, made, 2 + x.price + y.price)

    def _scaled_and_turned(self) -> _ColumnMap:
        def made(count: int) -> ComplexArray:
            return self._factor(count) * self.true

        every = len(self.true)
        factor = self._factor(every)
        uncertainty = self._relative_uncertainty(made(every))
        scale = _FittedNumber.of(abs(factor), uncertainty)
        turn = math.degrees(cmath.phase(factor))
        degrees = _FittedNumber.of(turn, math.degrees(uncertainty))
        scaled = f"prints x and y times {scale.text}"
        text = f"{scaled} and turned {_with_sense(f'{degrees.text}°')}"
        return self._mapped("turned", text, made, 2 + scale.price + degrees.price)

    def _similar(self) -> _ColumnMap:
        """Return the map that scales, turns and moves, with four free numbers."""
        basis = np.column_stack([self.true, np.ones_like(self.true)])

        def made(count: int) -> ComplexArray:
            return np.asarray(basis @ solved(basis[:count], self.printed[:count]))

        factor, shift = solved(basis, self.printed)
        text = (
            f"prints x and y times {abs(factor):.6g}, "
            f"turned {_with_sense(f'{math.degrees(cmath.phase(factor)):.6g}°')}, "
            f"with {shift.real:.6g} m and {shift.imag:.6g} m added"
        )
        return self._mapped("moved", text, made, 8)


def _with_sense(angle: str) -> str:
    """Return an angle and its sense, without a sign."""
    sense = "clockwise" if angle.startswith("-") else "anticlockwise"
    return f"by {angle.removeprefix('-')}, {sense}"


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
    printed = case.rows.positions[:, :2]

    def made(count: int) -> Array:
        return np.asarray(basis @ solved(basis[:count], printed[:count]))

    numbers = solved(basis, printed)
    (a, b, c), (d, e, f) = numbers.T
    x = f"{a:.6g} x {b:+.6g} y {c:+.6g} m"
    y = f"{d:.6g} x {e:+.6g} y {f:+.6g} m"
    text = f"prints a linear map of x and y: {x}, and {y}"
    return _ColumnMap("plane_mapped", text, (0, 1), made, 12)


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
    if not math.isfinite(choice.price):
        return None

    residuals = case.rows.positions - case.truth
    certain: list[Deviation] = []
    doubtful: list[Deviation] = []
    for maps in choice.groups:
        claim = _MapClaim.about(case, maps[0])
        size_m = largest(claim.case.rows.positions - claim.case.truth)
        finding = graded(claim, _reported(maps, size_m), claim.case.error)
        # some map makes any few rows
        if finding is None or not claim.enough_rows():
            return None
        residuals[:, maps[0].columns] = claim.residuals
        if finding.is_convention:
            certain.append(finding)
        else:
            doubtful.append(finding)
    explanation = case.explanation(tuple(doubtful), residuals, int(choice.price))
    return replace(explanation, conventions=(*explanation.conventions, *certain))


def of_evident_columns(case: FileCase) -> Explanation | None:
    """Return the explanation that the file itself shows a constant or copied column; None if it shows none.

    The first row of that column is wrong, while the other columns start at the release, so no motion from the release
    can have made it. The residual is that of the other columns.

    The case has the rows as they are printed.
    """
    starts = np.abs(case.rows.positions[0] - case.truth[0]) <= case.enough
    if case.rows.times[0] != 0 or starts.all() or not starts.any():
        return None
    residuals = case.rows.positions - case.truth
    findings = []
    for index in np.flatnonzero(~starts):
        column = _Column(case, int(index))
        text = column.evident_text(np.flatnonzero(starts))
        if not text:
            return None
        word = "constant" if "constant" in text else "copied"
        findings.append(Deviation(f"column_{word}", text, float(np.abs(residuals[:, index]).max())))
        residuals[:, index] = 0.0
    explanation = case.explanation((), residuals, len(findings))
    return replace(explanation, conventions=(*explanation.conventions, *findings))


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
    deviation = Deviation(first.id, first.text, size_m)
    if first.id == "plane_mapped" or len(maps) > ALTERNATIVES:
        return hedged(deviation)
    if len(maps) == 1:
        return deviation
    return one_of([Alternative(each.id, each.text) for each in maps], size_m)


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
