"""Taylor series from the right-hand side alone, order set by the precision: mpmath's `odefun`, pure Python, slow."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from reference.model.formulations import FORMULATIONS
from reference.model.start import Start
from reference.numbers.columns import STATE
from reference.numbers.precision import GUARD_BITS, context, to_fraction, to_mpf
from reference.numbers.table import Table
from reference.status import Status

from .method import Family, Method, RunOutcome, Work
from .rhs.problem import Problem

SPARE_BITS = 64  # exact states are written with this many bits below the precision


def prepare(problem: Problem, setting: float) -> Work:
    """Set up contexts of `setting` bits.

    The returned function computes the series and sums them.
    """
    prec = int(setting)
    ctx, model = context(prec), FORMULATIONS[problem.formulation]
    exact = Start.of(problem.scene.exact, prec + GUARD_BITS)
    k = exact.k.converted(ctx.mpf)
    start = [ctx.mpf(value) for value in exact.state(model)]
    times = [to_mpf(Fraction(t), ctx) for t in problem.times.tolist()]

    def work() -> RunOutcome:
        calls = 0

        def rhs(_: Any, state: Sequence[Any]) -> list[Any]:
            nonlocal calls
            calls += 1
            return list(model.derivatives(state, k, ctx))

        solution = ctx.odefun(rhs, 0, start)
        states = [solution(t) for t in times]

        def rows() -> Table:
            bits = prec + SPARE_BITS
            vectors = [model.cartesian(state, k, ctx) for state in states]
            values = [
                tuple(int(to_fraction(part * k.length) * 2**bits) for part in (*n, *v))
                for n, v in vectors
            ]
            return Table(STATE, bits, values)

        return RunOutcome(Status.OK, float(problem.times[-1]), rows, rhs_evaluations=calls)

    return work


METHODS = (
    Method(
        id="mpmath_odefun",
        title="Taylor series from the right-hand side alone, mpmath",
        setting="precision",
        ladder=(53, 113),
        source="F. Johansson et al., mpmath",
        licence="BSD-3-Clause",
        prepare=prepare,
        longest_s=60.0,
        family=Family.MANY_DIGITS,
        number="mpf",
    ),
)
