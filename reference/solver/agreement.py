"""Compare a published run with its witness: the bits they lack to agree, and the errors to state.

A zero is where a form a·n + b·n' - d vanishes: xdot, or that of a section. Errors of the form move
its time. A run takes the state at the zero that it found, so a column there is off by the run's own
error, and by the time's error times the column's rate. With Δ for errors and λ = v·v + n·F for the
tension over l, the rate of the form changes with the state by at most

    a·|Δv| + λ b·|Δr| + (|b| Ω² + |b·n| (|F| + Ω²)) |Δr| + (|b| w + |b·n| (2 |v| + w)) |Δv|,   w = 2
    |Ω| + γ,

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

_AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last printed digit
_UNKNOWN = 10**9  # the error stated, in SI units, where xdot only grazes zero: as good as unknown
# of the fastest rate's radian: a form's second rate is a difference over it
_INSTANT = Fraction("1e-6")
_ROUNDED_UP = 1 + 2.0**-40  # far more than the rounding of the binary64 arithmetic here


@dataclass(frozen=True)
class Agreement:
    """How far two runs are apart.

    Attributes:
        missing_bits: bits that they lack to agree to a quarter of the last digit; 0 if they do
            agree.
        grid: largest difference in each column of the grid.
        errors: estimated error of each column of the grid: twice the difference, or the witness's
            resolution if there is none.
        zeros: by word, the differences of each zero; None where they are not to be compared.
    """

    missing_bits: int
    grid: dict[str, Fraction]
    errors: dict[str, Fraction]
    zeros: dict[str, Table | None] = field(default_factory=dict)

    @property
    def transit_s(self) -> Fraction | None:
        """The largest difference of a transit's time in s; None where they cannot be compared."""
        transits = self.zeros.get(XDOT)
        return None if transits is None else transits.largest()["t"]

    @classmethod
    def between(cls, published: Run, witness: Run, digits: int) -> Agreement:
        """Compare a run with its witness, in the decimals that the published one gets.

        Raises:
            IntegrationError: the two runs are the same run.
        """
        states = published.grid.only(GRID)
        differences = states.distance(witness.grid).largest()
        _check_independent(states, differences)
        resolution = _resolution(published, witness)
        errors = {name: 2 * gap or resolution[name] for name, gap in differences.items()}
        decimals = decimals_of(resolved(states.largest(), differences), digits)
        missing = [bits_lacking(differences, decimals)]

        tables = {}
        for word, zeros in published.zeros.items():
            tables[word] = zeros.table.only(columns_of(word))
        zero_differences: dict[str, Table | None] = {}
        for word, zeros in published.zeros.items():
            lacking, zero_differences[word] = zeros_lacking(
                zeros._replace(table=tables[word]),
                witness.zeros[word],
                zero_decimals(tables, word, decimals, digits),
                witness,
            )
            missing.append(lacking)
        return cls(max(missing), differences, errors, zero_differences)


def _check_independent(states: Table, differences: Mapping[str, Fraction]) -> None:
    """Raise unless two runs differ in a column that changes with time.

    A column that does not change, such as y on the equator or everything at rest, may be exact in
    both. In one that does change, a difference of exactly zero comes about by chance, once in 2**16
    numbers; in all of them it does not.
    """
    columns = zip(states.columns, zip(*states.values, strict=True), strict=True)
    changing = [name for name, column in columns if len(set(column)) > 1]
    if changing and not any(differences[name] for name in changing):
        raise IntegrationError(
            "Both runs gave the same numbers throughout, so their agreement proves nothing."
        )


def _resolution(published: Run, witness: Run) -> dict[str, Fraction]:
    """Return the last bit of the witness in each column, for those in which both runs are equal."""
    inputs = published.plan.inputs
    start = Start.of(inputs, DOUBLE_BITS + GUARD_BITS)
    swing_rate = to_fraction(start.ctx.sqrt(start.ctx.norm(start.k.pull)))
    largest = published.grid.largest()
    speed = max(largest[name] for name in VELOCITY) or inputs.length * swing_rate
    sizes = dict.fromkeys(POSITION, inputs.length) | dict.fromkeys(VELOCITY, speed)
    return {name: size / 2**witness.plan.number.prec for name, size in sizes.items()}


def zero_decimals(
    tables: Mapping[str, Table], word: str, grid: Mapping[str, int], digits: int
) -> dict[str, int]:
    """Return the digits after the point that a word's zeros are printed with.

    Those of t follow from the latest zero in the same file, those of ax from the largest, the
    others are the grid's.

    Args:
        tables: the zeros by word.
        word: of the zeros.
        grid: the digits of the columns of the grid.
        digits: significant digits asked for.
    """
    in_transits = word == XDOT
    same_file = [table for other, table in tables.items() if (other == XDOT) == in_transits]
    latest = max(table.largest()["t"] for table in same_file)
    sizes = tables[word].largest() | {"t": latest}
    decimals = {}
    for name, size in sizes.items():
        decimals[name] = grid[name] if name in grid else decimals_for(size, digits)
    return decimals


def bits_lacking(differences: Mapping[str, Fraction], decimals: Mapping[str, int]) -> int:
    """Return the bits by which a difference exceeds one unit of its last digit, and a margin.

    0 if every difference is within `_AGREEMENT`.
    """
    largest = max(gap * 10 ** decimals[name] for name, gap in differences.items())
    return bits_in(largest) + MARGIN_BITS if largest > _AGREEMENT else 0


def zeros_lacking(
    published: Zeros[Table], witnessed: Zeros[Table], decimals: Mapping[str, int], witness: Run
) -> tuple[int, Table | None]:
    """Return the bits that a witness lacks to agree on zeros, and the differences of each.

    `witnessed` are the witness's zeros. Where directions differ, there are no differences.
    """
    if published.directions != witnessed.directions:
        return witness.plan.number.prec // 2, None
    differences = published.table.distance(witnessed.table)
    return bits_lacking(differences.largest(), decimals), differences


class _Motion(NamedTuple):
    """The motion at the zeros of a form, in SI units and doubles, shape (zeros,).

    Attributes:
        form_weights: by state column, how much an error of it changes the form.
        rate_weights: by state column, how much an error of it changes the form's rate, at most.
        slope: size of the form's rate.
        bend: size of its second rate.
        rates: by state column, the size of its rate.
        second_rates: by state column, the size of its second rate.
    """

    form_weights: dict[str, float]
    rate_weights: dict[str, Array]
    slope: Array
    bend: Array
    rates: dict[str, Array]
    second_rates: dict[str, Array]


def _motion_at(run: Run, word: str) -> _Motion:
    """Return the motion at the zeros of a word, from the run's own bits.

    In double the height of a small swing would be nothing but rounding.
    """
    table = run.zeros[word].table.only(("t", *STATE))
    # many names, as each step is one quantity of the motion
    bits = table.bits + GUARD_BITS
    start = Start.of(run.plan.inputs, bits)
    form = form_of(word, start)
    k = start.k.converted(lambda x: FixedPoint.of(x, bits))
    a = _fixed_vector(form.a, bits)
    b = _fixed_vector(form.b, bits)
    n, v = _states_over_length(table, k, bits)
    acc = acceleration(n, v, k)
    rate = plus(dot(a, v), dot(b, acc))

    # second rates are differences over a short time, to first order
    step = FixedPoint.of(_INSTANT / Fraction(start.fastest_rate), bits)
    n_later = add(n, scale(step, v))
    v_later = add(v, scale(step, acc))
    acc_later = acceleration(n_later, v_later, k)
    rate_later = plus(dot(a, v_later), dot(b, acc_later))
    jerk = [(after - before) / step for before, after in zip(acc, acc_later, strict=True)]

    length = float(start.k.length)
    rates = [np.abs(_floats(x)) * length for x in (*v, *acc)]
    second_rates = [np.abs(_floats(x)) * length for x in (*acc, *jerk)]
    weights = [abs(float(x)) for x in (*form.a, *form.b)]
    n_floats = _vector(map(_floats, n))
    v_floats = _vector(map(_floats, v))
    return _Motion(
        form_weights=dict(zip(STATE, weights, strict=True)),
        rate_weights=_rate_weights(form, n_floats, v_floats, start.k.converted(float)),
        slope=np.abs(_floats(rate)) * length,
        bend=np.abs(_floats((rate_later - rate) / step)) * length,
        rates=dict(zip(STATE, rates, strict=True)),
        second_rates=dict(zip(STATE, second_rates, strict=True)),
    )


def _states_over_length(table: Table, k: Constants, bits: int) -> tuple[Vector, Vector]:
    """Return n and n' at the rows of a table of t and the state, in fixed point."""
    columns = list(zip(*table.values, strict=True)) or [()] * len(table.columns)
    state = []
    for column in columns[1:]:
        metres = FixedPoint.column(integers(column), 1 << table.bits, bits)
        state.append(metres / k.length)
    return _vector(state[:3]), _vector(state[3:])


def _rate_weights(form: Form, n: Vector, v: Vector, k: Constants) -> dict[str, Any]:
    """Return by state column how much an error of it changes a form's rate, at most.

    The sum over all columns is that of the module's docstring.
    """
    a = _vector(map(float, form.a))
    b = _vector(map(float, form.b))
    pull = _vector(np.broadcast_arrays(*force(n, v, k), n[0])[:3])
    b_size = float(_norm(b))
    b_along = abs(dot(b, n))
    tension = abs(dot(v, v) + dot(n, pull))  # λ
    square = k.rate**2  # Ω²
    w = 2 * abs(k.rate) + k.drag
    of_position = b_size * square + b_along * (_norm(pull) + square)
    of_velocity = b_size * w + b_along * (2 * _norm(v) + w)

    weights = {}
    for name, component in zip(POSITION, b, strict=True):
        weights[name] = tension * abs(component) + of_position
    for name, component in zip(VELOCITY, a, strict=True):
        weights[name] = abs(component) + of_velocity
    return weights


def with_zero_errors(
    run: Run, errors: Mapping[str, Fraction], word: str, distances: Table | None
) -> Table:
    """Return the printed columns of a word's zeros, with an estimated error of each number.

    Args:
        run: the run.
        errors: those of its columns on the grid.
        word: of the zeros.
        distances: differences of its zeros from another run's: no error is less than twice that.
    """
    zeros = run.zeros[word].table
    # errors are in units of 2**power, as doubles may not hold them
    power = bits_in(max(errors.values()))
    state_errors = _state_errors(zeros, errors, power)
    motion = _motion_at(run, word)
    form_error = sum(state_errors[name] * motion.form_weights[name] for name in STATE)
    rate_error = sum(state_errors[name] * motion.rate_weights[name] for name in STATE)
    late, has_root = _lateness(motion, form_error, rate_error, power)
    late = late + np.ldexp(zeros["t"], -run.plan.number.prec - power)

    columns = {"t": late, "ax": rate_error + motion.bend * late}
    for name in STATE:
        rate = motion.rates[name] + motion.second_rates[name] * np.ldexp(late, power)
        columns[name] = state_errors[name] + rate * late
    table = zeros.only(columns_of(word))
    known = {name: np.where(has_root, columns[name], np.inf) for name in table.columns}
    return _with_errors(table, known, power, distances)


def _state_errors(zeros: Table, errors: Mapping[str, Fraction], power: int) -> dict[str, Any]:
    """Return the errors of each column of the state at zeros, in units of 2**power.

    They are those on the grid; the polynomial of a step, where a run took its states from one, adds
    its own.
    """
    state_errors: dict[str, Any] = {}
    for name, size in errors.items():
        state_errors[name] = float(size / Fraction(2) ** power)
    if zeros.errors:
        for name in STATE:
            bounds = [int(x * 2**zeros.bits) for x in zeros.bound(name)]
            state_errors[name] = state_errors[name] + _in_units(bounds, zeros.bits + power)
    return state_errors


def _lateness(motion: _Motion, form_error: Any, rate_error: Any, power: int) -> tuple[Array, Array]:
    """Return how late a zero may be at most, and where that is known.

    Errors and times are in units of 2**power.

    With the form's error e, its rate f, off by at most f_e, and its second rate g, it is the
    smaller root of (|f| - f_e - g late) late = e. If there is no root, the error is unknown, and 0
    is returned.
    """
    slope = motion.slope - np.ldexp(rate_error, power)
    room = slope**2 - 4 * motion.bend * np.ldexp(form_error, power)
    has_root = (slope > 0) & (room >= 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        late = 2 * form_error / (slope + np.sqrt(room))
    return np.where(has_root, late, 0.0), has_root


def _with_errors(
    table: Table, columns: Mapping[str, Array], power: int, distances: Table | None
) -> Table:
    """Return a table with errors, in units of 2**power.

    None is less than twice the distance from another run's number, where there is one.
    """
    errors = []
    for i, name in enumerate(table.columns):
        column = columns[name]
        if distances is not None:
            doubled = [2 * row[i] for row in distances.values]
            column = np.maximum(column, _in_units(doubled, distances.bits + power))
        errors.append(_fixed(column * _ROUNDED_UP, power, table.bits))
    return Table(table.columns, table.bits, table.values, list(zip(*errors, strict=True)))


def _floats(numbers: FixedPoint) -> Array:
    unit = 1 << numbers.bits
    return np.array([value / unit for value in numbers.values], dtype=np.float64)


def _in_units(values: list[int], bits: int) -> Array:
    """Return integers over 2**bits as doubles."""
    up = max(0, -bits)
    divisor = 1 << max(0, bits)
    return np.array([(value << up) / divisor for value in values], dtype=np.float64)


def _vector(components: Iterable[Any]) -> Vector:
    x, y, z = components
    return x, y, z


def _fixed_vector(vector: Vector, bits: int) -> Vector:
    """Return a vector in fixed point; a component that is the int 0 stays one."""
    return _vector(0 if is_zero(x) else FixedPoint.of(x, bits) for x in vector)


def _norm(vector: Vector) -> Any:
    return np.sqrt(dot(vector, vector))


def _fixed(column: Array, power: int, bits: int) -> list[int]:
    """Return numbers in units of 2**power as integers over 2**bits, rounded up.

    What is not finite becomes `_UNKNOWN`.
    """
    finite = np.isfinite(column)
    mantissas, exponents = np.frexp(np.where(finite, column, 0.0))
    wholes = np.ldexp(mantissas, DOUBLE_BITS).astype(np.int64).tolist()
    shifts = (exponents + (power + bits - DOUBLE_BITS)).tolist()

    numbers = []
    for whole, shift, known in zip(wholes, shifts, finite.tolist(), strict=True):
        if not known:
            numbers.append(_UNKNOWN << bits)
        elif shift >= 0:
            numbers.append(whole << shift)
        else:
            numbers.append(-(-whole >> -shift))
    return numbers
