"""The level `enclosed`: a proof, and its confirmation by heyoka.

A confirmation repeats the whole run, or a sample of the grid's intervals.

A sampled run starts from the middles of proven intervals, not from the digits printed of them. By
the theorem a motion that begins in the middle at one time passes through the interval at every
later one. So nothing has to be allowed for how an interval of the grid amplifies half a unit of the
last digit, and the run has to agree as closely as a whole one.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from fractions import Fraction

from ..engines import AUTO
from ..engines.plan import Plan, Report, Run
from ..engines.registry import (
    WORTH_A_PROCESS,
    expected_s,
    fastest,
    in_background,
    run,
    send_run,
)
from ..errors import IntegrationError
from ..numbers.precision import LONG_DOUBLE
from ..numbers.table import Table
from ..numbers.zeros import XDOT
from ..scenes.fields import Confirmation
from .agreement import bits_lacking, zeros_lacking
from .choice import confirming_plan, drawn_intervals, first_prec, need_flint, rounded_prec
from .guard import guarded
from .pilot import MAX_RAISES, check_reach, run_pilot
from .proving import ProofTask, proved
from .request import SolveRequest
from .solution import SAMPLED, CrossCheck, Solution, decimals_of_zeros, grid_decimals
from .workload import Workload

# parts of the work, as its progress names them
_PROVING = "proving"
_CONFIRMING = "confirming"
_SEEING = "looking for transits"
_WITHOUT = "The proof does not rest on heyoka's confirmation: `--confirm none` leaves it out."


def solve_enclosed(request: SolveRequest) -> Solution:
    """Enclose a scene's states and zeros so tightly that every digit asked for is decided.

    With `audit`, all that compiled code returns for the proof is checked, step by step. With
    `confirm`:

    - "whole": heyoka's run in another formulation has to agree to every digit and transit,
    - "sampled": heyoka has to reach the end of each drawn interval of the grid from its first row.

    A whole confirmation runs in the background where that pays. Unless a whole run confirms every
    transit, a cheaper run with event detection must find the same ones (`guard`).

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: no balls are small enough, and it tells the radius that was reached; or
            heyoka's confirmation is out of reach.
        IntegrationError: a run lies outside the enclosure, or finds other transits or numbers; or
            the audit finds that compiled code returned wrong sums.
    """
    need_flint()
    from .. import enclosure

    scene = request.scene
    options = request.proof
    enclosure.check_gates(scene.exact, scene.run.sections or ())
    pilot = run_pilot(scene.exact, request.times)
    task = ProofTask(scene, request.engine, pilot, options.function, options.audit)
    confirm = _affordable(options.confirm, task)

    with ExitStack() as background:
        plan = None if confirm == "none" else _confirming_plan(task, confirm)
        workload = _workload(request, task, plan, confirm)
        whole_run = None
        if plan is not None and confirm == "whole":
            pays = expected_s(plan, pilot.steps) >= WORTH_A_PROCESS
            whole_run = background.enter_context(in_background(pays, send_run, plan))
            workload.watch(_CONFIRMING, whole_run)

        solution = proved(task, enclosure.enclose, workload.part(_PROVING))
        workload.finish(_PROVING)
        if plan is not None and confirm == "sampled":
            witness = _sampled(plan, solution, workload.part(_CONFIRMING))
            solution = confirmed(task, solution, confirm, witness)
            workload.finish(_CONFIRMING)
        if whole_run is not None:
            witness = whole_run.result(workload.part(_CONFIRMING))
            solution = confirmed(task, solution, confirm, witness)

        if whole_run is not None and not solution.possible:
            return solution
        return guarded(solution, pilot, workload.part(_SEEING))


def _workload(
    request: SolveRequest, task: ProofTask, plan: Plan | None, confirm: Confirmation
) -> Workload:
    """Return the parts of the work, with their expected CPU seconds."""
    steps = task.pilot.steps
    prec = first_prec(task.scene, task.pilot, task.engine)
    engine = fastest(prec, task.engine, steps, proof=True)
    proof_s = steps * engine.proof_step_s + engine.expected_s(steps, prec)
    parts_s = {_PROVING: proof_s}
    if plan is not None:
        if confirm == "sampled":
            parts_s[_CONFIRMING] = expected_s(_states_alone(plan), steps) / SAMPLED
        else:
            parts_s[_CONFIRMING] = expected_s(plan, steps)
    if confirm != "whole":
        event_run = confirming_plan(task.scene, request.times, task.pilot, LONG_DOUBLE.prec)
        parts_s[_SEEING] = expected_s(event_run, steps)
    return Workload(request.report, float(task.scene.exact.t_end), parts_s)


def _affordable(confirm: Confirmation, task: ProofTask) -> Confirmation:
    """Return "whole" in place of "sampled" on a grid so fine that a sample costs more."""
    # each interval takes a step at least
    if confirm == "sampled" and len(drawn_intervals(task.scene)) > task.pilot.steps:
        return "whole"
    return confirm


def _confirming_plan(task: ProofTask, confirm: Confirmation, prec: int | None = None) -> Plan:
    """Return heyoka's run in another formulation, in `prec` bits or in those that the digits need.

    Raises:
        UnreachableError: the run, or the sampled tenth of it, is out of reach.
    """
    scene = task.scene
    pilot = task.pilot
    bits = prec or first_prec(scene, pilot, AUTO)
    steps = pilot.steps // SAMPLED if confirm == "sampled" else pilot.steps
    check_reach(steps, bits, scene.run.digits, _WITHOUT)
    return confirming_plan(scene, tuple(scene.exact.grid), pilot, bits)


def _sampled(plan: Plan, solution: Solution, report: Report | None = None) -> Run:
    """Return heyoka's run over the drawn intervals of the grid.

    Each starts from the middle of the proven interval at its first row.
    """
    from ..engines.heyoka.run import run_between

    intervals = drawn_intervals(solution.scene)
    return run_between(_states_alone(plan), solution.grid, intervals, report)


def _states_alone(plan: Plan) -> Plan:
    """Return a run that looks for no transits and no passages of sections."""
    return replace(plan, zeros=())


def confirmed(task: ProofTask, solution: Solution, confirm: Confirmation, witness: Run) -> Solution:
    """Return a proved solution with the run that confirms it, in more bits until it agrees.

    Raises:
        UnreachableError: a finer run, which it takes, is out of reach.
        IntegrationError: heyoka finds other numbers, or other transits.
    """
    grid = solution.grid
    if confirm == "sampled":
        rows = [grid.values[i + 1] for i in drawn_intervals(solution.scene)]
        grid = replace(grid, values=rows)

    last_m: Fraction | None = None
    for _ in range(MAX_RAISES):
        check, missing_bits = _compared(witness, solution, grid)
        if not missing_bits:
            assert solution.proof is not None
            proof = replace(solution.proof, confirmed=confirm)
            return replace(solution, checks=(*solution.checks, check), proof=proof)
        if last_m is not None and check.position_m >= last_m > 0:
            break  # a higher precision does not bring the run closer
        last_m = check.position_m

        solution = replace(solution, discarded_s=solution.discarded_s + witness.cpu_s)
        prec = max(LONG_DOUBLE.prec, rounded_prec(witness.plan.number.prec + missing_bits))
        plan = _confirming_plan(task, confirm, prec)
        witness = run(plan) if confirm == "whole" else _sampled(plan, solution)
    raise IntegrationError(
        f"heyoka does not confirm the proof: its positions differ by {float(check.position_m):.2g} m."
    )


def _compared(witness: Run, solution: Solution, grid: Table) -> tuple[CrossCheck, int]:
    """Return a run as a check of a solution, and the bits that it lacks to agree with it.

    They agree if they differ by a quarter of the last digit at most. `grid` holds the rows of the
    solution that the run has.
    """
    gaps = grid.distance(witness.grid).largest()
    missing = [bits_lacking(gaps, grid_decimals(solution))]
    transit_s = None
    for word, zeros in solution.zeros.items():
        if word not in witness.zeros or zeros.possible:
            continue
        decimals = decimals_of_zeros(solution, word)
        lacking, distances = zeros_lacking(zeros, witness.zeros[word], decimals, witness)
        missing.append(lacking)
        if word == XDOT and distances is not None:
            transit_s = distances.largest()["t"]
    return CrossCheck.by(witness, gaps, transit_s), max(missing)
