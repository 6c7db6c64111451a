"""Five numbers of a seconds pendulum that swings by a nanometre, with more digits than doubles have."""

from fractions import Fraction

import pytest

pytest.importorskip("numba")

from small_scenes import make_scene, run_in_limbs

LENGTH = "0.99362138556613170633012053788567555006143"  # m: g/π², so that half a period is a second

AMPLITUDE = Fraction(1, 10**9)  # m


def test_a_seconds_pendulum():
    scene = make_scene(
        pendulum={"length": LENGTH}, site={"rotation_rate": "0"}, release={"x": "1e-9", "y": "0"}
    )
    swing = run_in_limbs(scene, 113, (Fraction(0), Fraction(1, 2), Fraction(1), Fraction(5, 2)))
    x, vx, t = swing.grid.exact("x"), swing.grid.exact("vx"), swing.transits.exact("t")

    # straight down after a quarter of a period, but for the 3e-20 s that it is late, at 3e-9 m/s
    assert abs(x[1]) < Fraction(1, 10**27)
    # and π nm/s fast there
    assert float(vx[1]) == pytest.approx(-3.14159265358979e-9, rel=1e-14)
    # at the other end after a second: at a turning point its lateness counts by its square
    assert abs(x[2] + AMPLITUDE) < AMPLITUDE / 10**30
    # it turns back there: late by θ²/16 = (1e-9/0.99362)²/16 = 6.33e-20
    assert len(t) == 2
    assert float(t[0] - 1) == pytest.approx(6.33e-20, rel=1e-3)
    assert float(t[1] - 2) == pytest.approx(2 * 6.33e-20, rel=1e-3)
