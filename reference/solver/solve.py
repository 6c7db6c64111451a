"""From a scene to numbers with bounds: choose the precision, run, confirm, compare, raise, repeat.

A double run beside a long double run measures what rounding does to this scene over its whole span;
from that follow the bits that the digits asked for need. Two runs then have to agree to a quarter of
the last digit printed, in every column: for `self_consistent` at two precisions and tolerances, for
`confirmed` in another formulation as well. What is published comes from the finer run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ..engines import registry as engines
from ..engines.plan import Plan, Report, Run
from ..engines.run import run
from ..engines.side_by_side import run_both
from ..errors import UnreachableError
from ..precision import LONG_DOUBLE, real
from ..scene import Scene
from ..table import Table, bits_in, disagreement, largest_of
from .pilot import MARGIN_BITS, Pilot, run_pilot
from .reach import MAX_PREC, MAX_STEPS, effort
from .rounding import grid_decimals, transit_decimals
from .solution import GRID_COLUMNS, TRANSIT_COLUMNS, CrossCheck, Solution, Source

FINER_BITS = 16  # how much finer the published run is than the one it is compared with
ROUND_TO_BITS = 8  # precisions are multiples of this, so that a jitter of the pilot does not show
AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last digit printed
MAX_RAISES = 6

_OF_ZERO = (0, 1, 2, 3, 5, 7)  # of t, x, y, z, vx, vy, vz, ax


def confirming_formulation(pilot: Pilot) -> str:
    """`space` where the cord always pulls; `spin`, neutral at every angle, where a rod would be pushed."""
    return "space" if pilot.tension > 0 else "spin"


def solve(
    scene: Scene,
    *,
    digits: int | None = None,
    level: str | None = None,
    t_end: str | None = None,
    transits: bool | None = None,
    engine: str | None = None,
    report: Report | None = None,
) -> Solution:
    """Solve a scene to the digits and the level asked (the scene's own where not given).

    Args:
        scene: what to solve.
        digits: significant decimal digits of the largest number in each column.
        level: one of `scene.LEVELS`.
        t_end: end of the run in s, as a decimal string.
        transits: whether to find every zero of xdot.
        engine: "heyoka", "limbs" (many digits fast, needs numba), or None for limbs where it is installed. At the level
            confirmed the run that confirms is always heyoka's.
        report: called with the simulated time reached, in s.

    Returns:
        A `Solution`: binary64 arrays, exact values, and a bound on every number.

    Raises:
        InputError: a field of the scene is wrong.
        UnreachableError: the level or the digits cannot be had; no numbers then.
    """
    wanted = {"digits": digits, "level": level, "t_end": t_end, "transits": transits}
    scene = scene.with_values(f"run.{key}={value}" for key, value in wanted.items() if value is not None)
    inputs, asked = scene.exact, scene.run
    times = tuple(inputs.grid)
    engine = engines.chosen(engine)
    if asked.level == "enclosed":
        from .enclosed import solve_enclosed  # the proof is not imported unless the level asks for it

        return solve_enclosed(scene, times, engine, report)
    pilot = run_pilot(inputs, times)
    if asked.level == "computed":
        return _computed(scene, times, pilot, engine, report)
    return _agreed(scene, times, pilot, engine, report)


def _computed(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str, report: Report | None) -> Solution:
    prec = pilot.bits_for(scene.run.digits, _span(scene), checked=False)
    _check_reach(pilot, prec, scene.run.digits)
    formulation, number = engines.fastest(_rounded(prec) if prec > LONG_DOUBLE.prec else prec, engine)
    done = run(Plan(scene.exact, formulation, number, times, scene.run.transits), report)
    return _assemble(scene, times, done, pilot.estimates(number.prec), None, (), pilot)


def _agreed(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str, report: Report | None) -> Solution:
    confirmed = scene.run.level == "confirmed"
    other = confirming_formulation(pilot)
    prec = _rounded(max(pilot.bits_for(scene.run.digits, _span(scene), checked=True), LONG_DOUBLE.prec))
    _check_reach(pilot, prec, scene.run.digits)
    before: Fraction | None = None
    for _ in range(MAX_RAISES):
        formulation, number = engines.fastest(prec + FINER_BITS, engine)
        fine = Plan(scene.exact, formulation, number, times, scene.run.transits)
        checking = (other, real(prec)) if confirmed else engines.fastest(prec, engine)
        coarse = replace(fine, formulation=checking[0], number=checking[1])
        published, witness = run_both(fine, coarse, _expected_s(pilot, fine), report)
        missing, grid_gap, zero_gap = _missing_bits(published, witness, scene.run.digits)
        if not missing:
            errors = tuple(2 * gap for gap in grid_gap)
            check = CrossCheck.of(witness, grid_gap, zero_gap)
            zero_errors = None if zero_gap is None else [tuple(2 * gap for gap in row) for row in zero_gap]
            return _assemble(scene, times, published, errors, zero_errors, (check,), pilot)
        if before is not None and max(grid_gap) >= before > 0:
            raise UnreachableError("Two formulations disagree, and a higher precision does not bring them together.")
        before = max(grid_gap)
        raised = _rounded(prec + missing)
        if _out_of_reach(pilot, raised):
            break
        prec = raised
    raise UnreachableError(
        f"Two runs up to {prec} bits do not agree to {scene.run.digits} digits.",
        "Ask for fewer digits or a shorter run; a transit that only grazes xdot = 0 cannot be decided this way.",
    )


def _out_of_reach(pilot: Pilot, prec: int) -> bool:
    return prec > MAX_PREC or effort(pilot.steps, prec) > MAX_STEPS


def _check_reach(pilot: Pilot, prec: int, digits: int) -> None:
    if _out_of_reach(pilot, prec):
        raise UnreachableError(
            f"{digits} digits take {prec} bits over about {pilot.steps} steps, which is out of reach.",
            "Ask for fewer digits (run.digits) or a shorter run (run.t_end).",
        )


def _span(scene: Scene) -> Fraction | None:
    return scene.exact.t_end if scene.run.transits else None


def _rounded(prec: int) -> int:
    return -(-prec // ROUND_TO_BITS) * ROUND_TO_BITS


def _expected_s(pilot: Pilot, plan: Plan) -> float:
    """CPU seconds of a `real` run, from the pilot's steps: 0.6 ms a step at 160 bits, growing with the square."""
    return 0.0 if plan.number.name == "limbs" else pilot.steps * 6e-4 * (plan.number.prec / 160) ** 2


def _missing_bits(
    published: Run, witness: Run, digits: int
) -> tuple[int, tuple[Fraction, ...], list[tuple[Fraction, ...]] | None]:
    """Bits that two runs lack to agree to a quarter of the last digit, and by how much they differ."""
    gaps = disagreement(published.grid, published.bits, witness.grid, witness.bits)[:6]
    decimals = grid_decimals(largest_of(published.grid, published.bits)[:6], gaps, digits)
    missing = _lacking(gaps, decimals)
    if published.zeros is None or witness.zeros is None:
        return missing, gaps, None
    if published.directions != witness.directions:
        return witness.plan.number.prec // 2, gaps, None
    if not published.zeros:
        return missing, gaps, []
    rows = [
        tuple(disagreement([a], published.bits, [b], witness.bits)[i] for i in _OF_ZERO)
        for a, b in zip(published.zeros, witness.zeros, strict=True)
    ]
    sizes = largest_of(published.zeros, published.bits)
    worst = tuple(map(max, zip(*rows, strict=True)))
    return max(missing, _lacking(worst, transit_decimals(decimals, sizes[0], sizes[-1], digits))), gaps, rows


def _lacking(gaps: Sequence[Fraction], decimals: Sequence[int]) -> int:
    lacking = 0
    for gap, places in zip(gaps, decimals, strict=True):
        ratio = gap * 10**places
        if ratio > AGREEMENT:
            lacking = max(lacking, bits_in(ratio) + MARGIN_BITS)
    return lacking


def _assemble(
    scene: Scene,
    times: tuple[Fraction, ...],
    done: Run,
    errors: tuple[Fraction, ...],
    zero_errors: list[tuple[Fraction, ...]] | None,
    checks: tuple[CrossCheck, ...],
    pilot: Pilot,
) -> Solution:
    """A run with the bounds known for it as a `Solution`."""

    def fixed(values: Sequence[Fraction]) -> tuple[int, ...]:
        return tuple(math.ceil(value * 2**done.bits) for value in values)

    grid = Table(GRID_COLUMNS, done.bits, [row[:6] for row in done.grid], [fixed(errors)] * len(done.grid))
    met: Table | None = None
    if done.zeros is not None:
        rows = [tuple(row[i] for i in _OF_ZERO) for row in done.zeros]
        spread = [
            _zero_errors(row, done.bits, errors, zero_errors[i] if zero_errors else None) for i, row in enumerate(rows)
        ]
        met = Table(TRANSIT_COLUMNS, done.bits, rows, [fixed(row) for row in spread])
    return Solution(scene, times, grid, met, done.directions, Source.of(done), checks, pilot.cpu_s)


def _zero_errors(
    row: tuple[int, ...], bits: int, errors: tuple[Fraction, ...], measured: tuple[Fraction, ...] | None
) -> tuple[Fraction, ...]:
    """Errors of a transit: its time is the error of xdot over |ax|, and never less than two runs differ."""
    ax = abs(Fraction(row[5], 2**bits))
    late = errors[3] / ax if ax else Fraction(10) ** 9
    expected: tuple[Any, ...] = (late, errors[0], *errors[1:3], errors[4], errors[3])
    return tuple(map(max, expected, measured)) if measured else expected
