"""The run: from steps to states and transits, defects on all cores, more bits when needed.

Nothing here makes a bound: it hands every step, with the defect that belongs to it, to the trusted functions, which
check that steps join.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain, islice, pairwise
from math import ceil
from time import process_time
from typing import Any, cast

from flint import arb

from ..errors import UnreachableError
from .bound import Piece, Radius, World, output
from .candidate import Expansion, pair, polynomials
from .columns import Columns
from .frames import ColumnSource
from .helpers import Helper
from .plan import MAX_BITS, Plan, order_for, plan_for, short
from .recurrence import Recurrence
from .shapes import EnclosedTransit, Interval, Sizes, Step
from .transits import Scan

GUARD_BITS = 64  # the scene's balls beyond the steps' coefficients
ATTEMPTS = 4
LEAST_RAISE = 8  # bits
CHUNK = 32  # steps sent at once
AHEAD = 2  # chunks a helper holds
WORTH = 500  # oscillation times below which a helper costs more than it saves
TINY = -1e9  # logarithm of a width that is 0
PARTS = ("candidate", "defect", "bound", "transits")

Chain = Iterable[Expansion] | Iterable[Step]
Source = Chain | Callable[[int], Chain]
State = tuple[Interval, Interval, Interval, Interval, Interval, Interval]


@dataclass(frozen=True)
class Cost:
    """CPU seconds by part, helpers included."""

    candidate: float
    defect: float
    bound: float
    transits: float

    @property
    def proof(self) -> float:
        """All but the candidate."""
        return self.defect + self.bound + self.transits


@dataclass(frozen=True)
class Enclosure:
    """What was proved: the true state at `times` lies in `states`; all zeros of xdot in (0, T] in `transits`."""

    times: list[Fraction]
    states: list[State]  # x, y, z in m, vx, vy, vz in m/s
    transits: list[EnclosedTransit] | None  # None: not asked, or xdot is identically zero (see `still`)
    still: bool
    bits: int
    order: int
    steps: int
    method: str  # "radius" or "columns"
    position_radius: Fraction  # the largest of all, m
    velocity_radius: Fraction  # m/s
    cpu_s: Cost


class _Narrow(Exception):
    """Bounds came out too wide; carries how many bits to take."""

    def __init__(self, said: str, bits: int) -> None:
        super().__init__(said)
        self.bits = bits


def enclose(
    inputs: Any,
    times: Sequence[Fraction],
    *,
    radius: Fraction,
    transits: bool = True,
    candidate: Source | None = None,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
    method: str | None = None,
) -> Enclosure:
    """Prove where the pendulum is at `times` (s, increasing), and every transit up to the last of them.

    Args:
        inputs: the exact numbers of a scene (`Scene.exact`).
        times: output times in s, from 0 on, increasing.
        radius: wanted half-width, m for positions and m/s for velocities.
        transits: also enclose all zeros of xdot.
        candidate: expansions in a chain from t = 0, or what `pair` made of them, or a function of the precision in
            bits that gives either (only then can a second attempt be made); None for the package's own recurrence.
        workers: processes that may be used, this one included; None for one a core.
        progress: called with the part of the time span done.
        method: "radius" or "columns"; None for what is likely to be cheaper.

    Raises:
        UnreachableError: no bound of this width could be had; says how wide it came out.
    """
    if not times or times[0] < 0 or any(b <= a for a, b in pairwise(times)):
        raise ValueError("times: got a sequence that is empty, negative or not increasing")
    try:
        plan, said = plan_for(inputs, times[-1], radius, method), "nothing tried"
    except (ArithmeticError, ValueError) as error:
        advice = "Its numbers are too far apart: check lengths, rates and angles."
        raise UnreachableError(f"enclosure: no precision can be chosen for this scene; {error}.", advice) from None
    attempts = ATTEMPTS if candidate is None or callable(candidate) else 1
    for _ in range(attempts):
        try:
            run = _Run(inputs, plan, list(times), transits, workers, progress)
            return run.prove(candidate, radius)
        except _Narrow as error:
            said, bits = str(error), max(error.bits, plan.bits + LEAST_RAISE)
        except (ArithmeticError, ValueError) as error:
            # a bound that is not finite, a matrix without inverse, a step that does not join
            said, bits = f"at {plan.bits} bits: {error}", plan.bits * 4 // 3
        plan = plan._replace(bits=bits, order=order_for(bits))
        if plan.bits > MAX_BITS:
            break
    raise UnreachableError(
        f"enclosure: no bound of {short(radius)} m at {float(times[-1]):g} s; {said}.",
        "Ask for fewer digits or a shorter time.",
    )


@dataclass
class _Clock:
    """CPU seconds since the last reading, by part."""

    parts: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PARTS, 0.0))
    last: float = field(default_factory=process_time)

    def lap(self, part: str) -> None:
        now = process_time()
        self.parts[part] += now - self.last
        self.last = now


class _Run:
    """One attempt at one precision."""

    def __init__(
        self,
        inputs: Any,
        plan: Plan,
        times: list[Fraction],
        transits: bool,
        workers: int | None,
        progress: Callable[[float], None] | None,
    ) -> None:
        self.inputs, self.plan, self.times, self.progress = inputs, plan, times, progress
        self.transits = transits
        self.workers = workers or os.cpu_count() or 1
        self.end = times[-1]
        self.clock = _Clock()

    def prove(self, candidate: Source | None, radius: Fraction) -> Enclosure:
        """Run all steps; refuse a result that is wider than `radius`."""
        bits, order = self.plan.bits, self.plan.order
        steps: Iterator[Step] = iter(())
        if candidate is not None:
            given: Iterator[Any] = iter(candidate(bits) if callable(candidate) else candidate)
            first = next(given, None)
            if first is None:
                raise UnreachableError("enclosure: the candidate is empty.")
            bits, order = first.bits, len(first.coefficients[0]) - 1
            self.clock.lap("candidate")
            whole = chain([first], given)
            steps = whole if isinstance(first, Step) else pair(whole)
        self.world = world = World(self.inputs, bits + GUARD_BITS)
        if candidate is None:
            steps = pair(Recurrence(world, bits, order).chain(self.plan.first))
        self.clock.lap("bound")
        scan = Scan(world) if self.transits and not world.still else None
        states, count = self._steps(self._until(steps), scan, bits)
        found = (scan.finish() if self.end else []) if scan else None
        self.clock.lap("transits")
        widths = [[(i.high - i.low) / 2 for i in row] for row in states]
        position = max(max(row[:3]) for row in widths)
        velocity = max(max(row[3:]) for row in widths)
        if max(position, velocity) > radius:
            ratio = max(position, velocity) / radius
            more = 8 * ceil((ratio.numerator.bit_length() - ratio.denominator.bit_length() + 6) / 8)
            said = f"{bits} bits gave {short(position)} m and {short(velocity)} m/s ({self.plan.method})"
            raise _Narrow(said, bits + more)
        rows = cast("list[State]", [tuple(row) for row in states])
        cost = Cost(**self.clock.parts)
        return Enclosure(
            self.times, rows, found, world.still, bits, order, count, self.plan.method, position, velocity, cost
        )

    def _until(self, steps: Iterator[Step]) -> Iterator[Step]:
        """The steps up to the end of the run, the last one cut there."""
        for step in steps:
            if step.centre + step.h * step.high >= self.end:
                high = (self.end - step.centre) / step.h
                # a run of no time ends where it starts, and a step must have a length
                yield step._replace(high=high if high > step.low else step.low + Fraction(1, 1 << 20))
                return
            yield step
        raise UnreachableError(f"enclosure: the candidate ends before {float(self.end):g} s.")

    def _steps(self, steps: Iterator[Step], scan: Scan | None, bits: int) -> tuple[list[list[Interval]], int]:
        world, states, count, waiting = self.world, [], 0, deque(self.times)
        bound: Radius | Columns = Radius(world)
        columns = None
        if self.plan.method == "columns":
            bound, columns = Columns(world), ColumnSource(world)
        for piece, sizes in self._with_sizes(steps, bits):
            if columns is None:
                tube = cast(Radius, bound).advance(piece, sizes)
            else:
                box = cast(Columns, bound)
                proposal = columns.propose(piece.step, [_log(z) for z in box.z])
                self.clock.lap("candidate")
                tube = box.advance(piece, sizes, proposal)
            while waiting and waiting[0] <= piece.end:
                states.append(output(world, piece, tube, waiting.popleft()))
            self.clock.lap("bound")
            if scan:
                scan.advance(piece, tube)
                self.clock.lap("transits")
            count += 1
            if self.progress:
                self.progress(float(piece.end / self.end) if self.end else 1.0)
        return states, count

    def _with_sizes(self, steps: Iterator[Step], bits: int) -> Iterator[tuple[Piece, Sizes]]:
        """Each step with its defect, computed here or by helpers."""
        world = self.world
        if self.workers < 2 or float(self.end) * float(world.w0) < WORTH:
            for step in steps:
                self.clock.lap("candidate")
                piece = Piece(self.world, polynomials(step))
                sizes = piece.sizes()
                self.clock.lap("defect")
                yield piece, sizes
            return
        helpers = [Helper(self.inputs, world.prec) for _ in range(self.workers - 1)]
        try:
            yield from self._shared(steps, helpers)
        finally:
            for helper in helpers:
                helper.stop()

    def _shared(self, steps: Iterator[Step], helpers: list[Helper]) -> Iterator[tuple[Piece, Sizes]]:
        sent: deque[tuple[Helper, list[Step]]] = deque()
        turn = 0
        while True:
            chunk = list(islice(steps, CHUNK))
            self.clock.lap("candidate")
            if chunk:
                helper = helpers[turn % len(helpers)]
                helper.send(chunk)
                sent.append((helper, chunk))
                turn += 1
                self.clock.lap("defect")
            if not sent:
                return
            if chunk and len(sent) < AHEAD * len(helpers) + 1:
                continue
            helper, done = sent.popleft()
            sizes, cpu = helper.receive()
            self.clock.parts["defect"] += cpu
            for step, row in zip(done, sizes, strict=True):
                piece = Piece(self.world, polynomials(step))
                self.clock.lap("defect")
                yield piece, row


def _log(z: arb) -> float:
    return float(z.log()) if z > 0 else TINY
