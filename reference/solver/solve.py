"""Solve a scene to the digits and level asked for.

Pilot runs measure how rounding errors grow on the scene over its whole span; from that follow the
bits that the digits need. Two runs then have to agree to a quarter of the last printed digit in
every column: for `self_consistent` at two precisions, orders and steps, for `confirmed` by another
formulation as well. The published numbers are those of the finer run. For `computed` there is one
run only, and for `enclosed` a proof (`enclosed`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from fractions import Fraction

from ..engines.plan import Plan, Report, Run
from ..engines.registry import checked, fastest, run, run_both
from ..errors import UnreachableError
from ..model.start import Start
from ..numbers.columns import GRID
from ..numbers.precision import DOUBLE, LONG_DOUBLE, bits_of
from ..numbers.zeros import XDOT
from ..scenes.fields import Confirmation
from ..scenes.scene import AnyScene, Scene
from .agreement import Agreement, with_zero_errors
from .choice import (
    confirming_plan,
    expected_pilot_s,
    first_prec,
    need_heyoka,
    pilot_for,
    published_plan,
    rounded_prec,
)
from .pilot import MARGIN_BITS, MAX_PREC, MAX_RAISES, Pace, Pilot, check_reach, out_of_reach
from .request import ProofOptions, RunSettings, SolveRequest
from .solution import CrossCheck, Solution, Source
from .workload import Workload

# parts of a single run's work, as its progress names them
_MEASURING = "measuring how errors grow"
_INTEGRATING = "integrating"


def solve(
    scene: AnyScene,
    *,
    digits: int | None = None,
    level: str | None = None,
    t_end: str | float | None = None,
    transits: bool | None = None,
    sections: str | Sequence[str] | None = None,
    engine: str | None = None,
    audit: bool = False,
    confirm: Confirmation = "none",
    function: bool = False,
    report: Report | None = None,
) -> Solution:
    """Solve a scene to the digits and the level asked for (the scene's own by default).

    Args:
        scene: the scene to solve: a scene, its id, the path of a TOML file, or nested mappings.
        digits: significant decimal digits of the largest number in each column.
        level: one of `scene.LEVELS`.
        t_end: end of the run in s; a number is taken as it is printed.
        transits: whether to find every zero of xdot.
        sections: other moments to find, such as ["highest", "gate 30"]: docs/scene.md has the
            words.
        engine: "heyoka", "limbs" (fast at many digits, needs numba), or None for the fastest that
            is installed. At the level confirmed the confirming run is always heyoka's.
        audit: at the level enclosed, check all that compiled code returns for the proof, step by
            step, so that FLINT alone proves the same digits.
        confirm: at the level enclosed, what heyoka confirms in another formulation:
            "whole", every digit and transit, on a second core; "sampled", a tenth of the grid's
            intervals, each integrated from its first row; or "none".
        function: at the level enclosed, make the golden function as well: the motion at any time,
            `Solution.at`.
        report: called with the simulated time reached, in s.

    Returns:
        A `Solution`: binary64 arrays, exact values, and a bound on every number. For inputs that are
        known only as intervals, use `prove_ranges`.

    Raises:
        InputError: a field of the scene is wrong.
        UnreachableError: the level or the digits cannot be reached; no numbers are returned then.
    """
    settings = RunSettings(
        digits=digits, level=level, t_end=t_end, transits=transits, sections=sections
    )
    scene = settings.applied_to(scene)
    request = SolveRequest(
        scene=scene,
        times=tuple(scene.exact.grid),
        engine=checked(engine),
        proof=ProofOptions(audit=audit, confirm=confirm, function=function),
        report=report,
    )
    request.proof.check(scene.run.level)
    return _solved(request)


def _solved(request: SolveRequest) -> Solution:
    """Solve a scene at its level.

    Raises:
        InputError: heyoka is not installed.
    """
    need_heyoka()
    scene = request.scene
    level = scene.run.level
    if level == "enclosed":
        # a proof is not imported unless it is asked for
        from .enclosed import solve_enclosed

        return solve_enclosed(request)

    if level == "computed":
        return _computed(request)
    return _agreed(request, pilot_for(scene, request.times, request.engine))


def solve_at(scene: Scene, times: Collection[Fraction], digits: int) -> Solution:
    """Solve a scene at given times in s instead of its grid times, at level self_consistent, without transits."""
    settings = [f"run.digits={digits}", "run.level=self_consistent", "run.transits=false"]
    scene = scene.with_values(settings)
    moments = {Fraction(0), *times}
    if not any(times):  # a run needs an end after its start
        moments.add(scene.exact.grid_step)
    request = SolveRequest(scene=scene, times=tuple(sorted(moments)))
    return _agreed(request, pilot_for(scene, request.times))


def roughly(
    scene: Scene, times: Iterable[Fraction], report: Report | None = None
) -> Solution | None:
    """Solve a scene at times in s by two cheap runs; return None if they find different transits.

    One is in long double, the other in double in another formulation. Their distance is the error
    that is stated, an estimate.

    Raises:
        UnreachableError: it takes too many steps.
        IntegrationError: a run stopped.
    """
    scene = scene.with_values(["run.level=confirmed"])
    moments = tuple(sorted({Fraction(0), *times}))
    end = moments[-1]
    zeros: tuple[str, ...] = ()
    if scene.run.transits:
        zeros = (XDOT,)
        # the pace does not end a run that looks for transits
        check_reach(_expected_steps(scene, end), LONG_DOUBLE.prec, scene.run.digits)

    fine = Plan(scene.exact, "momentum", LONG_DOUBLE, moments, zeros)
    coarse = replace(fine, formulation="spin", number=DOUBLE)
    published = run(fine, report, Pace(scene.exact, end))
    witness = run(coarse)
    gap = Agreement.between(published, witness, scene.run.digits)
    if published.directions != witness.directions:
        return None
    check = CrossCheck.by(witness, gap.grid, None)
    return _assemble(scene, published, gap, (check,), pilot_s=0.0)


def _expected_steps(scene: Scene, end: Fraction) -> int:
    """Return about how many steps a run in double takes until a time in s: one a radian."""
    return math.ceil(Start.of(scene.exact, LONG_DOUBLE.prec).fastest_rate * float(end))


def _computed(request: SolveRequest) -> Solution:
    """Solve by a single run, whose errors are estimated from the pilot's."""
    scene = request.scene
    workload = _work_of_a_single_run(request)
    pilot = pilot_for(scene, request.times, request.engine, workload.part(_MEASURING))
    workload.finish(_MEASURING)
    prec = first_prec(scene, pilot, request.engine)
    check_reach(pilot.steps, prec, scene.run.digits)
    plan = published_plan(scene, request.times, pilot, prec, request.engine)
    published = run(plan, workload.part(_INTEGRATING))
    errors = pilot.estimates(published.plan.number.prec)
    return _assemble(scene, published, Agreement(0, {}, errors), (), pilot.cpu_s)


def _work_of_a_single_run(request: SolveRequest) -> Workload:
    """Return the parts of the work, with their expected CPU seconds."""
    end = request.times[-1]
    steps = _expected_steps(request.scene, end)
    prec = rounded_prec(bits_of(request.scene.run.digits) + MARGIN_BITS)
    parts_s = {
        _MEASURING: expected_pilot_s(request.engine, steps),
        _INTEGRATING: fastest(prec, request.engine, steps).expected_s(steps, prec),
    }
    return Workload(request.report, float(end), parts_s)


def _agreed(request: SolveRequest, pilot: Pilot) -> Solution:
    """Solve by two runs, at a precision that is raised until they agree.

    Raises:
        UnreachableError: they do not agree at any precision that is within reach.
    """
    scene = request.scene
    digits = scene.run.digits
    prec = first_prec(scene, pilot, request.engine)
    check_reach(pilot.steps, prec, digits)

    last_gap: Fraction | None = None
    discarded_s = 0.0
    for _ in range(MAX_RAISES):
        published, witness = _two_runs(request, pilot, prec)
        gap = Agreement.between(published, witness, digits)
        if not gap.missing_bits:
            check = CrossCheck.by(witness, gap.grid, gap.transit_s)
            solution = _assemble(scene, published, gap, (check,), pilot.cpu_s)
            return replace(solution, discarded_s=discarded_s)
        discarded_s += published.cpu_s + witness.cpu_s

        largest_gap = max(gap.grid.values())
        if last_gap is not None and largest_gap >= last_gap > 0:
            # limbs hold no more bits of a swing much smaller than the cord
            last_resort = fastest(MAX_PREC).name
            if published.plan.engine == last_resort:
                raise UnreachableError("Two runs disagree, even at a higher precision.")
            request = replace(request, engine=last_resort)
        last_gap = largest_gap

        next_prec = max(LONG_DOUBLE.prec, rounded_prec(prec + gap.missing_bits))
        if out_of_reach(pilot.steps, next_prec):
            break
        prec = next_prec
    raise UnreachableError(
        f"Two runs of up to {prec} bits do not agree to {digits} digits.",
        "Ask for fewer digits or a shorter run; "
        "two runs cannot decide whether xdot touches zero or crosses it.",
    )


def _two_runs(request: SolveRequest, pilot: Pilot, prec: int) -> tuple[Run, Run]:
    """Return the published run and its witness, of which the coarser has `prec` bits."""
    scene = request.scene
    fine = published_plan(scene, request.times, pilot, prec, request.engine)
    if scene.run.level == "confirmed":
        coarse = confirming_plan(scene, request.times, pilot, prec)
    else:
        coarse = _witness(fine, prec, request.engine, pilot.steps)
    return run_both(fine, coarse, pilot.steps, request.report)


def _witness(fine: Plan, prec: int, engine: str, steps: int) -> Plan:
    """Return the run that checks another at level self_consistent.

    It is made by another engine, or in other steps.
    """
    coarse = fastest(prec, engine, steps)
    if coarse.name == fine.engine:
        return coarse.witness(fine, prec)
    return coarse.plan(fine.inputs, prec, fine.times, fine.zeros)


def _assemble(
    scene: Scene, published: Run, gap: Agreement, checks: tuple[CrossCheck, ...], pilot_s: float
) -> Solution:
    """Return a run as a `Solution`, with its errors, its checks and the cost of its pilot."""
    grid = published.grid.only(GRID).with_errors(gap.errors)
    zeros = {}
    for word, of_word in published.zeros.items():
        table = with_zero_errors(published, gap.errors, word, gap.zeros.get(word))
        zeros[word] = of_word._replace(table=table)
    source = Source.of(published)
    return Solution(scene, published.plan.times, grid, zeros, source, checks, pilot_s)
