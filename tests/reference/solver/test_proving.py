"""A run with event detection confirms the transits of a proof within what it can see, and in their order."""

from fractions import Fraction
from types import SimpleNamespace

import pytest

from reference.errors import IntegrationError
from reference.numbers.table import Table
from reference.solver.pilot import ESTIMATE_FACTOR
from reference.solver.proving import EVALUATION_BITS, SEEN_BITS, _between_rows, _bits_to_see, _transit_gap

BITS, PREC, END = 150, 64, Fraction(100)
XDOT_ERROR = Fraction(1, 10**12)  # m/s
TIMES, AX = (Fraction(10), Fraction(30), Fraction(61)), (Fraction(-1, 3), Fraction(1, 7), Fraction(-2))
BOUND = Fraction(1, 10**20)
ROUNDING = END / 2 ** (PREC - EVALUATION_BITS)


def proved():
    rows = [tuple(int(x * 2**BITS) for x in row) for row in zip(TIMES, AX, strict=True)]
    return Table(("t", "ax"), BITS, rows).with_errors({"t": BOUND, "ax": BOUND})


def gap(times, signs=(-1, 1, -1), *, bits=90, undecided=False):
    """The gap to a run that found zeros at these times, at other bits than the proof's."""
    found = Table(("t",), bits, [(round(t * 2**bits),) for t in times])
    plan = SimpleNamespace(number=SimpleNamespace(prec=PREC), times=(Fraction(0), END))
    event_run = SimpleNamespace(transits=found, directions=list(signs), plan=plan)
    solution = SimpleNamespace(transits=proved(), directions=[-1, 1, -1], possible=("some",) if undecided else ())
    return _transit_gap(event_run, solution, XDOT_ERROR)


@pytest.mark.parametrize("bits", [90, 200])
@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize("way", [-1, 1])
def test_a_zero_may_be_off_by_the_errors_of_the_proof_and_of_the_run_and_no_more(bits, k, way):
    allowed = BOUND + XDOT_ERROR / abs(AX[k]) + ROUNDING
    for share, seen in ((Fraction(999, 1000), True), (Fraction(1001, 1000), False)):
        moved = [t + way * share * allowed * (i == k) for i, t in enumerate(TIMES)]
        if seen:
            assert abs(gap(moved, bits=bits) - share * allowed) < Fraction(1, 2**80)
        else:
            with pytest.raises(IntegrationError, match=rf"does not find transit {k + 1} .*at t = {float(TIMES[k])} s"):
                gap(moved, bits=bits)


def test_other_directions_and_other_counts_are_refused_and_zeros_between_only_where_some_are_undecided():
    assert gap(TIMES) < Fraction(1, 2**80)
    with pytest.raises(IntegrationError, match="transit 2"):
        gap(TIMES, (-1, -1, -1))
    with pytest.raises(IntegrationError, match="finds 2 transits, the enclosure 3"):
        gap(TIMES[:2], (-1, 1))
    more = ((*TIMES[:1], Fraction(20), *TIMES[1:]), (-1, 1, 1, -1))
    with pytest.raises(IntegrationError, match="finds 4 transits, the enclosure 3"):
        gap(*more)
    assert gap(*more, undecided=True) < Fraction(1, 2**80)


def test_the_bits_to_see_two_transits_follow_from_the_flattest_and_the_nearest():
    pilot = SimpleNamespace(prec=53, cautious={"vx": Fraction(1, 2**40)})
    # xdot reaches 10/7 m/s, which is from 1 to 2, between the release and the first transit
    assert _bits_to_see(proved(), END, pilot) == 53 - 40 + SEEN_BITS
    assert _bits_to_see(Table(("t", "ax"), BITS, []), END, pilot) == 0


def test_between_rows_a_column_may_be_off_as_far_as_any_of_its_kind():
    assert _between_rows({"x": 3, "y": 1, "z": 2, "vx": 5, "vy": 7, "vz": 6}) == {
        **dict.fromkeys(("x", "y", "z"), 3 * ESTIMATE_FACTOR),
        **dict.fromkeys(("vx", "vy", "vz"), 7 * ESTIMATE_FACTOR),
    }
