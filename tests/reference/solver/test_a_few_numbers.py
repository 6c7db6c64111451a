"""Five numbers of the Paris pendulum, solved: frequency, first transits, precession, tilt and where the bob is."""

import pytest

import reference


def test_paris():
    solution = reference.solve(
        "paris", t_end=3600, digits=15, level="confirmed", sections=["highest"]
    )
    transits = solution.transits.array("t")
    assert transits[0] == pytest.approx(8.21779243, abs=1e-8)  # s, half a swing
    # Hz, as Mathar's paper prints it
    assert 1 / transits[1] == pytest.approx(0.060843633, abs=1e-9)
    assert float(solution.x[-1]) == pytest.approx(0.384762151687661, abs=1e-15)  # m, after an hour
    # over an hour the plane turns clockwise by 11.34 degrees, Ω sin φ = 11.33 and what a narrow ellipse adds
    assert float(solution.swing.precession[0]) == pytest.approx(-11.34, abs=0.02)
    # it swings about a place 0.1152 m south of the vertical: half-way between the ends of the first swing
    first, second = (solution.transits.array("y")[k] for k in (0, 1))
    assert (first + second) / 2 == pytest.approx(-0.1152, abs=1e-3)
