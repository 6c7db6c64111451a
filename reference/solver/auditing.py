"""The audit of a proof: FLINT alone proves the same run again, in a process of its own where that pays."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from typing import Any

from ..engines.side_by_side import Beside, beside, reports
from ..errors import IntegrationError
from ..system.process import Emit
from .proving import Problem, proved
from .rounding import grid_decimals, transit_decimals
from .solution import Solution

WORTH_STEPS = 2000  # steps of the pilot, a proof of some seconds, from which a process pays for its start


def audit_of(problem: Problem) -> AbstractContextManager[Beside]:
    """Begin an audit, in a child process where that pays, else once it is waited for: its result is for `audited`."""
    return beside(problem.pilot.steps >= WORTH_STEPS, _send_digits, problem)


def audited(solution: Solution, digits: Any) -> Solution:
    """Return a proved solution as audited, given the digits of its audit.

    Raises:
        IntegrationError: FLINT alone proves other digits.
    """
    if digits != _digits(solution):
        raise IntegrationError("FLINT alone proves other digits.")
    assert solution.proof is not None
    return replace(solution, proof=replace(solution.proof, audited=True))


def _send_digits(emit: Emit, problem: Problem) -> None:
    from ..enclosure import enclose

    emit(_digits(proved(problem, partial(enclose, flint_only=True), reports(emit))))


def _digits(solution: Solution) -> Any:
    """Return all digits of a solution, and which transits are decided."""
    tables = [solution.grid.printed(grid_decimals(solution))]
    if solution.transits is not None:
        tables.append(solution.transits.printed(transit_decimals(solution)))
    return tables, solution.directions, [parity for *_, parity in solution.possible]
