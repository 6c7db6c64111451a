"""One proof: enclosing balls, made smaller until each printed digit is decided.

Nothing that is proved rests on a run, but a run that contradicts the proof refuses it: the
approximant, by heyoka or limbs, whose states must lie in the balls, and a run with event detection,
which must find the same transits (`guard`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
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
from .request import progress_report
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
_ROUNDING_BITS = 20
_ROUNDING_TRIES = 8  # radii that are tried before giving up
# the next radius is smaller by this factor at least, and so small that the widest undecided number
# is known to one part in _SPARE of its last digit
_FINER = 2**16
_SPARE = 2**20
# of the last digit: a number that lies so near to the middle of two decimals is a tie
_TIE = Fraction(1, 2**40)
# the tables' integers carry this many bits more than the proof, so that rounding costs nothing
_TABLE_BITS = 64
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
        audit: whether all that compiled code returns for the proof is checked.
    """

    scene: Scene
    engine: str
    pilot: Pilot
    function: bool = False
    audit: bool = False


def proved(task: ProofTask, enclose: Any, report: Report | None = None) -> Solution:
    """Return a solution with every digit decided.

    Args:
        task: what is to be proved.
        enclose: that of enclosure/prove.py.
        report: called with the simulated time reached, in s.

    Raises:
        UnreachableError: no balls are small enough, and it tells the radius that was reached.
        IntegrationError: the run lies outside the enclosure.
    """
    scene = task.scene
    # called with bits, it starts the run and gives its steps, paired (enclosure/approximant.py)
    feed = Feed(scene.exact, tuple(scene.exact.grid), task.engine, task.pilot.steps)
    try:
        solution = _decided(task, partial(enclose, approximant=feed, lost=feed.lost), feed, report)
        return replace(solution, discarded_s=feed.discarded_s)
    except EngineChanged as changed:
        again = proved(replace(task, engine=changed.engine), enclose, report)
        return replace(again, discarded_s=again.discarded_s + feed.discarded_s)
    finally:
        feed.stop()


def _decided(task: ProofTask, enclose: Any, feed: Feed, report: Report | None) -> Solution:
    """Return a solution with every digit decided, in balls that are made smaller until then.

    Raises:
        UnreachableError: the last radius that is tried leaves a digit undecided.
    """
    scene = task.scene
    times = tuple(scene.exact.grid)
    radius = first = first_radius(scene, task.pilot)
    for _ in range(_ROUNDING_TRIES):
        enclosed = enclose(
            scene.exact,
            times,
            radius=radius,
            zeros=scene.run.zeros,
            function=task.function,
            audit=task.audit,
            progress=progress_report(report, scene.exact.t_end),
        )
        solution = _solution(task, enclosed, feed.finished())
        try:
            check_decided(solution)
            return solution
        except UndecidedRounding as undecided:
            reason = f"{undecided} The proof went down to error bounds of {rounded_up(radius)} m."
            if undecided.width < _TIE:
                advice = (
                    "The value lies halfway between two numbers of this many digits: "
                    f"ask for one digit more, {scene.run.digits + 1}."
                )
                raise UnreachableError(reason, advice) from None
            radius = radius / max(_FINER, math.ceil(_SPARE * undecided.width))
            if undecided.column == "t":
                radius = min(radius, late_radius(first, scene.exact))
    raise UnreachableError(reason, "Ask for fewer digits.")


def _solution(task: ProofTask, enclosed: Any, approximant: Run) -> Solution:
    """Return an enclosure as a solution, which `approximant` agrees with.

    Raises:
        IntegrationError: a state of the approximant lies outside its ball.
    """
    bits = enclosed.bits + _TABLE_BITS
    times = tuple(task.scene.exact.grid)
    grid = Table.of_intervals(GRID, enclosed.proved.states, bits)
    zeros = {}
    for word, of_word in enclosed.proved.zeros.items():
        zeros[word] = separated(of_word, word, times[-1], partial(Table.of_intervals, bits=bits))
    transit_radius = None
    if XDOT in zeros:
        transit_radius = max(zeros[XDOT].table.bound("t"), default=None)

    gaps = _checked_states(grid, times, approximant).largest()
    # no further run, so no further cost
    check = replace(CrossCheck.by(approximant, gaps, None), cpu_s=0.0)
    return Solution(
        scene=task.scene,
        times=times,
        grid=grid,
        zeros=zeros,
        run=Source.of(approximant),
        checks=(check,),
        pilot_s=task.pilot.cpu_s,
        proof=Proof(
            enclosed,
            transit_radius,
            _agreement_bits(grid, gaps, approximant),
            audited=enclosed.audited,
            audit_s=enclosed.audit_s,
        ),
    )


def _agreement_bits(grid: Table, gaps: Mapping[str, Fraction], approximant: Run) -> int:
    """Return the bits to which the positions of a run agree with the middles of the balls."""
    sizes = grid.largest()
    gap = max(gaps[name] for name in POSITION)
    if not gap:
        return approximant.plan.number.prec
    return -bits_in(gap / max(sizes[name] for name in POSITION))


def first_radius(scene: Scene, pilot: Pilot) -> Fraction:
    """Return the radius in m of the balls that a proof of a scene begins with.

    It is a small part of the last digit's unit in the middle position or velocity column; smaller
    ones have smaller balls.
    """
    decimals = pilot.decimals(scene.run.digits)
    _, position, _ = sorted(decimals[name] for name in POSITION)
    _, velocity, _ = sorted(decimals[name] for name in VELOCITY)
    unit = Fraction(1, 10 ** max(position, velocity))
    return unit / (1 << _ROUNDING_BITS + second_order_bits(scene, pilot))


def late_radius(radius: Fraction, inputs: Inputs) -> Fraction:
    """Return the radius in m for a damped scene's last transits, from that for its first ones.

    A small swing dies as exp(-r t), where r = γ/2; where drag is too strong for a swing, r = γ/2 -
    (γ²/4 - g/l)^(1/2).
    """
    half_drag = float(inputs.drag) / 2
    stiffness = float(inputs.gravity / inputs.length)
    rate = half_drag - math.sqrt(max(half_drag**2 - stiffness, 0.0))
    bits = rate * float(inputs.t_end) * log2(math.e)
    return radius / (1 << math.ceil(min(bits, MOST_DIED)))


def _checked_states(grid: Table, times: tuple[Fraction, ...], approximant: Run) -> Table:
    """Return how far the run's states are from the middles of the balls.

    Raises:
        IntegrationError: one lies outside its ball by more than the rounding of its evaluation.
    """
    exact_bits = approximant.plan.number.prec - EVALUATION_BITS
    rounding = max(grid.largest().values()) / 2**exact_bits
    gaps = grid.distance(approximant.grid)
    for name in grid.columns:
        for t, gap, radius in zip(times, gaps.exact(name), grid.bound(name), strict=True):
            if gap > radius + rounding:
                raise IntegrationError(
                    f"the run is outside the enclosure at t = {float(t)} s in {name}."
                )
    return gaps
