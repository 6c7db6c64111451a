"""Run a proof: choose method and bits, take an approximant's steps, and try again with more bits if it fails.

Untrusted: no bound is computed here. Every step goes to the trusted `Course`, whose results are
passed on as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import chain, islice, pairwise
from math import ceil
from time import process_time
from typing import Any, NamedTuple

from flint import arb

from ..errors import IntegrationError, UnreachableError
from ..model.sections import gate_without_rest
from ..numbers.precision import log2
from ..numbers.taylor_step import TaylorStep
from ..numbers.zeros import XDOT
from .frames import ColumnSource
from .trusted.audit import SumsAudit, WrongSumsError
from .trusted.course import Course
from .trusted.shapes import Proved, ProvedFunction, State
from .trusted.system import SceneBalls

MARGIN_BITS = 18  # lost to the rounding of coefficients and to norms; measured on Paris
COLUMN_MARGIN_BITS = 14  # lost in addition where the error is carried in columns
# up to here one radius is always cheaper than columns: a step by columns takes six times as long
RADIUS_BITS = 400
# beyond, the share of the target bits that one radius may lose before columns are cheaper
RADIUS_SHARE = 0.2
LEAST_BITS = 96
MAX_BITS = 2048
LOOK_BITS = 128  # for a first look at a scene, before its proof
SCENE_GUARD_BITS = 64  # precision of the scene's balls beyond the steps' coefficients
ATTEMPTS = 4  # at rising precision
BATCH = 8  # steps that are read together
LEAST_RAISE = 8  # bits from one attempt to the next
USELESS = 2**12  # an attempt ends at once if a state is this many times wider than requested
LN_2 = 0.693
TINY = -1e9  # stands for the logarithm of a width that is 0

Approximant = Callable[[int], Iterable[TaylorStep]]
# bits that an approximant loses if one radius carries its error, as a function of its own bits
Lost = Callable[[int], int]


class ProofPlan(NamedTuple):
    """The method and the precision that an attempt at a proof begins with."""

    method: str  # "radius" or "columns"
    bits: int


@dataclass(frozen=True)
class Enclosure:
    """A proof's result as trusted code returned it, and how it was reached."""

    proved: Proved
    bits: int
    order: int
    steps: int
    method: str  # "radius" (Theorem C) or "columns" (Theorem E)
    position_radius: Fraction  # the largest of all, in m
    velocity_radius: Fraction  # in m/s
    cpu_s: float  # CPU seconds, without those of the approximant and of the audit
    audited: bool = False  # what compiled code returned was checked, for every step
    audit_s: float = 0.0  # CPU seconds of that
    function: ProvedFunction | None = None  # the golden function, if it was asked for


class _TooWide(Exception):
    """The bounds are wider than requested; `bits` is the precision to try next."""

    def __init__(self, reason: str, bits: int) -> None:
        super().__init__(reason)
        self.bits = bits


@dataclass(frozen=True)
class _Request:
    """What is to be proved: the arguments of `enclose`."""

    inputs: Any
    times: list[Fraction]
    radius: Fraction
    zeros: tuple[str, ...]
    progress: Callable[[float], None] | None
    audit: bool
    function: bool


def enclose(
    inputs: Any,
    times: Sequence[Fraction],
    *,
    radius: Fraction,
    approximant: Approximant,
    zeros: tuple[str, ...] = (XDOT,),
    progress: Callable[[float], None] | None = None,
    method: str | None = None,
    audit: bool = False,
    function: bool = False,
    lost: Lost | None = None,
) -> Enclosure:
    """Prove where the pendulum is at `times`, and every zero of some forms up to the last of them.

    Args:
        inputs: the exact numbers of a scene (`Scene.exact`).
        times: output times in s, from 0 on, increasing.
        radius: largest half-width to accept, in m for positions and m/s for velocities.
        approximant: function of a precision in bits; it returns the steps from t = 0 to the last
            time, as `pair` yields them. It is called again, with more bits, if the bounds are too
            wide.
        zeros: words of the zeros to enclose: `XDOT` for transits, and those of sections.
        progress: called with the part of the time span that is proved.
        method: "radius" or "columns"; None for the one that is likely to be cheaper.
        audit: check for every step what compiled code returned.
        function: also make the golden function, and bound it.
        lost: bits that a run loses in addition to `MARGIN_BITS`, if one radius carries its error
            (`Feed.lost`).

    Raises:
        UnreachableError: no bound of this width was reached; says how wide it is.
        IntegrationError: the audit found that compiled code returned wrong sums.
    """
    if not times or times[0] < 0 or any(b <= a for a, b in pairwise(times)):
        raise ValueError(
            "times: got a sequence that is empty, negative or not increasing, expected increasing times in s from 0"
        )
    request = _Request(inputs, list(times), radius, zeros, progress, audit, function)
    try:
        plan = plan_for(inputs, times[-1], radius, method, lost)
    except (ArithmeticError, ValueError) as error:
        advice = "Its numbers differ too much in size: check lengths, rates and angles."
        raise UnreachableError(
            f"enclosure: cannot choose a precision for this scene; {error}.", advice
        ) from None

    reason = "nothing tried"
    for _ in range(ATTEMPTS):
        try:
            return _attempt(request, plan, approximant)
        except _TooWide as error:
            reason = str(error)
            bits = max(error.bits, plan.bits + LEAST_RAISE)
        except (ArithmeticError, ValueError) as error:
            # a bound that is not finite, a matrix without inverse, a step that does not join
            reason = f"at {plan.bits} bits: {error}"
            bits = plan.bits * 4 // 3
        plan = plan._replace(bits=bits)
        if plan.bits > MAX_BITS:
            break
    raise UnreachableError(
        f"enclosure: cannot prove a bound of {short(radius)} m at t = {float(times[-1]):g} s; {reason}.",
        "Ask for fewer digits or a shorter run.",
    )


def _attempt(request: _Request, plan: ProofPlan, approximant: Approximant) -> Enclosure:
    """Prove all steps at one precision; raise _TooWide if a state is wider than requested."""
    steps = iter(approximant(plan.bits))
    first = next(steps, None)
    if first is None:
        raise UnreachableError("enclosure: the approximant has no steps.")
    attempt = _PointAttempt(request, plan, first)
    all_steps: Iterable[TaylorStep] = chain([first], steps)
    if request.function:
        from .fit import on_doubles

        # the same polynomials, each ended at the double below its end
        all_steps = on_doubles(all_steps)
    remaining = until(all_steps, request.times[-1])
    while batch := list(islice(remaining, BATCH)):
        attempt.advance(batch)
    return attempt.finish()


class _PointAttempt:
    """One attempt at one precision: the course, and what proposes columns and series to it."""

    def __init__(self, request: _Request, plan: ProofPlan, first: TaylorStep) -> None:
        self.request = request
        self.method = plan.method
        self.bits = first.bits
        self.order = len(first.coefficients[0]) - 1
        self.audit = SumsAudit() if request.audit else None
        self.audit_s = 0.0
        balls = SceneBalls(request.inputs, first.bits + SCENE_GUARD_BITS, self.audit)
        by_columns = plan.method == "columns"
        self.columns = ColumnSource(balls) if by_columns else None
        self.course = Course(balls, request.times, by_columns, request.zeros)
        self.fit = None
        if request.function:
            # a proof rests on the code of a function only where it has one
            from .fit import FunctionFit

            self.fit = FunctionFit(self.course)
        self.steps = 0
        self.checked_states = 0
        self.cpu_s = 0.0

    def advance(self, batch: list[TaylorStep]) -> None:
        """Prove the next steps."""
        begun = process_time()
        self.course.read(batch)
        self.cpu_s += process_time() - begun
        for step in batch:
            self._take(step)

    def _take(self, step: TaylorStep) -> None:
        """Prove the next step of those that were read."""
        begun = process_time()
        if self.columns:
            widths = [_log(z) for z in self.course.bound.z]
            self.course.take(self.columns.propose(step, widths))
        else:
            self.course.take()
        if self.fit:
            self.fit.add()
        self.cpu_s += process_time() - begun
        self.steps += 1
        if self.audit and self.audit.full:
            self._check_sums(self.audit)
        self._check_last_state()
        if self.request.progress:
            end = self.request.times[-1]
            self.request.progress(float((step.centre + step.h * step.high) / end) if end else 1.0)

    def finish(self) -> Enclosure:
        """Return what was proved; raise _TooWide if a state is wider than requested."""
        begun = process_time()
        # the proof of a function finishes the course, and passes on what that has proved
        function = self.fit.finish() if self.fit else None
        proved = function.proved if function else self.course.finish()
        radii = _radii(proved.states)
        self._check(radii, self.request.times[-1], 1)
        self.cpu_s += process_time() - begun
        if self.audit:
            self._check_sums(self.audit)
        return Enclosure(
            proved=proved,
            bits=self.bits,
            order=self.order,
            steps=self.steps,
            method=self.method,
            position_radius=radii.position,
            velocity_radius=radii.velocity,
            cpu_s=self.cpu_s,
            audited=self.audit is not None,
            audit_s=self.audit_s,
            function=function,
        )

    def _check_sums(self, audit: SumsAudit) -> None:
        """Check what compiled code returned since the last time.

        Raises:
            IntegrationError: it is wrong. Another attempt would only hide that.
        """
        begun = process_time()
        try:
            audit.check()
        except WrongSumsError as error:
            advice = "Delete numba's machine code, update numba, or try another machine."
            raise IntegrationError(f"audit: {error}.", advice) from None
        self.audit_s += process_time() - begun

    def _check_last_state(self) -> None:
        """Raise _TooWide if the last state of new ones is of no use."""
        states = self.course.states
        if len(states) > self.checked_states:
            self.checked_states = len(states)
            time = self.request.times[len(states) - 1]
            self._check(_radii(states[-1:]), time, USELESS)

    def _check(self, radii: _Radii, time: Fraction, factor: int) -> None:
        """Raise _TooWide if states up to `time` are wider than `factor` radii."""
        request = self.request
        largest = max(radii.position, radii.velocity)
        if largest <= factor * request.radius:
            return
        missing = magnitude(largest / request.radius) + 6
        # what the rest of the run will lose, if it loses as much per time
        lost = max(0, self.bits + magnitude(radii.position / request.inputs.length))
        missing += ceil(lost * (request.times[-1] - time) / time) if time else lost
        reached = f"{short(radii.position)} m and {short(radii.velocity)} m/s"
        reason = f"{self.bits} bits gave {reached} ({self.method})"
        raise _TooWide(reason, self.bits + 8 * ceil(missing / 8))


@dataclass(frozen=True)
class _Radii:
    """Largest half-widths of states, in m and m/s."""

    position: Fraction
    velocity: Fraction


def _radii(states: Sequence[State]) -> _Radii:
    """Return the largest half-widths of states."""
    positions = [(x.high - x.low) / 2 for state in states for x in state[:3]]
    velocities = [(x.high - x.low) / 2 for state in states for x in state[3:]]
    return _Radii(max(positions), max(velocities))


def check_gates(inputs: Any, words: tuple[str, ...]) -> None:
    """Refuse gates of a scene that no precision encloses, before any work.

    Raises:
        InputError: as `demand_rest_positions`.
    """
    # of other faults of a scene the proof tells the reason
    with suppress(ArithmeticError, ValueError):
        demand_rest_positions(SceneBalls(inputs, LOOK_BITS), words)


def demand_rest_positions(balls: SceneBalls, words: tuple[str, ...]) -> None:
    """Refuse gates if no single rest position is known (Lemma 13.3).

    Raises:
        InputError: it names the gate.
    """
    sections = [word for word in words if word != XDOT]
    if sections:
        from .trusted.sections import form

    for word in sections:
        try:
            form(balls, word)
        except ArithmeticError:
            reason = (
                "at so fast a rotation the proof finds no single rest position, unlike lower levels"
            )
            raise gate_without_rest(word, reason) from None


def plan_for(
    inputs: Any, end: Fraction, radius: Fraction, method: str | None, lost: Lost | None = None
) -> ProofPlan:
    """Choose method and precision for balls of `radius` at `end`.

    Raises:
        UnreachableError: it would take more than MAX_BITS.
    """
    balls = SceneBalls(inputs, LOOK_BITS)
    w = float(balls.w0)
    span = float(end)
    # 2 w times the rate of Theorem C, but for its second-order terms
    growth = float(max(balls.lambda_minus, balls.lambda_plus + balls.S**2, key=float))
    loss = span * growth / (2 * w) / LN_2
    log_radians = log2(2 + span * w)
    target = magnitude(inputs.length / radius) + log_radians

    if method is None:
        few_bits = target + MARGIN_BITS + loss <= RADIUS_BITS
        small_loss = loss <= RADIUS_SHARE * target + MARGIN_BITS
        method = "radius" if few_bits or small_loss else "columns"
    extra = loss if method == "radius" else COLUMN_MARGIN_BITS + log_radians
    bits = max(LEAST_BITS, 8 * ceil((target + MARGIN_BITS + extra) / 8))
    if lost and method == "radius":
        bits += lost(bits)
    if bits > MAX_BITS:
        reason = f"enclosure: a bound of {short(radius)} m would need more than {MAX_BITS} bits."
        raise UnreachableError(reason, "Ask for fewer digits.")
    return ProofPlan(method, bits)


def magnitude(ratio: Fraction) -> int:
    """Return an estimate of the logarithm to base 2."""
    return ratio.numerator.bit_length() - ratio.denominator.bit_length()


def short(x: Fraction) -> str:
    """Return a number with two digits, even one that a float cannot hold."""
    return f"{Decimal(x.numerator) / Decimal(x.denominator):.1e}"


def until(steps: Iterable[TaylorStep], end: Fraction) -> Iterator[TaylorStep]:
    """Yield the steps up to the end of the run, the last one cut there."""
    for step in steps:
        if step.centre + step.h * step.high >= end:
            high = (end - step.centre) / step.h
            # a run of no duration ends where it starts, but a step must have a length
            yield step._replace(high=high if high > step.low else step.low + Fraction(1, 1 << 20))
            return
        yield step
    raise UnreachableError(f"enclosure: the approximant ends before {float(end):g} s.")


def _log(z: arb) -> float:
    return float(z.log()) if z > 0 else TINY
