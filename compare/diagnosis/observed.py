"""The observation: how a motion became the columns of a file. Maps are fitted to a right program's motion.

A column may be a copy of another one, a constant, mirrored, scaled, moved, or some rows late; the horizontal axes may
be scaled, turned or moved together. Each map is run forwards: what it makes of the truth is compared with the file.
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
from .thresholds import ALTERNATIVES, RIVAL, ROWS_A_NUMBER

LATE_ROWS = (1, -1, 2, -2)  # by which a column may be late
PRINTED_DIGITS = 10  # of a fitted number at most


@dataclass(frozen=True)
class ColumnMap:
    """What a named map makes of the truth.

    Attributes:
        id: a stable word.
        text: the end of the sentence "Your file …".
        columns: numbers of the columns that it makes.
        made: these columns in m, shape (rows, columns).
        price: one, and one more for each number that nobody typed.
    """

    id: str
    text: str
    columns: tuple[int, ...]
    made: Array
    price: int = 1

    def left(self, case: FileCase) -> Array:
        """Return what it leaves of its columns in m."""
        return np.asarray(case.rows.positions[:, self.columns] - self.made)


def number(value: float, doubt: float) -> tuple[str, int]:
    """Return a fitted number to the digits that are known, and its price: nothing if somebody may have typed it."""
    decimal, _ = shortest_decimal(value, doubt)
    return f"{decimal:.{PRINTED_DIGITS}g}", int(not has_few_digits(value, doubt))


def maps_of_column(case: FileCase, column: int) -> Iterator[ColumnMap]:
    """Yield the maps that may have made a column of the file."""
    printed = case.rows.positions[:, column]
    names = "xyz"[: case.truth.shape[1]]
    name, true = names[column], case.truth[:, column]

    def mapped(word: str, text: str, made: Array, price: int = 1) -> ColumnMap:
        return ColumnMap(f"column_{word}", text, (column,), made.reshape(-1, 1), price)

    level = float(np.mean(printed))
    if np.ptp(printed) <= case.resolution:
        constant = np.full_like(printed, level)
        yield mapped(
            "constant", f"prints {name} as a constant, {level:.{PRINTED_DIGITS}g}", constant
        )
    for other, sign in ((k, s) for k in range(len(names)) if k != column for s in (1, -1)):
        what = f"{'−' if sign < 0 else ''}{names[other]}"
        text = f"prints {what} in its column of {name}"
        yield mapped("copied", text, sign * case.truth[:, other])
    yield mapped("mirrored", f"prints −{name} in its column of {name}", -true)
    square = float(true @ true)
    factor = float(true @ printed) / square if square else 0.0
    size = rms(true[:, None])
    # a constant and a mirrored column have words of their own
    if min(abs(factor), abs(factor + 1)) * size > RIVAL * case.resolution:
        text, price = number(factor, _doubt(case, printed - factor * true) / size)
        yield mapped("scaled", f"prints {name} times {text}", factor * true, 1 + price)
    shift = float(np.mean(printed - true))
    text, price = number(shift, _doubt(case, printed - true - shift))
    yield mapped("moved", f"prints {name} with {text} m added to it", true + shift, 1 + price)
    for rows in LATE_ROWS:
        if len(printed) <= abs(rows) or not _is_even(case):
            continue
        made = printed.copy()  # of rows beyond the ends nothing is known
        if rows > 0:
            made[rows:] = true[:-rows]
        else:
            made[:rows] = true[-rows:]
        count = "one row" if abs(rows) == 1 else f"{abs(rows)} rows"
        way = "late" if rows > 0 else "early"
        yield mapped("late", f"prints {name} {count} {way}", made)


def maps_of_plane(case: FileCase) -> Iterator[ColumnMap]:
    """Yield the maps that may have made x and y together."""
    printed = case.rows.positions[:, :2] @ np.array([1, 1j])
    true = case.truth[:, :2] @ np.array([1, 1j])
    size = rms(true[:, None])
    if not size > 0:
        return

    def mapped(word: str, text: str, made: Array, price: int) -> ColumnMap:
        return ColumnMap(
            f"plane_{word}", text, (0, 1), np.column_stack([made.real, made.imag]), price
        )

    factor = complex(np.vdot(true, printed) / np.vdot(true, true))
    scale = factor.real
    text, price = number(scale, _doubt(case, printed - scale * true) / size)
    yield mapped("scaled", f"prints x and y times {text}", scale * true, 1 + price)
    turn = cmath.phase(factor)
    turned = true * cmath.exp(1j * turn)
    doubt = _doubt(case, printed - turned) / size
    text, price = number(turn, doubt)
    degrees, in_degrees = number(math.degrees(turn), math.degrees(doubt))
    text = f"{degrees} degrees" if price else f"{text} rad"
    price *= in_degrees
    yield mapped("turned", f"prints x and y turned by {text}, anticlockwise", turned, 1 + price)
    shift = complex(np.mean(printed - true))
    doubt = _doubt(case, printed - true - shift)
    (x, x_price), (y, y_price) = number(shift.real, doubt), number(shift.imag, doubt)
    text = f"prints x and y with {x} m and {y} m added to them"
    yield mapped("moved", text, true + shift, 2 + x_price + y_price)
    both = factor * true
    doubt = _doubt(case, printed - both) / size
    (scale_text, first), (turn_text, second) = (
        number(abs(factor), doubt),
        number(math.degrees(turn), math.degrees(doubt)),
    )
    text = f"prints x and y times {scale_text} and turned by {turn_text} degrees, anticlockwise"
    yield mapped("turned", text, both, 2 + first + second)
    factor, shift = solved(np.column_stack([true, np.ones_like(true)]), printed)
    text = (
        f"prints x and y times {abs(factor):.6g}, turned by {math.degrees(cmath.phase(factor)):.6g} degrees, "
        f"with {shift.real:.6g} m and {shift.imag:.6g} m added"
    )
    yield mapped("moved", text, factor * true + shift, 8)


def general_map(case: FileCase) -> ColumnMap:
    """Return the linear map of x and y, with six free numbers."""
    basis = np.column_stack([case.truth[:, :2], np.ones(len(case.truth))])
    numbers = solved(basis, case.rows.positions[:, :2])
    (a, b, c), (d, e, f) = numbers.T
    text = f"prints a linear map of x and y: {a:.6g} x {b:+.6g} y {c:+.6g} m, and {d:.6g} x {e:+.6g} y {f:+.6g} m"
    return ColumnMap("plane_mapped", text, (0, 1), basis @ numbers, 12)


def of_observation(case: FileCase) -> Explanation | None:
    """Return how the columns of a file were made of a right program's; None if no map makes them.

    The case has the rows as they are printed.
    """
    errors = np.abs(case.rows.positions - case.truth).max(axis=0)
    wrong = [column for column, error in enumerate(errors) if error > case.enough]
    spans = float(case.rows.times[-1]) * case.frequency >= 2 * math.pi
    if not wrong or not spans:
        return None
    chosen: list[list[ColumnMap]] = []
    for column in wrong:
        chosen.append(_best(case, list(maps_of_column(case, column))))
    apart = sum(maps[0].price for maps in chosen if maps) if all(chosen) else math.inf
    if {0, 1} <= {*wrong}:
        beside = [maps for column, maps in zip(wrong, chosen, strict=True) if column > 1]
        together = _best(case, list(maps_of_plane(case))) or _best(case, [general_map(case)])
        others = sum(maps[0].price for maps in beside if maps) if all(beside) else math.inf
        if together and together[0].price + others < apart:
            chosen, apart = [together, *beside], together[0].price + others
    if not math.isfinite(apart) or ROWS_A_NUMBER * apart > len(case.rows.times):
        return None
    left = case.rows.positions - case.truth
    certain: list[Deviation] = []
    doubtful: list[Deviation] = []
    for maps in chosen:
        columns = maps[0].columns
        size_m = largest(case.rows.positions[:, columns] - case.truth[:, columns])
        left[:, columns] = maps[0].left(case)
        deviation = _said(maps, size_m)
        (doubtful if deviation.stage else certain).append(deviation)
    explanation = case.explanation(tuple(doubtful), largest(left), rms(left), int(apart))
    conventions = (*explanation.conventions, *certain)
    return replace(explanation, conventions=conventions)


def _said(maps: Sequence[ColumnMap], size_m: float) -> Deviation:
    """Return what is said of maps that make the same columns."""
    first = maps[0]
    if first.id == "plane_mapped" or len(maps) > ALTERNATIVES:
        text = f"looks like one that {first.text}"
        return Deviation(f"{AS_IF}.{first.id}", text, size_m, AS_IF)
    if len(maps) == 1:
        return Deviation(first.id, first.text, size_m)
    ids = "|".join(one.id for one in maps)
    return Deviation(ids, f"either {', or '.join(one.text for one in maps)}", size_m, EITHER)


def _best(case: FileCase, maps: Sequence[ColumnMap]) -> list[ColumnMap]:
    """Return the cheapest of the maps that make their columns, and those that cost and leave about as much."""
    sizes = [max(rms(one.left(case)), case.resolution) for one in maps]
    least = min(sizes, default=math.inf)
    near = [
        one
        for one, size in zip(maps, sizes, strict=True)
        if size <= RIVAL * least and np.abs(one.left(case)).max() <= case.enough
    ]
    price = min((one.price for one in near), default=0)
    return [one for one in near if one.price == price]


def _doubt(case: FileCase, left: Array) -> float:
    """Return what may be the error of a mean: the residual in m, or the rounding."""
    return max(rms(left[:, None]), case.resolution)


def _is_even(case: FileCase) -> bool:
    """Return whether the rows are one step of the clock apart."""
    steps = np.diff(case.rows.times)
    return bool(np.ptp(steps) <= 1e-6 * steps[0])
