"""The foundations of every proof, one at a time: outward rounding, joins, and the exact zeros of a scene."""

from fractions import Fraction

import mpmath as mp
import pytest
from enclosure_oracle import acceleration, constants, scene, start, truth
from flint import arb, ctx, fmpz, fmpz_poly
from small_scenes import make_scene

from reference.enclosure.trusted.balls import ball, fixed, interval, size, total, upper
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.radius import PhasePoint, Radius
from reference.enclosure.trusted.shapes import Covered, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.tube import output
from reference.numbers.taylor_step import TaylorStep

WIDE = arb(1, 0.5)  # all of [1/2, 3/2]


def test_a_size_is_that_of_the_farthest_point():
    assert upper(WIDE) >= 1.5
    assert size([arb(3), arb(0), arb(4)]) >= 5 > size([arb(3), arb(0), arb("3.99")])
    assert size([arb(0, 3), arb(0), arb(0, 4)]) >= 5
    assert size([arb(-3, 1), arb(0), arb(0)]) >= 4
    assert total(fmpz_poly([1, -1, 1]), 1) == 1.5


def test_the_pull_at_the_pivot_is_gravity_and_the_centrifugal_force_of_a_sphere():
    """On the equator of a sphere that turns at 0.01/s, at 6.4e6 m: 9.8 - 0.01² 6.4e6 = -630.2 m/s², for 2 m of cord."""
    fields = {
        "latitude": "0",
        "altitude": "0",
        "gravity": "9.8",
        "rotation_rate": "0.01",
        "equatorial_radius": "6.4e6",
    }
    scene_there = make_scene(pendulum={"length": "2"}, site={**fields, "inverse_flattening": "inf"})
    balls = SceneBalls(scene_there.exact, 128)
    east, north, up = balls.turned(balls.c, -1)
    assert east.is_zero() and north.contains(0)
    assert up.overlaps(arb("630.2") / 2)


@pytest.mark.parametrize("prec", [4, 64])
def test_ends_and_integers_are_on_the_safe_side(prec):
    third = Fraction(1, 3)
    with ctx.workprec(prec):
        inside = interval(-ball(third))
        assert inside.low <= -third <= inside.high < 0
        assert upper(ball(third)) >= ball(third)
        whole, off = fixed([ball(third), WIDE, arb(-7) / 3], 5)
    assert all(isinstance(n, fmpz) for n in whole)
    gap = sum(max(abs(x - Fraction(int(n), 32)) for x in ends) for n, ends in zip(
        whole, ((third,), (Fraction(1, 2), Fraction(3, 2)), (Fraction(-7, 3),)), strict=True))  # fmt: skip
    with ctx.workprec(64):
        assert off >= ball(gap) * (1 - arb(2) ** -50)


@pytest.mark.parametrize("useless", [arb("nan"), arb("inf"), arb(2) ** 130, arb(0, "inf")])
def test_ends_of_what_is_useless_are_refused(useless):
    with pytest.raises(ArithmeticError):
        interval(useless)


def piece_at(balls, x, low=0, high=1):
    row = [int(Fraction(q) * 2**64) for q in x]
    rows = (*([c] for c in row), [0])
    return Piece(
        balls, TaylorStep(Fraction(0), Fraction(1), Fraction(low), Fraction(high), 64, rows)
    )


def test_a_join_counts_the_gap_and_the_radius_of_what_is_joined():
    balls = SceneBalls(scene(rotation_rate="0.5"), 128)
    bound = Radius(balls)
    bound.last = PhasePoint([arb(0, 0.25), arb(0), arb(0)], [arb(0)] * 3)
    with ctx.workprec(128):
        jump = bound.join(piece_at(balls, ("0.5", 0, 0), 0, "1/2"))
        assert jump.p[0] >= 0.75
        assert jump.K[2] >= 0.125  # K = p × (Ω × p)
        again = bound.join(piece_at(balls, ("0.5", 0, "0.125"), "1/2", 1))
        assert again.p[0] <= 1e-18
        assert again.p[2] >= 0.125
        assert again.K[0] >= 0.03125


def test_a_tube_is_asked_on_its_own_step_only():
    balls = SceneBalls(scene(), 128)
    piece = piece_at(balls, (0, 0, -1))
    with pytest.raises(ArithmeticError, match="own step"):
        output(Covered(piece, Tube(arb(0), arb(0), arb(0))), Fraction(3, 2))
    got = output(Covered(piece, Tube(arb(1) / 67, arb(2) / 67, arb(0))), Fraction(1, 2))
    assert all(i.high - i.low >= 2 for i in got[:3])
    assert all(i.high - i.low >= 4 for i in got[3:])


@pytest.mark.parametrize("inputs", [
    scene(), scene(vx="0.1"), scene(vy="0.1"), scene(x="0"), scene(x="0", vy="0.1"), scene(x="0", y="0"),
    scene(x="0", latitude="0"), scene(x="0", latitude="90"), scene(x="0", y="0", latitude="0"),
    scene(x="0", y="0", vy="0.1", latitude="90"), scene(x="0", y="0", vx="0.1", latitude="90"),
    scene(rotation_rate="0"), scene(rotation_rate="0", x="0", vy="0.1"), scene(rotation_rate="0", x="0", vx="0.1"),
    scene(rotation_rate="0", x="0", y="0"), scene(angles=("0", "0", "0", "0")), scene(angles=("0", "0", "0", "5")),
    scene(angles=("30", "90", "0", "0")), scene(angles=("30", "90", "0", "5"), latitude="90"),
])  # fmt: skip
def test_exact_zeros_are_claimed_only_where_they_are(inputs):
    balls = SceneBalls(inputs, 128)
    with mp.workprec(300):
        state = start(inputs)
        pull = acceleration(constants(inputs), state)
        small = mp.mpf(10) ** -60
        assert not balls.slow or abs(state[3]) < small
        assert not balls.flat or abs(pull[0]) < small
        ((*_, vx, _, _),) = truth(inputs, [Fraction(7, 3)], 300)
        assert not balls.still or abs(vx) < small
        # what is claimed is also noticed where the input says it plainly
        assert balls.slow == (abs(state[3]) < small)
