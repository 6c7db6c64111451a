"""Many short runs in limbs with one set of constants, each from a state of its own: as from row to row of a table."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from ...model.algebra import dot
from ...model.start import Start
from ...model.vanishing import xdot_vanishes
from ...numbers.precision import NumberType, to_mpf
from ...scenes.inputs import Inputs
from ..plan import Plan, Run
from .integration import Integration
from .output_times import limbs_of_fractions
from .problem import LimbProblem, limb_problem, state_rows
from .run import result

State = Sequence[Fraction]  # x, y, z in m, vx, vy, vz in m/s


def runs_from(
    inputs: Inputs, prec: int, restarts: Iterable[tuple[State, tuple[Fraction, ...]]], transits: bool
) -> Iterator[Run]:
    """Yield a run for each state and its output times in s, which begin with 0 at that state.

    A state is first put on the sphere, and its velocity along it.

    Args:
        inputs: the exact inputs of a scene, for its constants.
        prec: bits that numbers as large as the swing keep.
        restarts: states and times.
        transits: whether zeros of xdot are looked for.

    Raises:
        IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
    """
    problem = limb_problem(inputs, prec)
    seek = transits and not xdot_vanishes(problem.start)
    for state, times in restarts:
        restarted = _restarted(problem, state)
        whole, remainders = limbs_of_fractions(times, problem.grain, problem.model.limb_count)
        integration = Integration(restarted, whole, remainders, seek)
        cpu_start = time.process_time()
        integration.finish(None)
        yield result(integration, Plan(inputs, "inertial", NumberType("limbs", prec), times, seek, "limbs"), cpu_start)


def _restarted(problem: LimbProblem, state: State) -> LimbProblem:
    ctx, k = problem.start.ctx, problem.start.k
    x, y, z, vx, vy, vz = (to_mpf(value, ctx) / k.length for value in state)
    size = ctx.sqrt(x * x + y * y + z * z)
    n = (x / size, y / size, z / size)
    radial = dot(n, (vx, vy, vz))
    v = (vx - radial * n[0], vy - radial * n[1], vz - radial * n[2])
    position, velocity = (tuple(part * k.length for part in vector) for vector in (n, v))
    start = Start(ctx, k, position, velocity)
    return replace(problem, start=start, state=state_rows(start, problem.unit, problem.model.limb_count))
