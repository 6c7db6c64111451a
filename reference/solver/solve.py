"""Solve a scene to the digits and level asked for: choose a precision, run twice, raise it until both agree.

Pilot runs measure how rounding errors grow on the scene over its whole span; from that follow the bits that the digits
need. Two runs then have to agree to a quarter of the last printed digit in every column: for `self_consistent` at two
precisions and tolerances, for `confirmed` in another formulation as well. The published numbers are those of the finer
run. For `computed` there is one run only, and for `enclosed` a proof (`enclosed`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

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
from .solution import GRID_COLUMNS, STATE, TRANSIT_COLUMNS, CrossCheck, Solution, Source

FINER_BITS = 16  # bits that the published run has more than the one it is compared with
ROUND_TO_BITS = 8  # precisions are multiples of this, so that small changes of the pilot's errors do not show
AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last printed digit
MAX_RAISES = 6  # pairs of runs before giving up

_ZERO_TO_TRANSIT = (0, 1, 2, 3, 5, 7)  # columns t, x, y, z, vy, ax of a run's zeros (t, x, y, z, vx, vy, vz, ax)


def confirming_formulation(pilot: Pilot) -> str:
    """Return `space` if the cord always pulls; `spin`, neutral off the sphere at every angle, if a rod is pushed."""
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
    """Solve a scene to the digits and the level asked for (the scene's own by default).

    Args:
        scene: the scene to solve.
        digits: significant decimal digits of the largest number in each column.
        level: one of `scene.LEVELS`.
        t_end: end of the run in s, as a decimal string.
        transits: whether to find every zero of xdot.
        engine: "heyoka", "limbs" (fast at many digits, needs numba), or None for limbs where numba is installed. At the
            level confirmed the run that confirms is always heyoka's.
        report: called with the simulated time reached, in s.

    Returns:
        A `Solution`: binary64 arrays, exact values, and a bound on every number.

    Raises:
        InputError: a field of the scene is wrong.
        UnreachableError: the level or the digits cannot be reached; no numbers are returned then.
    """
    requested = {"digits": digits, "level": level, "t_end": t_end, "transits": transits}
    scene = scene.with_values(f"run.{key}={value}" for key, value in requested.items() if value is not None)
    inputs, settings = scene.exact, scene.run
    times = tuple(inputs.grid)
    engine = engines.engine_named(engine)
    if settings.level == "enclosed":
        from .enclosed import solve_enclosed  # the proof is not imported unless the level asks for it

        return solve_enclosed(scene, times, engine, report)
    pilot = run_pilot(inputs, times)
    if settings.level == "computed":
        return _computed(scene, times, pilot, engine, report)
    return _agreed(scene, times, pilot, engine, report)


def _computed(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str, report: Report | None) -> Solution:
    """Solve by a single run, whose errors are estimated from the pilot's."""
    prec = pilot.bits_for(scene.run.digits, _span(scene), checked=False)
    _check_reach(pilot, prec, scene.run.digits)
    formulation, number = engines.fastest(_rounded(prec) if prec > LONG_DOUBLE.prec else prec, engine)
    single = run(Plan(scene.exact, formulation, number, times, scene.run.transits), report)
    return _assemble(scene, times, single, pilot.estimates(number.prec), None, (), pilot)


def _agreed(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str, report: Report | None) -> Solution:
    """Solve by two runs, at a precision that is raised until they agree."""
    confirmed = scene.run.level == "confirmed"
    confirming = confirming_formulation(pilot)
    prec = _rounded(max(pilot.bits_for(scene.run.digits, _span(scene), checked=True), LONG_DOUBLE.prec))
    _check_reach(pilot, prec, scene.run.digits)
    last_gap: Fraction | None = None
    for _ in range(MAX_RAISES):
        formulation, number = engines.fastest(prec + FINER_BITS, engine)
        fine = Plan(scene.exact, formulation, number, times, scene.run.transits)
        formulation, number = (confirming, real(prec)) if confirmed else engines.fastest(prec, engine)
        coarse = replace(fine, formulation=formulation, number=number)
        published, witness = run_both(fine, coarse, _expected_s(pilot, fine), report)
        missing, grid_gap, zero_gap = _missing_bits(published, witness, scene.run.digits)
        if not missing:
            errors = tuple(2 * gap for gap in grid_gap)
            check = CrossCheck.of(witness, grid_gap, zero_gap)
            zero_errors = None if zero_gap is None else [tuple(2 * gap for gap in row) for row in zero_gap]
            return _assemble(scene, times, published, errors, zero_errors, (check,), pilot)
        if last_gap is not None and max(grid_gap) >= last_gap > 0:
            raise UnreachableError("Two runs disagree, and a higher precision does not bring them together.")
        last_gap = max(grid_gap)
        next_prec = _rounded(prec + missing)
        if _out_of_reach(pilot, next_prec):
            break
        prec = next_prec
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
    """Return the time in s over which transits are wanted."""
    return scene.exact.t_end if scene.run.transits else None


def _rounded(prec: int) -> int:
    """Round a precision up to a multiple of `ROUND_TO_BITS`."""
    return -(-prec // ROUND_TO_BITS) * ROUND_TO_BITS


def _expected_s(pilot: Pilot, plan: Plan) -> float:
    """Estimate the CPU seconds of heyoka's run from the pilot's steps: 0.6 ms a step at 160 bits, growing as bits²."""
    return 0.0 if plan.number.name == "limbs" else pilot.steps * 6e-4 * (plan.number.prec / 160) ** 2


def _missing_bits(
    published: Run, witness: Run, digits: int
) -> tuple[int, tuple[Fraction, ...], list[tuple[Fraction, ...]] | None]:
    """Return the bits that two runs lack to agree to a quarter of the last digit, and how far apart they are."""
    gaps = disagreement(published.grid, published.bits, witness.grid, witness.bits)[STATE]
    decimals = grid_decimals(largest_of(published.grid, published.bits)[STATE], gaps, digits)
    missing = _bits_lacking(gaps, decimals)
    if published.zeros is None or witness.zeros is None:
        return missing, gaps, None
    if published.directions != witness.directions:
        return witness.plan.number.prec // 2, gaps, None
    if not published.zeros:
        return missing, gaps, []
    rows = [
        tuple(disagreement([a], published.bits, [b], witness.bits)[i] for i in _ZERO_TO_TRANSIT)
        for a, b in zip(published.zeros, witness.zeros, strict=True)
    ]
    t, *_, ax = largest_of(published.zeros, published.bits)
    worst = tuple(map(max, zip(*rows, strict=True)))
    return max(missing, _bits_lacking(worst, transit_decimals(decimals, t, ax, digits))), gaps, rows


def _bits_lacking(gaps: Sequence[Fraction], decimals: Sequence[int]) -> int:
    """Return the bits by which a gap exceeds one unit of its last digit, and a margin; 0 if all keep to `AGREEMENT`."""
    lacking = 0
    for gap, places in zip(gaps, decimals, strict=True):
        ratio = gap * 10**places
        if ratio > AGREEMENT:
            lacking = max(lacking, bits_in(ratio) + MARGIN_BITS)
    return lacking


def _assemble(
    scene: Scene,
    times: tuple[Fraction, ...],
    published: Run,
    errors: tuple[Fraction, ...],
    zero_errors: list[tuple[Fraction, ...]] | None,
    checks: tuple[CrossCheck, ...],
    pilot: Pilot,
) -> Solution:
    """Return a run with its bounds as a `Solution`."""

    def fixed(values: Sequence[Fraction]) -> tuple[int, ...]:
        return tuple(math.ceil(value * 2**published.bits) for value in values)

    states = [row[STATE] for row in published.grid]
    grid = Table(GRID_COLUMNS, published.bits, states, [fixed(errors)] * len(states))
    transits: Table | None = None
    if published.zeros is not None:
        rows = [tuple(row[i] for i in _ZERO_TO_TRANSIT) for row in published.zeros]
        row_errors = [
            _transit_errors(row, published.bits, errors, zero_errors[i] if zero_errors else None)
            for i, row in enumerate(rows)
        ]
        transits = Table(TRANSIT_COLUMNS, published.bits, rows, [fixed(row) for row in row_errors])
    return Solution(scene, times, grid, transits, published.directions, Source.of(published), checks, pilot.cpu_s)


def _transit_errors(
    row: tuple[int, ...], bits: int, errors: tuple[Fraction, ...], measured: tuple[Fraction, ...] | None
) -> tuple[Fraction, ...]:
    """Return the errors of a transit, none less than the two runs differ.

    That of its time is the error of xdot over |ax|; that of ax is taken to be as large as that of vx.
    """
    x, y, z, vx, vy, _ = errors
    ax = abs(Fraction(row[TRANSIT_COLUMNS.index("ax")], 2**bits))
    t = vx / ax if ax else Fraction(10) ** 9  # where xdot only grazes zero, the time is as good as unknown
    expected = (t, x, y, z, vy, vx)
    return tuple(map(max, expected, measured)) if measured else expected
