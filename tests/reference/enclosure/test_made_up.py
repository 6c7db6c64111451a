"""Steps and tubes that are made up, so that every zero of xdot is known exactly beforehand."""

from fractions import Fraction
from itertools import pairwise
from random import Random

import pytest
from enclosure_oracle import scene, truth, unit_step
from enclosure_recurrence import prove
from flint import arb, ctx, fmpq, fmpq_poly

from reference.enclosure.trusted.balls import ball
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.shapes import Covered, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.zeros import Scan
from reference.numbers.taylor_step import TaylorStep

BITS = 200
MOVING = scene(vx="1")


def rational(q):
    return fmpq(q.numerator, q.denominator)


def made_up(edges, xdot, u, rng):
    """The transits that Scan finds in steps between `edges` whose polynomials are off by all that their tubes allow."""
    balls = SceneBalls(MOVING, BITS + 64)
    scan = Scan(balls)
    for a, b in pairwise(edges):
        c = a + (b - a) * Fraction(rng.randint(0, 4), 4)
        h = max(c - a, b - c) * Fraction(rng.randint(16, 24), 16)
        local = xdot(fmpq_poly([rational(c), rational(h)])) * rational(h)
        off = rational(u * Fraction(rng.randint(-8, 8), 9))  # half of it shift, half of it slope
        moved = (local + fmpq_poly([off / 2, off / 2])).integral()
        row = [
            int(q * (1 << BITS)) for q in ([Fraction(int(q.p), int(q.q)) for q in moved.coeffs()])
        ]
        step = TaylorStep(c, h, (a - c) / h, (b - c) / h, BITS, (row, *[[0]] * 3))
        with ctx.workprec(64):
            tube = Tube(
                arb(0), (ball(u) + arb(2) ** -180).upper(), (ball(u) + arb(2) ** -180).upper()
            )
        scan.advance(Covered(Piece(balls, step), tube))
    return scan.finish()


@pytest.mark.parametrize("seed", range(60))
def test_known_zeros_are_found_once_wherever_steps_end(seed):
    rng = Random(seed)
    edges = [
        Fraction(0),
        *sorted({Fraction(rng.randint(1, 30), 7) for _ in range(rng.randint(0, 3))}),
        Fraction(31, 7),
    ]
    u = Fraction(1, 10 ** rng.randint(2, 40))
    zeros = []
    for _ in range(rng.randint(1, 4)):
        near = rng.choice([*edges[1:], Fraction(rng.randint(1, 999), 230)])
        if any(abs(near - z) < Fraction(1, 4) for z in zeros):
            continue  # three together take many leaves
        zeros.append(near + rng.choice((-1, 0, 1)) * Fraction(1, 10 ** rng.randint(1, 50)))
        if rng.random() < 0.4:  # a double zero, or two that are close
            zeros.append(zeros[-1] + rng.choice((0, 1)) * Fraction(1, 10 ** rng.randint(1, 20)))
    xdot = fmpq_poly([rng.choice((-1, 1))])
    for z in zeros:
        xdot *= fmpq_poly([-rational(z), 1])
    found = made_up(edges, xdot, u, rng)
    for z in zeros:
        assert not 0 < z <= edges[-1] or any(f.t.low <= z <= f.t.high for f in found), z
    for f in found:
        inside = [z for z in zeros if f.t.low <= z <= f.t.high]
        assert f.parity != "one" or len(inside) == 1
        assert f.parity != "odd" or len(inside) % 2 == 1
        assert f.parity != "even" or len(inside) % 2 == 0
        if f.parity in ("one", "odd"):
            after = xdot(rational(f.t.high) + fmpq(1, 10**60))
            assert f.direction == (1 if after > 0 else -1)
    if u < Fraction(1, 10**30) and min(
        abs(a - b) for a in zeros for b in [*edges, *zeros] if a is not b
    ) > Fraction(1, 10**6):
        assert [f.parity for f in found] == ["one"] * sum(0 < z <= edges[-1] for z in zeros)


def test_three_zeros_within_the_tube_are_odd_and_not_one():
    xdot = fmpq_poly([1])
    for z in (Fraction(1), Fraction(1) + Fraction(1, 10**4), Fraction(1) - Fraction(1, 10**4)):
        xdot *= fmpq_poly([-rational(z), 1])
    (found,) = made_up([Fraction(0), Fraction(2)], xdot, Fraction(1, 10**6), Random(1))
    assert (found.parity, found.direction) == ("odd", 1)
    assert found.t.low < Fraction(9999, 10000)
    assert found.t.high > Fraction(10001, 10000)


def test_a_release_a_hair_off_the_meridian_keeps_its_early_transit():
    """ẍ(0) = -+1.5e-31 is not known to the bound, and x''' soon turns it round for one of the two signs."""
    first = []
    for x in ("1e-30", "-1e-30"):
        inputs = scene(x=x, y="0.5")
        state = [float(s) for s in truth(inputs, [Fraction(1, 1000)], 300)[0]]
        early = (state[3] > 0) == (float(x) > 0)  # ẍ(0) has the sign of -x
        (hit, *_) = prove(inputs, [Fraction(12)], Fraction(1, 10**15)).proved.zeros["xdot"]
        assert not early or hit.t.low < Fraction(1, 1000)
        first.append(early)
    assert sorted(first) == [False, True]


def test_from_rest_the_third_derivative_must_keep_its_sign_on_the_whole_leaf():
    fast = {"rotation_rate": "0.5", "equatorial_radius": "5", "gravity": "0.01"}
    balls = SceneBalls(scene(x="0", y="0.5", length="1", **fast), BITS + 64)
    assert balls.flat
    x = [0, 0, 0, Fraction(1, 12), Fraction(-1, 4)]  # xdot = s² (1/4 - s)
    m = [0, 0, Fraction(1, 2), Fraction(-2, 3)]  # its second derivative, 1 - 4 s, turns x''' round
    rows = tuple([int(q * 2**BITS) for q in row] for row in (x, m, [-1], [0]))
    tiny = arb(2) ** -180
    scan = Scan(balls)
    piece = Piece(balls, TaylorStep(Fraction(0), Fraction(1), Fraction(0), Fraction(1), BITS, rows))
    scan.advance(Covered(piece, Tube(tiny, tiny, tiny)))
    assert any(f.t.low <= Fraction(1, 4) <= f.t.high for f in scan.finish())


def two_steps(cut, *rows):
    """The zeros that are found in two made-up steps of 1 s that meet at `cut`; their polynomials need not."""
    balls = SceneBalls(MOVING, 128)
    scan = Scan(balls)
    for low, high, own in zip((Fraction(0), cut), (cut, Fraction(1)), rows, strict=True):
        piece = Piece(balls, TaylorStep(Fraction(0), Fraction(1), low, high, 128, own))
        scan.advance(Covered(piece, Tube(*[arb(2) ** -100] * 3)))
    return scan.finish()


def test_at_a_boundary_both_steps_are_asked():
    third, x = Fraction(1, 3), [0, -(2**128) // 3, 2**127]  # xdot = s - 1/3
    (found,) = two_steps(third, *((x, [y << 120], [0], [0]) for y in (0, 1)))
    assert found.parity == "one"
    assert found.t.low <= third <= found.t.high
    # m of both steps (cos of the latitude is 0.66)
    assert found.z.high - found.z.low > Fraction(67, 2**9)


@pytest.mark.parametrize("changes, rows, least", [
    # Ω below the last bit, p' along x and 1000: p × d = p × (2 Ω × p')
    ({"rotation_rate": Fraction(9, 10 * 2**64), "gravity": 0, "latitude": 90},
     ([0, 1000 * 2**64], [0], [2**64], [0]), 1999 * 1000 * Fraction(9, 10 * 2**64)),
    # Ω is a whole number of 2^-64 and Ω² is not; p is large and constant: p × d = Ω² × 10^4
    ({"rotation_rate": Fraction(3, 2**34), "gravity": 0, "latitude": 90},
     ([100 * 2**64], [0], [100 * 2**64], [0]), 9999 * Fraction(9, 2**68)),
    # c below the last bit
    ({"gravity": Fraction(9, 10 * 2**64), "rotation_rate": 0}, ([2**64], [0], [0], [0]), Fraction(9, 10 * 2**64)),
])  # fmt: skip
def test_constants_below_the_last_bit_still_count(changes, rows, least):
    balls = SceneBalls(scene(length="1", **changes), 192)
    piece = Piece(balls, unit_step(64, rows))
    assert piece.sizes.d2 >= ball(least)


def test_sides_that_contradict_each_other_are_refused():
    """xdot is -1/s up to the boundary, and +1/s from there on."""
    with pytest.raises(ArithmeticError, match="contradict"):
        two_steps(Fraction(1, 2), *(([0, way << 128], [0], [0], [0]) for way in (-1, 1)))
