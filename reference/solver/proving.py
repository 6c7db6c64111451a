"""One proof: enclosing balls, made smaller until each printed digit is decided.

The approximant is a run by heyoka or limbs, whose states must lie in the balls (`proof_checks`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil
from typing import Any

from ..engines.plan import Report, Run
from ..errors import UnreachableError
from ..numbers.columns import GRID, POSITION, TRANSITS
from ..numbers.precision import rounded_up
from ..numbers.table import Table, bits_in
from ..scenes.scene import Scene
from .choice import first_radius, late_radius
from .pilot import Pilot
from .proof_checks import checked_states
from .proof_steps import COEFFICIENT_BITS, EngineChanged, Feed
from .rounding import UndecidedRounding, check_decided
from .solution import CrossCheck, Proof, Solution, Source

ROUNDING_TRIES = 8  # radii that are tried before giving up
FINER = 2**16  # the next radius is smaller by this factor at least,
SPARE = 2**20  # and at least so small that the widest undecided number is known to this part of its last digit
TIE = Fraction(1, 2**40)  # of the last digit: a number that lies so near to the middle of two decimals is a tie
TABLE_BITS = 64  # the tables' integers carry this many bits more than the proof, so that rounding costs nothing


@dataclass(frozen=True)
class Problem:
    """A scene to be proved, and what its pilot runs told about it.

    Attributes:
        scene: the scene, with the digits asked for.
        times: output times in s.
        engine: name of the engine that makes the approximant; "auto" for the fastest.
        pilot: how rounding errors grow on the scene.
    """

    scene: Scene
    times: tuple[Fraction, ...]
    engine: str
    pilot: Pilot


def proved(problem: Problem, enclose: Any, report: Report | None = None) -> Solution:
    """Return a solution with every digit decided.

    Args:
        problem: what is to be proved.
        enclose: `enclosure.enclose`, or the same by FLINT alone.
        report: called with the simulated time reached, in s.

    Raises:
        UnreachableError: no balls are small enough, and it tells the radius that was reached.
        IntegrationError: the run lies outside the enclosure.
    """
    scene, times, pilot = problem.scene, problem.times, problem.pilot
    span = float(times[-1])
    radius = first = first_radius(pilot, scene.run.digits)
    feed = Feed(scene.exact, times, problem.engine, pilot.steps)

    try:
        for _ in range(ROUNDING_TRIES):
            enclosed = enclose(
                scene.exact,
                times,
                radius=radius,
                transits=scene.run.transits,
                approximant=lambda bits: feed(bits - COEFFICIENT_BITS),
                progress=report and (lambda part: report(part * span)),
            )
            try:
                solution = _solution(scene, times, enclosed, feed.finished(), pilot)
                check_decided(solution)
            except UndecidedRounding as undecided:
                tried, reason, advice = radius, str(undecided), "Ask for fewer digits."
                if undecided.width < TIE:
                    advice = "It lies between two decimals as nearly as can be told: ask for one digit more."
                    break
                radius = radius / max(FINER, ceil(SPARE * undecided.width))
                if undecided.column == "t":
                    radius = min(radius, late_radius(first, scene.exact))
            else:
                return solution
    except EngineChanged as changed:
        return proved(replace(problem, engine=changed.engine), enclose, report)
    finally:
        feed.stop()
    raise UnreachableError(f"{reason} Balls of {rounded_up(tried)} m were tried.", advice)


def _solution(scene: Scene, times: tuple[Fraction, ...], enclosed: Any, approximant: Run, pilot: Pilot) -> Solution:
    bits = enclosed.bits + TABLE_BITS
    grid = Table.of_intervals(GRID, enclosed.states, bits)
    gaps = checked_states(grid, times, approximant).largest()
    check = replace(CrossCheck.of(approximant, gaps, None), cpu_s=0.0)  # no further run, so no further cost
    zeros = enclosed.transits or ()
    decided, undecided = [z for z in zeros if z.kind == "one"], [z for z in zeros if z.kind != "one"]
    directions = [z.direction for z in decided]
    transits = None
    if enclosed.transits is not None:
        transits = Table.of_intervals(TRANSITS, [[getattr(z, name) for name in TRANSITS] for z in decided], bits)
    size, gap = (max(of[name] for name in POSITION) for of in (grid.largest(), gaps))
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
    source = Source.of(approximant)
    return Solution(scene, times, grid, transits, directions, source, (check,), pilot.cpu_s, proof, possible)
