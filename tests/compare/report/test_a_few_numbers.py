"""Five numbers that the report of a study makes from rows that can be checked by eye."""

import pytest

from compare.report.pareto import cost_at, curves, front
from compare.studies.row import Row
from reference.status import Status


def row(method, setting, error_m, cpu_s):
    return Row(
        method, "plane", setting, "step", "binary64", Status.OK, error_m=error_m, cpu_s=cpu_s
    )


# ten times the steps: ten times the cost, and of fourth order a 10,000th of the error
RK4 = [row("rk4", 0.1, 1e-4, 1.0), row("rk4", 0.01, 1e-8, 10.0)]
CHEAPER = row("rkng67", 0.1, 1e-8, 2.0)


def test_a_method_of_fourth_order_and_a_cheaper_one():
    rk4, cheaper = curves([*RK4, CHEAPER])

    assert cost_at(rk4, 1e-4) == pytest.approx(1.0)
    # half the way on a logarithmic scale: sqrt(10) s
    assert cost_at(rk4, 1e-6) == pytest.approx(3.162, abs=1e-3)
    # nothing is extrapolated to a smaller error
    assert cost_at(rk4, 1e-9) is None
    assert cost_at(cheaper, 1e-8) == pytest.approx(2.0)
    # the dear run with the same error is beaten
    assert front([*RK4, CHEAPER]) == [RK4[0], CHEAPER]
