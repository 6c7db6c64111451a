"""How far a published run and its witness are apart: the bits that they lack to agree, and the errors that follow.

The errors of transits are those of the time, where xdot's error moves the zero, and of the state, taken at that time.
A run takes the state at the zero that it found. So a column there is off by the run's own error, and by the time's
error times the column's rate. With Δ for errors, λ = v·v + n·F for the tension over l, and n_x = x/l, the acceleration
ax = F_x - n_x λ changes with the state by at most

    |Δax| <= λ |Δx| + (Ω² + |n_x| (|F| + Ω²)) |Δr| + (w + |n_x| (2 |v| + w)) |Δv|,   w = 2 |Ω| + γ,

to first order; with the rates in the place of the errors the same sum bounds the rate of ax.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from ..engines.plan import Run
from ..errors import IntegrationError
from ..model.algebra import add, dot, plus, scale
from ..model.constants import Vector, is_zero
from ..model.force import acceleration, force
from ..model.sections import form_of
from ..model.start import Start
from ..numbers.columns import GRID, POSITION, SECTION, STATE, TRANSITS, VELOCITY
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, Array, decimals_for, to_fraction
from ..numbers.table import FixedPoint, Table, bits_in, decimals_of, integers, resolved
from .pilot import MARGIN_BITS

AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last printed digit
UNKNOWN = 10**9  # the error stated, in SI units, where xdot only grazes zero: as good as unknown
INSTANT = Fraction("1e-6")  # of the fastest rate's radian: a form's second rate is a difference over it
Zeros = tuple[Table, list[int]]  # of xdot or of a section: a row for each, and its direction
ROUNDED_UP = 1 + 2.0**-40  # far more than the rounding of the binary64 arithmetic here


@dataclass(frozen=True)
class Agreement:
    """How far two runs are apart.

    Attributes:
        missing_bits: that they lack to agree to a quarter of the last digit; 0 if they do agree.
        grid: largest difference in each column of the grid.
        transits: differences of each transit; None where they are not to be compared.
        errors: of each column of the grid: twice the difference, or the witness's resolution if there is none.
        sections: the same of the passages of each section.
    """

    missing_bits: int
    grid: dict[str, Fraction]
    transits: Table | None
    errors: dict[str, Fraction]
    sections: dict[str, Table | None] = field(default_factory=dict)

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
        missing, transits, sections = [bits_lacking(gaps, decimals)], None, {}
        if published.transits is not None and witness.transits is not None:
            table = published.transits.only(TRANSITS)
            same = {name: places for name, places in decimals.items() if name in TRANSITS}
            zeros, witnessed = (table, published.directions), (witness.transits, witness.directions)
            lacking, transits = zeros_lacking(zeros, witnessed, decimals_of(table.largest(), digits) | same, witness)
            missing.append(lacking)
        latest = max((table.largest()["t"] for table, _ in published.passages.values()), default=Fraction(0))
        decimals = {"t": decimals_for(latest, digits), **decimals}
        for word, passages in published.passages.items():
            lacking, sections[word] = zeros_lacking(passages, witness.passages[word], decimals, witness)
            missing.append(lacking)
        return cls(max(missing), gaps, transits, errors, sections)


def _check_independent(states: Table, gaps: Mapping[str, Fraction]) -> None:
    """Raise unless two runs differ in a column that changes with time.

    A column that does not change, such as y on the equator or everything at rest, may be exact in both. In one that
    does change, a difference of exactly zero comes about by chance, once in 2**16 numbers; in all of them it does not.
    """
    columns = zip(states.columns, zip(*states.values, strict=True), strict=True)
    changing = [name for name, column in columns if len(set(column)) > 1]
    if changing and not any(gaps[name] for name in changing):
        raise IntegrationError("The two runs are the same run: they differ nowhere, so their agreement proves nothing.")


def _resolution(published: Run, witness: Run) -> dict[str, Fraction]:
    """Return the last bit of the witness in each column, for columns in which both runs happen to be equal."""
    start = Start.of(published.plan.inputs, DOUBLE_BITS + GUARD_BITS)
    length, largest = published.plan.inputs.length, published.grid.largest()
    swing = to_fraction(start.ctx.sqrt(start.ctx.norm(start.k.pull)))
    speed = max(largest[name] for name in VELOCITY) or length * swing
    sizes = dict.fromkeys(POSITION, length) | dict.fromkeys(VELOCITY, speed)
    return {name: size / 2**witness.plan.number.prec for name, size in sizes.items()}


def bits_lacking(gaps: Mapping[str, Fraction], decimals: Mapping[str, int]) -> int:
    """Return the bits by which a gap exceeds one unit of its last digit, and a margin; 0 if all keep to `AGREEMENT`."""
    largest = max(gap * 10 ** decimals[name] for name, gap in gaps.items())
    return bits_in(largest) + MARGIN_BITS if largest > AGREEMENT else 0


def zeros_lacking(
    published: Zeros, witnessed: Zeros, decimals: Mapping[str, int], witness: Run
) -> tuple[int, Table | None]:
    """Return the bits that a witness lacks to agree on zeros, which are `witnessed` there, and how far these are apart.

    Where directions differ, there are no distances.
    """
    (table, directions), (seen, signs) = published, witnessed
    if directions != signs:
        return witness.plan.number.prec // 2, None
    apart = table.distance(seen)
    return bits_lacking(apart.largest(), decimals), apart


def with_passage_errors(run: Run, errors: Mapping[str, Fraction], word: str, apart: Table | None) -> Table:
    """Return a section's passages in a run with the errors of each number, as `with_transit_errors` does for transits.

    With the form's error e, its rate f and its second rate g, the time is off by at most 2 e/f where g (2 e/f) is far
    below f. These are computed in the run's own bits: in double the height of a small swing is nothing but rounding.
    Velocities come from the rates of a step's polynomials here, and are off by what these lack, too.
    """
    table, _ = run.passages[word]
    bits, rows = table.bits + GUARD_BITS, list(zip(*table.values, strict=True)) or [()] * len(SECTION)
    start = Start.of(run.plan.inputs, bits)
    form, k = form_of(word, start), start.k.converted(lambda x: FixedPoint.of(x, bits))
    a, b = (_vector(0 if is_zero(x) else FixedPoint.of(x, bits) for x in part) for part in (form.a, form.b))
    state = [FixedPoint.column(integers(column), 1 << table.bits, bits) / k.length for column in rows[1:]]
    n, v, step = _vector(state[:3]), _vector(state[3:]), FixedPoint.of(INSTANT / Fraction(start.fastest_rate), bits)
    acc = acceleration(n, v, k)
    later = acceleration(add(n, scale(step, v)), add(v, scale(step, acc)), k)
    f, after = plus(dot(a, v), dot(b, acc)), plus(dot(a, add(v, scale(step, acc))), dot(b, later))
    power, length = bits_in(max(errors.values())), float(start.k.length)
    parts = {name: float(size / Fraction(2) ** power) for name, size in errors.items()}
    lost = {name: _in_units([row[i] for row in table.errors], table.bits + power) for i, name in enumerate(SECTION)}
    weights = {name: abs(float(x)) for name, x in zip(STATE, (*form.a, *form.b), strict=True)}
    off: Any = sum(parts[name] * weight for name, weight in weights.items())
    off = off + sum(lost[name] * weights[name] for name in VELOCITY)
    slope, bend = (np.abs(_floats(x)) * length for x in (f, (after - f) / step))
    with np.errstate(divide="ignore", invalid="ignore"):
        late = 2 * off / slope
        late = np.where(bend * np.ldexp(late, power) <= slope / 4, late, np.inf)
        late += np.ldexp(table["t"], -run.plan.number.prec - power)
        rates = dict(zip(STATE, (*v, *acc), strict=True))
        columns = {"t": late} | {
            name: parts[name] + lost[name] + np.abs(_floats(rates[name])) * length * late for name in STATE
        }
    return _with_errors(table, columns, power, apart)


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


def with_transit_errors(run: Run, errors: Mapping[str, Fraction], apart: Table | None) -> Table:
    """Return `columns.TRANSITS` of a run, which has transits, with the errors of each number.

    Args:
        run: the run.
        errors: those of its columns on the grid.
        apart: differences of its transits from another run's: no error is less than twice that.
    """
    table, power = run.transits, bits_in(max(errors.values()))
    assert table is not None
    parts = {name: float(size / Fraction(2) ** power) for name, size in errors.items()}
    k = Start.of(run.plan.inputs, DOUBLE_BITS + GUARD_BITS).k.converted(float)
    n, v = (_vector(table[name] / k.length for name in kind) for kind in (POSITION, VELOCITY))
    pulled, a = (_vector(np.broadcast_arrays(*of(n, v, k), n[0])[:3]) for of in (force, acceleration))
    square, loss, aside = k.rate**2, 2 * abs(k.rate) + k.drag, abs(n[0])
    of_x = abs(dot(v, v) + dot(n, pulled))
    of_position = square + aside * (_norm(pulled) + square)
    of_velocity = loss + aside * (2 * _norm(v) + loss)

    ax = abs(a[0]) * k.length
    ax_error = of_x * parts["x"]
    ax_error += of_position * sum(parts[name] for name in POSITION)
    ax_error += of_velocity * sum(parts[name] for name in VELOCITY)
    jerk = (of_x * abs(v[0]) + of_position * _norm(v) + of_velocity * _norm(a)) * k.length

    # at the zero xdot's error e is at most (slope - jerk late) late: the smaller root, if there is one
    slope = ax - np.ldexp(ax_error, power)
    room = slope**2 - 4 * jerk * np.ldexp(parts["vx"], power)
    has_root = (slope > 0) & (room >= 0)
    late = np.zeros(len(table))
    late[has_root] = 2 * parts["vx"] / (slope[has_root] + np.sqrt(room[has_root]))
    late += np.ldexp(table["t"], -run.plan.number.prec - power)
    columns = {"t": late, "x": parts["x"] + ax * np.ldexp(late, power) * late, "ax": ax_error + jerk * late}
    for name, rate in (("y", v[1]), ("z", v[2]), ("vy", a[1])):
        columns[name] = parts[name] + abs(rate) * k.length * late
    columns = {name: np.where(has_root, column, np.inf) for name, column in columns.items()}
    return _with_errors(table.only(TRANSITS), columns, power, apart)


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
