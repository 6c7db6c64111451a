"""The level `enclosed`: a proof, its audit by FLINT alone, and heyoka's confirmation; each in a process of its own."""

from __future__ import annotations

from contextlib import AbstractContextManager, ExitStack
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from ..engines import AUTO
from ..engines.background import WORTH_A_PROCESS, Background, expected_s, in_background, reports, send_run, slowest
from ..engines.plan import Plan, Report, Run
from ..engines.registry import run
from ..errors import InputError, IntegrationError
from ..numbers.columns import GRID, TRANSITS
from ..numbers.precision import LONG_DOUBLE
from ..scenes.scene import Scene
from ..system.workers import Emit
from .agreement import bits_lacking
from .choice import confirming_plan, first_prec, rounded_prec
from .pilot import run_pilot
from .proving import Problem, guarded, proved
from .reach import MAX_RAISES, check_reach
from .solution import CrossCheck, Solution, grid_decimals, transit_decimals

AUDIT_STEPS = 2000  # steps of the pilot, a proof of some seconds, from which an audit in a process pays for its start
WITHOUT = "The proof does not rest on heyoka's confirmation: `--no-confirm` leaves it out."


def solve_enclosed(
    scene: Scene,
    times: tuple[Fraction, ...],
    engine: str,
    report: Report | None,
    audit: bool = False,
    confirm: bool = False,
) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

    With `audit` FLINT alone proves the same run again, which has to give the same digits; with `confirm` heyoka's run
    in another formulation has to agree to each of them. Both are done meanwhile, where that pays. Where no such run
    confirms every transit, one in a cheaper type may refuse them.

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: no balls are small enough, and it tells the radius that was reached; or heyoka's confirmation
            is out of reach.
        IntegrationError: a run lies outside the enclosure, or finds other transits or numbers.
    """
    try:
        from .. import enclosure
    except ModuleNotFoundError as error:
        advice = "Install it with pip install 'foucault-reference[enclose]', or ask for the level confirmed."
        raise InputError("--level", "enclosed", f"the package {error.name}, which the proof needs", advice) from None

    problem = Problem(scene, times, engine, run_pilot(scene.exact, times))
    with ExitStack() as meanwhile:
        confirmation = meanwhile.enter_context(begin_confirmation(problem)) if confirm else None
        second_proof = meanwhile.enter_context(begin_audit(problem)) if audit else None
        report = report and slowest(report, [child for child in (confirmation, second_proof) if child is not None])
        solution = proved(problem, enclosure.enclose, report)
        if second_proof is not None:
            solution = audited(solution, second_proof.result(report))
        if confirmation is not None:
            solution = confirmed(problem, solution, confirmation.result(report))
        return solution if confirm and not solution.possible else guarded(solution, problem.pilot)


def begin_audit(problem: Problem) -> AbstractContextManager[Background]:
    """Begin a proof by FLINT alone; its result, the digits that it proves, is for `audited`."""
    return in_background(problem.pilot.steps >= AUDIT_STEPS, _send_digits, problem)


def audited(solution: Solution, digits: Any) -> Solution:
    """Return a proved solution as audited, given the digits that FLINT alone proves.

    Raises:
        IntegrationError: they are others.
    """
    if digits != proved_digits(solution):
        raise IntegrationError("FLINT alone proves other digits.")
    assert solution.proof is not None
    return replace(solution, proof=replace(solution.proof, audited=True))


def proved_digits(solution: Solution) -> Any:
    """Return all digits of a solution, and which transits are decided."""
    tables = [solution.grid.printed(grid_decimals(solution))]
    if solution.zeros is not None:
        tables.append(solution.zeros.printed(transit_decimals(solution)))
    return tables, solution.directions, [parity for *_, parity in solution.possible]


def _send_digits(emit: Emit, problem: Problem) -> None:
    from ..enclosure import enclose

    emit(proved_digits(proved(problem, partial(enclose, flint_only=True), reports(emit))))


def begin_confirmation(problem: Problem) -> AbstractContextManager[Background]:
    """Begin heyoka's run in another formulation; its result is for `confirmed`.

    Raises:
        UnreachableError: the run is out of reach.
    """
    plan = _confirming_plan(problem, first_prec(problem.scene, problem.pilot, AUTO))
    return in_background(expected_s(plan, problem.pilot.steps) >= WORTH_A_PROCESS, send_run, plan)


def confirmed(problem: Problem, solution: Solution, witness: Run) -> Solution:
    """Return a proved solution with the run that confirms it, at a precision that is raised until it agrees.

    Raises:
        UnreachableError: a finer run, which it takes, is out of reach.
        IntegrationError: heyoka finds other numbers, or other transits.
    """
    last = None
    for _ in range(MAX_RAISES):
        check, missing = _compared(witness, solution)
        if not missing:
            assert solution.proof is not None
            proof = replace(solution.proof, confirmed=True)
            return replace(solution, checks=(*solution.checks, check), proof=proof)
        if last is not None and check.position_m >= last > 0:
            break
        last = check.position_m
        prec = max(LONG_DOUBLE.prec, rounded_prec(witness.plan.number.prec + missing))
        witness = run(_confirming_plan(problem, prec))
    raise IntegrationError(f"heyoka does not confirm the proof: it is {float(check.position_m):.2g} m away.")


def _confirming_plan(problem: Problem, prec: int) -> Plan:
    check_reach(problem.pilot.steps, prec, problem.scene.run.digits, WITHOUT)
    return confirming_plan(problem.scene, problem.times, problem.pilot, prec)


def _compared(witness: Run, solution: Solution) -> tuple[CrossCheck, int]:
    """Return a run as a check of a solution, and the bits that it lacks to agree to a quarter of the last digit."""
    gaps = solution.grid.distance(witness.grid.only(GRID)).largest()
    missing = bits_lacking(gaps, grid_decimals(solution))
    if solution.zeros is None or witness.transits is None or solution.possible:
        return CrossCheck.of(witness, gaps, None), missing
    if witness.directions != solution.directions:
        return CrossCheck.of(witness, gaps, None), max(missing, witness.plan.number.prec // 2)
    apart = solution.zeros.distance(witness.transits.only(TRANSITS)).largest()
    missing = max(missing, bits_lacking(apart, transit_decimals(solution)))
    return CrossCheck.of(witness, gaps, apart["t"]), missing
