"""Which column stands where: the words of a header, or of `--columns`, resolved to columns with their units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

from .candidate import COLUMNS, Convention
from .names import Meaning, meaning, unquoted
from .units import defaults

SKIPPED = ("-", "_", "")  # words for a column that is not read
FOUCPEND = 10  # columns of the paper's program: t x y z X Y Z φ λ speed
UNNAMED = {3: ("t", "x", "y"), 4: ("t", "x", "y", "z"), 7: ("t", *COLUMNS), FOUCPEND: ("t", "x", "y", "z")}


@dataclass(frozen=True)
class Naming:
    """Hold the names and units that a user gives to the columns of a file.

    Attributes:
        columns: their names in order, as in a header, `-` for one that is not read; empty if the file says it.
        units: of times and lengths where the names give none, such as ms or cm.
    """

    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse units that are not known."""
        defaults(self.units)


@dataclass(frozen=True)
class Layout:
    """Where each column stands.

    Attributes:
        places: index of each column that is read, in the order t, x, y, z, vx, vy, vz.
        factors: by which a column's numbers come to SI units, east, north and up; only where it is not 1.
        conventions: what is not plain about it.
    """

    places: dict[str, int]
    factors: dict[str, Fraction] = field(default_factory=dict)
    conventions: tuple[Convention, ...] = ()

    def converted(self, columns: dict[str, Array], low: dict[str, Array]) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return columns and their low parts in SI units."""
        columns, low = dict(columns), dict(low)
        for name, factor in self.factors.items():
            if name in low:
                columns[name], low[name] = _scaled(columns[name], low[name], factor)
            elif name in columns:
                columns[name] = columns[name] * float(factor.numerator) / float(factor.denominator)
        return columns, low


def _scaled(near: Array, low: Array, factor: Fraction) -> tuple[Array, Array]:
    """Multiply doubles with low parts; what is not finite, and will be refused, stays as it is."""
    scaled, rest = near.copy(), np.zeros_like(low)
    for i in np.flatnonzero(np.isfinite(near)).tolist():
        exact = (Fraction(float(near[i])) + Fraction(float(low[i]))) * factor
        scaled[i] = float(exact)
        rest[i] = float(exact - Fraction(float(scaled[i])))
    return scaled, rest


def layout(
    words: Sequence[str], needed: Sequence[str], optional: Sequence[str], units: tuple[str, ...], where: str
) -> Layout:
    """Resolve the words of a header.

    Args:
        words: one for each column of the file.
        needed: columns that must be among them.
        optional: columns that are read if they are there.
        units: as in `Naming`.
        where: the header's name in messages.

    Raises:
        InputError: a column is missing or there twice, or its unit is not known.
    """
    of_units = defaults(units)
    known = [*needed, *optional]
    meanings = [meaning(word, of_units) for word in words]
    places: dict[str, int] = {}
    for name in known:
        found = [(one.rank, i) for i, one in enumerate(meanings) if one is not None and one.column == name]
        best = [i for rank, i in found if rank == min(found)[0]]
        if len(best) > 1:
            same = ", ".join(words[i].strip() for i in best)
            raise InputError(where, same, f"one column {name}", "Say with --columns which one it is.")
        if best:
            places[name] = best[0]
        elif name in needed:
            got = f"no {name} in {', '.join(word.strip() for word in words)[:80]}"
            raise InputError(where, got, f"one column {name}", advice(needed, optional))
    chosen = {name: one for name, i in places.items() if (one := meanings[i]) is not None}
    for name, one in chosen.items():
        if one.factor is None:
            field = f"{where}: {words[places[name]].strip()}"
            raise InputError(field, one.unit, f"a unit of {name} that is known", "Write s, m or m/s.")
    factors = {name: one.factor for name, one in chosen.items() if one.factor is not None and one.factor != 1}
    return Layout(places, factors, tuple(_conventions(words, places, chosen)))


def unnamed(count: int, needed: Sequence[str]) -> tuple[str, ...] | None:
    """Return the names of the columns of a file without a header, by their number; None if it does not tell them."""
    if count == len(needed) == 1:
        return tuple(needed)
    names = UNNAMED.get(count)
    return None if names is None or len(needed) == 1 else (*names, *[""] * (count - len(names)))


def guessed(names: Sequence[str]) -> Convention:
    """Return what is said where names were taken from the number of columns."""
    read = ", ".join(name for name in names if name)
    return Convention("no_header", f"no header: the columns are taken as {read} (--columns names others)")


def advice(needed: Sequence[str], optional: Sequence[str]) -> str:
    """Return what a header has to name."""
    more = f" and, if there, {', '.join(optional)}" if optional else ""
    return f"The first line names the columns: {', '.join(needed)}{more}; or --columns does."


def _conventions(words: Sequence[str], places: dict[str, int], chosen: dict[str, Meaning]) -> list[Convention]:
    said = []
    renamed = [
        f"{unquoted(words[i])} as {_signed(chosen[name])}" for name, i in places.items() if chosen[name].rank == 2
    ]
    if renamed:
        others = [unquoted(word) for i, word in enumerate(words) if i not in places.values()]
        others = [word for word in others if word not in SKIPPED]
        left = f"; not read: {', '.join(others)}" if others else ""
        said.append(Convention("columns", f"{', '.join(renamed)}{left}"))
    units = [f"{name} from {one.unit}" for name, one in chosen.items() if abs(one.factor or 1) != 1]
    if units:
        said.append(Convention("units", f"{', '.join(units)}, converted to SI units"))
    return said


def _signed(one: Meaning) -> str:
    return f"-{one.column}" if one.factor is not None and one.factor < 0 else one.column
