"""Choose the run that a scene's digits come from: engine, form of the equations, and bits, which the pilot measured.

`solve` and `foucault show --equations` both ask here, and so does a confirmation, for its sample of the grid.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from hashlib import sha256
from math import ceil, e, sqrt

from ..engines import AUTO
from ..engines.plan import Plan
from ..engines.registry import fastest
from ..model.start import Start
from ..numbers.columns import POSITION, VELOCITY
from ..numbers.precision import DOUBLE, LONG_DOUBLE, bits_of, log2, real
from ..numbers.table import bits_in
from ..scenes.inputs import Inputs
from ..scenes.scene import Scene
from ..system.imports import needed
from .pilot import Pilot, run_pilot
from .proof_steps import COEFFICIENT_BITS, Feed
from .solution import SAMPLED

FINER_BITS = 16  # bits that the published run has more than the one it is compared with
ROUND_TO_BITS = 8  # precisions are multiples of this, so that small changes of the pilot's errors do not show
SAMPLES = 3  # pilot runs where their errors are stated: in one alone the constants may be rounded luckily
HARDWARE_ENGINE = "heyoka"  # computes in double and long double
MOST_DIED = 1024  # bits by which a swing may die down: beyond them balls are made smaller step by step
ROUNDING_BITS = 20  # balls are this many bits smaller than the last digit: of 1e5 numbers usually none is undecided


def pilot_for(scene: Scene, times: tuple[Fraction, ...], engine: str = AUTO) -> Pilot:
    """Return the pilot of a scene: in hardware only where its level promises no bytes and its numbers are hardware's.

    That of a single run, which states what the pilot measured as its own errors, is of the same arithmetic.

    Raises:
        UnreachableError: as `run_pilot`.
    """
    if scene.run.level in ("computed", "self_consistent") and bits_of(scene.run.digits) <= LONG_DOUBLE.prec:
        pilot = run_pilot(scene.exact, times, hardware=True)
        if published_plan(scene, times, pilot, first_prec(scene, pilot, engine), engine).number.hardware:
            return pilot
    if scene.run.level != "computed":
        return run_pilot(scene.exact, times)
    pilot = run_pilot(scene.exact, times, samples=SAMPLES)
    published = published_plan(scene, times, pilot, first_prec(scene, pilot, engine), engine).engine
    return pilot if published == pilot.engine else run_pilot(scene.exact, times, published, samples=SAMPLES)


def need_flint() -> None:
    """Refuse the level enclosed where python-flint is not installed.

    Raises:
        InputError: it is not.
    """
    needed("flint", "enclose", "--level", "enclosed", "which the proof needs", ", or ask for the level confirmed")


def first_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot) -> Plan:
    """Return the published run as it is begun; where runs disagree, `solve` raises its precision.

    Args:
        scene: with its digits and level.
        times: its output times in s.
        pilot: its pilot run.
    """
    if scene.run.level == "enclosed":
        need_flint()
        from ..enclosure.plan import plan_for  # python-flint is not imported unless the level asks for it

        feed = Feed(scene.exact, times, AUTO, pilot.steps)
        bits = plan_for(scene.exact, times[-1], first_radius(scene, pilot), None, feed.lost).bits - COEFFICIENT_BITS
        return fastest(bits, steps=pilot.steps, proof=True).plan(scene.exact, bits, times, transits=False)
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


def published_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int, engine: str) -> Plan:
    """Return the run that is published: of `prec` bits if it is alone, else finer than the one beside it."""
    finer = LONG_DOUBLE.prec if prec == DOUBLE.prec else prec + FINER_BITS
    bits = prec if scene.run.level == "computed" else finer
    plan = fastest(bits, engine, pilot.steps).plan(scene.exact, bits, times, scene.run.transits)
    return replace(plan, sections=scene.run.sections or ())


def confirming_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int) -> Plan:
    """Return heyoka's run that confirms another one: in another formulation, of `prec` bits.

    It is `space` if the cord always pulls; `spin`, neutral off the sphere at every angle, if a rod is pushed.
    """
    number, formulation = DOUBLE if prec == DOUBLE.prec else real(prec), "space" if pilot.tension > 0 else "spin"
    return Plan(scene.exact, formulation, number, times, scene.run.transits, sections=scene.run.sections or ())


def drawn_intervals(scene: Scene) -> list[int]:
    """Return the intervals of a scene's grid that a sampled confirmation integrates: the first is 0.

    A tenth of them, rounded up: those with the least sha256 of "HASH K", where K counts intervals from 1, and HASH is
    the sha256, in hexadecimal figures, of the scene's inputs as JSON without spaces.
    """
    inputs = scene.model_dump_json(include={"inputs", "pendulum", "site", "release", "run"}, exclude_none=True)
    word, count = sha256(inputs.encode()).hexdigest(), len(scene.exact.grid) - 1
    drawn = sorted(range(count), key=lambda i: sha256(f"{word} {i + 1}".encode()).digest())
    return sorted(drawn[: ceil(Fraction(count, SAMPLED))])


def second_order_bits(scene: Scene, pilot: Pilot) -> int:
    """Return the bits that highest and lowest points need besides: the height is of second order in the amplitude."""
    fastest_speed = max(pilot.sizes[name] for name in VELOCITY)
    if not fastest_speed or not {"highest", "lowest"} & {*(scene.run.sections or ())}:
        return 0
    return bits_in(scene.exact.length * Fraction(Start.of(scene.exact, DOUBLE.prec).rate) / fastest_speed)


def rounded_prec(prec: int) -> int:
    """Round a precision up to a multiple of `ROUND_TO_BITS`."""
    return -(-prec // ROUND_TO_BITS) * ROUND_TO_BITS


def first_radius(scene: Scene, pilot: Pilot) -> Fraction:
    """Return the radius in m of the balls that a proof of a scene begins with.

    It is a small part of the last digit's unit in the middle position or velocity column; smaller ones have smaller
    balls.
    """
    decimals = pilot.decimals(scene.run.digits)
    unit = Fraction(1, 10 ** max(sorted(decimals[name] for name in kind)[1] for kind in (POSITION, VELOCITY)))
    return unit / (1 << ROUNDING_BITS + second_order_bits(scene, pilot))


def late_radius(radius: Fraction, inputs: Inputs) -> Fraction:
    """Return the radius in m that tells a damped scene's last transits as closely as `radius` tells the first ones.

    A small swing dies as exp(-r t), where r = γ/2; where drag is too strong for a swing, r = γ/2 - (γ²/4 - g/l)^(1/2).
    """
    half, stiffness = float(inputs.drag) / 2, float(inputs.gravity / inputs.length)
    rate = half - sqrt(max(half**2 - stiffness, 0.0))
    return radius / (1 << ceil(min(rate * float(inputs.t_end) * log2(e), MOST_DIED)))
