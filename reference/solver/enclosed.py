"""The level `enclosed`: from enclosing balls to printed digits, cross-checked against independent runs.

The approximant is a run by heyoka or limbs, whose states must lie in the balls; a second run with heyoka's event
detection, in the cheapest type that serves, must find the same transits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import ceil
from typing import Any

from ..columns import GRID, POSITION, TRANSITS
from ..engines.plan import Plan, Report, Run
from ..engines.registry import run
from ..errors import InputError, IntegrationError, UnreachableError
from ..precision import cheapest_type, rounded_up
from ..scene import Scene
from ..table import Table, bits_in
from .approximant import COEFFICIENT_BITS, Feed
from .choice import first_radius
from .pilot import Pilot, run_pilot
from .rounding import UndecidedRounding, check_decided, grid_decimals, transit_decimals
from .solution import CrossCheck, Proof, Solution, Source

ROUNDING_TRIES = 8  # radii that are tried before giving up
FINER = 2**16  # the next radius is smaller by this factor at least,
SPARE = 2**20  # and at least so small that the widest undecided number is known to this part of its last digit
TIE = Fraction(1, 2**40)  # of the last digit: a number that lies so near to the middle of two decimals is a tie
USUAL_DIGITS, FINER_DIGITS = 9, 27  # of the run with event detection, at first and on a second try
EVALUATION_BITS = 12  # bits that a run may lose when its polynomial is evaluated, so that it misses its ball
MOST_CHECK_PREC = 1024  # bits of a run with event detection; one that would need more is not made
SEEN_BITS = 12  # xdot has this many bits beside a transit in such a run
TABLE_BITS = 64  # the tables' integers carry this many bits more than the proof, so that rounding costs nothing


def solve_enclosed(
    scene: Scene, times: tuple[Fraction, ...], engine: str, report: Report | None, audit: bool = False
) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

    With `audit` the same run is then proved again by FLINT alone, which has to give the same digits.

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: no balls are small enough; it tells the radius that was reached.
        IntegrationError: a run lies outside the enclosure, or finds other transits.
    """
    try:
        from .. import enclosure
    except ModuleNotFoundError as error:
        advice = "Install it with pip install 'foucault-reference[enclose]'."
        raise InputError("--level", "enclosed", f"the package {error.name}, which the proof needs", advice) from None

    pilot = run_pilot(scene.exact, times)
    solution = _decided(scene, times, engine, report, pilot, enclosure.enclose)
    if audit:
        again = _decided(scene, times, engine, report, pilot, partial(enclosure.enclose, audit=True))
        if _digits(again) != _digits(solution):
            raise IntegrationError("FLINT alone proves other digits.")
        assert solution.proof is not None
        solution = replace(solution, proof=replace(solution.proof, audited=True))
    return solution


def _digits(solution: Solution) -> Any:
    """Return all digits of a solution, and which transits are decided."""
    tables = [solution.grid.printed(grid_decimals(solution))]
    if solution.transits is not None:
        tables.append(solution.transits.printed(transit_decimals(solution)))
    return tables, solution.directions, [parity for *_, parity in solution.possible]


def _decided(
    scene: Scene, times: tuple[Fraction, ...], engine: str, report: Report | None, pilot: Pilot, enclose: Any
) -> Solution:
    """Return a solution with every digit decided, proved by `enclose`."""
    span = float(times[-1])
    radius = first_radius(pilot, scene.run.digits)
    feed = Feed(scene.exact, times, engine)

    try:
        for _ in range(ROUNDING_TRIES):
            enclosed = enclose(
                scene.exact,
                times,
                radius=radius,
                transits=scene.run.transits,
                approximant=lambda bits: feed(bits - COEFFICIENT_BITS),
                progress=report and _scaled(report, span),
            )
            try:
                solution = _solution(scene, times, enclosed, feed.finished(), pilot)
                check_decided(solution)
                solution = _cross_checked(solution, pilot)
            except UndecidedRounding as undecided:
                tried, reason, advice = radius, str(undecided), "Ask for fewer digits."
                if undecided.width < TIE:
                    advice = "It lies between two decimals as nearly as can be told: ask for one digit more."
                    break
                radius = radius / max(FINER, ceil(SPARE * undecided.width))
            else:
                return solution
    finally:
        feed.stop()
    raise UnreachableError(
        f"{reason} Balls of {rounded_up(tried)} m were tried.",
        advice,
    )


def _scaled(report: Report, span: float) -> Callable[[float], None]:
    return lambda part: report(part * span)


def _solution(scene: Scene, times: tuple[Fraction, ...], enclosed: Any, approximant: Run, pilot: Pilot) -> Solution:
    bits = enclosed.bits + TABLE_BITS
    grid = Table.of_intervals(GRID, enclosed.states, bits)
    gaps = _checked_states(grid, times, approximant).largest()
    checks = [replace(CrossCheck.of(approximant, gaps, None), cpu_s=0.0)]  # no further run, so no further cost
    decided: list[Any] = []
    undecided: list[Any] = []
    for transit in enclosed.transits or ():
        (decided if transit.kind == "one" else undecided).append(transit)
    directions = [z.direction for z in decided]
    transits = None
    if enclosed.transits is not None:
        transits = Table.of_intervals(TRANSITS, [[getattr(z, name) for name in TRANSITS] for z in decided], bits)
    size, gap = (max(of[name] for name in POSITION) for of in (pilot.largest, gaps))
    proof = Proof(
        method=enclosed.method,
        prec=enclosed.bits,
        order=enclosed.order,
        steps=enclosed.steps,
        position_radius=enclosed.position_radius,
        velocity_radius=enclosed.velocity_radius,
        transit_radius=None if transits is None else max(transits.bound("t"), default=None),
        agreement_bits=-bits_in(gap / size) if gap else approximant.plan.number.prec,
        cpu_s={part: float(seconds) for part, seconds in vars(enclosed.cpu_s).items()},
        enclosed=enclosed,
    )
    # all zeros lie in (0, T]; the ball of a cluster may be a little wider
    possible = tuple((max(z.t.low, Fraction(0)), min(z.t.high, times[-1]), z.parity) for z in undecided)
    return Solution(
        scene,
        times,
        grid,
        transits,
        directions,
        Source.of(approximant),
        tuple(checks),
        pilot.cpu_s,
        proof,
        possible,
    )


def _cross_checked(solution: Solution, pilot: Pilot) -> Solution:
    """Return a solution with the check of its transits, or with the reason why that could not be made."""
    if solution.transits is None:
        return solution
    check = _transit_check(
        solution.scene,
        solution.times,
        solution.grid,
        solution.transits,
        solution.directions,
        pilot,
        bool(solution.possible),
    )
    if isinstance(check, CrossCheck):
        return replace(solution, checks=(*solution.checks, check))
    return replace(solution, not_checked=check)


def _checked_states(grid: Table, times: tuple[Fraction, ...], approximant: Run) -> Table:
    """Return how far the run's states are from the middles of the balls.

    Raises:
        IntegrationError: one lies outside its ball by more than the rounding of its evaluation.
    """
    rounding = max(grid.largest().values()) / 2 ** (approximant.plan.number.prec - EVALUATION_BITS)
    gaps = grid.distance(approximant.grid)
    for name in grid.columns:
        for t, gap, radius in zip(times, gaps.exact(name), grid.bound(name), strict=True):
            if gap > radius + rounding:
                raise IntegrationError(f"the run is outside the enclosure at t = {float(t)} s in {name}.")
    return gaps


def _transit_check(
    scene: Scene,
    times: tuple[Fraction, ...],
    grid: Table,
    transits: Table,
    directions: list[int],
    pilot: Pilot,
    any_undecided: bool,
) -> CrossCheck | str:
    """Check that heyoka's event detection finds the enclosed transits, and no others unless some are undecided.

    Returns:
        The check, or why it could not be made: the proof does not rest on it.

    Raises:
        IntegrationError: the run finds other transits; names the first that differs.
    """
    usual, finer = (pilot.bits_for(digits, times[-1], checked=False) for digits in (USUAL_DIGITS, FINER_DIGITS))
    least = _bits_to_see(transits, times[-1], pilot)
    contradiction: IntegrationError | None = None
    for prec in (max(usual, least), max(finer, least + finer - usual)):
        if prec > MOST_CHECK_PREC:
            reason: Exception = UnreachableError(f"A run would take {prec} bits to see transits so flat.")
            break
        try:
            event_run = run(Plan(scene.exact, "momentum", cheapest_type(prec), times, transits=True))
        except (UnreachableError, OverflowError) as error:
            reason = error
            break
        try:
            gap = _transit_gap(event_run, transits, directions, pilot, any_undecided)
        except IntegrationError as error:  # the motion may amplify errors too much for so few digits
            contradiction = reason = error
        else:
            return CrossCheck.of(event_run, grid.distance(event_run.grid).largest(), gap)
    if contradiction is not None:
        raise contradiction
    return str(reason)


def _bits_to_see(transits: Table, end: Fraction, pilot: Pilot) -> int:
    """Return the bits at which xdot between any two transits is far above a run's rounding errors."""
    if not len(transits):
        return 0
    times = [Fraction(0), *transits.exact("t"), end]
    apart = min((b - a for a, b in pairwise(times) if b > a), default=end)
    least = min(map(abs, transits.exact("ax"))) * apart
    return pilot.prec + bits_in(pilot.cautious["vx"] / least) + SEEN_BITS if least else MOST_CHECK_PREC + 1


def _transit_gap(event_run: Run, transits: Table, directions: list[int], pilot: Pilot, any_undecided: bool) -> Fraction:
    """Return how far the transits that a run found are from the enclosed ones, at most, in s."""
    found = [] if event_run.transits is None else event_run.transits.exact("t")
    if len(found) != len(directions) and not any_undecided:
        raise IntegrationError(f"heyoka finds {len(found)} transits, the enclosure {len(directions)}.")
    prec = event_run.plan.number.prec
    xdot_error, rounding = pilot.estimates(prec)["vx"], event_run.plan.times[-1] / 2 ** (prec - EVALUATION_BITS)
    remaining = iter(zip(found, event_run.directions, strict=True))
    largest = Fraction(0)
    rows = zip(*(transits.exact(name) for name in ("t", "ax")), transits.bound("t"), directions, strict=True)
    for k, (t, ax, bound, direction) in enumerate(rows, 1):
        allowed = bound + xdot_error / abs(ax) + rounding
        gap = next((abs(t - time) for time, sign in remaining if sign == direction and abs(t - time) <= allowed), None)
        if gap is None:
            raise IntegrationError(f"heyoka does not find transit {k} of the enclosure, at t = {float(t)} s.")
        largest = max(largest, gap)
    return largest
