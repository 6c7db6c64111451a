"""The audit of a proof: FLINT alone proves the same run again, in a process of its own where that pays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

from ..errors import IntegrationError
from ..process import Emit, Worker, usable_cores
from .proving import Problem, proved
from .rounding import grid_decimals, transit_decimals
from .solution import Solution

WORTH_STEPS = 2000  # steps of the pilot, a proof of some seconds, from which a process pays for its start


@contextmanager
def audit_of(problem: Problem) -> Iterator[Callable[[Solution], Solution]]:
    """Begin an audit; yield the function that takes the proved solution, waits, and returns it as audited.

    The audit is done meanwhile if it is worth a process and the machine has two cores, else once it is waited for.

    Raises:
        IntegrationError: FLINT alone proves other digits.
    """
    worth = problem.pilot.steps >= WORTH_STEPS and usable_cores() >= 2
    worker = Worker(_send_digits, problem) if worth else None

    def audited(solution: Solution) -> Solution:
        if (worker.receive() if worker else _digits_by_flint(problem)) != _digits(solution):
            raise IntegrationError("FLINT alone proves other digits.")
        assert solution.proof is not None
        return replace(solution, proof=replace(solution.proof, audited=True))

    try:
        yield audited
    finally:
        if worker is not None:
            worker.stop()


def _send_digits(emit: Emit, problem: Problem) -> None:
    emit(_digits_by_flint(problem))


def _digits_by_flint(problem: Problem) -> Any:
    from ..enclosure import enclose

    return _digits(proved(problem, partial(enclose, audit=True)))


def _digits(solution: Solution) -> Any:
    """Return all digits of a solution, and which transits are decided."""
    tables = [solution.grid.printed(grid_decimals(solution))]
    if solution.transits is not None:
        tables.append(solution.transits.printed(transit_decimals(solution)))
    return tables, solution.directions, [parity for *_, parity in solution.possible]
