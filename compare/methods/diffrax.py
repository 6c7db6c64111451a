"""Dormand-Prince 8(7), order 8, explicit Runge-Kutta with adaptive step: `Dopri8` of diffrax, compiled by JAX.

It runs in binary64 on one thread of the processor. The relative tolerance is the setting, the
absolute tolerance the setting times the smallest of the variables' swings.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from .method import HIGH_ORDER, SPACE_FIRST, RunOutcome, Work, adaptive, leading, outcome
from .rhs.problem import Problem

ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"


def prepare(problem: Problem, setting: float) -> Work:
    """Compile the whole integration; the returned function runs it."""
    os.environ.setdefault("XLA_FLAGS", ONE_THREAD)
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    parameters = dict(problem.system.parameters)
    solver = diffrax.Dopri8()
    controller = diffrax.PIDController(rtol=setting, atol=setting * float(problem.sizes.min()))

    def rhs(_: Any, y: Any, __: Any) -> Any:
        return jnp.stack(
            [jnp.asarray(part) for part in problem.system.rates(tuple(y), jnp, parameters)]
        )

    def integrate(start: Any, times: Any) -> Any:
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rhs),
            solver,
            t0=0.0,
            t1=times[-1],
            dt0=None,
            y0=start,
            saveat=diffrax.SaveAt(ts=times),
            stepsize_controller=controller,
            max_steps=None,
            throw=False,
        )
        return (
            solution.ys,
            solution.stats["num_steps"],
            solution.result == diffrax.RESULTS.successful,
        )

    start, times = jnp.asarray(problem.start), jnp.asarray(problem.times)
    compiled = jax.jit(integrate).lower(start, times).compile()
    stages = solver.tableau.num_stages - int(solver.tableau.fsal)

    def work() -> RunOutcome:
        ys, step_count, successful = compiled(start, times)
        states, steps = np.array(ys), int(step_count)
        reason = "" if successful else "diffrax stopped before the end"
        if not successful:
            states = states[: leading(np.isfinite(states).all(axis=1))]
        return outcome(
            problem, states, steps=steps, rhs_evaluations=steps * stages + 1, reason=reason
        )

    return work


METHODS = (
    adaptive(
        id="diffrax_dopri8",
        title="Dormand-Prince 8(7), diffrax on JAX",
        ladder=HIGH_ORDER,
        source="P. Kidger, On Neural Differential Equations (2021); P. J. Prince and J. R. Dormand (1981)",
        licence="Apache-2.0",
        prepare=prepare,
        formulations=SPACE_FIRST,
        requires=("diffrax",),
        extra="methods-jax",
        order=8,
    ),
)
