"""One proof: enclosing balls, made smaller until each printed digit is decided, and the runs that may refuse it.

Nothing that is proved rests on a run. One that contradicts the proof refuses it: the approximant, by heyoka or limbs,
whose states must lie in the balls, and one with event detection, which must find the same transits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

from ..engines.plan import Report, Run
from ..errors import IntegrationError, UnreachableError
from ..numbers.columns import GRID, POSITION, VELOCITY
from ..numbers.precision import log2, rounded_up
from ..numbers.table import Table, bits_in
from ..numbers.zeros import XDOT
from ..scenes.inputs import Inputs
from ..scenes.scene import Scene
from .pilot import Pilot, second_order_bits
from .proof_steps import EngineChanged, Feed
from .solution import (
    CrossCheck,
    Proof,
    Solution,
    Source,
    UndecidedRounding,
    check_decided,
    separated,
)

# bits by which a swing may die down: beyond them balls are made smaller step by step
MOST_DIED = 1024
# balls are this many bits smaller than the last digit: of 1e5 numbers usually none is undecided
ROUNDING_BITS = 20
ROUNDING_TRIES = 8  # radii that are tried before giving up
FINER = 2**16  # the next radius is smaller by this factor at least,
# and at least so small that the widest undecided number is known to this part of its last digit
SPARE = 2**20
# of the last digit: a number that lies so near to the middle of two decimals is a tie
TIE = Fraction(1, 2**40)
# the tables' integers carry this many bits more than the proof, so that rounding costs nothing
TABLE_BITS = 64
# bits that a run may lose when its polynomial is evaluated, so that it misses its ball
EVALUATION_BITS = 12


@dataclass(frozen=True)
class ProofTask:
    """A scene to be proved, and what its pilot runs measured.

    Attributes:
        scene: the scene, with the digits asked for.
        engine: name of the engine that makes the approximant; "auto" for the fastest.
        pilot: how rounding errors grow on the scene.
        function: whether the golden function is made, too.
    """

    scene: Scene
    engine: str
    pilot: Pilot
    function: bool = False


def proved(problem: ProofTask, enclose: Any, report: Report | None = None) -> Solution:
    """Return a solution with every digit decided.

    Args:
        problem: what is to be proved.
        enclose: that of enclosure/prove.py, or the same by FLINT alone.
        report: called with the simulated time reached, in s.

    Raises:
        UnreachableError: no balls are small enough, and it tells the radius that was reached.
        IntegrationError: the run lies outside the enclosure.
    """
    scene, pilot = problem.scene, problem.pilot
    times, span = tuple(scene.exact.grid), float(scene.exact.t_end)
    radius = first = first_radius(scene, pilot)
    # `enclose` calls it with bits: it starts the run and gives its steps, paired (enclosure/approximant.py)
    feed = Feed(scene.exact, times, problem.engine, pilot.steps)
    try:
        for _ in range(ROUNDING_TRIES):
            enclosed = enclose(
                scene.exact,
                times,
                radius=radius,
                zeros=scene.run.zeros,
                approximant=feed,
                lost=feed.lost,
                function=problem.function,
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
                radius = radius / max(FINER, math.ceil(SPARE * undecided.width))
                if undecided.column == "t":
                    radius = min(radius, late_radius(first, scene.exact))
            else:
                return replace(solution, discarded_s=feed.discarded_s)
    except EngineChanged as changed:
        again = proved(replace(problem, engine=changed.engine), enclose, report)
        return replace(again, discarded_s=again.discarded_s + feed.discarded_s)
    finally:
        feed.stop()
    raise UnreachableError(f"{reason} Balls of {rounded_up(tried)} m were tried.", advice)


def _solution(
    scene: Scene, times: tuple[Fraction, ...], enclosed: Any, approximant: Run, pilot: Pilot
) -> Solution:
    bits = enclosed.bits + TABLE_BITS
    grid = Table.of_intervals(GRID, enclosed.proved.states, bits)
    gaps = checked_states(grid, times, approximant).largest()
    # no further run, so no further cost
    check = replace(CrossCheck.by(approximant, gaps, None), cpu_s=0.0)
    table = partial(Table.of_intervals, bits=bits)
    zeros = {
        word: separated(of_word, word, times[-1], table)
        for word, of_word in enclosed.proved.zeros.items()
    }
    size, gap = (max(columns[name] for name in POSITION) for columns in (grid.largest(), gaps))
    transit_radius = max(zeros[XDOT].table.bound("t"), default=None) if XDOT in zeros else None
    proof = Proof(
        enclosed, transit_radius, -bits_in(gap / size) if gap else approximant.plan.number.prec
    )
    return Solution(scene, times, grid, zeros, Source.of(approximant), (check,), pilot.cpu_s, proof)


def first_radius(scene: Scene, pilot: Pilot) -> Fraction:
    """Return the radius in m of the balls that a proof of a scene begins with.

    It is a small part of the last digit's unit in the middle position or velocity column; smaller ones have smaller
    balls.
    """
    decimals = pilot.decimals(scene.run.digits)
    unit = Fraction(
        1, 10 ** max(sorted(decimals[name] for name in kind)[1] for kind in (POSITION, VELOCITY))
    )
    return unit / (1 << ROUNDING_BITS + second_order_bits(scene, pilot))


def late_radius(radius: Fraction, inputs: Inputs) -> Fraction:
    """Return the radius in m that tells a damped scene's last transits as closely as `radius` tells the first ones.

    A small swing dies as exp(-r t), where r = γ/2; where drag is too strong for a swing, r = γ/2 - (γ²/4 - g/l)^(1/2).
    """
    half, stiffness = float(inputs.drag) / 2, float(inputs.gravity / inputs.length)
    rate = half - math.sqrt(max(half**2 - stiffness, 0.0))
    return radius / (1 << math.ceil(min(rate * float(inputs.t_end) * log2(math.e), MOST_DIED)))


def checked_states(grid: Table, times: tuple[Fraction, ...], approximant: Run) -> Table:
    """Return how far the run's states are from the middles of the balls.

    Raises:
        IntegrationError: one lies outside its ball by more than the rounding of its evaluation.
    """
    rounding = max(grid.largest().values()) / 2 ** (approximant.plan.number.prec - EVALUATION_BITS)
    gaps = grid.distance(approximant.grid)
    for name in grid.columns:
        for t, gap, radius in zip(times, gaps.exact(name), grid.bound(name), strict=True):
            if gap > radius + rounding:
                raise IntegrationError(
                    f"the run is outside the enclosure at t = {float(t)} s in {name}."
                )
    return gaps
