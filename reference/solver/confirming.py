"""heyoka's confirmation of a proof: a run of its own, in another formulation, that agrees to every printed digit."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import replace
from fractions import Fraction

from ..engines import AUTO
from ..engines.plan import Run
from ..engines.registry import run
from ..engines.side_by_side import WORTH_A_PROCESS, Beside, beside, expected_s, send_run
from ..errors import IntegrationError
from ..numbers.columns import GRID, TRANSITS
from ..numbers.precision import LONG_DOUBLE
from ..scenes.scene import Scene
from .agreement import bits_lacking
from .choice import confirming_plan, first_prec, rounded_prec
from .pilot import Pilot
from .reach import MAX_RAISES, check_reach
from .rounding import grid_decimals, transit_decimals
from .solution import CrossCheck, Solution

WITHOUT = "The proof does not rest on heyoka's confirmation: `--no-confirm` leaves it out."


class Confirmation:
    """A run that confirms a proof, done meanwhile; its precision is raised until it agrees.

    Raises:
        UnreachableError: as it begins: the run is out of reach.
    """

    def __init__(self, scene: Scene, times: tuple[Fraction, ...], pilot: Pilot) -> None:
        self._scene, self._times, self._pilot = scene, times, pilot
        self._prec = first_prec(scene, pilot, AUTO)
        check_reach(pilot.steps, self._prec, scene.run.digits, WITHOUT)

    def begun(self) -> AbstractContextManager[Beside]:
        """Do the run in a child process meanwhile, where that pays; else once it is waited for."""
        plan = confirming_plan(self._scene, self._times, self._pilot, self._prec)
        return beside(expected_s(plan, self._pilot.steps) >= WORTH_A_PROCESS, send_run, plan)

    def of(self, solution: Solution, found: Run) -> Solution:
        """Return a proved solution with the check that confirms it, given the run that was begun.

        Raises:
            UnreachableError: a finer run, which it takes, is out of reach.
            IntegrationError: heyoka finds other numbers, or other transits.
        """
        last = None
        for _ in range(MAX_RAISES):
            check, missing = _compared(found, solution)
            if not missing:
                assert solution.proof is not None
                proof = replace(solution.proof, confirmed=True)
                return replace(solution, checks=(*solution.checks, check), proof=proof)
            if last is not None and check.position_m >= last > 0:
                break
            last = check.position_m
            self._prec = max(LONG_DOUBLE.prec, rounded_prec(self._prec + missing))
            check_reach(self._pilot.steps, self._prec, self._scene.run.digits, WITHOUT)
            found = run(confirming_plan(self._scene, self._times, self._pilot, self._prec))
        raise IntegrationError(f"heyoka does not confirm the proof: it is {float(check.position_m):.2g} m away.")


def _compared(found: Run, solution: Solution) -> tuple[CrossCheck, int]:
    """Return a run as a check of a solution, and the bits that it lacks to agree to a quarter of the last digit."""
    gaps = solution.grid.distance(found.grid.only(GRID)).largest()
    missing = bits_lacking(gaps, grid_decimals(solution))
    if solution.transits is None or found.transits is None or solution.possible:
        return CrossCheck.of(found, gaps, None), missing
    if found.directions != solution.directions:
        return CrossCheck.of(found, gaps, None), max(missing, found.plan.number.prec // 2)
    apart = solution.transits.distance(found.transits.only(TRANSITS)).largest()
    missing = max(missing, bits_lacking(apart, transit_decimals(solution)))
    return CrossCheck.of(found, gaps, apart["t"]), missing
