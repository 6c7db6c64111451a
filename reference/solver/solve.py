"""Solve a scene to the digits and level asked for: run twice at the bits of choice.py, raise them until both agree.

Pilot runs measure how rounding errors grow on the scene over its whole span; from that follow the bits that the digits
need. Two runs then have to agree to a quarter of the last printed digit in every column: for `self_consistent` at two
precisions, orders and steps, for `confirmed` by another formulation as well. The published numbers are those of the
finer run. For `computed` there is one run only, and for `enclosed` a proof (`enclosed`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from fractions import Fraction

from ..engines import AUTO
from ..engines.plan import Plan, Report, Run
from ..engines.registry import checked, fastest, run, run_both
from ..errors import InputError, UnreachableError, in_words
from ..model.start import Start
from ..numbers.columns import GRID
from ..numbers.precision import DOUBLE, LONG_DOUBLE
from ..numbers.zeros import XDOT
from ..scenes.fields import CONFIRMATIONS, Confirmation
from ..scenes.scene import AnyScene, Scene
from .agreement import Agreement, with_zero_errors
from .choice import confirming_plan, first_prec, pilot_for, published_plan, rounded_prec
from .pilot import MAX_PREC, MAX_RAISES, Pace, Pilot, check_reach, out_of_reach
from .request import requested_scene
from .solution import CrossCheck, Solution, Source


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
        sections: other moments to find, such as ["highest", "gate 30"]: docs/scene.md has the words.
        engine: "heyoka", "limbs" (fast at many digits, needs numba), or None for the fastest that is installed. At
            the level confirmed the run that confirms is always heyoka's.
        audit: at the level enclosed, prove the same run again by FLINT alone, and require the same digits.
        confirm: at the level enclosed, what heyoka confirms as well, in another formulation: "whole", every digit and
            transit, on a second core; "sampled", the end of a tenth of the grid's intervals, each from its first row;
            or "none".
        function: at the level enclosed, make the golden function as well: the motion at any time, `Solution.at`.
        report: called with the simulated time reached, in s.

    Returns:
        A `Solution`: binary64 arrays, exact values, and a bound on every number. Where inputs are known to intervals
        only, `prove_ranges` returns intervals.

    Raises:
        InputError: a field of the scene is wrong.
        UnreachableError: the level or the digits cannot be reached; no numbers are returned then.
    """
    requested = {
        "digits": digits,
        "level": level,
        "t_end": t_end,
        "transits": transits,
        "sections": sections,
    }
    scene = requested_scene(scene, requested)
    settings, times = scene.run, tuple(scene.exact.grid)
    engine = checked(engine)
    if confirm not in CONFIRMATIONS:
        raise InputError("confirm", confirm, in_words(CONFIRMATIONS))
    proving = {"audit": audit, "confirm": confirm != "none", "function": function}
    for name, value in proving.items():
        if value and settings.level != "enclosed":
            raise InputError(
                name,
                settings.level,
                "the level enclosed",
                "Nothing else has the proof that it takes.",
            )
    # a proof is not imported unless it is asked for
    if settings.level == "enclosed":
        from .enclosed import solve_enclosed

        return solve_enclosed(scene, engine, report, audit, confirm, function)
    if settings.level == "computed":
        return _computed(scene, times, engine, report)
    return _agreed(scene, times, pilot_for(scene, times, engine), engine, report)


def solve_at(scene: Scene, times: Collection[Fraction], digits: int) -> Solution:
    """Solve a scene at the level self_consistent and without transits, at times in s that stand for its grid."""
    scene = scene.with_values(
        [f"run.digits={digits}", "run.level=self_consistent", "run.transits=false"]
    )
    every = tuple(
        sorted({Fraction(0), *times} | ({scene.exact.grid_step} if not any(times) else set()))
    )
    return _agreed(scene, every, pilot_for(scene, every), AUTO, None)


def roughly(
    scene: Scene, times: Iterable[Fraction], report: Report | None = None
) -> Solution | None:
    """Solve a scene at times in s by two cheap runs, in long double and in double and another formulation.

    Their distance is the error that is stated; None where they find other transits.

    Raises:
        UnreachableError: it takes too many steps.
        IntegrationError: a run stopped.
    """
    scene, every = scene.with_values(["run.level=confirmed"]), tuple(sorted({Fraction(0), *times}))
    if scene.run.transits:  # a run that finds them is not ended by its pace
        radians = math.ceil(Start.of(scene.exact, LONG_DOUBLE.prec).fastest_rate * float(every[-1]))
        check_reach(radians, LONG_DOUBLE.prec, scene.run.digits)  # about one a step
    fine = Plan(scene.exact, "momentum", LONG_DOUBLE, every, (XDOT,) if scene.run.transits else ())
    published = run(fine, report, Pace(scene.exact, every[-1]))
    witness = run(replace(fine, formulation="spin", number=DOUBLE))
    gap = Agreement.between(published, witness, scene.run.digits)
    if published.directions != witness.directions:
        return None
    check = CrossCheck.by(witness, gap.grid, None)
    return _assemble(scene, published, gap, (check,), 0.0)


def _computed(
    scene: Scene, times: tuple[Fraction, ...], engine: str, report: Report | None
) -> Solution:
    """Solve by a single run, whose errors are estimated from the pilot's."""
    pilot = pilot_for(scene, times, engine)
    prec = first_prec(scene, pilot, engine)
    check_reach(pilot.steps, prec, scene.run.digits)
    published = run(published_plan(scene, times, pilot, prec, engine), report)
    errors = pilot.estimates(published.plan.number.prec)
    return _assemble(scene, published, Agreement(0, {}, errors), (), pilot.cpu_s)


def _agreed(
    scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str, report: Report | None
) -> Solution:
    """Solve by two runs, at a precision that is raised until they agree."""
    digits = scene.run.digits
    prec = first_prec(scene, pilot, engine)
    check_reach(pilot.steps, prec, digits)
    last_gap: Fraction | None = None
    discarded_s = 0.0
    for _ in range(MAX_RAISES):
        fine = published_plan(scene, times, pilot, prec, engine)
        if scene.run.level == "confirmed":
            coarse = confirming_plan(scene, times, pilot, prec)
        else:
            coarse = _witness(fine, prec, engine, pilot.steps)
        published, witness = run_both(fine, coarse, pilot.steps, report)
        gap = Agreement.between(published, witness, digits)
        if not gap.missing_bits:
            checks = (CrossCheck.by(witness, gap.grid, gap.transit_s),)
            return replace(
                _assemble(scene, published, gap, checks, pilot.cpu_s), discarded_s=discarded_s
            )
        discarded_s += published.cpu_s + witness.cpu_s
        largest = max(gap.grid.values())
        if last_gap is not None and largest >= last_gap > 0:
            # limbs hold no more bits of a swing much smaller than the cord
            last_resort = fastest(MAX_PREC).name
            if fine.engine == last_resort:
                raise UnreachableError(
                    "Two runs disagree, and a higher precision does not bring them together."
                )
            engine = last_resort
        last_gap, next_prec = largest, max(LONG_DOUBLE.prec, rounded_prec(prec + gap.missing_bits))
        if out_of_reach(pilot.steps, next_prec):
            break
        prec = next_prec
    raise UnreachableError(
        f"Two runs up to {prec} bits do not agree to {digits} digits.",
        "Ask for fewer digits or a shorter run; a transit that only grazes xdot = 0 cannot be decided this way.",
    )


def _witness(fine: Plan, prec: int, engine: str, steps: int) -> Plan:
    """Return the run that checks another at the level self_consistent: by another engine, or in other steps."""
    coarse = fastest(prec, engine, steps)
    if coarse.name == fine.engine:
        return coarse.witness(fine, prec)
    return coarse.plan(fine.inputs, prec, fine.times, fine.zeros)


def _assemble(
    scene: Scene, published: Run, gap: Agreement, checks: tuple[CrossCheck, ...], pilot_s: float
) -> Solution:
    """Return a run with its bounds as a `Solution`, given its errors and how far a second run is apart, if any."""
    grid = published.grid.only(GRID).with_errors(gap.errors)
    zeros = {
        word: of_word._replace(
            table=with_zero_errors(published, gap.errors, word, gap.zeros.get(word))
        )
        for word, of_word in published.zeros.items()
    }
    return Solution(scene, published.plan.times, grid, zeros, Source.of(published), checks, pilot_s)
