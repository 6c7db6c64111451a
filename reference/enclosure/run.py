"""Run a proof: from an approximant's steps to enclosed states and transits, on all cores, with more bits if needed.

Untrusted: no bound is computed here. Every step goes, with its defect, to the trusted functions, which check that the
steps join.
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
from ..process import Worker
from ..taylor_step import TaylorStep
from .approximant import polynomials
from .bound import Piece, Radius, World, output
from .columns import Columns
from .defects import compute_defects, unpacked
from .frames import ColumnSource
from .plan import MAX_BITS, ProofPlan, plan_for, short
from .shapes import EnclosedTransit, Interval, Sizes
from .transits import Scan

SCENE_GUARD_BITS = 64  # precision of the scene's balls beyond the steps' coefficients
ATTEMPTS = 4  # at rising precision
LEAST_RAISE = 8  # bits from one attempt to the next
CHUNK = 32  # steps sent to a process at once
AHEAD = 2  # chunks that a process may hold
WORTH = 500  # duration times angular frequency below which a second process costs more than it saves
TINY = -1e9  # stands for the logarithm of a width that is 0
PARTS = ("candidate", "defect", "bound", "transits")  # as datasets name them: the first is the approximant

Approximant = Callable[[int], Iterable[TaylorStep]]
State = tuple[Interval, Interval, Interval, Interval, Interval, Interval]


@dataclass(frozen=True)
class ProofCost:
    """CPU seconds by part, of all processes; `candidate` is the approximant's share, by the name that datasets use."""

    candidate: float
    defect: float
    bound: float
    transits: float

    @property
    def proof(self) -> float:
        """All but the approximant."""
        return self.defect + self.bound + self.transits


@dataclass(frozen=True)
class Enclosure:
    """A proof's result: the true state at `times` lies in `states`, all zeros of xdot in (0, T] in `transits`."""

    times: list[Fraction]
    states: list[State]  # x, y, z in m, vx, vy, vz in m/s
    transits: list[EnclosedTransit] | None  # None: not requested, or xdot is identically zero (`still`)
    still: bool
    bits: int
    order: int
    steps: int
    method: str  # "radius" (Theorem C) or "columns" (Theorem E)
    position_radius: Fraction  # the largest of all, in m
    velocity_radius: Fraction  # in m/s
    cpu_s: ProofCost


class _TooWide(Exception):
    """The bounds are wider than requested; `bits` is the precision to try next."""

    def __init__(self, reason: str, bits: int) -> None:
        super().__init__(reason)
        self.bits = bits


def enclose(
    inputs: Any,
    times: Sequence[Fraction],
    *,
    radius: Fraction,
    approximant: Approximant,
    transits: bool = True,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
    method: str | None = None,
) -> Enclosure:
    """Prove where the pendulum is at `times` (s, increasing), and every transit up to the last of them.

    Args:
        inputs: the exact numbers of a scene (`Scene.exact`).
        times: output times in s, from 0 on, increasing.
        radius: largest half-width to accept, in m for positions and m/s for velocities.
        approximant: function of a precision in bits that gives steps from t = 0 to the last time, as `pair` yields
            them; it is called again, with more bits, where the bounds are too wide.
        transits: also enclose all zeros of xdot.
        workers: processes that may be used, this one included; None for one a core.
        progress: called with the part of the time span that is proved.
        method: "radius" or "columns"; None for the one that is likely to be cheaper.

    Raises:
        UnreachableError: no bound of this width was reached; says how wide it is.
    """
    if not times or times[0] < 0 or any(b <= a for a, b in pairwise(times)):
        raise ValueError("times: got a sequence that is empty, negative or not increasing")
    try:
        plan, reason = plan_for(inputs, times[-1], radius, method), "nothing tried"
    except (ArithmeticError, ValueError) as error:
        advice = "Its numbers are too far apart: check lengths, rates and angles."
        raise UnreachableError(f"enclosure: no precision can be chosen for this scene; {error}.", advice) from None
    for _ in range(ATTEMPTS):
        try:
            run = _Run(inputs, plan, list(times), transits, workers, progress)
            return run.prove(approximant, radius)
        except _TooWide as error:
            reason, bits = str(error), max(error.bits, plan.bits + LEAST_RAISE)
        except (ArithmeticError, ValueError) as error:
            # a bound that is not finite, a matrix without inverse, a step that does not join
            reason, bits = f"at {plan.bits} bits: {error}", plan.bits * 4 // 3
        plan = plan._replace(bits=bits)
        if plan.bits > MAX_BITS:
            break
    raise UnreachableError(
        f"enclosure: no bound of {short(radius)} m at {float(times[-1]):g} s; {reason}.",
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
        plan: ProofPlan,
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

    def prove(self, approximant: Approximant, radius: Fraction) -> Enclosure:
        """Prove all steps; raise _TooWide if a state is known less closely than to `radius`."""
        steps = iter(approximant(self.plan.bits))
        first = next(steps, None)
        if first is None:
            raise UnreachableError("enclosure: the approximant is empty.")
        bits, order = first.bits, len(first.coefficients[0]) - 1
        self.clock.lap("candidate")
        self.world = world = World(self.inputs, bits + SCENE_GUARD_BITS)
        self.clock.lap("bound")
        scan = Scan(world) if self.transits and not world.still else None
        states, count = self._steps(self._until(chain([first], steps)), scan)
        transits = (scan.finish() if self.end else []) if scan else None
        self.clock.lap("transits")
        widths = [[(i.high - i.low) / 2 for i in row] for row in states]
        position = max(max(row[:3]) for row in widths)
        velocity = max(max(row[3:6]) for row in widths)
        if max(position, velocity) > radius:
            ratio = max(position, velocity) / radius
            more = 8 * ceil((ratio.numerator.bit_length() - ratio.denominator.bit_length() + 6) / 8)
            reason = f"{bits} bits gave {short(position)} m and {short(velocity)} m/s ({self.plan.method})"
            raise _TooWide(reason, bits + more)
        rows = cast("list[State]", [tuple(row) for row in states])
        cost = ProofCost(**self.clock.parts)
        return Enclosure(
            self.times, rows, transits, world.still, bits, order, count, self.plan.method, position, velocity, cost
        )

    def _until(self, steps: Iterator[TaylorStep]) -> Iterator[TaylorStep]:
        """Yield the steps up to the end of the run, the last one cut there."""
        for step in steps:
            if step.centre + step.h * step.high >= self.end:
                high = (self.end - step.centre) / step.h
                # a run of no duration ends where it starts, but a step must have a length
                yield step._replace(high=high if high > step.low else step.low + Fraction(1, 1 << 20))
                return
            yield step
        raise UnreachableError(f"enclosure: the approximant ends before {float(self.end):g} s.")

    def _steps(self, steps: Iterator[TaylorStep], scan: Scan | None) -> tuple[list[list[Interval]], int]:
        """Prove the steps one by one; return the states at the output times and the number of steps."""
        world, states, count, waiting = self.world, [], 0, deque(self.times)
        bound: Radius | Columns = Radius(world)
        columns = None
        if self.plan.method == "columns":
            bound, columns = Columns(world), ColumnSource(world)
        for piece, sizes in self._with_sizes(steps):
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

    def _with_sizes(self, steps: Iterator[TaylorStep]) -> Iterator[tuple[Piece, Sizes]]:
        """Yield each step with its defect, computed here or in other processes."""
        world = self.world
        if self.workers < 2 or float(self.end) * float(world.w0) < WORTH:
            for step in steps:
                self.clock.lap("candidate")
                piece = Piece(self.world, polynomials(step))
                sizes = piece.sizes()
                self.clock.lap("defect")
                yield piece, sizes
            return
        processes = [Worker(compute_defects, self.inputs, world.prec) for _ in range(self.workers - 1)]
        try:
            yield from self._shared(steps, processes)
        finally:
            for process in processes:
                process.kill()
                process.stop()

    def _shared(self, steps: Iterator[TaylorStep], processes: list[Worker]) -> Iterator[tuple[Piece, Sizes]]:
        """Send the steps to the processes in turn, and yield them with their defects in order."""
        sent: deque[tuple[Worker, list[TaylorStep]]] = deque()
        turn = 0
        while True:
            chunk = list(islice(steps, CHUNK))
            self.clock.lap("candidate")
            if chunk:
                process = processes[turn % len(processes)]
                process.send(chunk)
                sent.append((process, chunk))
                turn += 1
                self.clock.lap("defect")
            if not sent:
                return
            if chunk and len(sent) < AHEAD * len(processes) + 1:
                continue
            process, chunk = sent.popleft()
            rows, cpu = process.receive()
            self.clock.parts["defect"] += cpu
            for step, sizes in zip(chunk, unpacked(rows), strict=True):
                piece = Piece(self.world, polynomials(step))
                self.clock.lap("defect")
                yield piece, sizes


def _log(z: arb) -> float:
    return float(z.log()) if z > 0 else TINY
