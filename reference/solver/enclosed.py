"""The level `enclosed`: balls that contain the truth, turned into digits; runs are held against them.

The candidate is a run of heyoka or in limbs, so the proof is one about that run; a second run with heyoka's event
detection, in the cheapest type that serves, has to find the same transits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from ..engines.plan import Plan, Report, Run
from ..engines.run import run
from ..errors import InputError, IntegrationError, UnreachableError
from ..precision import cheapest_type
from ..scene import Scene
from ..table import Table, bits_in
from .approximant import GUARD_BITS, Feed
from .pilot import Pilot, run_pilot
from .rounding import UndecidedRounding, check_decided, grid_decimals
from .solution import GRID_COLUMNS, TRANSIT_COLUMNS, CrossCheck, Proof, Solution, Source

ROUNDING_BITS = 20  # balls are this much smaller than the last digit: among 1e5 numbers few ties, mostly none
ROUNDING_TRIES = 3
FINER = 2**16  # factor of the next try
USUAL_DIGITS, FINER_DIGITS = 9, 27  # what the run with event detection is asked for, at first and on a second try
ROUNDING_SLACK = 12  # bits that evaluating a run's polynomial may lose, by which it may miss its ball
SCALE_BITS = 64  # of the tables' integers, below the smallest ball


def solve_enclosed(scene: Scene, times: tuple[Fraction, ...], engine: str, report: Report | None) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: balls small enough cannot be had; says what was reached.
        IntegrationError: the run lies outside the enclosure.
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
            proved = enclosure.enclose(
                scene.exact,
                times,
                radius=radius,
                transits=scene.run.transits,
                approximant=lambda bits: feed(bits - GUARD_BITS),
                workers=feed.workers,
                progress=report and _scaled(report, span),
            )
            try:
                solution = _solution(scene, times, proved, feed.finished(), pilot)
                check_decided(solution)
            except UndecidedRounding as undecided:
                radius, said = radius / FINER, str(undecided)
            else:
                return solution
    finally:
        feed.stop()
    raise UnreachableError(
        f"{said} Balls of {float(radius * FINER):.1e} m were tried.",
        "A number may lie exactly between two decimals: ask for one digit more.",
    )


def _scaled(report: Report, span: float) -> Callable[[float], None]:
    return lambda part: report(part * span)


def _usual_unit(pilot: Pilot, digits: int) -> Fraction:
    """The last digit of the middle position and velocity columns; smaller ones, like vz, have smaller balls."""
    decimals = grid_decimals(pilot.largest, pilot.errors, digits)
    return Fraction(1, 10 ** max(sorted(decimals[:3])[1], sorted(decimals[3:])[1]))


def _solution(scene: Scene, times: tuple[Fraction, ...], proved: Any, feed: Run, pilot: Pilot) -> Solution:
    bits = proved.bits + SCALE_BITS
    grid = _table(GRID_COLUMNS, proved.states, bits)
    gaps = _checked_states(grid, times, feed)
    checks = [replace(CrossCheck.of(feed, gaps, None), cpu_s=0.0)]  # the run itself, not one more
    sure: list[Any] = []
    unsure: list[Any] = []
    for transit in proved.transits or ():
        (sure if transit.kind == "one" else unsure).append(transit)
    met = None
    if proved.transits is not None:
        met = _table(TRANSIT_COLUMNS, [(z.t, z.x, z.y, z.z, z.vy, z.ax) for z in sure], bits)
        checks.append(_transit_check(scene, times, grid, met, [z.direction for z in sure], pilot, bool(unsure)))
    size = max(pilot.largest[:3])
    proof = Proof(
        method=proved.method,
        prec=proved.bits,
        order=proved.order,
        steps=proved.steps,
        position_radius=proved.position_radius,
        velocity_radius=proved.velocity_radius,
        transit_radius=None if met is None else max(met.bound("t"), default=None),
        agreement_bits=-bits_in(max(gaps[:3]) / size) if any(gaps[:3]) else feed.plan.number.prec,
        cpu_s={part: float(spent) for part, spent in vars(proved.cpu_s).items()},
    )
    # all zeros lie in (0, T]; the ball of a cluster may be a little wider
    possible = tuple((max(z.t.low, Fraction(0)), min(z.t.high, times[-1]), z.parity) for z in unsure)
    directions = [z.direction for z in sure]
    return Solution(scene, times, grid, met, directions, Source.of(feed), tuple(checks), pilot.cpu_s, proof, possible)


def _table(columns: tuple[str, ...], rows: Sequence[Sequence[Any]], bits: int) -> Table:
    """Middles and half-widths of intervals, as integers; rounded outwards."""
    values, errors = [], []
    for row in rows:
        lows = [(x.low.numerator << bits) // x.low.denominator for x in row]
        highs = [-((-x.high.numerator << bits) // x.high.denominator) for x in row]
        middles = tuple((low + high) // 2 for low, high in zip(lows, highs, strict=True))
        values.append(middles)
        errors.append(tuple(high - middle for high, middle in zip(highs, middles, strict=True)))
    return Table(columns, bits, values, errors)


def _checked_states(grid: Table, times: tuple[Fraction, ...], feed: Run) -> tuple[Fraction, ...]:
    """How far the run's states are from the middles of the balls, per column, in m and m/s.

    Raises:
        IntegrationError: one lies outside its ball by more than the rounding of its evaluation.
    """
    rounding = max(grid.largest()) / 2 ** (feed.plan.number.prec - ROUNDING_SLACK)
    gaps = [Fraction(0)] * len(GRID_COLUMNS)
    for t, row, middles, errors in zip(times, feed.grid, grid.values, grid.errors, strict=True):
        for i, name in enumerate(GRID_COLUMNS):
            gap = abs(Fraction(row[i], 2**feed.bits) - Fraction(middles[i], 2**grid.bits))
            gaps[i] = max(gaps[i], gap)
            if gap > Fraction(errors[i], 2**grid.bits) + rounding:
                raise IntegrationError(f"the run is outside the enclosure at t = {float(t)} s in {name}.")
    return tuple(gaps)


def _transit_check(
    scene: Scene,
    times: tuple[Fraction, ...],
    grid: Table,
    met: Table,
    directions: list[int],
    pilot: Pilot,
    undecided: bool,
) -> CrossCheck:
    """Heyoka's event detection must find the enclosed transits, no other (unless some are undecided), where they are.

    Raises:
        IntegrationError: naming the transit on which they part.
    """

    def seen_with(digits: int) -> Run:
        number = cheapest_type(pilot.bits_for(digits, times[-1], checked=False))
        return run(Plan(scene.exact, "momentum", number, times, transits=True))

    seen = seen_with(USUAL_DIGITS)
    try:
        gaps = _matched(seen, met, directions, pilot, undecided)
    except IntegrationError:  # where the flow blurs its transits
        seen = seen_with(FINER_DIGITS)
        gaps = _matched(seen, met, directions, pilot, undecided)
    state = [max(column) for column in zip(*_gaps(grid, seen), strict=True)]
    return CrossCheck.of(seen, state, gaps)


def _matched(seen: Run, met: Table, directions: list[int], pilot: Pilot, undecided: bool) -> list[tuple[Fraction, ...]]:
    """How far the transits that a run found are from the enclosed ones, in s."""
    found = [(Fraction(row[0], 2**seen.bits), way) for row, way in zip(seen.zeros or (), seen.directions, strict=True)]
    if len(found) != len(directions) and not undecided:
        raise IntegrationError(f"heyoka finds {len(found)} transits, the enclosure {len(directions)}.")
    prec = seen.plan.number.prec
    late, rounding = pilot.estimates(prec)[3], seen.plan.times[-1] / 2 ** (prec - ROUNDING_SLACK)
    nearest = iter(found)
    gaps: list[tuple[Fraction, ...]] = []
    for k, (t, ax, way) in enumerate(zip(met.exact("t"), met.exact("ax"), directions, strict=True), 1):
        allowed = late / abs(ax) + rounding
        gap = next((abs(t - moment) for moment, sign in nearest if sign == way and abs(t - moment) <= allowed), None)
        if gap is None:
            raise IntegrationError(f"heyoka does not find transit {k} of the enclosure, at t = {float(t)} s.")
        gaps.append((gap,))
    return gaps


def _gaps(grid: Table, seen: Run) -> list[tuple[Fraction, ...]]:
    return [
        tuple(abs(Fraction(a, 2**grid.bits) - Fraction(b, 2**seen.bits)) for a, b in zip(middles, row, strict=False))
        for middles, row in zip(grid.values, seen.grid, strict=True)
    ]
