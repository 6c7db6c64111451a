"""Derivatives to inputs, by differences of runs of limbs at forty digits; and what follows from them is true."""

from fractions import Fraction
from functools import cache
from random import Random

import pytest
from boxes import (
    BOXES,
    box_of,
    check_runs,
    drawn,
    inputs_of,
    outside,
    proof_of,
    truth,
    widened,
    wrong_derivatives,
)
from enclosure_oracle import scene
from flint import fmpz_poly

from reference.enclosure.prove_box import enclose_box
from reference.enclosure.trusted.derivatives import within
from reference.enclosure.trusted.shapes import Box, Interval
from reference.solver.proof_steps import Feed

# by position with drag, by angles with all inputs at once, above the horizontal, with effective gravity,
# with a rest position of each pendulum's own
IN_EVERY_RUN = ("only drag", "fast", "very wide", "effective, fast", "turning table, all inputs")
NAMES = [
    name if name in IN_EVERY_RUN else pytest.param(name, marks=pytest.mark.long) for name in BOXES
]


def narrow_box_of(name):
    """A box whose flattening is exact, as scenes give its inverse."""
    box, times = box_of(name)
    widths = {key: width for key, width in BOXES[name][2].items() if key != "flattening"}
    return widened(box.inputs, widths), times


@cache
def proof_with_derivatives(name):
    """The proof of a box with derivatives to all inputs, also to those that it does not vary."""
    box, times = narrow_box_of(name)
    return proof_of(box, times, inputs_of(box))


@pytest.mark.parametrize("name", NAMES)
def test_every_pendulum_lies_in_what_follows_from_derivatives(name, size):
    check_runs(name, narrow_box_of(name)[0], proof_with_derivatives(name).proved, size(4, 1000))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("point", [True, False])
def test_differences_of_runs_lie_inside(name, point, size):
    box, times = narrow_box_of(name)
    halves, rng = inputs_of(box), Random(f"{name} {point}")
    if point:
        box, halves = Box(box.inputs, box.inputs, box.inputs), dict.fromkeys(halves, Fraction(0))
        found = proof_of(box, times, halves).derivatives
    else:
        found = proof_with_derivatives(name).derivatives
    assert found.names == tuple(halves)
    for key in rng.sample(list(halves), size(1, len(halves))):
        if point:  # and they have four digits; shares are printed with two
            j = found.names.index(key)
            for row in found.states[1:]:
                far = max(max(abs(x.low), abs(x.high)) for x in row[j][:3])
                assert all(x.high - x.low <= far / 10**4 for x in row[j][:3])
        assert wrong_derivatives(found, box.inputs, key) == []
        if not point:
            assert wrong_derivatives(found, drawn(box, rng, corner=True), key) == []


def turned_inside(step, angle):
    """The rows of a step, turned about the Earth's axis by an angle that is 0, with its rate, at both ends."""
    unit = 1 << step.bits
    x, m, *others = (list(map(int, row)) for row in step.coefficients)
    ends = fmpz_poly([-int(step.low * 2**40), 2**40]) * fmpz_poly([-int(step.high * 2**40), 2**40])
    turn = fmpz_poly([int(c) * int(angle * unit) >> 160 for c in (ends**2).coeffs()])
    turned_x = fmpz_poly(x) - turn * fmpz_poly(m) // unit
    turned_m = fmpz_poly(m) + turn * fmpz_poly(x) // unit
    return [list(map(int, f.coeffs())) for f in (turned_x, turned_m)] + others


def test_a_source_whose_steps_change_when_they_are_read_again_proves_nothing_false():
    """As a buffer does that is used again: the radius of the scene's own motion is that of the same polynomials."""
    inputs = scene(t_end="20")
    box = widened(inputs, {"length": "1e-12"})
    times = [Fraction(k, 2) for k in range(41)]

    def steps(bits, end):
        for step in Feed(inputs, (end,), "limbs", 1)(bits):
            readings = [
                step.coefficients,
                turned_inside(step, Fraction(1, 10**9)),
                step.coefficients,
            ]
            yield step._replace(
                rows=lambda readings=readings: readings.pop(0) if len(readings) > 1 else readings[0]
            )

    found = enclose_box(
        box,
        times,
        steps,
        halves={"pendulum.length": Fraction(1, 10**12)},
        derivatives=True,
        zeros=("xdot", "highest"),
    )
    assert outside(found.proved, truth(inputs, times)) == []


def test_bounds_of_one_number_that_contradict_each_other_end_the_proof():
    with pytest.raises(ArithmeticError, match="contradict"):
        within(Interval(Fraction(0), Fraction(1)), Interval(Fraction(2), Fraction(3)), [], [])
