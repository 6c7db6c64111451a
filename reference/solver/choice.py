"""Choose the run that a scene's digits come from: engine, formulation, and bits, from the pilot.

`solve` and `foucault show --equations` use it, and so does a confirmation, for its sample of the
grid.
"""

from __future__ import annotations

from fractions import Fraction
from hashlib import sha256
from math import ceil

from ..engines import AUTO
from ..engines.plan import Plan, Report
from ..engines.registry import fastest
from ..numbers.precision import DOUBLE, LONG_DOUBLE, bits_of, real
from ..scenes.scene import Scene
from ..system.imports import needed
from .pilot import (
    PILOT_GAP_BITS,
    PILOT_PREC,
    Pilot,
    pilot_engine,
    run_pilot,
    second_order_bits,
)
from .proof_steps import COEFFICIENT_BITS, Feed
from .proving import first_radius
from .solution import SAMPLED

_FINER_BITS = 16  # bits that the published run has more than the one it is compared with
# precisions are multiples of this, so that small changes of the pilot's errors do not show
_ROUND_TO_BITS = 8
# pilot runs where their errors are stated: in one alone the constants may be rounded luckily
_SAMPLES = 3
_WITHOUT_TRANSITS = 0.5  # what a run takes that does not look for them, over one that does
_HARDWARE_ENGINE = "heyoka"  # computes in double and long double


def pilot_for(
    scene: Scene,
    times: tuple[Fraction, ...],
    engine: str = AUTO,
    report: Report | None = None,
) -> Pilot:
    """Return the pilot of a scene.

    It is in hardware numbers only if the level promises no bytes and the published numbers are in
    hardware. A single run states as its errors those that the pilot measured, so that its pilot
    uses the same engine.

    `report` is called with the simulated time, as far as the work is done.

    Raises:
        UnreachableError: as `run_pilot`.
    """
    inputs = scene.exact
    promises_bytes = scene.run.level not in ("computed", "self_consistent")
    if not promises_bytes and bits_of(scene.run.digits) <= LONG_DOUBLE.prec:
        pilot = run_pilot(inputs, times, hardware=True)
        if _first_published(scene, times, pilot, engine).number.hardware:
            return pilot
    if scene.run.level != "computed":
        return run_pilot(inputs, times, report=report)

    # if the user names a slower engine, a second pilot by that one is most of the work
    is_last = engine in (AUTO, pilot_engine(inputs, times[-1]).name)
    first_report = report if is_last else None
    pilot = run_pilot(inputs, times, samples=_SAMPLES, report=first_report)
    published_engine = _first_published(scene, times, pilot, engine).engine
    if published_engine == pilot.engine:
        return pilot
    return run_pilot(inputs, times, published_engine, samples=_SAMPLES, report=report)


def expected_pilot_s(engine: str, steps: int) -> float:
    """Return about how many CPU seconds the pilot of a single run takes, by the steps of a run in double."""
    prec = PILOT_PREC + PILOT_GAP_BITS
    run_s = fastest(prec, engine, steps).expected_s(steps, prec)
    return (_SAMPLES + 1) * run_s * _WITHOUT_TRANSITS


def _first_published(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, engine: str) -> Plan:
    """Return the run that is published if the first precision suffices."""
    return published_plan(scene, times, pilot, first_prec(scene, pilot, engine), engine)


def need_heyoka(field: str = "solve") -> None:
    """Refuse to solve a scene where heyoka is not installed: no run would be checked.

    Raises:
        InputError: it is not.
    """
    needed("heyoka", "", field, "solving a scene")


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
        radius = first_radius(scene, pilot)
        proof = plan_for(scene.exact, times[-1], radius, None, feed.lost)
        bits = proof.bits - COEFFICIENT_BITS
        return fastest(bits, steps=pilot.steps, proof=True).plan(scene.exact, bits, times)
    return _first_published(scene, times, pilot, AUTO)


def first_prec(scene: Scene, pilot: Pilot, engine: str) -> int:
    """Return the bits that a scene's digits need: of the only run, or of the coarser of two.

    Where double serves, it is compared with long double, and nothing of higher precision is
    compiled; this does not hold for a proof.
    """
    is_single = scene.run.level == "computed"
    span = scene.exact.t_end if scene.run.transits else None
    prec = pilot.bits_for(scene.run.digits, span, checked=not is_single)
    prec += second_order_bits(scene, pilot)
    if is_single:
        return rounded_prec(prec) if prec > LONG_DOUBLE.prec else prec
    may_be_double = engine in (AUTO, _HARDWARE_ENGINE) and scene.run.level != "enclosed"
    if may_be_double and prec <= DOUBLE.prec:
        return DOUBLE.prec
    return rounded_prec(max(prec, LONG_DOUBLE.prec))


def published_plan(
    scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int, engine: str
) -> Plan:
    """Return the run that is published: in `prec` bits if it is the only one, else in more."""
    if scene.run.level == "computed":
        bits = prec
    elif prec == DOUBLE.prec:
        bits = LONG_DOUBLE.prec
    else:
        bits = prec + _FINER_BITS
    return fastest(bits, engine, pilot.steps).plan(scene.exact, bits, times, scene.run.zeros)


def confirming_plan(scene: Scene, times: tuple[Fraction, ...], pilot: Pilot, prec: int) -> Plan:
    """Return heyoka's run that confirms another one: in another formulation, of `prec` bits.

    It is `space` if the cord always pulls; `spin`, neutral off the sphere at every angle, if a rod
    is pushed.
    """
    number = DOUBLE if prec == DOUBLE.prec else real(prec)
    formulation = "space" if pilot.tension > 0 else "spin"
    return Plan(scene.exact, formulation, number, times, scene.run.zeros)


def drawn_intervals(scene: Scene) -> list[int]:
    """Return the intervals of a grid, counted from 0, that a sampled confirmation integrates.

    A tenth of them, rounded up: those with the least sha256 of "HASH K", where K counts intervals
    from 1, and HASH is the sha256, in hexadecimal figures, of the scene's inputs as JSON without
    spaces.
    """
    sections = {"inputs", "pendulum", "site", "release", "run"}
    inputs = scene.model_dump_json(include=sections, exclude_none=True)
    scene_hash = sha256(inputs.encode()).hexdigest()

    def draw(i: int) -> bytes:
        return sha256(f"{scene_hash} {i + 1}".encode()).digest()

    count = len(scene.exact.grid) - 1
    drawn = sorted(range(count), key=draw)
    return sorted(drawn[: ceil(Fraction(count, SAMPLED))])


def rounded_prec(prec: int) -> int:
    """Round a precision up to a multiple of `_ROUND_TO_BITS`."""
    return -(-prec // _ROUND_TO_BITS) * _ROUND_TO_BITS
