"""Isolate the zeros of a step's polynomial, and find the passages of sections in a run.

The zeros of a polynomial are counted by Descartes' rule: the coefficients of its Bernstein form
change sign as often as it has zeros, or 2, 4, ... times more often. No change or one is certain;
a piece with more is halved. This is done in doubles until rounding shows; then the series of the
piece is made from the integers. Signs at places are those of integers. No zero is lost or counted
twice between steps: the sign at a step's start is that at the end of the step before.

Passages of sections are found here for every engine; the zeros of xdot by each engine as it runs.

A zero at the release that the run's digits cannot distinguish from t = 0, such as that of every
velocity at rest, does not count.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import islice
from math import comb
from typing import Any, NamedTuple

import numpy as np

from ..errors import IntegrationError
from ..model.sections import Form, form_of
from ..model.start import Start
from ..numbers.columns import SECTION
from ..numbers.precision import GUARD_BITS, Array, to_fraction
from ..numbers.table import Table
from ..numbers.taylor_step import LOCAL, TaylorStep
from ..numbers.zeros import Zeros
from .plan import Plan

SPARE_BITS = 64  # of forms, places and states beyond the run's own
_BATCH = 64  # steps that are examined together
_NOISE_BITS = 14  # last bits of a form that rounding may have spoilt
_ROUNDING = (
    2.0**-46
)  # of Bernstein's form in double, relative to the sum of the coefficients' sizes
_BLURRED = 2.0**10  # times its rounding: a smaller form is made again from the integers
# of a polynomial whose zeros are counted; those beyond, e**-80 of the first, count as rounding
_MOST_TERMS = 40
_GRAZING = "Ask for more digits, or leave this section out (run.sections)."


class _Passage(NamedTuple):
    """A passage of a section; numbers are integers over 2**bits.

    Attributes:
        time: in s.
        position: n, over l.
        velocity: n', in 1/s.
        velocity_errors: estimates of what each velocity lacks, in 1/s.
        direction: +1 where the section's form grows, else -1.
    """

    time: int
    position: list[int]
    velocity: list[int]
    velocity_errors: list[int]
    direction: int


class _SectionSearch:
    """The search for the passages of one section: `take` all steps of a run in order.

    Attributes:
        word: of the section.
        passages: those found so far.
    """

    def __init__(self, word: str, form: Form, prec: int) -> None:
        self.word = word
        self.passages: list[_Passage] = []
        self._form = form
        self._bits = prec + SPARE_BITS
        self._noise_bits = prec - _NOISE_BITS
        self._a = [_fixed(x, self._bits) for x in form.a]
        self._b = [_fixed(x, self._bits) for x in form.b]
        self._d = _fixed(form.d, self._bits)
        self._sign = 0  # of the form at the end of the last step; 0 before the first

    def take(self, steps: list[TaylorStep], rows: list[list[list[int]]], series: Array) -> None:
        """Find the passages in steps that follow each other; most have none, as doubles show.

        Args:
            steps: the steps.
            rows: of each step its polynomials x, y, z over l.
            series: the same in doubles, shape (steps, 3, orders).
        """
        h = np.array([[float(step.h)] for step in steps])
        k = np.arange(1, series.shape[2] + 1)
        a = np.array(self._form.a, float)
        b = np.array(self._form.b, float)
        form = h * (a @ series[..., :-1]) + b @ (series[..., 1:] * k[:-1])
        form[:, :1] -= h * float(self._form.d)
        sizes = (h * abs(a).sum() + abs(b).sum()) * abs(series).sum(1) * k

        bounds = forms(form, sizes)
        positive = bounds.min(1) > 1
        negative = bounds.max(1) < -1
        signs = positive.astype(int) - negative  # in the whole step; 0 where doubles do not decide
        for step, row, sign in zip(steps, rows, signs.tolist(), strict=True):
            if not self._sign or sign != self._sign:
                self._search(step, row)

    def _search(self, step: TaylorStep, rows: list[list[int]]) -> None:
        """Find the passages in one step from its integers."""
        g, noise = self._polynomial(step, rows)
        if not self._sign:  # at the release, where a zero does not count
            while g and abs(g[0]) <= noise:
                g = g[1:]
        if not g or max(map(abs, g)) <= noise:
            raise IntegrationError(
                f"{self.word}: to working precision, the motion never leaves this section.",
                _GRAZING,
            )
        places = Places(g, noise, self._bits, self.word)
        before = self._sign or places.sign(0)
        after = places.sign(1 << self._bits)
        for zero in places.isolated(before, after):
            direction = -zero.sign_before
            if self._form.direction in (0, direction):
                passage = self._passage(step, rows, places.root(zero), direction)
                self.passages.append(passage)
        self._sign = after

    def _polynomial(self, step: TaylorStep, rows: list[list[int]]) -> tuple[list[int], int]:
        """Return h times the form as a polynomial of s in [0, 1], and how far rounding moves it."""
        h = step.h
        a = [_times(x, h) for x in self._a]
        d = _times(self._d, h)
        g = [-d << step.bits] + [0] * (len(rows[0]) - 2)
        for p, q, row in zip(a, self._b, rows, strict=True):
            terms = enumerate(zip(g, row, row[1:], strict=False), 1)
            g = [x + p * c + q * k * rate for k, (x, c, rate) in terms]
        size = sum(map(abs, a)) + sum(map(abs, self._b))
        return g, size << step.bits >> self._noise_bits

    def _passage(self, step: TaylorStep, rows: list[list[int]], s: int, direction: int) -> _Passage:
        """Return the passage at a place of a step, an integer over 2**bits."""
        h = step.h
        up = self._bits - step.bits
        values = [_horner(row, s, self._bits) for row in rows]
        velocity = [_over(_shifted(rate, up), h) for _, rate in values]
        missing = [int(_over(_truncation(row, s / (1 << self._bits)), h)) for row in rows]
        centre = (step.centre.numerator << self._bits) // step.centre.denominator
        return _Passage(
            time=centre + _times(s, h),
            position=[_shifted(value, up) for value, _ in values],
            velocity=velocity,
            velocity_errors=[_shifted(error, up) + 1 for error in missing],
            direction=direction,
        )


class IsolatedZero(NamedTuple):
    """A zero of a polynomial, alone between two places.

    Attributes:
        low, high: the places, integers over 2**bits.
        sign_before: sign of the polynomial at `low`.
    """

    low: int
    high: int
    sign_before: int


class _Piece(NamedTuple):
    """A piece of a polynomial's interval [0, 1].

    Attributes:
        form: Bernstein's form of the polynomial on the piece, as `forms` gives it.
        low, high: its ends, integers over 2**bits.
        sign_low, sign_high: signs of the polynomial there.
    """

    form: Array
    low: int
    high: int
    sign_low: int
    sign_high: int


class Places:
    """A polynomial of s in [0, 1] with integer coefficients; places of s are integers over 2**bits.

    Args:
        g: coefficients, lowest order first.
        noise: how far rounding may have moved the polynomial, in the unit of its coefficients.
        bits: of places.
        word: what its zeros are called in messages: "xdot", or the word of a section.
    """

    def __init__(self, g: list[int], noise: int, bits: int, word: str) -> None:
        self.g = g
        self.noise = noise
        self.bits = bits
        self.word = word

    def sign(self, s: int) -> int:
        """Return the sign at a place."""
        value, _ = _horner(self.g, s, self.bits)
        return 1 if value >= 0 else -1

    def isolated(self, sign_low: int, sign_high: int) -> Iterator[IsolatedZero]:
        """Yield intervals that hold one zero each, in order, given the signs at 0 and 1.

        Raises:
            IntegrationError: two zeros are too close to be distinguished from none.
        """
        to_half = _bernstein(min(len(self.g), _MOST_TERMS)).to_half
        whole = _Piece(self._bernstein_form(0, 1), 0, 1 << self.bits, sign_low, sign_high)
        pieces = [whole]
        cuts = 0
        while pieces:
            piece = pieces.pop()
            form = piece.form
            if cuts and abs(form).max() < _BLURRED:
                count = (1 << self.bits) // (piece.high - piece.low)
                form = self._bernstein_form(piece.low, count)

            signs = signs_of(form, piece.sign_low, piece.sign_high)
            if np.count_nonzero(np.diff(signs)) <= 1:
                if piece.sign_low != piece.sign_high:
                    yield IsolatedZero(piece.low, piece.high, piece.sign_low)
                continue

            cuts += 1
            if cuts == self.bits:  # before a piece is shorter than the distance of two places
                reason = f"{self.word}: the motion touches this section within the precision."
                raise IntegrationError(reason, _GRAZING)
            middle = (piece.low + piece.high) // 2
            sign = self.sign(middle)
            second_half = (to_half @ form[::-1])[::-1]
            pieces.append(_Piece(second_half, middle, piece.high, sign, piece.sign_high))
            pieces.append(_Piece(to_half @ form, piece.low, middle, piece.sign_low, sign))

    def _bernstein_form(self, low: int, count: int) -> Array:
        """Return Bernstein's form, as `forms` gives it, on a part of [0, 1], from integers.

        The part begins at `low`, and is one of `count` = 2**n equal ones.
        """
        g = [*self.g]
        for i in range(len(g) if low else 0):  # a move of the origin to `low`
            for j in range(len(g) - 2, i - 1, -1):
                g[j] += g[j + 1] * low >> self.bits
        shift = count.bit_length() - 1
        g = [c >> shift * k for k, c in enumerate(g)]
        # the move rounds c_k by binom(orders, k + 1) at most: 2 1.5**orders in all
        rounding = 2 * 3 ** len(g) >> len(g)

        scale = max(map(abs, g)) or 1
        series = np.array([c / scale for c in g])
        return forms(series, abs(series), (self.noise + rounding) / scale)

    def root(self, zero: IsolatedZero) -> int:
        """Return the place of a zero by Newton's method; where that leaves it, by halving."""
        low, high = zero.low, zero.high
        s = (low + high) // 2
        for _ in range(4 * self.bits):
            value, rate = _horner(self.g, s, self.bits)
            if (value >= 0) == (zero.sign_before > 0):
                low = s
            else:
                high = s

            last = s
            s = (low + high) // 2
            if rate:
                newton = last - (value << self.bits) // rate
                if low <= newton <= high:
                    s = newton
            if abs(s - last) <= 1:
                break
        return s


def forms(series: Array, sizes: Array, noise: float = 0.0) -> Array:
    """Return Bernstein's forms of series on [0, 1], in units of their uncertainty.

    A coefficient above 1 in size has a certain sign.

    Args:
        series: coefficients, shape (..., orders); the forms have at most `_MOST_TERMS`.
        sizes: sums of the sizes of the terms that each coefficient is a sum of, in the same shape.
        noise: uncertainty besides that of rounding here and of the terms that are left out.
    """
    uncertainty = _ROUNDING * sizes.sum(-1) + sizes[..., _MOST_TERMS:].sum(-1) + noise
    series = series[..., :_MOST_TERMS]
    return np.asarray(series @ _bernstein(series.shape[-1]).from_series.T / uncertainty[..., None])


def signs_of(form: Array, sign_low: Any, sign_high: Any) -> Array:
    """Return the signs of Bernstein forms, at the ends as given.

    A sign that rounding decides is 0, and so makes two changes.
    """
    signs = np.sign(np.trunc(form))
    signs[..., 0] = sign_low
    signs[..., -1] = sign_high
    return signs


class _Bernstein(NamedTuple):
    """Matrices from a series to Bernstein's form, and from that to the form on the first half."""

    from_series: Array
    to_half: Array


@cache
def _bernstein(terms: int) -> _Bernstein:
    """Return the matrices of Bernstein's form for polynomials of so many terms."""
    from_series = np.zeros((terms, terms))
    to_half = np.zeros((terms, terms))
    for j in range(terms):
        for i in range(terms):
            from_series[j, i] = comb(j, i) / comb(terms - 1, i)
            to_half[j, i] = comb(j, i) / 2**j
    return _Bernstein(from_series, to_half)


def passages(plan: Plan, steps: Iterator[TaylorStep]) -> dict[str, Zeros[Table]]:
    """Return the passages of a plan's sections by word, from its Taylor steps: `columns.SECTION`.

    Errors of the tables are those of velocities alone, estimated from the last terms of each step.

    Raises:
        IntegrationError: the motion touches a section, or stays in it, as far as the digits tell.
    """
    prec = plan.number.prec
    start = Start.of(plan.inputs, prec + SPARE_BITS + GUARD_BITS)
    searches = [_SectionSearch(word, form_of(word, start), prec) for word in plan.sections]
    to_local = _LocalAxes(start, prec + SPARE_BITS)
    while batch := list(islice(steps, _BATCH)):
        rows = [to_local.rows(step) for step in batch]
        series = (np.array(rows, object) / (1 << batch[-1].bits)).astype(float)
        for search in searches:
            search.take(batch, rows, series)
    return {search.word: _zeros(plan, search) for search in searches}


class _LocalAxes:
    """Turns the polynomials of steps into the axes x, y, z of a scene."""

    def __init__(self, start: Start, bits: int) -> None:
        # without rotation the axes of a proof are the local ones
        sin, cos = (start.k.sin, start.k.cos) if start.k.rate else (1, 0)
        self._sin = _fixed(sin, bits)
        self._cos = _fixed(cos, bits)
        self._unit = 1 << bits

    def rows(self, step: TaylorStep) -> list[list[int]]:
        """Return the polynomials x, y, z over l of a step."""
        x, second, third, *_ = step.coefficients
        if step.columns[:3] == LOCAL:
            return [x, second, third]
        sin, cos = self._sin, self._cos
        unit = self._unit
        pairs = list(zip(second, third, strict=True))
        y = [(m * sin + w * cos) // unit for m, w in pairs]
        z = [(w * sin - m * cos) // unit for m, w in pairs]
        return [x, y, z]


def _zeros(plan: Plan, search: _SectionSearch) -> Zeros[Table]:
    """Return the passages of a search up to the end of a plan, in SI units."""
    bits = plan.number.prec + SPARE_BITS
    length = plan.inputs.length
    end = int(plan.times[-1] * (1 << bits))
    values = []
    errors = []
    directions = []
    for passage in search.passages:
        if passage.time > end:
            continue
        state = [int(x * length) for x in (*passage.position, *passage.velocity)]
        velocity_errors = [int(error * length) + 1 for error in passage.velocity_errors]
        values.append((passage.time, *state))
        errors.append((0, 0, 0, 0, *velocity_errors))
        directions.append(passage.direction)
    return Zeros(Table(SECTION, bits, values, errors), directions)


def _horner(g: list[int], s: int, bits: int) -> tuple[int, int]:
    """Return a polynomial and its rate at s/2**bits, rounded down."""
    value = rate = 0
    for c in reversed(g):
        rate = value + (rate * s >> bits)
        value = c + (value * s >> bits)
    return value, rate


def _truncation(row: list[int], s: float) -> int:
    """Return about what the rate of a polynomial lacks at a place: twice the next term.

    Terms are taken to fall like the last four, pair by pair.
    """
    last = max(map(abs, row[-2:]))
    before = max(map(abs, row[-4:-2]))
    next_term = min(last, last * last // max(before, 1))
    power = int(s ** (len(row) - 1) * 2**53)
    return 2 * len(row) * next_term * power >> 53


def _fixed(number: Any, bits: int) -> int:
    """Return a number as an integer over 2**bits, cut off towards zero."""
    return int(to_fraction(number) * (1 << bits))


def _times(value: int, factor: Fraction) -> int:
    return value * factor.numerator // factor.denominator


def _over(value: int, divisor: Fraction) -> int:
    return value * divisor.denominator // divisor.numerator


def _shifted(value: int, bits: int) -> int:
    return value << bits if bits >= 0 else value >> -bits
