"""Gauss-Legendre collocation with 8 stages, order 16: implicit Runge-Kutta, symplectic, fixed step, by this project.

It is symmetric in time and conserves every quadratic invariant. In `momentum` these are n·n, H·n
and, without drag, the energy: whatever the step, the bob stays on the sphere and keeps its energy.
The stages are found by fixed-point iteration, which starts from the polynomial of the step before
and stops where only rounding is left; sums over steps are compensated (Hairer, Lubich, Wanner,
Geometric Numerical Integration, IV.2, VIII.5, VIII.6).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from reference.numbers.precision import Array, context

from .fixed_step import fixed_step, steps_between
from .method import Family, RunOutcome, Work, outcome
from .rhs.problem import Problem
from .tableau import TableauError

STAGES = 8
MOST_ITERATIONS = 60
# below this relative change, an iteration that no longer shrinks has converged to rounding
CONVERGED = 1e-9
_BITS = 200  # precision of the coefficients before they are rounded to double

_MARCH = """
@nb.njit("Tuple((int64, int64, int64))(float64[::1], float64[::1], float64[::1], int64[::1], float64[:, ::1],"
         "float64[:, ::1], float64[::1], float64[:, ::1], float64[::1])", **OPTIONS)
def march(y, k, times, counts, states, a, b, ahead, sizes):
    ${unpack_k}
    x, lost = y.copy(), np.zeros(${size})
    slopes, guess, z, f = np.zeros((${stages}, ${size})), np.zeros((${stages}, ${size})), y.copy(), np.zeros(${size})
    ${f}= traced(${y}${c})
    for i in range(${stages}):
        for d in range(${size}):  # not as slices, for which numba compiles twice as long
            slopes[i, d] = f[d]
    steps, calls = 0, 1
    for row in range(1, len(times)):
        h = (times[row] - times[row - 1]) / counts[row]
        for _ in range(counts[row]):
            if steps > 0:
                for i in range(${stages}):
                    for d in range(${size}):
                        guess[i, d] = 0.0
                        for j in range(${stages}):
                            guess[i, d] += ahead[i, j] * slopes[j, d]
                slopes, guess = guess, slopes
            before, settled = np.inf, False
            for _ in range(${most}):
                change = 0.0
                for i in range(${stages}):
                    for d in range(${size}):
                        sum = 0.0
                        for j in range(${stages}):
                            sum += a[i, j] * slopes[j, d]
                        z[d] = x[d] + h * sum
                    ${f}= traced(${z}${c})
                    for d in range(${size}):
                        change = max(change, abs(h * (f[d] - slopes[i, d])) / sizes[d])
                        slopes[i, d] = f[d]
                calls += ${stages}
                if change == 0.0 or (change < ${converged} and change >= before):
                    settled = True
                    break
                if not np.isfinite(change):
                    break
                before = change
            if not settled:
                return row, steps, calls
            for d in range(${size}):
                sum = 0.0
                for j in range(${stages}):
                    sum += b[j] * slopes[j, d]
                add = h * sum + lost[d]
                moved = x[d] + add
                lost[d] = add - (moved - x[d])
                x[d] = moved
            steps += 1
        for d in range(${size}):
            states[row, d] = x[d]
    return len(times), steps, calls
"""


@cache
def gauss(stages: int) -> tuple[Array, Array, Array]:
    """Return the Gauss-Legendre method of order 2 stages, rounded once, and a prediction of the next step's stages.

    Returns:
        a_ij, shape (stages, stages); b_j, shape (stages,); and the weights of a step's slopes in
        the first guess for the next step's, shape (stages, stages).

    Raises:
        TableauError: the quadrature does not have that order.
    """
    ctx = context(_BITS)
    guesses = np.polynomial.legendre.leggauss(stages)[0]
    nodes = [(1 + ctx.findroot(lambda x: ctx.legendre(stages, x), guess)) / 2 for guess in guesses]
    powers = ctx.matrix([[node**power for node in nodes] for power in range(stages)])

    def weights(values: list[Any]) -> list[Any]:
        """Return the weights of the nodes whose sums over the powers 1, c, c², … have these values."""
        return list(ctx.lu_solve(powers, values))

    b = weights([ctx.mpf(1) / (power + 1) for power in range(stages)])
    for order in range(1, 2 * stages + 1):
        residual = abs(
            sum(w * c ** (order - 1) for w, c in zip(b, nodes, strict=True)) - ctx.mpf(1) / order
        )
        if residual > ctx.mpf(2) ** (-_BITS // 2):
            raise TableauError(f"Gauss-Legendre with {stages} stages", order, residual)
    a = [weights([node ** (power + 1) / (power + 1) for power in range(stages)]) for node in nodes]
    ahead = [weights([(1 + node) ** power for power in range(stages)]) for node in nodes]
    return np.array(a, dtype=float), np.array(b, dtype=float), np.array(ahead, dtype=float)


def prepare(problem: Problem, setting: float, stages: int = STAGES) -> Work:
    """Compile the integration at a fixed step of `setting` seconds.

    The returned function runs it.
    """
    limits = {"stages": stages, "most": MOST_ITERATIONS, "converged": CONVERGED}
    march = problem.compiled(problem.system.program, _MARCH, **limits).march
    coefficients, counts = gauss(stages), steps_between(problem.times, setting)

    def work() -> RunOutcome:
        states = np.empty((len(problem.times), len(problem.start)))
        states[0] = problem.start
        rows, steps, calls = march(
            problem.start,
            problem.parameters,
            problem.times,
            counts,
            states,
            *coefficients,
            problem.sizes,
        )
        reason = (
            ""
            if rows == len(states)
            else "the iteration for the stages does not converge: shorten the step"
        )
        return outcome(problem, states[:rows], steps=steps, rhs_evaluations=calls, reason=reason)

    return work


METHODS = (
    fixed_step(
        id="gauss_legendre",
        title="Gauss-Legendre with 8 stages, order 16, symplectic",
        ladder=(12, 10, 8, 6, 5, 4, 3),
        source="J. C. Butcher, Math. Comp. 18 (1964) 50; J. M. Sanz-Serna, BIT 28 (1988) 877",
        prepare=prepare,
        formulations=("momentum", "spin", "space", "plane", "angles"),
        order=2 * STAGES,
        family=Family.GEOMETRIC,
        stability=((None, 1 / 20),),
        long_runs=(("momentum", 4.0),),
    ),
)
