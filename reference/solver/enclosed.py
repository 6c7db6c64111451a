"""The level `enclosed`: from enclosing balls to printed digits, cross-checked against independent runs.

The approximant is a run by heyoka or limbs, whose states must lie in the balls; a second run with heyoka's event
detection, in the cheapest type that serves, must find the same transits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ..columns import GRID, POSITION, TRANSITS, VELOCITY
from ..engines.plan import Plan, Report, Run
from ..engines.registry import run
from ..errors import InputError, IntegrationError, UnreachableError
from ..precision import cheapest_type
from ..scene import Scene
from ..table import Table, bits_in
from .approximant import COEFFICIENT_BITS, Feed
from .pilot import Pilot, run_pilot
from .rounding import UndecidedRounding, check_decided
from .solution import CrossCheck, Proof, Solution, Source

ROUNDING_BITS = 20  # balls are this many bits smaller than the last digit: of 1e5 numbers usually none is undecided
ROUNDING_TRIES = 3  # radii that are tried before giving up
FINER = 2**16  # the next radius is smaller by this factor
USUAL_DIGITS, FINER_DIGITS = 9, 27  # of the run with event detection, at first and on a second try
EVALUATION_BITS = 12  # bits that a run may lose when its polynomial is evaluated, so that it misses its ball
TABLE_BITS = 64  # the tables' integers carry this many bits more than the proof, so that rounding costs nothing


def solve_enclosed(scene: Scene, times: tuple[Fraction, ...], engine: str, report: Report | None) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

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
    span = float(times[-1])
    radius = _usual_unit(pilot, scene.run.digits) / 2**ROUNDING_BITS
    feed = Feed(scene.exact, times, engine)

    try:
        for _ in range(ROUNDING_TRIES):
            enclosed = enclosure.enclose(
                scene.exact,
                times,
                radius=radius,
                transits=scene.run.transits,
                approximant=lambda bits: feed(bits - COEFFICIENT_BITS),
                workers=feed.workers,
                progress=report and _scaled(report, span),
            )
            try:
                solution = _solution(scene, times, enclosed, feed.finished(), pilot)
                check_decided(solution)
            except UndecidedRounding as undecided:
                radius, reason = radius / FINER, str(undecided)
            else:
                return solution
    finally:
        feed.stop()
    raise UnreachableError(
        f"{reason} Balls of {float(radius * FINER):.1e} m were tried.",
        "A number may lie exactly between two decimals: ask for one digit more.",
    )


def _scaled(report: Report, span: float) -> Callable[[float], None]:
    return lambda part: report(part * span)


def _usual_unit(pilot: Pilot, digits: int) -> Fraction:
    """Return the unit of the last digit of the middle position or velocity column; smaller ones have smaller balls."""
    decimals = pilot.decimals(digits)
    return Fraction(1, 10 ** max(sorted(decimals[name] for name in kind)[1] for kind in (POSITION, VELOCITY)))


def _solution(scene: Scene, times: tuple[Fraction, ...], enclosed: Any, approximant: Run, pilot: Pilot) -> Solution:
    bits = enclosed.bits + TABLE_BITS
    grid = Table.of_intervals(GRID, enclosed.states, bits)
    gaps = _checked_states(grid, times, approximant).largest()
    checks = [replace(CrossCheck.of(approximant, gaps, None), cpu_s=0.0)]  # no further run, so no further cost
    decided: list[Any] = []
    undecided: list[Any] = []
    for transit in enclosed.transits or ():
        (decided if transit.kind == "one" else undecided).append(transit)
    transits = None
    if enclosed.transits is not None:
        transits = Table.of_intervals(TRANSITS, [[getattr(z, name) for name in TRANSITS] for z in decided], bits)
        checks.append(
            _transit_check(scene, times, grid, transits, [z.direction for z in decided], pilot, bool(undecided))
        )
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
    )
    # all zeros lie in (0, T]; the ball of a cluster may be a little wider
    possible = tuple((max(z.t.low, Fraction(0)), min(z.t.high, times[-1]), z.parity) for z in undecided)
    directions = [z.direction for z in decided]
    return Solution(
        scene, times, grid, transits, directions, Source.of(approximant), tuple(checks), pilot.cpu_s, proof, possible
    )


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
) -> CrossCheck:
    """Check that heyoka's event detection finds the enclosed transits, and no others unless some are undecided.

    Raises:
        IntegrationError: it does not; names the first transit that differs.
    """

    def run_with_events(digits: int) -> Run:
        number = cheapest_type(pilot.bits_for(digits, times[-1], checked=False))
        return run(Plan(scene.exact, "momentum", number, times, transits=True))

    event_run = run_with_events(USUAL_DIGITS)
    try:
        gap = _transit_gap(event_run, transits, directions, pilot, any_undecided)
    except IntegrationError:  # the motion amplifies errors too much for so few digits
        event_run = run_with_events(FINER_DIGITS)
        gap = _transit_gap(event_run, transits, directions, pilot, any_undecided)
    return CrossCheck.of(event_run, grid.distance(event_run.grid).largest(), gap)


def _transit_gap(event_run: Run, transits: Table, directions: list[int], pilot: Pilot, any_undecided: bool) -> Fraction:
    """Return how far the transits that a run found are from the enclosed ones, at most, in s."""
    found = [] if event_run.transits is None else event_run.transits.exact("t")
    if len(found) != len(directions) and not any_undecided:
        raise IntegrationError(f"heyoka finds {len(found)} transits, the enclosure {len(directions)}.")
    prec = event_run.plan.number.prec
    xdot_error, rounding = pilot.estimates(prec)["vx"], event_run.plan.times[-1] / 2 ** (prec - EVALUATION_BITS)
    remaining = iter(zip(found, event_run.directions, strict=True))
    largest = Fraction(0)
    for k, (t, ax, direction) in enumerate(zip(transits.exact("t"), transits.exact("ax"), directions, strict=True), 1):
        allowed = xdot_error / abs(ax) + rounding
        gap = next((abs(t - time) for time, sign in remaining if sign == direction and abs(t - time) <= allowed), None)
        if gap is None:
            raise IntegrationError(f"heyoka does not find transit {k} of the enclosure, at t = {float(t)} s.")
        largest = max(largest, gap)
    return largest
