"""Five inputs of the Paris pendulum, as Mathar's section VII prints them."""

from fractions import Fraction

from reference import load_scene


def test_paris_has_the_papers_inputs():
    inputs = load_scene("paris").exact
    assert inputs.length == 67  # m
    # m and m/s: an amplitude of 0.5 m, at rest
    assert inputs.position == (Fraction("0.3"), Fraction("0.4"), 0, 0)
    assert inputs.latitude == Fraction("48.846111")  # degrees
    assert inputs.gravity == Fraction("9.80665")  # m/s²
    assert inputs.rotation_rate == Fraction("7.292115e-5")  # rad/s
