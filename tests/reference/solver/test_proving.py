"""A run with event detection refuses a proof whose zeros it does not see: in number, direction, order and time."""

from dataclasses import replace
from fractions import Fraction

import pytest

import reference
from reference.errors import IntegrationError
from reference.solver.guard import guarded
from reference.solver.pilot import run_pilot


@pytest.fixture(scope="module")
def proved():
    return reference.solve("paris", t_end="60", digits=18, level="enclosed", sections=["gate 30"])


@pytest.fixture(scope="module")
def pilot(proved):
    return run_pilot(proved.scene.exact, proved.times)


# the word of the zeros, and what messages call one of them
KINDS = pytest.mark.parametrize(
    ("word", "name"), [("xdot", "transit"), ("gate 30", "gate 30 passage")]
)


def with_times(solution, word, times):
    """Return a solution whose zeros of a word are said to be at other times."""
    table = solution.zeros[word].table
    place = table.columns.index("t")
    rows = [list(row) for row in table.values]
    for row, t in zip(rows, times, strict=True):
        row[place] = round(t * 2**table.bits)
    return changed(solution, word, table=replace(table, values=[tuple(row) for row in rows]))


def changed(solution, word, **zeros):
    return replace(solution, zeros=solution.zeros | {word: solution.zeros[word]._replace(**zeros)})


def without(solution, word, k):
    """Return a solution that lacks one of the zeros of a word."""
    table, directions, _ = solution.zeros[word]
    values, errors = ([*column[:k], *column[k + 1 :]] for column in (table.values, table.errors))
    directions = [*directions[:k], *directions[k + 1 :]]
    return changed(
        solution, word, table=replace(table, values=values, errors=errors), directions=directions
    )


@KINDS
@pytest.mark.parametrize("k", [0, 3, 6])
@pytest.mark.parametrize("way", [-1, 1])
def test_a_zero_may_be_off_by_what_a_run_in_double_cannot_see_and_no_more(
    proved, pilot, word, name, k, way
):
    """In double a time near 60 s has a last bit of 7e-15 s; xdot has errors near 1e-15 m/s, over its slope of 0.04."""
    times = proved.zeros[word].table.exact("t")
    for off, seen in ((Fraction(1, 10**13), True), (Fraction(1, 10**9), False)):
        moved = with_times(proved, word, [t + way * off * (i == k) for i, t in enumerate(times)])
        if not seen:
            with pytest.raises(
                IntegrationError, match=f"did not find {name} {k + 1}, which the proof has"
            ):
                guarded(moved, pilot)
            continue
        guard = guarded(moved, pilot).guard
        assert word != "xdot" or guard.transit_s >= off * Fraction(9, 10)


@KINDS
def test_another_direction_is_refused(proved, pilot, word, name):
    first, second, *others = proved.zeros[word].directions
    assert guarded(proved, pilot).guard.number == "double"
    with pytest.raises(IntegrationError, match=f"did not find {name} 2"):
        guarded(changed(proved, word, directions=[first, -second, *others]), pilot)


@KINDS
def test_zeros_in_another_order_are_refused(proved, pilot, word, name):
    first, second, third, *others = proved.zeros[word].table.exact("t")
    with pytest.raises(IntegrationError, match=f"did not find {name} 2"):
        guarded(with_times(proved, word, [third, second, first, *others]), pilot)


@KINDS
def test_a_zero_that_is_missing_is_refused_unless_some_are_undecided(proved, pilot, word, name):
    fewer = without(proved, word, 2)
    with pytest.raises(IntegrationError, match=f"finds 7 {name}s, but the proof finds 6"):
        guarded(fewer, pilot)
    t = proved.zeros[word].table.exact("t")[2]
    undecided = changed(fewer, word, possible=((t - 1, t + 1, "odd"),))
    assert guarded(undecided, pilot).guard is not None


@pytest.mark.parametrize(("x", "number"), [("0.3", "double"), ("-1e-9", "real")])
def test_a_flat_transit_soon_after_the_release_is_seen_in_more_bits(x, number):
    """A nanometre beside the meridian, 0.615 m from the rest position: xdot is 0 at x/(0.615 Ω sin φ), after 30 µs."""
    scene = reference.load_scene(
        "paris", [f"release.x={x}", "release.y=0.5", "run.t_end=20", "run.grid_step=20"]
    )
    solution = reference.solve(scene, digits=20, level="enclosed")
    assert solution.guard.number.startswith(number)
    if number == "real":
        assert solution.transits["t"][0] == pytest.approx(1e-9 / (0.615 * 5.49e-5), rel=0.02)
