"""A run with event detection refuses a proof whose transits it does not see: in number, direction, order and time."""

from dataclasses import replace
from fractions import Fraction

import pytest

import reference
from reference.errors import IntegrationError
from reference.solver.pilot import run_pilot
from reference.solver.proving import guarded


@pytest.fixture(scope="module")
def proved():
    return reference.solve("paris", t_end="60", digits=18, level="enclosed")


@pytest.fixture(scope="module")
def pilot(proved):
    return run_pilot(proved.scene.exact, proved.times)


def with_times(solution, times):
    """Return a solution whose transits are said to be at other times."""
    zeros = solution.zeros
    place = zeros.columns.index("t")
    rows = [list(row) for row in zeros.values]
    for row, t in zip(rows, times, strict=True):
        row[place] = round(t * 2**zeros.bits)
    return replace(solution, zeros=replace(zeros, values=[tuple(row) for row in rows]))


def without(solution, k):
    """Return a solution that lacks one of its transits."""
    zeros = solution.zeros
    values, errors = ([*column[:k], *column[k + 1 :]] for column in (zeros.values, zeros.errors))
    directions = [*solution.directions[:k], *solution.directions[k + 1 :]]
    return replace(solution, zeros=replace(zeros, values=values, errors=errors), directions=directions)


@pytest.mark.parametrize("k", [0, 3, 6])
@pytest.mark.parametrize("way", [-1, 1])
def test_a_transit_may_be_off_by_what_a_run_in_double_cannot_see_and_no_more(proved, pilot, k, way):
    """In double a time near 60 s has a last bit of 7e-15 s; xdot has errors near 1e-15 m/s, over its slope of 0.04."""
    times = proved.zeros.exact("t")
    for off, seen in ((Fraction(1, 10**13), True), (Fraction(1, 10**9), False)):
        moved = with_times(proved, [t + way * off * (i == k) for i, t in enumerate(times)])
        if seen:
            assert guarded(moved, pilot).guard.transit_s >= off * Fraction(9, 10)
        else:
            with pytest.raises(IntegrationError, match=f"does not find transit {k + 1} of the enclosure"):
                guarded(moved, pilot)


def test_another_direction_is_refused(proved, pilot):
    first, second, *others = proved.directions
    assert guarded(proved, pilot).guard.number == "double"
    with pytest.raises(IntegrationError, match="does not find transit 2"):
        guarded(replace(proved, directions=[first, -second, *others]), pilot)


def test_transits_in_another_order_are_refused(proved, pilot):
    first, second, third, *others = proved.zeros.exact("t")
    with pytest.raises(IntegrationError, match="does not find transit 2"):
        guarded(with_times(proved, [third, second, first, *others]), pilot)


def test_a_transit_that_is_missing_is_refused_unless_some_are_undecided(proved, pilot):
    fewer = without(proved, 2)
    with pytest.raises(IntegrationError, match="finds 7 transits, the enclosure 6"):
        guarded(fewer, pilot)
    t = proved.zeros.exact("t")[2]
    undecided = replace(fewer, possible=((t - 1, t + 1, "odd"),))
    assert guarded(undecided, pilot).guard is not None


@pytest.mark.parametrize(("x", "number"), [("0.3", "double"), ("-1e-9", "real")])
def test_a_flat_transit_soon_after_the_release_is_seen_in_more_bits(x, number):
    """A nanometre beside the meridian, 0.615 m from the rest position: xdot is 0 at x/(0.615 Ω sin φ), after 30 µs."""
    scene = reference.load_scene("paris", [f"release.x={x}", "release.y=0.5", "run.t_end=20", "run.grid_step=20"])
    solution = reference.solve(scene, digits=20, level="enclosed")
    assert solution.guard.number.startswith(number)
    if number == "real":
        assert solution.transits["t"][0] == pytest.approx(1e-9 / (0.615 * 5.49e-5), rel=0.02)
