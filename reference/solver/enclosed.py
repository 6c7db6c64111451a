"""The level `enclosed`: a proof, its audit by FLINT alone, and heyoka's confirmation beside it."""

from __future__ import annotations

from contextlib import ExitStack
from fractions import Fraction

from ..engines.plan import Report
from ..engines.side_by_side import Beside, slowest
from ..errors import InputError
from ..scenes.scene import Scene
from .auditing import audit_of, audited
from .confirming import Confirmation
from .pilot import run_pilot
from .proof_checks import guarded
from .proving import Problem, proved
from .solution import Solution


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
    in another formulation has to agree to each of them. Both are done meanwhile, in processes of their own. Where no
    such run confirms every transit, one in a cheaper type may refuse them.

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

    pilot = run_pilot(scene.exact, times)
    problem = Problem(scene, times, engine, pilot)
    children: list[Beside] = []
    report = report and slowest(report, children)
    with ExitStack() as meanwhile:
        if confirm:
            confirmation = Confirmation(scene, times, pilot)
            confirming = meanwhile.enter_context(confirmation.begun())
            children.append(confirming)
        if audit:
            auditing = meanwhile.enter_context(audit_of(problem))
            children.append(auditing)
        solution = proved(problem, enclosure.enclose, report)
        if audit:
            solution = audited(solution, auditing.result(report))
        if confirm:
            solution = confirmation.of(solution, confirming.result(report))
        return solution if confirm and not solution.possible else guarded(solution, pilot)
