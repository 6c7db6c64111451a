"""Choose the run that a scene's digits come from: engine, form of the equations, and bits, which the pilot measured.

`solve` and `foucault show --equations` both ask here, and so does a confirmation, for its sample of the grid.
"""

from __future__ import annotations

from fractions import Fraction
from hashlib import sha256
from math import ceil

from ..engines import AUTO
from ..engines.plan import Plan
from ..engines.registry import fastest
from ..numbers.precision import DOUBLE, LONG_DOUBLE, bits_of, real
from ..scenes.scene import Scene
from ..system.imports import needed
from .pilot import Pilot, run_pilot, second_order_bits
from .proof_steps import COEFFICIENT_BITS, Feed
from .proving import first_radius
from .solution import SAMPLED

FINER_BITS = 16  # bits that the published run has more than the one it is compared with
# precisions are multiples of this, so that small changes of the pilot's errors do not show
ROUND_TO_BITS = 8
# pilot runs where their errors are stated: in one alone the constants may be rounded luckily
SAMPLES = 3
HARDWARE_ENGINE = "heyoka"  # computes in double and long double


def pilot_for(scene: Scene, times: tuple[Fraction, ...], engine: str = AUTO) -> Pilot:
    """Return the pilot of a scene: in hardware only where its level promises no bytes and its numbers are hardware's.

    That of a single run, which states what the pilot measured as its own errors, is of the same arithmetic.

    Raises:
        UnreachableError: as `run_pilot`.
    """
    if (
        scene.run.level in ("computed", "self_consistent")
        and bits_of(scene.run.digits) <= LONG_DOUBLE.prec
    ):
        pilot = run_pilot(scene.exact, times, hardware=True)
        if published_plan(
            scene, times, pilot, first_prec(scene, pilot, engine), engine
        ).number.hardware:
            return pilot
    if scene.run.level != "computed":
        return run_pilot(scene.exact, times)
    pilot = run_pilot(scene.exact, times, samples=SAMPLES)
    published = published_plan(scene, times, pilot, first_prec(scene, pilot, engine), engine).engine
    return (
        pilot
        if published == pilot.engine
        else run_pilot(scene.exact, times, published, samples=SAMPLES)
    )


def need_flint() -> None:
    """Refuse the level enclosed where python-flint is not installed.

    Raises:
        InputError: it is not.
    """
    needed(
        "flint", "enclose", "run.level", "the level enclosed", ", or ask for the level confirmed"
    )


def first_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot) -> Plan:
    """Return the published run as it is begun; where runs disagree, `solve` raises its precision.

    Args:
        scene: with its digits and level.
        times: its output times in s.
        pilot: its pilot run.
    """
    if scene.run.level == "enclosed":
        need_flint()
        # python-flint is not imported unless the level asks for it
        from ..enclosure.prove import plan_for

        feed = Feed(scene.exact, times, AUTO, pilot.steps)
        bits = (
            plan_for(scene.exact, times[-1], first_radius(scene, pilot), None, feed.lost).bits
            - COEFFICIENT_BITS
        )
        return fastest(bits, steps=pilot.steps, proof=True).plan(scene.exact, bits, times)
    return published_plan(scene, times, pilot, first_prec(scene, pilot, AUTO), AUTO)


def first_prec(scene: Scene, pilot: Pilot, engine: str) -> int:
    """Return the bits that a scene's digits need: of the only run, or of the coarser of two that have to agree.

    Where double serves, long double is compared with it, and nothing of higher precision is compiled; not with a proof.
    """
    span = scene.exact.t_end if scene.run.transits else None
    more = second_order_bits(scene, pilot)
    if scene.run.level == "computed":
        prec = pilot.bits_for(scene.run.digits, span, checked=False) + more
        return rounded_prec(prec) if prec > LONG_DOUBLE.prec else prec
    prec = pilot.bits_for(scene.run.digits, span, checked=True) + more
    if prec <= DOUBLE.prec and engine in (AUTO, HARDWARE_ENGINE) and scene.run.level != "enclosed":
        return DOUBLE.prec
    return rounded_prec(max(prec, LONG_DOUBLE.prec))


def published_plan(
    scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int, engine: str
) -> Plan:
    """Return the run that is published: of `prec` bits if it is alone, else finer than the one beside it."""
    finer = LONG_DOUBLE.prec if prec == DOUBLE.prec else prec + FINER_BITS
    bits = prec if scene.run.level == "computed" else finer
    return fastest(bits, engine, pilot.steps).plan(scene.exact, bits, times, scene.run.zeros)


def confirming_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int) -> Plan:
    """Return heyoka's run that confirms another one: in another formulation, of `prec` bits.

    It is `space` if the cord always pulls; `spin`, neutral off the sphere at every angle, if a rod is pushed.
    """
    number, formulation = (
        DOUBLE if prec == DOUBLE.prec else real(prec),
        "space" if pilot.tension > 0 else "spin",
    )
    return Plan(scene.exact, formulation, number, times, scene.run.zeros)


def drawn_intervals(scene: Scene) -> list[int]:
    """Return the intervals of a scene's grid that a sampled confirmation integrates: the first is 0.

    A tenth of them, rounded up: those with the least sha256 of "HASH K", where K counts intervals from 1, and HASH is
    the sha256, in hexadecimal figures, of the scene's inputs as JSON without spaces.
    """
    inputs = scene.model_dump_json(
        include={"inputs", "pendulum", "site", "release", "run"}, exclude_none=True
    )
    word, count = sha256(inputs.encode()).hexdigest(), len(scene.exact.grid) - 1
    drawn = sorted(range(count), key=lambda i: sha256(f"{word} {i + 1}".encode()).digest())
    return sorted(drawn[: ceil(Fraction(count, SAMPLED))])


def rounded_prec(prec: int) -> int:
    """Round a precision up to a multiple of `ROUND_TO_BITS`."""
    return -(-prec // ROUND_TO_BITS) * ROUND_TO_BITS
