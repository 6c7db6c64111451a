"""How far a published run and its witness are apart: the bits that they lack to agree, and the errors that follow.

A zero is where a form a·n + b·n' - d vanishes: xdot, or that of a section. Errors of the form move its time. A run
takes the state at the zero that it found, so a column there is off by the run's own error, and by the time's error
times the column's rate. With Δ for errors and λ = v·v + n·F for the tension over l, the rate of the form changes with
the state by at most

    a·|Δv| + λ b·|Δr| + (|b| Ω² + |b·n| (|F| + Ω²)) |Δr| + (|b| w + |b·n| (2 |v| + w)) |Δv|,   w = 2 |Ω| + γ,

to first order, where the acceleration is F - n λ.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ..engines.plan import Run
from ..errors import IntegrationError
from ..model.algebra import add, dot, plus, scale
from ..model.constants import Constants, Vector, is_zero
from ..model.force import acceleration, force
from ..model.sections import Form, form_of
from ..model.start import Start
from ..numbers.columns import GRID, POSITION, STATE, VELOCITY
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, Array, decimals_for, to_fraction
from ..numbers.table import FixedPoint, Table, bits_in, decimals_of, integers, resolved
from ..numbers.zeros import XDOT, Zeros, columns_of
from .pilot import MARGIN_BITS

AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last printed digit
UNKNOWN = 10**9  # the error stated, in SI units, where xdot only grazes zero: as good as unknown
# of the fastest rate's radian: a form's second rate is a difference over it
INSTANT = Fraction("1e-6")
ROUNDED_UP = 1 + 2.0**-40  # far more than the rounding of the binary64 arithmetic here


@dataclass(frozen=True)
class Agreement:
    """How far two runs are apart.

    Attributes:
        missing_bits: that they lack to agree to a quarter of the last digit; 0 if they do agree.
        grid: largest difference in each column of the grid.
        errors: of each column of the grid: twice the difference, or the witness's resolution if there is none.
        zeros: by word, the differences of each zero; None where they are not to be compared.
    """

    missing_bits: int
    grid: dict[str, Fraction]
    errors: dict[str, Fraction]
    zeros: dict[str, Table | None] = field(default_factory=dict)

    @property
    def transit_s(self) -> Fraction | None:
        """The largest difference of a transit's time in s; None where they are not to be compared."""
        transits = self.zeros.get(XDOT)
        return None if transits is None else transits.largest()["t"]

    @classmethod
    def between(cls, published: Run, witness: Run, digits: int) -> Agreement:
        """Compare a run with its witness; the decimals are those that the published one gets.

        Raises:
            IntegrationError: the two runs are the same run.
        """
        states = published.grid.only(GRID)
        gaps = states.distance(witness.grid).largest()
        _check_independent(states, gaps)
        finest = _resolution(published, witness)
        errors = {name: 2 * gap or finest[name] for name, gap in gaps.items()}
        decimals = decimals_of(resolved(states.largest(), gaps), digits)
        missing, apart = [bits_lacking(gaps, decimals)], dict[str, Table | None]()
        tables = {
            word: zeros.table.only(columns_of(word)) for word, zeros in published.zeros.items()
        }
        for word, zeros in published.zeros.items():
            places = zero_decimals(tables, word, decimals, digits)
            lacking, apart[word] = zeros_lacking(
                zeros._replace(table=tables[word]), witness.zeros[word], places, witness
            )
            missing.append(lacking)
        return cls(max(missing), gaps, errors, apart)


def _check_independent(states: Table, gaps: Mapping[str, Fraction]) -> None:
    """Raise unless two runs differ in a column that changes with time.

    A column that does not change, such as y on the equator or everything at rest, may be exact in both. In one that
    does change, a difference of exactly zero comes about by chance, once in 2**16 numbers; in all of them it does not.
    """
    columns = zip(states.columns, zip(*states.values, strict=True), strict=True)
    changing = [name for name, column in columns if len(set(column)) > 1]
    if changing and not any(gaps[name] for name in changing):
        raise IntegrationError(
            "The two runs are the same run: they differ nowhere, so their agreement proves nothing."
        )


def _resolution(published: Run, witness: Run) -> dict[str, Fraction]:
    """Return the last bit of the witness in each column, for columns in which both runs happen to be equal."""
    start = Start.of(published.plan.inputs, DOUBLE_BITS + GUARD_BITS)
    length, largest = published.plan.inputs.length, published.grid.largest()
    swing = to_fraction(start.ctx.sqrt(start.ctx.norm(start.k.pull)))
    speed = max(largest[name] for name in VELOCITY) or length * swing
    sizes = dict.fromkeys(POSITION, length) | dict.fromkeys(VELOCITY, speed)
    return {name: size / 2**witness.plan.number.prec for name, size in sizes.items()}


def zero_decimals(
    tables: Mapping[str, Table], word: str, grid: Mapping[str, int], digits: int
) -> dict[str, int]:
    """Return the digits after the point that a word's zeros are printed with.

    Those of t follow from the latest zero in the same file, those of ax from the largest, the others are the grid's.

    Args:
        tables: the zeros by word.
        word: of the zeros.
        grid: the digits of the columns of the grid.
        digits: significant digits asked for.
    """
    same_file = [table for other, table in tables.items() if (other == XDOT) == (word == XDOT)]
    latest = max(table.largest()["t"] for table in same_file)
    sizes = tables[word].largest() | {"t": latest}
    return {
        name: grid[name] if name in grid else decimals_for(size, digits)
        for name, size in sizes.items()
    }


def bits_lacking(gaps: Mapping[str, Fraction], decimals: Mapping[str, int]) -> int:
    """Return the bits by which a gap exceeds one unit of its last digit, and a margin; 0 if all keep to `AGREEMENT`."""
    largest = max(gap * 10 ** decimals[name] for name, gap in gaps.items())
    return bits_in(largest) + MARGIN_BITS if largest > AGREEMENT else 0


def zeros_lacking(
    published: Zeros[Table], witnessed: Zeros[Table], decimals: Mapping[str, int], witness: Run
) -> tuple[int, Table | None]:
    """Return the bits that a witness lacks to agree on zeros, which are `witnessed` there, and how far these are apart.

    Where directions differ, there are no distances.
    """
    if published.directions != witnessed.directions:
        return witness.plan.number.prec // 2, None
    apart = published.table.distance(witnessed.table)
    return bits_lacking(apart.largest(), decimals), apart


class _Motion(NamedTuple):
    """The motion at the zeros of a form, in SI units and doubles, shape (zeros,).

    Attributes:
        weights: by state column, what of its error the form has.
        slope: size of the form's rate.
        bend: size of its second rate.
        of_error: by state column, what of its error the form's rate has.
        rates: by state column, the size of its rate.
        second_rates: by state column, the size of its second rate.
    """

    weights: dict[str, float]
    slope: Array
    bend: Array
    of_error: dict[str, Array]
    rates: dict[str, Array]
    second_rates: dict[str, Array]


def _motion_at(run: Run, word: str) -> _Motion:
    """Return the motion at the zeros of a word, from the run's own bits.

    In double the height of a small swing would be nothing but rounding.
    """
    table = run.zeros[word].table.only(("t", *STATE))
    bits = table.bits + GUARD_BITS
    start = Start.of(run.plan.inputs, bits)
    form, k = form_of(word, start), start.k.converted(lambda x: FixedPoint.of(x, bits))
    a, b = (
        _vector(0 if is_zero(x) else FixedPoint.of(x, bits) for x in part)
        for part in (form.a, form.b)
    )
    columns = list(zip(*table.values, strict=True)) or [()] * len(table.columns)
    state = [
        FixedPoint.column(integers(column), 1 << table.bits, bits) / k.length
        for column in columns[1:]
    ]
    n, v = _vector(state[:3]), _vector(state[3:])
    step = FixedPoint.of(INSTANT / Fraction(start.fastest_rate), bits)
    acc = acceleration(n, v, k)
    n_later = add(n, scale(step, v))
    v_later = add(v, scale(step, acc))
    acc_later = acceleration(n_later, v_later, k)
    rate = plus(dot(a, v), dot(b, acc))
    rate_later = plus(dot(a, v_later), dot(b, acc_later))
    jerk = [(after - before) / step for before, after in zip(acc, acc_later, strict=True)]

    length = float(start.k.length)
    sizes = [np.abs(_floats(x)) * length for x in (*v, *acc)]
    second_sizes = [np.abs(_floats(x)) * length for x in (*acc, *jerk)]
    return _Motion(
        weights={name: abs(float(x)) for name, x in zip(STATE, (*form.a, *form.b), strict=True)},
        slope=np.abs(_floats(rate)) * length,
        bend=np.abs(_floats((rate_later - rate) / step)) * length,
        of_error=_of_rate(
            form, _vector(map(_floats, n)), _vector(map(_floats, v)), start.k.converted(float)
        ),
        rates=dict(zip(STATE, sizes, strict=True)),
        second_rates=dict(zip(STATE, second_sizes, strict=True)),
    )


def _of_rate(form: Form, n: Vector, v: Vector, k: Constants) -> dict[str, Any]:
    """Return what of an error in each state column a form's rate a·v + b·acc has, at most: see the module's sum."""
    a, b = (_vector(map(float, part)) for part in (form.a, form.b))
    pulled = _vector(np.broadcast_arrays(*force(n, v, k), n[0])[:3])
    square = k.rate**2
    loss = 2 * abs(k.rate) + k.drag
    size, aside = float(_norm(b)), abs(dot(b, n))
    tight = abs(dot(v, v) + dot(n, pulled))
    of_position = size * square + aside * (_norm(pulled) + square)
    of_velocity = size * loss + aside * (2 * _norm(v) + loss)
    of_places = {
        name: tight * abs(part) + of_position for name, part in zip(POSITION, b, strict=True)
    }
    return of_places | {
        name: abs(part) + of_velocity for name, part in zip(VELOCITY, a, strict=True)
    }


def with_zero_errors(
    run: Run, errors: Mapping[str, Fraction], word: str, apart: Table | None
) -> Table:
    """Return the columns that are printed of a word's zeros in a run, with the error of each number.

    With the form's error e, its rate f, off by at most f_e, and its second rate g, a zero is late by at most the
    smaller root of (|f| - f_e - g late) late = e. If there is no root, the error is unknown.

    Args:
        run: the run.
        errors: those of its columns on the grid.
        word: of the zeros.
        apart: differences of its zeros from another run's: no error is less than twice that.
    """
    zeros, power = run.zeros[word].table, bits_in(max(errors.values()))
    motion = _motion_at(run, word)
    # errors are in units of 2**power, as doubles may not hold them; a step's polynomial has errors of its own
    parts: dict[str, Any] = {
        name: float(size / Fraction(2) ** power) for name, size in errors.items()
    }
    for name in STATE if zeros.errors else ():
        parts[name] = parts[name] + _in_units(
            [int(x * 2**zeros.bits) for x in zeros.bound(name)], zeros.bits + power
        )
    form_error = sum(parts[name] * motion.weights[name] for name in STATE)
    rate_error = sum(parts[name] * motion.of_error[name] for name in STATE)

    slope = motion.slope - np.ldexp(rate_error, power)
    room = slope**2 - 4 * motion.bend * np.ldexp(form_error, power)
    has_root = (slope > 0) & (room >= 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        late = 2 * form_error / (slope + np.sqrt(room))
    late = np.where(has_root, late, 0.0) + np.ldexp(zeros["t"], -run.plan.number.prec - power)

    columns = {"t": late, "ax": rate_error + motion.bend * late}
    for name in STATE:
        moved = motion.rates[name] + motion.second_rates[name] * np.ldexp(late, power)
        columns[name] = parts[name] + moved * late
    table = zeros.only(columns_of(word))
    known = {name: np.where(has_root, columns[name], np.inf) for name in table.columns}
    return _with_errors(table, known, power, apart)


def _with_errors(table: Table, columns: dict[str, Array], power: int, apart: Table | None) -> Table:
    """Return a table with errors in units of 2**power, none less than twice the distance from another run's."""
    for i, name in enumerate(table.columns):
        if apart is not None:
            least = _in_units([2 * row[i] for row in apart.values], apart.bits + power)
            columns[name] = np.maximum(columns[name], least)
    fixed = [_fixed(columns[name] * ROUNDED_UP, power, table.bits) for name in table.columns]
    return Table(table.columns, table.bits, table.values, list(zip(*fixed, strict=True)))


def _floats(numbers: FixedPoint) -> Array:
    return np.array([float(x) for x in numbers.fractions()], dtype=np.float64)


def _in_units(values: list[int], bits: int) -> Array:
    """Return integers over 2**bits as doubles."""
    top, bottom = max(0, -bits), 1 << max(0, bits)
    return np.array([(value << top) / bottom for value in values], dtype=np.float64)


def _vector(parts: Iterable[Any]) -> Vector:
    x, y, z = parts
    return x, y, z


def _norm(vector: Vector) -> Any:
    return np.sqrt(dot(vector, vector))


def _fixed(column: Array, power: int, bits: int) -> list[int]:
    """Return numbers in units of 2**power as integers over 2**bits, rounded up; what is not finite is `UNKNOWN`."""
    mantissas, exponents = np.frexp(np.where(np.isfinite(column), column, 0.0))
    wholes = np.ldexp(mantissas, DOUBLE_BITS).astype(np.int64).tolist()
    shifts = (exponents + (power + bits - DOUBLE_BITS)).tolist()
    return [
        (whole << shift if shift >= 0 else -(-whole >> -shift)) if finite else UNKNOWN << bits
        for whole, shift, finite in zip(wholes, shifts, np.isfinite(column).tolist(), strict=True)
    ]
