"""The Pareto front, costs at an error, their sentences, and the fitted power law."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compare.report.pareto import (
    cost_at,
    cost_sentence,
    costs_at,
    costs_of_digits,
    curves,
    front,
    sentences,
)
from compare.studies.row import Row

BOUND = 1e-40


def row(
    method="rk4",
    setting=0.1,
    error_m=1e-3,
    cpu_s=1.0,
    status="ok",
    formulation="plane",
    kind="step",
    **more,
):
    return Row(
        method, formulation, setting, kind, "binary64", status, error_m=error_m, cpu_s=cpu_s, **more
    )


def ladder(method, points, *, status="ok", kind="tolerance", formulation="space"):
    """Rows of falling tolerance from (error, cpu) pairs."""
    return [
        row(method, 10.0 ** -(i + 1), error, cpu, status, formulation, kind)
        for i, (error, cpu) in enumerate(points)
    ]


def document(rows, bound_m=BOUND):
    return {
        "scene": "paris",
        "t_end": 86400.0,
        "reference": {"level": "confirmed", "bound_m": bound_m, "transits": 2},
        "machine": {},
        "rows": [asdict(one) for one in rows],
    }


def beats(a, b, bound_m):
    """a dominates b: nowhere worse, somewhere better."""
    errors = [max(one.error_m, bound_m) for one in (a, b)]
    return (
        errors[0] <= errors[1]
        and a.cpu_s <= b.cpu_s
        and (errors[0] < errors[1] or a.cpu_s < b.cpu_s)
    )


def same(a, b, bound_m):
    return a.cpu_s == b.cpu_s and max(a.error_m, bound_m) == max(b.error_m, bound_m)


FEW = st.sampled_from([1e-12, 1e-9, 2e-9, 1e-6, 1e-3, 1.0])  # so that ties happen
ROWS = st.lists(
    st.builds(
        lambda i, error, cpu, status: row(f"m{i}", 0.1, error, cpu, status),
        st.integers(0, 99),
        FEW | st.floats(1e-14, 1.0),
        FEW | st.floats(1e-3, 1e3),
        st.sampled_from(["ok", "ok", "extrapolated", "missed_transits"]),
    ),
    max_size=40,
)


@settings(max_examples=25)
@given(ROWS, st.sampled_from([0.0, 1e-40, 1e-9]))
def test_no_row_of_the_front_is_beaten_and_every_other_measured_row_is(rows, bound_m):
    best = front(rows, bound_m)
    measured = [one for one in rows if one.measured]
    assert not any(beats(other, one, bound_m) for one in best for other in measured)
    for one in measured:
        assert any(
            one is other or beats(other, one, bound_m) or same(other, one, bound_m)
            for other in best
        )


@settings(max_examples=25)
@given(ROWS)
def test_along_the_front_cost_rises_and_error_falls(rows):
    for a, b in pairwise(front(rows)):
        assert a.cpu_s < b.cpu_s
        assert a.error_m > b.error_m


def test_a_failed_row_is_never_on_the_front_however_good_its_numbers():
    failed = row(error_m=1e-30, cpu_s=1e-6, status="missed_transits")
    assert front([failed, row(setting=0.2)]) == [row(setting=0.2)]


def test_a_row_with_a_number_that_is_none_is_not_on_the_front():
    broken = [row(error_m=math.nan), row(cpu_s=None), row(error_m=math.inf)]
    assert front([*broken, row(setting=0.2)]) == [row(setting=0.2)]


def test_below_the_bound_of_the_reference_errors_are_equal():
    cheap, dear = row("a", error_m=3e-41, cpu_s=1.0), row("b", error_m=1e-60, cpu_s=2.0)
    assert front([cheap, dear], BOUND) == [cheap]
    assert front([cheap, dear]) == [cheap, dear]


def test_the_first_formulation_of_a_method_is_its_own_and_others_are_named():
    rows = [
        row("a", formulation="momentum"),
        row("a", formulation="space"),
        row("b", formulation="space"),
    ]
    assert [one.label for one in curves(rows)] == ["a", "a (space)", "b"]


def test_a_ladder_goes_from_loose_to_tight_whatever_order_it_comes_in():
    steps = curves([row(setting=0.1), row(setting=0.5), row(setting=0.2)])[0]
    bits = curves([row(setting=s, kind="precision") for s in (256, 64, 113)])[0]
    assert [one.setting for one in steps.rows] == [0.5, 0.2, 0.1]
    assert [one.setting for one in bits.rows] == [64, 113, 256]


def test_the_cost_of_an_order_four_method_is_interpolated_exactly():
    curve = curves([row(setting=h, error_m=h**4, cpu_s=2 / h) for h in (0.5, 0.2, 0.05, 0.01)])[0]
    for error in (1e-2, 1e-5, 1e-7):
        cost = cost_at(curve, error)
        assert cost == pytest.approx(2 / error**0.25, rel=1e-12)


def test_a_cost_is_never_extrapolated_beyond_the_ladder():
    curve = curves(ladder("a", [(1e-6, 1.0), (1e-9, 2.0)]))[0]
    assert cost_at(curve, 1e-10) is None
    assert cost_at(curve, 1e-3) == 1.0


def test_nothing_is_interpolated_across_a_failed_setting():
    rows = ladder("a", [(1e-2, 1.0), (1e-5, 2.0), (1e-8, 4.0)])
    rows[1] = row("a", 1e-2, None, None, "gave_up", "space", "tolerance")
    assert cost_at(curves(rows)[0], 1e-5) == 4.0


def test_a_ladder_that_turns_back_counts_its_cheapest_way():
    curve = curves(ladder("a", [(1e-3, 1.0), (1e-9, 4.0), (1e-8, 8.0)]))[0]
    assert cost_at(curve, 2e-9) < 4.0
    assert cost_at(curve, 1e-9) == 4.0


def test_no_error_below_the_bound_has_a_cost():
    curve = curves(ladder("a", [(1e-3, 1.0), (1e-60, 4.0)]))[0]
    assert cost_at(curve, 1e-45, BOUND) is None
    assert cost_at(curve, 1e-40, BOUND) == pytest.approx(4.0)


def test_a_run_over_a_part_of_the_span_says_nothing_of_an_error():
    """Neither its cost nor an error of its part may stand for the whole: truth.md F7."""
    part = ladder("a", [(None, 1.0), (1e-9, 5.0), (None, 9.0)])
    part[0], part[2] = (replace(one, status="extrapolated") for one in (part[0], part[2]))
    assert [cpu_s for _, cpu_s in costs_at(part, 1e-9)] == [5.0]
    assert costs_at(part, 1e-10) == []
    assert front(part) == [part[1]]
    assert not any(one.measured or one.failed for one in (part[0], part[2]))


def test_the_sentence_names_the_cheapest_and_how_many_times_dearer_the_papers_method_is():
    rows = [row(setting=h, error_m=h**4, cpu_s=0.01 / h) for h in (0.5, 0.1, 0.01)]
    rows += ladder("fast", [(1e-2, 0.001), (1e-12, 0.01)])
    lines = sentences(document(rows))
    assert len(lines) == 4
    assert lines[1].startswith("At 1e-6 m the cheapest method is fast, with ")
    # 0.01 / 1e-6**0.25 over 0.001 * 10**0.4, two digits
    assert "130 times cheaper than the paper's RK4" in lines[1]
    assert "the paper's RK4 does not reach it (1.0e-08 m at best)" in lines[2]


def test_there_is_no_sentence_where_no_method_reaches():
    assert len(sentences(document(ladder("a", [(1e-2, 1.0), (1e-7, 2.0)])))) == 2
    assert sentences(document([row(status="gave_up")])) == []


def test_where_the_papers_method_is_the_cheapest_the_next_is_named():
    lines = sentences(document([row(error_m=1e-4, cpu_s=1.0), *ladder("a", [(1e-4, 3.0)])]))
    assert (
        lines[0]
        == "At 1e-3 m the cheapest method is rk4, with 1 s of CPU time: 3 times cheaper than the next, a."
    )


def test_the_cost_of_digits_leaves_out_rows_at_the_bound():
    rows = [
        row("heyoka_real", bits, 10.0**-digits, 0.01 * digits**1.5, "ok", "momentum", "precision")
        for bits, digits in ((64, 15), (113, 30), (160, 39), (256, 70), (512, 150))
    ]
    law = costs_of_digits(rows, BOUND)["heyoka_real"]
    assert law.points == 3
    assert law.exponent == pytest.approx(1.5)
    assert law.standard_error < 1e-12
    assert cost_sentence("heyoka_real", law, 600.0) == (
        "The cost of heyoka_real over 600 s is about 0.01 s · digits^1.5: 3 settings of 15 to 39 digits lie within a "
        "factor of 1.00 of it (digits = −log10 of the largest error in m)."
    )
    assert costs_of_digits(rows, 1e-35) == {}
    assert costs_of_digits(rows)["heyoka_real"].points == 5


def test_every_method_whose_setting_is_the_precision_has_its_cost_of_digits():
    points = [(10.0**-digits, 0.01 * digits**1.5) for digits in (15, 30, 60)]
    rows = [one for name in ("a", "b") for one in ladder(name, points, kind="precision")] + ladder(
        "c", points
    )
    assert list(costs_of_digits(rows)) == ["a", "b"]
    heads = [line.split(" is ")[0].partition(":")[0] for line in sentences(document(rows, 1e-70))]
    assert heads == ["a", "b", "c", "The cost of a over 86400 s", "The cost of b over 86400 s"]


def test_a_study_of_precisions_says_the_price_of_a_digit_and_not_the_cheapest_at_large_errors():
    rows = [
        row("heyoka_double", 2**-52, 1e-12, 0.001, "ok", "momentum", "tolerance"),
        row("limbs", 113, 1e-34, 0.003, "ok", "inertial", "precision"),
        row("limbs", 160, 1e-48, 0.010, "ok", "inertial", "precision"),
    ]
    assert sentences(document(rows, 1e-60)) == [
        "heyoka_double: 12 digits over 86400 s cost 1 ms.",
        "limbs: 34 digits over 86400 s cost 3 ms, 48 digits 10 ms; from 34 to 48 a further digit costs 500 µs.",
    ]


def test_the_same_run_that_is_cheapest_at_several_errors_has_one_sentence():
    rows = [
        row("a", 1e-12, 1e-10, 0.5, "ok", "space", "tolerance"),
        row("b", 1e-9, 1e-4, 2.0, kind="tolerance"),
    ]
    rows[1] = row("b", 1e-9, 1e-10, 2.0, "ok", "space", "tolerance")
    assert sentences(document(rows)) == [
        "From 1e-3 m to 1e-9 m the cheapest method is a, with 0.5 s of CPU time."
    ]
