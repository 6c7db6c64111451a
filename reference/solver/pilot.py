"""Pilot runs: how fast rounding errors grow on a scene, and the bits and steps that it needs.

Two cheap runs that differ in precision show how many digits are lost between release and end. From
them follow bits, number types and formulations, and so the bytes of a dataset. So they are made in
arithmetic that is the same on every machine, in limbs or heyoka's `real`; in double and long double
only where the result itself is in these types. A scene that would take too many steps, because it
is stiff or long, is refused by the pace of the first steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from ..engines import AUTO
from ..engines.plan import Engine, Plan, Report, Run
from ..engines.registry import fastest, run
from ..errors import BeyondDoublesError, UnreachableError
from ..model.start import Start
from ..numbers.columns import GRID, HORIZONTAL, POSITION, VELOCITY
from ..numbers.precision import DOUBLE, LONG_DOUBLE, decimals_for, real
from ..numbers.table import Table, bits_in, decimals_of, resolved
from ..scenes.inputs import Inputs
from ..scenes.scene import Scene
from ..system.channel import ACTIVITY

PILOT_PREC = 47  # of the first exact run: three limbs
PILOT_GAP_BITS = 22  # bits between it and the second: a limb
_LATER_GAP_BITS = 64  # bits between two pilot runs of more precision
# a run's error stays this many bits below the last digit, so that rounding is rarely in doubt
MARGIN_BITS = 14
# bits that the time of a day's worst conditioned transit loses against xdot
_CLOSE_TRANSIT_BITS = 12
# safety factor from the pilot's error to that of a run which no second one checks
ESTIMATE_FACTOR = 16
_LEAST_ULPS = 4  # and that error is never taken below this many units in the last place
# the pilot runs are compared at more times than this, so that no error is small by luck
_LEAST_TIMES = 64
# an error above this part of the largest position or speed leaves no digit
_LOST = Fraction(1, 1 << 12)
STILL_PREC = 128  # bits from which a velocity that is exactly zero is that of rest
# bits from which a position or velocity that shrinks with the precision is taken for zero
ZERO_PREC = 512
MAX_PREC = 8192  # bits; a run that needs more is refused
MAX_RAISES = 6  # of the precision, before giving up
_MAX_STEPS = 1 << 24  # at 160 bits or less: a year of Paris, three CPU hours
_PACE_STEPS = 1 << 16  # steps over which the pace is measured, once or, with drag, again and again
_SETTLED = 10  # with drag γ the pace may change until t = _SETTLED/γ


@dataclass(frozen=True)
class Pilot:
    """How rounding errors grow on a scene.

    Attributes:
        prec: bits of the coarser pilot run.
        errors: its largest error in each column of the grid, in SI units.
        largest: largest number in each column of the grid.
        tension: least tension of the cord over l, in 1/s²; negative where a rod is pushed.
        cpu_s: CPU seconds of both runs.
        steps: steps of the coarser run.
        engine: that of both runs.
    """

    prec: int
    errors: dict[str, Fraction]
    largest: dict[str, Fraction]
    tension: float
    cpu_s: float
    steps: int
    engine: str = ""

    @property
    def sizes(self) -> dict[str, Fraction]:
        """Size of each column: its largest number, or that of its kind if it is rounding noise."""
        return resolved(self.largest, self.errors)

    @property
    def cautious(self) -> dict[str, Fraction]:
        """Errors to assume where no second run checks them, in SI units.

        They have a safety factor and a floor, and are the same for x and y.
        """
        floored = {}
        for name, error in self.errors.items():
            least = _LEAST_ULPS * self.largest[name] / 2**self.prec
            floored[name] = ESTIMATE_FACTOR * max(error, least)
        cautious = {}
        for name in floored:
            alike = HORIZONTAL.get(name, (name,))
            cautious[name] = max(floored[column] for column in alike)
        return cautious

    def estimates(self, prec: int) -> dict[str, Fraction]:
        """Return the errors to state for a single run at a precision."""
        factor = Fraction(2) ** (self.prec - prec)
        return {name: error * factor for name, error in self.cautious.items()}

    def decimals(self, digits: int) -> dict[str, int]:
        """Return the decimals that give the largest number of each column `digits` digits."""
        return decimals_of(self.sizes, digits)

    def bits_for(self, digits: int, t_end: Fraction | None, *, checked: bool) -> int:
        """Return the bits with which every column's error stays `MARGIN_BITS` below its last digit.

        Args:
            digits: significant digits of each column's largest number.
            t_end: end of the run in s if the times of transits need their digits too, else None.
            checked: whether a second run will check the result; if not, `cautious` errors are
                assumed.
        """
        needed = 0
        expected = self.errors if checked else self.cautious
        for name, places in self.decimals(digits).items():
            unit = Fraction(1, 10**places)
            if expected[name]:
                needed = max(needed, self.prec + bits_in(expected[name] / unit) + MARGIN_BITS)
            elif self.largest[name]:
                needed = max(needed, bits_in(self.largest[name] / unit) + MARGIN_BITS)
        if t_end is not None:
            ratio = expected["vx"] * 10 ** decimals_for(t_end, digits)
            needed = max(needed, self.prec + bits_in(ratio) + _CLOSE_TRANSIT_BITS)
        return needed


def run_pilot(
    inputs: Inputs,
    times: tuple[Fraction, ...],
    engine: str = AUTO,
    *,
    samples: int = 1,
    hardware: bool = False,
    report: Report | None = None,
) -> Pilot:
    """Measure rounding errors from two cheap runs, in higher precision if the first keep no digit.

    Args:
        inputs: the exact inputs of a scene.
        times: output times in s, from 0.
        engine: whose errors to measure; "auto" for the fastest, which shows how errors grow.
        samples: how many coarser runs, a bit apart, the largest error of which counts.
        hardware: begin with double and long double, for a result in these types; its errors are
            measured, and not the same on every machine.
        report: called with the simulated time, as far as the work of all runs is done.

    Raises:
        UnreachableError: the run takes too many steps, or rounding grows so fast that no affordable
            run keeps a digit.
    """
    ACTIVITY.send("measuring how errors grow")
    if len(times) <= _LEAST_TIMES:
        times = tuple(times[-1] * k / _LEAST_TIMES for k in range(_LEAST_TIMES + 1))
    pair = _PilotPair(inputs, times, engine, PILOT_PREC, PILOT_PREC + PILOT_GAP_BITS)
    if hardware:
        pair = replace(pair, prec=DOUBLE.prec, fine_prec=LONG_DOUBLE.prec, hardware=True)

    pace: Pace | None = Pace(inputs, times[-1])
    last_prec = 0
    good_until = Fraction(0)
    steps = 0
    while pair.fine_prec <= MAX_PREC and effort(steps, pair.fine_prec) <= _MAX_STEPS:
        runs = pair.run(samples, pace, report)
        pace = None  # the first pair has shown it
        steps = runs.coarse.steps
        if not runs.lost():
            return runs.pilot()

        last_good_until = good_until
        good_until = runs.good_until()
        extrapolated = _extrapolated_prec(
            (last_prec, last_good_until), (pair.prec, good_until), times[-1]
        )
        last_prec = pair.prec
        prec = max(2 * LONG_DOUBLE.prec, 2 * pair.prec, extrapolated)
        pair = _PilotPair(inputs, times, engine, prec, prec + _LATER_GAP_BITS)
    raise UnreachableError(
        f"Rounding errors grow so fast that no digit is left after t = {float(good_until):.3g} s; "
        f"a run to the end would need about {pair.prec} bits, which is out of reach.",
        "Ask for a shorter run: run.t_end.",
    )


def pilot_engine(
    inputs: Inputs, end: Fraction, engine: str = AUTO, prec: int = PILOT_PREC
) -> Engine:
    """Return the engine of a pilot run of `prec` bits until a time in s."""
    # about one a step
    radians = math.ceil(Start.of(inputs, LONG_DOUBLE.prec).fastest_rate * float(end))
    return fastest(max(prec, LONG_DOUBLE.prec + 1), engine, 2 * radians)


@dataclass(frozen=True)
class _PilotPair:
    """Two pilot runs that are to be made.

    Attributes:
        inputs: the exact inputs of a scene.
        times: output times in s, from 0.
        engine: that makes them; "auto" for the fastest.
        prec: bits of the coarse run.
        fine_prec: bits of the fine run.
        hardware: whether they are in double and long double.
    """

    inputs: Inputs
    times: tuple[Fraction, ...]
    engine: str
    prec: int
    fine_prec: int
    hardware: bool = False

    def run(self, samples: int, pace: Pace | None, report: Report | None) -> _PilotRuns:
        """Make the runs, and coarse ones of a few more bits up to `samples` in all.

        Raises:
            UnreachableError: at its pace the coarse run takes too many steps.
        """
        try:
            coarse = run(self._plan(self.prec), self._nth_report(report, 0, samples), pace)
            fine = run(self._plan(self.fine_prec), self._nth_report(report, 1, samples))
            further = [
                run(self._plan(self.prec + i), self._nth_report(report, 1 + i, samples))
                for i in range(1, samples)
            ]
            tension = coarse.tension
        except OverflowError:
            raise BeyondDoublesError from None
        return _PilotRuns(self, coarse, fine, further, tension)

    def _nth_report(self, report: Report | None, n: int, samples: int) -> Report | None:
        """Return the report of run n, from 0, of the fine run and `samples` coarse ones."""
        if report is None:
            return None
        end = float(self.times[-1])
        return lambda t: report((n * end + t) / (samples + 1))

    def _plan(self, prec: int) -> Plan:
        """Return a pilot run, in limbs or in heyoka's `real` unless it is to be in hardware."""
        if self.hardware:
            number = DOUBLE if prec == DOUBLE.prec else LONG_DOUBLE
            return Plan(self.inputs, "momentum", number, self.times)
        engine = pilot_engine(self.inputs, self.times[-1], self.engine, prec)
        plan = engine.plan(self.inputs, prec, self.times)
        return replace(plan, number=real(prec)) if plan.number.hardware else plan


@dataclass(frozen=True)
class _PilotRuns:
    """Pilot runs that have been made.

    Attributes:
        pair: what was to be made.
        coarse: the run whose errors are measured.
        fine: the run that it is compared with.
        further: coarse runs of 1, 2, ... bits more.
        tension: least tension of the cord over l in the coarse run, in 1/s².
    """

    pair: _PilotPair
    coarse: Run
    fine: Run
    further: list[Run]
    tension: float

    @cached_property
    def _grid(self) -> Table:
        return self.fine.grid.only(GRID)

    @cached_property
    def _gaps(self) -> Table:
        """Differences of the coarse run from the fine one."""
        return self._grid.distance(self.coarse.grid)

    @cached_property
    def _largest(self) -> dict[str, Fraction]:
        return self._grid.largest()

    @cached_property
    def _errors(self) -> dict[str, Fraction]:
        """The largest error in each column, scaled to the bits of the coarse run."""
        errors = self._gaps.largest()
        for bits, other in enumerate(self.further, 1):
            gaps = self._grid.distance(other.grid).largest()
            errors = {name: max(error, gaps[name] * 2**bits) for name, error in errors.items()}
        return errors

    def lost(self) -> bool:
        """Return whether position or velocity keeps no digit."""
        return _lost(self._errors, self._largest, self.pair.inputs.length, self.pair.prec)

    def good_until(self) -> Fraction:
        """Return the time in s until which both position and velocity keep a digit."""
        return _good_until(self._gaps, self.pair.times, self._largest)

    def pilot(self) -> Pilot:
        """Return what the runs have measured."""
        errors = self._errors
        if not self.pair.hardware:
            # no error is taken to be less than that of a last bit a step, always in one direction
            drift = Fraction(self.coarse.steps, 2**self.pair.prec)
            sizes = self._largest
            errors = {name: max(error, sizes[name] * drift) for name, error in errors.items()}
        return Pilot(
            prec=self.pair.prec,
            errors=errors,
            largest=self._largest,
            tension=self.tension,
            cpu_s=sum(done.cpu_s for done in (self.coarse, self.fine, *self.further)),
            steps=self.coarse.steps,
            engine=self.coarse.plan.engine,
        )


def _lost(
    errors: dict[str, Fraction], largest: dict[str, Fraction], length: Fraction, prec: int
) -> bool:
    """Return whether position or velocity keeps no digit.

    One that shrinks with the precision is zero, not lost.

    Nor does one keep it that is exactly zero in few bits: numbers with a fixed point may not show
    so slow a motion.
    """
    zero = length / 2 ** (prec // 2) if prec >= ZERO_PREC else Fraction(0)
    for kind in (POSITION, VELOCITY):
        size = max(largest[name] for name in kind)
        error = max(errors[name] for name in kind)
        if size > zero and error > size * _LOST:
            return True
        if size <= zero and prec < STILL_PREC:
            return True
    return False


def _extrapolated_prec(last: tuple[int, Fraction], now: tuple[int, Fraction], end: Fraction) -> int:
    """Return the bits that keep a digit to the end; 0 if that is unknown.

    It is extrapolated from two precisions, each with the time in s until which it kept a digit.

    The pair in double is not used: a single fall from the top may cost all its digits, and what
    follows little.
    """
    last_prec, last_until = last
    prec, until = now
    if last_prec <= LONG_DOUBLE.prec or until <= last_until:
        return 0
    return math.ceil(prec + (end - until) * (prec - last_prec) / (until - last_until))


def _good_until(gaps: Table, times: tuple[Fraction, ...], largest: dict[str, Fraction]) -> Fraction:
    """Return the time in s until which both position and velocity keep a digit."""
    columns = []
    for kind in (POSITION, VELOCITY):
        limit = _LOST * max(largest[name] for name in kind)
        columns += [(gaps.exact(name), limit) for name in kind]
    good_until = Fraction(0)
    for i, time in enumerate(times):
        if any(column[i] > limit for column, limit in columns):
            break
        good_until = time
    return good_until


def effort(steps: int, prec: int) -> int:
    """Return the number of steps at 160 bits that cost as much.

    A step's cost is taken to grow with the cube of the bits.

    That is cautious, for a limit: at a few hundred bits it grows more like the square
    (`Engine.expected_s`).
    """
    return steps * max(1, prec // 32) ** 3 // 125


def out_of_reach(steps: int, prec: int) -> bool:
    """Return whether a run of `steps` steps in `prec` bits costs more than the solver begins."""
    return prec > MAX_PREC or effort(steps, prec) > _MAX_STEPS


def check_reach(steps: int, prec: int, digits: int, advice: str = "") -> None:
    """Refuse a run that is out of reach.

    Raises:
        UnreachableError: it would take too many bits or steps.
    """
    if out_of_reach(steps, prec):
        raise UnreachableError(
            f"{digits} digits would need {prec} bits and about {steps} steps, which is out of reach.",
            advice or "Ask for fewer digits (run.digits) or a shorter run (run.t_end).",
        )


class Pace:
    """The pace of a run, which is called with the steps taken and the time reached in s.

    Args:
        inputs: the exact inputs of a scene.
        end: end of the run in s.

    Raises:
        UnreachableError: at that pace the run takes more than `_MAX_STEPS` steps.
    """

    def __init__(self, inputs: Inputs, end: Fraction) -> None:
        self._inputs = inputs
        self._end = float(end)
        self._last_steps = 0
        self._last_t = 0.0
        self._watching = True

    def __call__(self, steps: int, t: float) -> None:
        """Measure the pace once, or with drag again and again."""
        more_steps = steps - self._last_steps
        if not self._watching or more_steps < _PACE_STEPS:
            return
        pace = more_steps / (t - self._last_t) if t > self._last_t else math.inf
        self._last_steps = steps
        self._last_t = t

        needed = steps + (self._end - t) * pace
        self._watching = needed > _MAX_STEPS
        if self._watching and (steps >= _MAX_STEPS or self._settled(t)):
            most = 0.95 * (t + (_MAX_STEPS - steps) / pace)
            advice = f"Ask for a shorter run (run.t_end up to about {most:.2g}) or less drag."
            raise UnreachableError(_reason(self._inputs, needed, pace), advice)

    def _settled(self, t: float) -> bool:
        """Return whether drag does not change the pace any more."""
        drag = self._inputs.drag
        return not drag or drag * Fraction(t) >= _SETTLED


def _reason(inputs: Inputs, needed: float, pace: float) -> str:
    """Return why a run takes too many steps: it is long, or strong drag makes it stiff.

    Stiff is a motion whose rates are far apart in size.
    """
    altogether = f"{needed:.1e} steps, and at most {_MAX_STEPS:.1e} are taken."
    start = Start.of(inputs, LONG_DOUBLE.prec)
    swing = float(start.ctx.norm(start.k.pull)) ** 0.5
    drag = float(inputs.drag)
    if 2 * swing >= drag:
        return f"The run takes {pace:.1e} steps per simulated second, altogether {altogether}"

    fast = drag * (1 + math.sqrt(1 - (2 * swing / drag) ** 2)) / 2
    slow = swing**2 / fast
    then = "nothing moves any more"
    if slow:
        then = f"the bob relaxes at {slow:.1e}/s; the rates differ by a factor of {fast / slow:.1e}"
    return (
        f"Stiff: drag takes the speed away at {fast:.1e}/s, and after that {then}. "
        f"An explicit method's steps are limited by the faster rate: {altogether}"
    )


def second_order_bits(scene: Scene, pilot: Pilot) -> int:
    """Return the bits that highest and lowest points need besides.

    The height is of second order in the amplitude.
    """
    speed = max(pilot.sizes[name] for name in VELOCITY)
    needs_height = {"highest", "lowest"} & {*(scene.run.sections or ())}
    if not speed or not needs_height:
        return 0
    swing_rate = Fraction(Start.of(scene.exact, DOUBLE.prec).rate)
    return bits_in(scene.exact.length * swing_rate / speed)
