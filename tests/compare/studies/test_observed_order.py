"""The order that a ladder of runs shows: the slope where there is one, a dash where rounding or length hides it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from compare.studies.row import Row
from compare.studies.study import orders
from reference.status import Status


def ladder(errors, method="rk4", counts=None, status=Status.OK):
    counts = counts or [100 * 2**i for i in range(len(errors))]
    return [
        Row(method, "plane", 1 / count, "step", "binary64", status, error_m=error, steps=count)
        for count, error in zip(counts, errors, strict=True)
    ]


def only(rows, bound_m=1e-20):
    (one,) = orders(rows, bound_m)
    return one


def test_a_clean_ladder_shows_its_order():
    order = only(ladder([1e-2 * 16.0**-i for i in range(5)]))
    # the least may be rounding
    assert (order.method, order.declared, order.settings) == ("rk4", 4, 4)
    assert order.observed == pytest.approx(4)
    assert order.standard_error == pytest.approx(0, abs=1e-9)


def test_a_wrong_order_is_shown_as_it_is():
    assert only(ladder([1e-2 * 4.0**-i for i in range(6)])).observed == pytest.approx(2)


def test_rounding_and_steps_that_are_too_long_are_left_out():
    errors = [1.0, 0.9, *(1e-2 * 16.0**-i for i in range(4)), 4e-12, 9e-12, 5e-12]
    order = only(ladder(errors))
    assert order.observed == pytest.approx(4)
    assert order.settings == 4


@pytest.mark.parametrize(
    "errors",
    [
        [1e-3, 1e-5],  # two settings
        [1e-3, 9e-4, 1e-3, 8e-4, 1e-3],  # no slope
        [1e-3, 1e-9, 2e-9, 1e-9, 3e-9],  # all but one are rounding
    ],
)
def test_what_cannot_be_told_is_not_told(errors):
    assert only(ladder(errors)).observed is None


def test_errors_near_the_bound_of_the_reference_are_left_out():
    errors = [1e-2 * 16.0**-i for i in range(5)]
    assert only(ladder(errors), bound_m=1e-5).settings == 0  # two are left
    assert only(ladder(errors), bound_m=1e-6).settings == 3


def test_only_whole_runs_count_and_only_methods_with_an_order():
    assert (
        only(ladder([1e-2 * 16.0**-i for i in range(6)], status=Status.EXTRAPOLATED)).observed
        is None
    )
    assert orders(ladder([1e-2, 1e-4, 1e-6, 1e-9], method="heyoka_double"), 1e-20) == []


def test_a_program_declares_no_order_and_shows_the_one_it_has():
    """It tells neither steps nor evaluations, but {setting} is its step."""
    rows = [
        replace(row, steps=None)
        for row in ladder([1e-2 * 16.0**-i for i in range(5)], method="mine")
    ]
    order = only(rows)
    # its command has no {setting}
    assert orders([replace(row, setting=0.0) for row in rows], 1e-20) == []
    assert (order.method, order.declared) == ("mine", None)
    assert order.observed == pytest.approx(4)
