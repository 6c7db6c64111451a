"""Every zero of xdot, once; those that cannot be decided are said to be so."""

from fractions import Fraction
from itertools import pairwise
from random import Random

import mpmath as mp
import numpy as np
import pytest
from enclosure_oracle import (
    PARIS,
    acceleration,
    carry,
    constants,
    doubles,
    q,
    scanned,
    scene,
    steps,
    truth,
    unit_step,
)
from enclosure_recurrence import prove
from flint import arb, ctx
from mutations import with_names
from sampled import one_in
from scipy.integrate import solve_ivp

from reference.enclosure.trusted.balls import ball
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.shapes import Covered, Leaf, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.zeros import Scan, XdotOnStep, narrowed
from reference.numbers.taylor_step import TaylorStep


def middle(interval):
    return (interval.low + interval.high) / 2


def events(inputs, end):
    """Zeros of xdot after t = 0, by scipy."""
    rates, first = doubles(inputs)
    zero = lambda _t, s: s[3]  # noqa: E731
    run = solve_ivp(
        rates, (0, float(end)), first, method="DOP853", rtol=1e-12, atol=1e-13, events=zero
    )
    return [t for t in run.t_events[0] if t > 1e-6]


CASES = {
    "paris": scene(),
    "equator": scene(latitude="0"),
    "pole": scene(latitude="90"),
    "southern": scene(latitude="-33.3"),
    "fast earth": scene(rotation_rate="0.001"),
    "no rotation": scene(rotation_rate="0"),
    "drag": scene(drag="0.01", vx="0.2"),
    "moving, a transit in the first leaf": scene(vx="0.067"),
    "from rest in the meridian": scene(x="0", y="0.5"),
    "drag, from rest in the meridian": scene(x="0", y="0.5", drag="0.01", rotation_rate="0.001"),
    "steep": scene(length="1", angles=("114.59", "30", "0", "0")),
    "near inverted": scene(length="1", angles=("177.6", "30", "0", "0")),
}


# in every run: rest and motion, drag, two swings that are far from small
IN_EVERY_RUN = (
    "paris",
    "moving, a transit in the first leaf",
    "drag, from rest in the meridian",
    "steep",
)
IN_EVERY_RUN += ("near inverted",)


@pytest.mark.parametrize(
    "name",
    [
        name if name in IN_EVERY_RUN else pytest.param(name, marks=pytest.mark.long)
        for name in CASES
    ],
)
def test_transits_are_those_of_an_event_finder(name):
    inputs = CASES[name]
    end = {"steep": Fraction(10), "near inverted": Fraction(4)}.get(name, Fraction(100))
    proof = prove(inputs, [end], Fraction(1, 10**20))
    expected = events(inputs, end)
    assert [t.kind for t in proof.proved.zeros["xdot"]] == ["one"] * len(expected)
    assert np.allclose(
        [float(middle(t.t)) for t in proof.proved.zeros["xdot"]], expected, rtol=0, atol=1e-6
    )
    for before, after in pairwise(proof.proved.zeros["xdot"]):
        assert before.direction == -after.direction
        assert before.t.high < after.t.low


def test_each_column_of_a_transit_holds_what_it_is_called_by():
    inputs = scene(drag="0.01", vx="0.2", rotation_rate="0.001")
    (found, *_) = prove(inputs, [Fraction(20)], Fraction(1, 10**20)).proved.zeros["xdot"]
    (state,) = truth(inputs, [middle(found.t)])
    with mp.workprec(200):
        state = [q(x) for x in state]
        ax, _, _ = acceleration(constants(inputs), state)
        expected = dict(zip(("x", "y", "z", "xdot", "vy", "vz"), state, strict=True)) | {"ax": ax}
        for name in ("x", "y", "z", "vy", "ax"):
            interval = getattr(found, name)
            assert abs(q(middle(interval)) - expected[name]) < mp.mpf(10) ** -15, name
            assert interval.low < interval.high < interval.low + Fraction(1, 10**15)
    assert found.vx is found.vz is None


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_a_transit_on_a_step_boundary_is_found_once(parts):
    rows = list(steps(PARIS, Fraction(30)))
    first = middle(scanned(PARIS, rows)[0].t)
    cut = Fraction(int(first * 2**110), 2**110)
    out = []
    for s in rows:
        at = (cut - s.centre) / s.h
        if s.low < at < s.high:
            inner = [s.low + (at - s.low) * Fraction(i, parts) for i in range(parts + 1)]
            out += [
                s._replace(low=a, high=b) for a, b in zip(inner, [*inner[1:], s.high], strict=True)
            ]
        else:
            out.append(s)
    found = scanned(PARIS, out)
    assert [t.kind for t in found] == ["one"] * len(scanned(PARIS, rows))
    assert found[0].t.low <= cut + Fraction(1, 2**100)
    assert found[0].t.high >= cut - Fraction(1, 2**100)


def test_a_release_perpendicular_to_the_earths_axis_takes_few_leaves():
    """There ẋ ~ t⁴."""
    inputs = scene(latitude="30", length="1", angles=("30", "90", "0", "0"))
    scan, leaves = None, 0
    for covered in carry(inputs, steps(inputs, Fraction(5), bits=200, order=100)):
        scan = scan or Scan(covered.piece.balls)
        scan.advance(covered)
        leaves += scan.leaves
    assert [t.kind for t in scan.finish()] == ["possible", "one", "one", "one", "one"]
    assert leaves < 5000


@pytest.mark.parametrize("inputs", [
    scene(rotation_rate="0", x="0"),
    scene(rotation_rate="0", angles=("100", "90", "3", "0")),
    scene(latitude="90", x="0", y="0"),
    scene(latitude="0", angles=("180", "13", "0", "0")),
])  # fmt: skip
def test_no_transits_where_xdot_is_zero_for_ever(inputs):
    proof = prove(inputs, [Fraction(20)], Fraction(1, 10**15))
    assert proof.proved.still
    assert proof.proved.zeros == {}


def released_in_the_meridian(rng):
    """Rest at x = 0 anywhere in the meridian, above the horizontal too, on any planet, with or without drag."""
    rate = rng.choice((-1, 1)) * 10 ** rng.uniform(-4, 0)
    drag = rng.choice(("0", f"{10 ** rng.uniform(-3, 1):.9f}"))
    angles = (f"{rng.uniform(1, 179):.6f}", rng.choice(("90", "-90")), "0", "0")
    place = {"latitude": f"{rng.uniform(-90, 90):.6f}", "length": f"{10 ** rng.uniform(-1, 2):.6f}"}
    return scene(
        **place, angles=angles, rotation_rate=f"{rate:.9f}", drag=drag, equatorial_radius="100"
    )


@pytest.mark.parametrize("seed", one_in(10, range(20)))
def test_from_rest_in_the_meridian_xdot_has_the_sign_of_the_coriolis_force_on_a_short_leaf(seed):
    inputs = released_in_the_meridian(Random(seed))
    covered = next(carry(inputs, steps(inputs, Fraction(1, 100))))
    form, step, k = XdotOnStep(covered), covered.piece.step, covered.piece.constants
    vague = XdotOnStep(covered._replace(tube=Tube(*covered.tube[:2], arb(1e9))))
    assert vague.sign_from_rest(ball(step.low)) == 0
    signs, longest = set(), 0
    for doubling in range(-8, 20):
        length = (step.high - step.low) * Fraction(2) ** doubling
        sign = form.sign_from_rest(ball(step.low).union(ball(step.low + length)))
        if float(length) ** 2 * float(k.c_size + k.S**2) > 1:
            assert sign == 0
        elif doubling <= 0 and sign:
            signs, longest = signs | {sign}, length
    times = [step.h * longest * Fraction(part, 64) for part in range(1, 65)]
    assert longest > 0
    assert {1 if state[3] > 0 else -1 for state in truth(inputs, times, 160)} == signs


def test_the_tension_follows_from_the_angular_momentum():
    """λ = |v|² + r·F = |H|² + r·c, on which the largest leaf at a start from rest rests (THEOREM.md, section 8)."""
    rng = np.random.default_rng(0)
    r, v, c, turn = rng.normal(size=(4, 100, 3))
    r /= np.linalg.norm(r, axis=1)[:, None]
    along = lambda a, b: np.sum(a * b, axis=1)  # noqa: E731
    v -= along(v, r)[:, None] * r
    force = c - np.cross(turn, np.cross(turn, r)) - 2 * np.cross(turn, v) - 0.3 * v
    momentum = np.cross(r, v + np.cross(turn, r))
    assert along(v, v) + along(r, force) == pytest.approx(
        along(momentum, momentum) + along(r, c), abs=1e-12
    )


def parabola(delta, u):
    """A made-up step with xdot = (s - 1/3)² + delta, true within u."""
    bits = 200
    rows = [[0, Fraction(1, 9) + delta, Fraction(-1, 3), Fraction(1, 3)], *[[0]] * 3]
    whole = tuple([int(c * 2**bits) for c in r] for r in rows)
    step = unit_step(bits, whole)
    balls = SceneBalls(scene(vx="1"), 264)
    out = Scan(balls)
    out.advance(Covered(Piece(balls, step), Tube(arb(u), arb(u), arb(u) * 10)))
    return out.finish()


@pytest.mark.parametrize("delta", [Fraction(0), Fraction(1, 10**41), -Fraction(1, 10**41)])
def test_a_grazing_zero_is_possible_and_even(delta):
    (found,) = parabola(delta, "1e-40")
    assert (found.kind, found.parity) == ("possible", "even")
    assert found.t.low < Fraction(4, 3) < found.t.high
    assert found.t.high - found.t.low < Fraction(1, 10**15)


def test_two_zeros_that_are_close_are_told_apart():
    found = parabola(-Fraction(1, 10**6), "1e-40")
    assert [t.kind for t in found] == ["one", "one"]
    assert [t.direction for t in found] == [-1, 1]
    for t, root in zip(
        found, (Fraction(4, 3) - Fraction(1, 1000), Fraction(4, 3) + Fraction(1, 1000)), strict=True
    ):
        assert abs(middle(t.t) - root) < Fraction(1, 10**35)


def test_a_step_shorter_than_the_precision_is_refused():
    balls, third = SceneBalls(scene(), 128), Fraction(1, 3)
    row = [0, 1 << 128]
    step = TaylorStep(
        -third, Fraction(1), third, third + Fraction(1, 2**200), 128, (row, *[[0]] * 3)
    )
    with pytest.raises(ArithmeticError, match="too short"):
        Scan(balls).advance(Covered(Piece(balls, step), Tube(arb(0), arb(0), arb(0))))


ROUNDED = arb(2) ** -25  # the radius of a ball has 30 bits


@pytest.mark.parametrize("low, high, sides, far", [
    ("1/3", "2/3", (-1, 1), (0, 0)),  # nothing is known outside: both ends stay
    ("-2/3", "1/3", (-1, 1), (1, 1)), ("-2/3", "1/3", (0, 1), (0, 1)), ("-2/3", "1/3", (1, 1), (0, 1)),
    ("-2/3", "1/3", (-1, 0), (1, 0)),
])  # fmt: skip
def test_ends_move_only_to_signs_that_are_those_of_the_sides(low, high, sides, far):
    balls = SceneBalls(scene(), 128)
    with ctx.workprec(balls.prec):
        row = [0, 0, 1 << 127]  # xdot = s
        piece = Piece(balls, unit_step(128, (row, *[[0]] * 3)))
        form = XdotOnStep(Covered(piece, Tube(*[arb(2) ** -90] * 3)))
        low, high = (ball(Fraction(q)) for q in (low, high))
        found = narrowed([Leaf(1, low, high, form)], *sides)
        for end, old, moved in zip((found.lower(), found.upper()), (low, high), far, strict=True):
            assert abs(end - 1 - (0 if moved else old)) < ROUNDED


def test_a_zero_far_from_the_middle_of_a_bent_leaf_is_found():
    balls = SceneBalls(scene(), 128)
    with ctx.workprec(balls.prec):
        row = [0, -(1 << 108), 0, 0, 0, (1 << 128) // 5]  # xdot = s^4 - 2^-20, 0 at 1/32
        piece = Piece(balls, unit_step(128, (row, *[[0]] * 3)))
        form = XdotOnStep(Covered(piece, Tube(*[arb(2) ** -90] * 3)))
        found = narrowed([Leaf(1, arb("0.01"), arb(1), form)], -1, 1)
        assert found.contains(1 + arb(2) ** -5)
        assert found.rad() < arb(2) ** -70


def test_whatever_is_proposed_the_zero_stays_between():
    rng, balls = Random(2), SceneBalls(scene(), 128)
    trusted = with_names("reference/enclosure/trusted/zeros.py", around_zero=lambda _: times)
    with ctx.workprec(balls.prec):
        row = [0, 0, 1 << 127]  # xdot = s, known to 0.01
        piece = Piece(balls, unit_step(128, (row, *[[0]] * 3)))
        form = XdotOnStep(Covered(piece, Tube(*[arb("0.01")] * 3)))
        leaves = [Leaf(1, arb(-1), arb("0.25"), form), Leaf(1, arb("0.25"), arb(1), form)]
        for _ in range(200):
            times = tuple(1 + arb(rng.choice((-1, 1)) * 10 ** rng.uniform(-4, 1)) for _ in range(2))
            found = trusted.narrowed(leaves, -1, 1)
            assert -ROUNDED <= found.lower() <= arb("0.99")
            assert arb("1.01") <= found.upper() <= 2 + ROUNDED


def test_a_parabola_that_stays_clear_has_no_zero():
    assert parabola(Fraction(1, 10**6), "1e-40") == []


def test_an_end_on_a_transit_is_undecided_and_a_little_later_is_not():
    (hit, *_) = prove(PARIS, [Fraction(12)], Fraction(1, 10**30)).proved.zeros["xdot"]
    at = middle(hit.t)
    (last,) = prove(PARIS, [at], Fraction(1, 10**20)).proved.zeros["xdot"]
    assert (last.kind, last.parity) == ("possible", "unknown")
    (later,) = prove(PARIS, [at + Fraction(1, 10**6)], Fraction(1, 10**20)).proved.zeros["xdot"]
    assert later.kind == "one"
    assert prove(PARIS, [at - Fraction(1, 10**6)], Fraction(1, 10**20)).proved.zeros["xdot"] == ()
