"""The zeros of polynomials, lane by lane: which lanes are sure of what they say, and what the long way adds."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

pytest.importorskip("numba")
pytest.importorskip("flint")

import flint
import numba

from reference.engines.octet.lane_zeros import CONVERGED, LanePolynomial, all_zeros, refine, seek
from reference.engines.octet.march import empty_march
from reference.engines.simd.lanes import LANES

ORDER = 24


@pytest.fixture(scope="module")
def search():
    """Return a function that searches eight polynomials on 0 < s <= length, as a step of the march does."""

    @numba.njit(error_model="numpy")
    def on_lanes(m, order):
        seek(m.transits, m.series.xdot, m.length, m.time, order)
        refine(m.transits, m.series.xdot, m.length, order, CONVERGED)

    @numba.njit(error_model="numpy")
    def on_one(m, lane, multiplicity, order):
        polynomial = LanePolynomial(m.series.xdot, lane, order, m.length[lane])
        return all_zeros(m.bisection, m.transits, polynomial, multiplicity)

    def of(polynomials, lengths):
        m = empty_march()
        m.series.xdot.reshape(-1, LANES)[:ORDER] = polynomials.T
        m.length[:], m.transits.sought[:] = lengths, 1.0
        m.time[:] = 1.0
        m.transits.before[:] = polynomials[:, 0]
        m.transits.after[:] = [
            np.polyval(f[::-1], r) for f, r in zip(polynomials, lengths, strict=True)
        ]
        on_lanes(m, ORDER)
        return m, lambda lane, multiplicity=-1: on_one(m, lane, multiplicity, ORDER)

    return of


def real_zeros(f, length):
    """The zeros on 0 < s <= length, isolated by FLINT."""
    whole = flint.fmpz_poly([int(Fraction(float(c)) * 2**400) for c in f])
    roots = [root for root, _ in whole.complex_roots() if 0 in root.imag]
    return sorted(float(root.real) for root in roots if 0 < root.real <= length)


def polynomials(generator, count):
    """Random series of all kinds: single zeros, close pairs, none, several."""
    orders = np.arange(ORDER)
    for _ in range(count):
        f = (
            generator.normal(size=(LANES, ORDER))
            * generator.uniform(0.05, 0.9, size=(LANES, 1)) ** orders
        )
        f[:, 0] *= generator.uniform(0.0, 2.0, size=LANES)
        for lane in range(0, LANES, 2):  # a pair: (s - a)² + b
            a, b = (
                generator.uniform(0.1, 0.9),
                generator.normal() * 10.0 ** -generator.uniform(0, 9),
            )
            tail = np.zeros(ORDER)
            tail[0], tail[1:4] = 1.0, 0.2 * generator.normal(size=3)
            f[lane] = np.convolve([a * a + b, -2 * a, 1.0], tail)[:ORDER]
        yield f, generator.uniform(0.3, 1.5, size=LANES)


def test_lanes_are_right_about_the_zeros_they_are_sure_of_and_bisection_finds_the_others(
    search, size, tally
):
    generator, sure, long = np.random.default_rng(7), 0, 0
    for many, lengths in polynomials(generator, size(12, 300)):
        m, bisected = search(many, lengths)
        z = m.transits
        assert not (z.hit * z.doubt).any()  # a lane in doubt that crosses would be counted twice
        for lane in range(LANES):
            exact = real_zeros(many[lane], lengths[lane])
            if z.doubt[lane]:
                count = bisected(lane)
                found, slopes, long = (
                    m.bisection.places[:count].copy(),
                    m.bisection.slopes[:count].copy(),
                    long + 1,
                )
            else:
                found, slopes, sure = (
                    z.place[[lane]][z.hit[[lane]] > 0],
                    z.slope[[lane]][z.hit[[lane]] > 0],
                    sure + 1,
                )
            # counts alone would not tell: a place may be off where half a step only is monotone
            assert len(found) == len(exact), (many[lane], lengths[lane])
            # what rounding counts from
            scale = np.polyval(np.abs(many[lane])[::-1], max(1.0, lengths[lane]))
            assert (np.abs(found - exact) * np.abs(slopes) <= 2.0**-48 * scale).all(), (
                many[lane],
                lengths[lane],
            )
    tally(f"zeros on lanes: {sure} lanes sure, {long} the long way, all as by FLINT")
    assert sure > 40 and long > 40


def test_a_zero_of_a_half_that_newton_overshoots_stays_in_its_half(search):
    # sin(3 s + 0.2): the first half has no zero, the second one, and the whole is not monotone
    k = np.arange(ORDER)
    factorials = np.array([float(math.factorial(int(i))) for i in k])
    wave = np.sin(0.2 + k * np.pi / 2) * 3.0**k / factorials
    m, bisected = search(np.tile(wave, (LANES, 1)), np.linspace(0.9, 1.3, LANES))
    for lane in range(LANES):
        places = m.transits.place[[lane]]
        if m.transits.doubt[lane]:
            assert bisected(lane) == (1 if m.length[lane] > (np.pi - 0.2) / 3 else 0)
            places = m.bisection.places[:1]
        if m.length[lane] > (np.pi - 0.2) / 3:
            assert abs(places[0] - (np.pi - 0.2) / 3) < 1e-12  # the series is cut off at order 24


def test_what_rounding_hides_is_doubtful(search):
    touching = np.zeros(ORDER)
    touching[:3] = 0.25, -1.0, 1.0  # (s - 1/2)²
    m, bisected = search(np.tile(touching, (LANES, 1)), np.full(LANES, 0.9))
    assert (m.transits.doubt == 1).all()
    assert bisected(0) == -1


@pytest.mark.parametrize("multiplicity", [1, 2])
def test_an_exact_zero_at_the_start_is_not_counted(search, multiplicity):
    f = np.zeros(ORDER)
    f[multiplicity : multiplicity + 2] = 1.0, -2.0
    f[0] = -1e-18  # what rounding leaves of the zero
    _, bisected = search(np.tile(f, (LANES, 1)), np.full(LANES, 0.9))
    assert bisected(0, multiplicity) == 1
