"""Zeros of a polynomial, counted and told apart, and the passages of sections in a run, none lost and none doubled.

The zeros of a step's polynomial are counted by Descartes' rule: in Bernstein's form its coefficients change sign as
often as it has zeros, or 2, 4, ... times oftener. One change at most is certain; any other piece is halved. This is
done in doubles, until rounding shows: then a piece's own series is made from the integers. Signs at places are those of
integers, and that at a step's start is that at the end of the step before.

Sections are found here for every engine; the zeros of xdot by each engine as it runs.

A zero at the release that no digit of the run tells from it, as that of every velocity at rest, does not count.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import islice
from math import comb
from typing import Any

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

BATCH = 64  # steps that are looked at together
SPARE_BITS = 64  # of forms, places and states beyond the run's own
NOISE_BITS = 14  # last bits of a form that rounding may have spoilt
ROUNDING = 2.0**-46  # of Bernstein's form in double, against the sum of the coefficients' sizes
BLURRED = 2.0**10  # times its rounding: a form below that is made again of a piece alone
# of a polynomial whose zeros are counted; those beyond, e**-80 of the first, count as rounding
MOST_TERMS = 40
GRAZING = "Ask for more digits, or leave this section out (run.sections)."


class SectionSearch:
    """The passages of one section: `take` all steps in order."""

    def __init__(self, word: str, form: Form, prec: int) -> None:
        self.word, self.form, self.bits, self.noise = (
            word,
            form,
            prec + SPARE_BITS,
            prec - NOISE_BITS,
        )
        self.whole = [
            [int(to_fraction(x) * (1 << self.bits)) for x in v] for v in (form.a, form.b, [form.d])
        ]
        self.left, self.passages = 0, list[tuple[list[int], int, list[int]]]()

    def take(self, steps: list[TaylorStep], rows: list[list[list[int]]], series: Array) -> None:
        """Find the passages in steps that follow each other; most have none, as doubles show.

        `rows` of each step are its polynomials x, y, z over l, `series` the same in doubles, shape (steps, 3, orders).
        """
        h, k = np.array([[float(step.h)] for step in steps]), np.arange(1, series.shape[2] + 1)
        a, b = (np.array(v, float) for v in self.form[:2])
        form = h * (a @ series[..., :-1]) + b @ (series[..., 1:] * k[:-1])
        form[:, :1] -= h * float(self.form.d)
        sizes = (h * abs(a).sum() + abs(b).sum()) * abs(series).sum(1) * k
        bounds = forms(form, sizes)
        sides = (bounds.min(1) > 1).astype(int) - (bounds.max(1) < -1)
        for step, row, side in zip(steps, rows, sides.tolist(), strict=True):
            if not self.left or side != self.left:
                self._search(step, row)

    def _search(self, step: TaylorStep, rows: list[list[int]]) -> None:
        unit, h, (a, b, d) = 1 << self.bits, step.h, self.whole
        a, d = ([x * h.numerator // h.denominator for x in v] for v in (a, d))
        g = [-d[0] << step.bits] + [0] * (len(rows[0]) - 2)
        for p, q, row in zip(a, b, rows, strict=True):
            g = [
                x + p * c + q * k * rate
                for k, (x, c, rate) in enumerate(zip(g, row, row[1:], strict=False), 1)
            ]
        least = (sum(map(abs, a)) + sum(map(abs, b))) << step.bits >> self.noise
        if not self.left:  # at the release
            while g and abs(g[0]) <= least:
                g = g[1:]
        if not g or max(map(abs, g)) <= least:
            raise IntegrationError(
                f"{self.word}: the motion stays in this section, as far as digits tell.", GRAZING
            )
        places = Places(g, least, self.bits, self.word)
        left, right = self.left or places.sign(0), places.sign(unit)
        for low, high, sign in places.isolated(left, right):
            if self.form.direction in (0, -sign):
                s = places.root(low, high, sign)
                last = (_left_out(row, s / unit) * h.denominator // h.numerator for row in rows)
                lost = [_shifted(int(x), self.bits - step.bits) + 1 for x in last]
                self.passages.append((self._moment(step, rows, s), -sign, lost))
        self.left = right

    def _moment(self, step: TaylorStep, rows: list[list[int]], s: int) -> list[int]:
        """Return time in s, n and n' in 1/s at a place, as integers over 2**bits."""
        values = [horner(row, s, self.bits) for row in rows]
        n, v = ([_shifted(value[i], self.bits - step.bits) for value in values] for i in (0, 1))
        t, h = step.centre, step.h
        time = (t.numerator << self.bits) // t.denominator + s * h.numerator // h.denominator
        return [time, *n, *(x * h.denominator // h.numerator for x in v)]


class Places:
    """A polynomial of s in [0, 1] with integer coefficients, and the places of its zeros, integers over 2**bits."""

    def __init__(self, g: list[int], least: int, bits: int, word: str) -> None:
        self.g, self.least, self.bits, self.word = g, least, bits, word

    def sign(self, s: int) -> int:
        """Return the sign at a place."""
        return 1 if horner(self.g, s, self.bits)[0] >= 0 else -1

    def isolated(self, left: int, right: int) -> Iterator[tuple[int, int, int]]:
        """Yield, in order, intervals that hold one zero each, and the sign before it; given the signs at the ends."""
        to_half = bernstein(min(len(self.g), MOST_TERMS))[1]
        pieces, cut = [(self._form(0, 1), 0, 1 << self.bits, left, right)], 0
        while pieces:
            form, low, high, before, after = pieces.pop()
            if cut and abs(form).max() < BLURRED:
                form = self._form(low, (1 << self.bits) // (high - low))
            if np.count_nonzero(np.diff(signs_of(form, before, after))) <= 1:
                yield from [(low, high, before)] * (before != after)
            else:
                cut += 1
                if cut == self.bits:  # before a piece is shorter than the distance of two places
                    reason = f"{self.word}: the motion touches this section within the precision."
                    raise IntegrationError(reason, GRAZING)
                middle = (low + high) // 2
                between = self.sign(middle)
                pieces.append(((to_half @ form[::-1])[::-1], middle, high, between, after))
                pieces.append((to_half @ form, low, middle, before, between))

    def _form(self, low: int, parts: int) -> Array:
        """Return Bernstein's form on the one of 2**n equal parts that begins at `low`, from integers; see `forms`."""
        g, shift = [*self.g], parts.bit_length() - 1
        for i in range(len(g) if low else 0):
            for j in range(len(g) - 2, i - 1, -1):
                g[j] += g[j + 1] * low >> self.bits
        g = [c >> shift * k for k, c in enumerate(g)]
        scale = max(map(abs, g)) or 1
        series = np.array([c / scale for c in g])
        # a move rounds c_k by binom(orders, k + 1) at most: 2 1.5**orders in all
        return forms(series, abs(series), (self.least + (2 * 3 ** len(g) >> len(g))) / scale)

    def root(self, low: int, high: int, before: int) -> int:
        """Return the zero between two places, by Newton's method, or by halving where that leaves them."""
        s = (low + high) // 2
        for _ in range(4 * self.bits):
            value, rate = horner(self.g, s, self.bits)
            low, high = (s, high) if (value >= 0) == (before > 0) else (low, s)
            place = s - (value << self.bits) // rate if rate else low - 1
            s, last = (place if low <= place <= high else (low + high) // 2), s
            if abs(s - last) <= 1:
                break
        return s


def horner(g: list[int], s: int, bits: int) -> tuple[int, int]:
    """Return a polynomial and its rate at s/2**bits, rounded down."""
    value = rate = 0
    for c in reversed(g):
        rate = value + (rate * s >> bits)
        value = c + (value * s >> bits)
    return value, rate


def forms(series: Array, sizes: Array, least: float = 0.0) -> Array:
    """Return Bernstein's forms of series up to 1, in units of what rounding, terms left out and `least` amount to.

    `sizes` are those of what the coefficients are sums of; both have shape (..., orders), the forms up to MOST_TERMS.
    """
    noise = ROUNDING * sizes.sum(-1) + sizes[..., MOST_TERMS:].sum(-1) + least
    series = series[..., :MOST_TERMS]
    return np.asarray(series @ bernstein(series.shape[-1])[0].T / noise[..., None])


def signs_of(form: Array, left: Any, right: Any) -> Array:
    """Return the signs of Bernstein forms, at the ends as given; where rounding decides 0, which makes two changes."""
    signs = np.sign(np.trunc(form))
    signs[..., 0], signs[..., -1] = left, right
    return signs


@cache
def bernstein(terms: int) -> tuple[Array, Array]:
    """Return the matrices from coefficients to Bernstein's form, and from that to the form on the first half."""
    n = range(terms)
    form = np.array([[comb(j, i) / comb(terms - 1, i) for i in n] for j in n])
    return form, np.array([[comb(j, i) / 2**j for i in n] for j in n])


def _left_out(row: list[int], s: float) -> int:
    """Return about what a rate lacks at a place: twice the next term, as terms fall like the last four, two by two."""
    last, before = (max(map(abs, pair)) for pair in (row[-2:], row[-4:-2]))
    return (
        2 * len(row) * min(last, last * last // max(before, 1)) * int(s ** (len(row) - 1) * 2**53)
        >> 53
    )


def _shifted(value: int, bits: int) -> int:
    return value << bits if bits >= 0 else value >> -bits


def passages(plan: Plan, steps: Iterator[TaylorStep]) -> dict[str, Zeros[Table]]:
    """Return `columns.SECTION` at each passage of a plan's sections, and its direction, from the plan's Taylor steps.

    Errors of the tables are those of velocities alone, by the end of a step's polynomial, as its last terms tell.

    Raises:
        IntegrationError: a section that the motion touches, or stays in, as far as the digits tell.
    """
    start = Start.of(plan.inputs, plan.number.prec + SPARE_BITS + GUARD_BITS)
    searches = [
        SectionSearch(word, form_of(word, start), plan.number.prec) for word in plan.sections
    ]
    unit = 1 << plan.number.prec + SPARE_BITS
    sin, cos = (
        (int(to_fraction(x) * unit))
        for x in ((start.k.sin, start.k.cos) if start.k.rate else (1, 0))
    )
    while batch := list(islice(steps, BATCH)):
        rows = []
        for step in batch:
            x, second, third, *_ = step.coefficients
            if step.columns[:3] != LOCAL:
                pairs = list(zip(second, third, strict=True))
                second = [(m * sin + w * cos) // unit for m, w in pairs]
                third = [(w * sin - m * cos) // unit for m, w in pairs]
            rows.append([x, second, third])
        series = (np.array(rows, object) / (1 << step.bits)).astype(float)
        for search in searches:
            search.take(batch, rows, series)
    bits, length, last = (
        plan.number.prec + SPARE_BITS,
        plan.inputs.length,
        int(plan.times[-1] * unit),
    )
    tables = {}
    for search in searches:
        kept = [passage for passage in search.passages if passage[0][0] <= last]
        values = [(row[0], *(int(x * length) for x in row[1:])) for row, _, _ in kept]
        errors = [(0, 0, 0, 0, *(int(size * length) + 1 for size in lost)) for _, _, lost in kept]
        table = Table(SECTION, bits, values, errors)
        tables[search.word] = Zeros(table, [direction for _, direction, _ in kept])
    return tables
