"""The level `enclosed`: a proof, its audit by FLINT alone, and heyoka's confirmation, of the whole or of a sample.

A sampled run starts from the middles of proven intervals, not from the digits printed of them. By the theorem a motion
that begins in the middle at one time passes through the interval at every later one. So nothing has to be allowed for
how an interval of the grid amplifies half a unit of the last digit, and the run has to agree as closely as a whole one.
"""

from __future__ import annotations

import os
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from typing import Any

from ..engines import AUTO
from ..engines.plan import Plan, Report, Run
from ..engines.registry import (
    WORTH_A_PROCESS,
    expected_s,
    in_background,
    reports,
    run,
    send_run,
    slowest,
)
from ..errors import IntegrationError
from ..numbers.precision import LONG_DOUBLE
from ..numbers.table import Table
from ..numbers.zeros import XDOT
from ..scenes.fields import Confirmation
from ..scenes.scene import Scene
from ..system.workers import Emit, Parent
from .agreement import bits_lacking, zeros_lacking
from .choice import confirming_plan, drawn_intervals, first_prec, need_flint, rounded_prec
from .guard import guarded
from .pilot import MAX_RAISES, check_reach, run_pilot
from .proving import ProofTask, proved
from .solution import SAMPLED, CrossCheck, Solution, decimals_of_zeros, grid_decimals, tables_of

# steps of the pilot, a proof of some seconds, from which an audit in a process pays for its start
AUDIT_STEPS = 2000
LOWER = 5  # priority of that process, in steps of `nice`
WITHOUT = "The proof does not rest on heyoka's confirmation: `--confirm none` leaves it out."


def solve_enclosed(
    scene: Scene,
    engine: str,
    report: Report | None,
    audit: bool,
    confirm: Confirmation,
    function: bool,
) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

    With `audit` FLINT alone proves the same run again, which has to give the same digits. Where `confirm` is "whole",
    heyoka's run in another formulation has to agree to each of them. Both are done meanwhile, where that pays. Where it
    is "sampled", heyoka has to reach the end of each drawn interval of the grid from its first row; if these are more
    than the steps of a whole run, that is made. Where no whole run confirms every transit, one in a cheaper type may
    refuse them. With `function` the golden function is made as well.

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: no balls are small enough, and it tells the radius that was reached; or heyoka's confirmation
            is out of reach.
        IntegrationError: a run lies outside the enclosure, or finds other transits or numbers.
    """
    need_flint()
    from .. import enclosure

    enclosure.check_gates(scene.exact, scene.run.sections or ())
    problem = ProofTask(scene, engine, run_pilot(scene.exact, tuple(scene.exact.grid)), function)
    if confirm == "sampled" and len(drawn_intervals(scene)) > problem.pilot.steps:
        # of a grid so fine a sample costs more: a step at least for each interval
        confirm = "whole"
    with ExitStack() as meanwhile:
        plan = None if confirm == "none" else _confirming_plan(problem, confirm)
        pays = plan is not None and expected_s(plan, problem.pilot.steps) >= WORTH_A_PROCESS
        confirming = (
            meanwhile.enter_context(in_background(pays, send_run, plan))
            if confirm == "whole"
            else None
        )
        pays = problem.pilot.steps >= AUDIT_STEPS
        again = in_background(pays, _send_digits, replace(problem, function=False))
        second_proof = meanwhile.enter_context(again) if audit else None
        report = report and slowest(
            report, [child for child in (confirming, second_proof) if child is not None]
        )
        solution = proved(problem, enclosure.enclose, report)
        if plan and confirm == "sampled":  # while the audit goes on
            solution = confirmed(problem, solution, confirm, _sampled(plan, solution, report))
        if second_proof is not None:
            solution = audited(solution, *second_proof.result(report))
        if confirming is not None:
            solution = confirmed(problem, solution, confirm, confirming.result(report))
        return (
            solution if confirming and not solution.possible else guarded(solution, problem.pilot)
        )


def audited(solution: Solution, digits: Any, cpu_s: float) -> Solution:
    """Return a proved solution as audited, given the digits that FLINT alone proves, and the CPU seconds it took.

    Raises:
        IntegrationError: they are others.
    """
    if digits != proved_digits(solution):
        raise IntegrationError("FLINT alone proves other digits.")
    assert solution.proof is not None
    return replace(solution, proof=replace(solution.proof, audited=True, audit_s=cpu_s))


def proved_digits(solution: Solution) -> Any:
    """Return all digits of a solution, and which transits are decided."""
    tables = [table.printed(decimals) for table, decimals in tables_of(solution)]
    decided = {
        word: (zeros.directions, [parity for *_, parity in zeros.possible])
        for word, zeros in solution.zeros.items()
    }
    return tables, decided


def _send_digits(emit: Emit, problem: ProofTask) -> None:
    """Prove the digits by FLINT alone; in a process of its own give way: heyoka's run, the longest, needs a core."""
    from ..enclosure import enclose

    if isinstance(emit, Parent):
        os.nice(LOWER)
    again = proved(problem, partial(enclose, flint_only=True), reports(emit))
    emit((proved_digits(again), again.cpu_s - again.pilot_s))


def _confirming_plan(problem: ProofTask, confirm: Confirmation, prec: int | None = None) -> Plan:
    """Return heyoka's run in another formulation, in `prec` bits or in those that the digits need.

    Raises:
        UnreachableError: the run, or the sampled tenth of it, is out of reach.
    """
    scene, pilot = problem.scene, problem.pilot
    bits = prec or first_prec(scene, pilot, AUTO)
    check_reach(
        pilot.steps // (SAMPLED if confirm == "sampled" else 1), bits, scene.run.digits, WITHOUT
    )
    return confirming_plan(scene, tuple(scene.exact.grid), pilot, bits)


def _sampled(plan: Plan, solution: Solution, report: Report | None = None) -> Run:
    """Return heyoka's run over the drawn intervals, each from the middle of the proven one at its first row."""
    from ..engines.heyoka.run import run_between

    states_alone = replace(plan, zeros=())
    return run_between(states_alone, solution.grid, drawn_intervals(solution.scene), report)


def confirmed(
    problem: ProofTask, solution: Solution, confirm: Confirmation, witness: Run
) -> Solution:
    """Return a proved solution with the run that confirms it, at a precision that is raised until it agrees.

    Raises:
        UnreachableError: a finer run, which it takes, is out of reach.
        IntegrationError: heyoka finds other numbers, or other transits.
    """
    last, grid = None, solution.grid
    if confirm == "sampled":
        grid = replace(grid, values=[grid.values[i + 1] for i in drawn_intervals(solution.scene)])
    for _ in range(MAX_RAISES):
        check, missing = _compared(witness, solution, grid)
        if not missing:
            assert solution.proof is not None
            proof = replace(solution.proof, confirmed=confirm)
            return replace(solution, checks=(*solution.checks, check), proof=proof)
        if last is not None and check.position_m >= last > 0:
            break
        last = check.position_m
        solution = replace(solution, discarded_s=solution.discarded_s + witness.cpu_s)
        prec = max(LONG_DOUBLE.prec, rounded_prec(witness.plan.number.prec + missing))
        plan = _confirming_plan(problem, confirm, prec)
        witness = run(plan) if confirm == "whole" else _sampled(plan, solution)
    raise IntegrationError(
        f"heyoka does not confirm the proof: it is {float(check.position_m):.2g} m away."
    )


def _compared(witness: Run, solution: Solution, grid: Table) -> tuple[CrossCheck, int]:
    """Return a run as a check of a solution, and the bits that it lacks to agree to a quarter of the last digit.

    `grid` are the solution's rows that the run has.
    """
    gaps, late = grid.distance(witness.grid).largest(), None
    missing = [bits_lacking(gaps, grid_decimals(solution))]
    for word, zeros in solution.zeros.items():
        if word in witness.zeros and not zeros.possible:
            lacking, apart = zeros_lacking(
                zeros, witness.zeros[word], decimals_of_zeros(solution, word), witness
            )
            missing.append(lacking)
            if word == XDOT and apart is not None:
                late = apart.largest()["t"]
    return CrossCheck.by(witness, gaps, late), max(missing)
