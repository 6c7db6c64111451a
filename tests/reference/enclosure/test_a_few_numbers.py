"""Five numbers of the Paris pendulum in its first minute, proved to twenty digits."""

from fractions import Fraction

from enclosure_oracle import PARIS
from enclosure_recurrence import prove


def between(interval, low, high):
    return Fraction(low) < interval.low <= interval.high < Fraction(high)


def test_paris_in_its_first_minute():
    proved = prove(PARIS, [Fraction(0), Fraction(60)], Fraction(1, 10**20)).proved
    first, *others = proved.zeros["xdot"]
    (_, _, z, *_), (x, y, *_) = proved.states

    # the cord is 67 m long, and the bob 0.5 m from below its end: sqrt(67² - 0.5²) = 66.998134
    assert between(z, "-66.998135", "-66.998134")
    # xdot vanishes first after half a period, π sqrt(67/9.792) = 8.2178 s
    assert between(first.t, "8.21779", "8.21780")
    # then the bob is as far from the plumb line, which is 0.1152 m to the south: -(0.4 + 2 · 0.1152) = -0.6304 m
    assert between(first.y, "-0.631", "-0.630")
    # 60 s / 8.2178 s = 7.3: seven in a minute, each a single one
    assert [zero.parity for zero in (first, *others)] == ["one"] * 7
    # as docs/gallery/proof_and_checker.ipynb prints it; the interval is no wider than asked for
    assert between(x, "-0.17632674", "-0.17632673")
    assert x.high - x.low <= Fraction(2, 10**20)
    assert between(y, "-0.41586769", "-0.41586768")
