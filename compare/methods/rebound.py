"""Gragg-Bulirsch-Stoer extrapolation, variable order, and IAS15, Gauss-Radau of order 15: REBOUND.

Forces are compiled to C functions. REBOUND is under the GPL and used only if it is installed.
Bulirsch-Stoer integrates the system as an `ode` of REBOUND's, with eps_rel the setting and eps_abs
the setting times the smallest of the variables' swings. IAS15 moves one particle at n = r/l under
the accelerations of the formulation `space`; its tolerance is `epsilon`, 1e-9 by REBOUND's own
choice. Steps end on the output times.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from .method import SPACE_FIRST, Family, RunOutcome, Work, adaptive, outcome
from .rhs.problem import Problem

POINTER = 8  # bytes

# each reads its structure as a list of pointers to doubles
_ODE = """
@nb.cfunc("void(CPointer(CPointer(float64)), CPointer(float64), CPointer(float64), float64)", **OPTIONS)
def rates(ode, dy, y, t):
    k = ode[${ref}]
    k[${counter}] += 1.0
    ${dy}= traced(${y}${k})
"""

_FORCES = """
@nb.cfunc("void(CPointer(CPointer(float64)))", **OPTIONS)
def rates(simulation):
    k, p = simulation[${extras}], simulation[${particles}]
    k[${counter}] += 1.0
    x, y, z, ax, ay, az = traced(${p}${k})
    p[6] += ax
    p[7] += ay
    p[8] += az
"""


def prepare_bs(problem: Problem, setting: float) -> Work:
    """Compile the right-hand side; the returned function sets up a simulation and integrates."""
    import rebound

    size = len(problem.start)
    rates = problem.compiled(
        problem.system.program, _ODE, ref=rebound.ODE.ref.offset // POINTER
    ).rates

    def work() -> RunOutcome:
        data = np.append(problem.parameters, 0.0)
        simulation = rebound.Simulation()
        simulation.integrator = "bs"
        simulation.integrator.eps_rel = setting
        simulation.integrator.eps_abs = setting * float(problem.sizes.min())
        simulation.dt = _first_step(problem)
        ode = simulation.create_ode(length=size, needs_nbody=False)
        ode.ref = data.ctypes.data
        # the public setter would call it through Python
        ode._derivatives = rebound.ode.ODEDER(rates.address)

        def state() -> Array:  # REBOUND swaps the array that it steps from with the one it steps to
            return np.ctypeslib.as_array(ode.y, (size,))

        state()[:] = problem.start
        return _march(problem, simulation, state, data)

    return work


def prepare_ias15(problem: Problem, setting: float) -> Work:
    """Compile the forces; the returned function sets up a simulation and integrates."""
    import rebound

    fields = {"extras": rebound.Simulation.extras, "particles": rebound.Simulation._particles}
    places = {name: field.offset // POINTER for name, field in fields.items()}
    rates = problem.compiled(problem.system.program, _FORCES, **places).rates

    def work() -> RunOutcome:
        data = np.append(problem.parameters, 0.0)
        simulation = rebound.Simulation()
        simulation.integrator = "ias15"
        simulation.integrator.epsilon = setting
        simulation.gravity = "none"
        simulation.dt = _first_step(problem)
        simulation.extras = data.ctypes.data
        simulation._additional_forces = rebound.simulation.AFF(rates.address)
        simulation.force_is_velocity_dependent = 1
        simulation.add(
            **dict(zip(("x", "y", "z", "vx", "vy", "vz"), problem.start.tolist(), strict=True))
        )
        return _march(
            problem,
            simulation,
            lambda: [*simulation.particles[0].xyz, *simulation.particles[0].vxyz],
            data,
        )

    return work


def _first_step(problem: Problem) -> float:
    """Return a first step, a hundredth of the time scale of a small swing, in s.

    The method adapts it.
    """
    strength = float(np.linalg.norm(np.array(problem.constants.pull, dtype=float)))
    return min(0.01 / math.sqrt(strength) if strength else 1.0, float(problem.times[-1]) or 1.0)


def _march(problem: Problem, simulation: Any, state: Callable[[], Any], data: Array) -> RunOutcome:
    """Integrate to every output time, until the simulation reports an error or the state is not finite."""
    import rebound

    failures = (RuntimeError, rebound.GenericError, rebound.NoParticles, rebound.Escape)
    states, reason, rows = np.empty((len(problem.times), len(problem.start))), "", 1
    states[0] = problem.start
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for span in np.diff(problem.times).tolist():
            # it adds up its steps: at 86400 s their rounding alone would cost 6e-10 m
            simulation.t = 0.0
            try:
                simulation.integrate(span)
            except failures as error:
                reason = str(error)
                break
            states[rows] = state()
            rows += 1
            if not np.isfinite(states[rows - 1]).all():
                break
    reason = reason or "; ".join(dict.fromkeys(str(entry.message) for entry in caught))
    steps = int(simulation.steps_done)
    return outcome(
        problem, states[:rows], steps=steps, rhs_evaluations=int(data[-1]), reason=reason
    )


_rebound = partial(
    adaptive,
    licence="GPL-3.0",
    requires=("rebound", "numba"),
    extra="methods-gpl",
    family=Family.REBOUND,
)

METHODS = (
    _rebound(
        id="rebound_bs",
        title="Gragg-Bulirsch-Stoer, REBOUND",
        ladder=(1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
        source="H. Rein and S.-F. Liu, Astron. Astrophys. 537 (2012) A128",
        prepare=prepare_bs,
        formulations=SPACE_FIRST,
        long_runs=(("space", 1e-12),),
    ),
    _rebound(
        id="rebound_ias15",
        title="IAS15, Gauss-Radau of order 15, REBOUND",
        ladder=(1e-1, 1e-3, 1e-6, 1e-9),
        source="H. Rein and D. S. Spiegel, Mon. Not. R. Astron. Soc. 446 (2015) 1424",
        prepare=prepare_ias15,
        formulations=("space",),
        order=15,
    ),
)
