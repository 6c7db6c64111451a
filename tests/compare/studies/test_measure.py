"""What a measurement costs: the whole span, a part of it, and a start that takes longer than all that follows."""

from __future__ import annotations

import numpy as np
import pytest

from compare.methods.method import Method, RunOutcome, Work, outcome
from compare.methods.rhs.problem import Problem
from compare.studies.measure import Bench
from compare.studies.row import GridTruth
from compare.truth import golden_of
from reference import load_scene

T_END = 7680.0  # 128 rows, so that a probe is shorter than what is cut


@pytest.fixture(scope="module")
def truth() -> GridTruth:
    return GridTruth(golden_of(load_scene("paris", ["inputs=binary64"])), T_END)


def costing(start_s: float, s_per_s: float, ends: list[float]) -> Method:
    """A method that stands still, and says that it took `start_s` and then `s_per_s` for each simulated second."""

    def prepare(problem: Problem, setting: float) -> Work:
        def work() -> RunOutcome:
            states = np.tile(problem.start, (len(problem.times), 1))
            ends.append(float(problem.times[-1]))
            return outcome(problem, states, cpu_s=start_s + s_per_s * problem.times[-1])

        return work

    return Method("still", "stands still", "step", (1.0,), "", "", prepare)


@pytest.mark.parametrize(
    ("start_s", "rest_s", "status", "cost_s"),
    [
        (0.0, 1.0, "ok", 1.0),
        (0.04, 0.001, "ok", 0.041),
        # a stiff start: the probe alone, times 64, is far beyond the limit
        (2.9, 0.05, "ok", 2.95),
        (2.0, 30.0, "extrapolated", 32.0),
        (0.0, 30.0, "extrapolated", 30.0),
        (0.0, 600.0, "extrapolated", 600.0),
    ],
)
def test_a_start_is_counted_once(
    truth: GridTruth, start_s: float, rest_s: float, status: str, cost_s: float
) -> None:
    ends: list[float] = []
    bench = Bench(load_scene("paris", ["inputs=binary64"]), truth, 3.0, repeats=1, transits=False)
    row = bench.row(costing(start_s, rest_s / T_END, ends), "plane", 1.0)
    assert row.status == status
    assert row.cpu_s == pytest.approx(cost_s, rel=1e-9)
    assert (max(ends) == T_END) == (status == "ok")
    assert row.reached_t == max(ends)
    # never much more than the limit, once it is known
    assert sum(ends) * rest_s / T_END < 4 * 3.0 + 600 / 64


def test_a_probe_that_passes_the_limit_is_all_that_is_run(truth: GridTruth) -> None:
    ends: list[float] = []
    bench = Bench(load_scene("paris", ["inputs=binary64"]), truth, 3.0, repeats=1, transits=False)
    row = bench.row(costing(0.0, 1000 / T_END, ends), "plane", 1.0)
    assert (row.status, len(ends)) == ("extrapolated", 1)
    assert "measured to t = " in row.reason
