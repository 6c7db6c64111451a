"""Many rows by heyoka, one after the other.

One pass finds the zeros of a row by events, one more gives the states there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ...model.constants import Constants
from ...numbers.precision import DOUBLE, Array
from ..batch_interface import STOPPED, XDOT, Outcomes, PlumbAxes, Rows, RunOptions, moved, turned
from ..row_zeros import (
    HEIGHT,
    MODEL,
    TRANSIT,
    FoundZeros,
    RowMotion,
    RowRelease,
    RowZeros,
    Samples,
    describe_highest_points,
    describe_transits,
)
from .conversions import Numbers
from .library import hy
from .system import as_pairs, rates

_PARAMETERS = ("turn_1", "turn_2", "pull_2", "drag")
_STEPS_PER_SWING = 1000  # most steps over 2π/√|c|; a small swing takes seven
# at least, between which a rate may dip to zero; a step of a tiny swing lasts half of one
_SAMPLES_PER_SWING = 12
_LEAST_STEPS = 10_000  # that are granted to any row


@dataclass(frozen=True)
class _Compilation:
    """What the code of an integrator depends on.

    Attributes:
        sought: kinds of the zeros that are looked for: `TRANSIT`, `HEIGHT`.
        form: whether the transits are the zeros of any form, not of xdot.
        drag: whether there is drag.
        tolerance: relative error of a step.
    """

    sought: tuple[int, ...]
    form: bool
    drag: bool
    tolerance: float

    @classmethod
    def of(cls, options: RunOptions, drag: bool, tolerance: float) -> _Compilation:
        """Build from what is asked for of rows."""
        is_sought = {TRANSIT: options.transits or options.times, HEIGHT: options.apsides}
        sought = tuple(kind for kind, wanted in is_sought.items() if wanted)
        return cls(sought, options.form and bool(sought), drag, tolerance)

    @property
    def without_events(self) -> _Compilation:
        """The same equations without events."""
        return replace(self, sought=(), form=False)


@dataclass(frozen=True)
class _Row:
    """A row to be solved, in the axes of the plumb line.

    Attributes:
        number: its place among the outcomes.
        release: its release.
        k: its constants.
        state: its state at t = 0, n and n × V.
        compilation: of the integrator that finds its zeros.
    """

    number: int
    release: RowRelease
    k: Constants
    state: list[Any]
    compilation: _Compilation

    @property
    def form(self) -> Any:
        """The form whose zeros are the transits."""
        return self.release.forms[TRANSIT]

    def times_swings(self, per_swing: int) -> float:
        """Return a number per period of a small swing as that of the whole span."""
        return per_swing * self.release.end * self.release.rate / (2 * np.pi)


class _RunEnd(NamedTuple):
    """The end of a run: state, steps taken, and whether it stopped before the end of the span."""

    state: Any
    steps: int
    stopped: bool


class Integrator:
    """The equations compiled once, in the axes of the plumb line.

    Two threads may not use one at the same time.
    """

    def __init__(self, compilation: _Compilation) -> None:
        names = _PARAMETERS if compilation.drag else _PARAMETERS[:-1]
        k = Constants.of({name: hy.par[i] for i, name in enumerate(names)})
        state = hy.make_vars(*MODEL.variables)
        n, v = MODEL.cartesian(state, k, hy)
        form_rates = {TRANSIT: v[0], HEIGHT: v[2]}
        if compilation.form:
            form = [hy.par[len(names) + i] for i in range(len(XDOT))]
            form_rates[TRANSIT] = RowMotion(n, v, v).form(form)[0]

        self._parameters = len(names)
        self._events: dict[int, list[float]] = {kind: [] for kind in compilation.sought}
        events = []
        for kind, recorded in self._events.items():
            events.append((form_rates[kind], _recorder(recorded)))
        system = as_pairs(state, rates(MODEL, k)(state, hy))
        self._ta = Numbers(DOUBLE).integrator(
            system, [], tol=compilation.tolerance, events=tuple(events)
        )

    def begin(self, row: _Row) -> None:
        """Set a row's constants, its state at t = 0 and its form, where there is one."""
        for recorded in self._events.values():
            recorded.clear()
        self._ta.time = 0.0
        self._ta.state[:] = row.state
        constants = [*row.k.turn[1:], row.k.pull[2], row.k.drag]
        numbers = [*constants[: self._parameters], *row.form]
        self._ta.pars[:] = numbers[: len(self._ta.pars)]

    def to_end(self, release: RowRelease, max_steps: int) -> _RunEnd:
        """Integrate to the end of the span.

        A zero at the release may hide the next one from heyoka, if both are in one step: the first
        step is short.
        """
        short = any(release.zero[kind] for kind in self._events)
        if short:
            self._ta.step(min(release.quiet, release.end))
            if not np.isfinite(self._ta.time):
                return _RunEnd(self._ta.state.copy(), 1, stopped=True)
        outcome, _, _, steps, *_ = self._ta.propagate_until(release.end, max_steps=max_steps)
        state = self._ta.state.copy()
        in_time = outcome == hy.taylor_outcome.time_limit
        return _RunEnd(state, int(steps) + short, not in_time or not np.isfinite(state).all())

    def zeros(self, kind: int) -> RowZeros:
        """Return the zeros of a kind that were passed, in order."""
        return RowZeros.of(self._events.get(kind, []))

    def at(self, times: Array) -> Any:
        """Return the states at increasing times from 0 on, shape (variables, times)."""
        return self._ta.propagate_grid(times)[-1].T


def _recorder(recorded: list[float]) -> Callable[[Any, float, int], None]:
    """Return a function that records an event.

    heyoka deep-copies callbacks: a function stays itself, a bound method would not.
    """

    def record(_: Any, t: float, direction: int) -> None:
        recorded.extend((t, direction))

    return record


_free: dict[_Compilation, list[Integrator]] = {}


@contextmanager
def _lent(compilation: _Compilation) -> Iterator[Integrator]:
    """Lend an integrator to the calling thread."""
    free = _free.setdefault(compilation, [])
    try:
        integrator = free.pop()
    except IndexError:
        integrator = Integrator(compilation)
    yield integrator
    free.append(integrator)


def prepare(options: RunOptions, tolerance: float) -> None:
    """Compile what such rows without drag need in the calling thread."""
    compilation = _Compilation.of(options, False, tolerance)
    for needed in {compilation, compilation.without_events}:
        with _lent(needed):
            pass


def solve(rows: Rows, options: RunOptions, tolerance: float) -> Outcomes:
    """Solve rows to a relative error of a step; see `Batch.solve`."""
    outcomes = Outcomes.empty(len(rows))
    axes = PlumbAxes.of(rows)
    numbers = np.array([part.high for part in (*axes.n, *axes.V, *axes.turn, -axes.size)])
    numbers = moved(numbers, options.moved)
    drags = moved(rows.drag[:, 0], options.moved)
    forms = axes.forms(rows).T if options.form else [XDOT] * len(rows)
    transits: list[RowZeros] = []
    with np.errstate(all="ignore"):
        for i in range(len(rows)):
            k, state = _constants_and_state(numbers[:, i], drags[i])
            release = RowRelease.of(rows, axes, i, RowMotion.of(state, k), forms[i])
            compilation = _Compilation.of(options, bool(k.drag), tolerance)
            transits.append(_solve(outcomes, _Row(i, release, k, state, compilation)))
        _turn_to_earth(outcomes, axes, rows.length[:, :1])
    if not options.times:
        return outcomes
    times = [zeros.times for zeros in transits]
    directions = [zeros.directions for zeros in transits]
    return outcomes.with_transits(times, directions)


def _constants_and_state(numbers: Array, drag: float) -> tuple[Constants, list[Any]]:
    """Return a row's constants, and n and n × V at the release, from n, V, turn and pull."""
    n, V, (turn_p, turn_u, pull) = np.split(numbers, 3)
    k = Constants(turn=(0, turn_p, turn_u), pull=(0, 0, pull), drag=drag)
    return k, [*n, *np.cross(n, V)]


def _turn_to_earth(outcomes: Outcomes, axes: PlumbAxes, length: Array) -> None:
    """Turn the states at the end to the axes x, y, z, and multiply them by the length."""
    x, p, u, vx, vp, vu = outcomes.state.T
    sin, cos = axes.sin.high, axes.cos.high
    y, z = turned(p, u, -sin, cos)
    vy, vz = turned(vp, vu, -sin, cos)
    outcomes.state[:] = np.transpose((x, y, z, vx, vy, vz)) * length


def _solve(outcomes: Outcomes, row: _Row) -> RowZeros:
    """Solve a row, its state at the end left in these axes and over l; return its transits."""
    release = row.release
    with _lent(row.compilation) as integrator:
        integrator.begin(row)
        max_steps = int(_LEAST_STEPS + row.times_swings(_STEPS_PER_SWING))
        end = integrator.to_end(release, max_steps)
        transits = release.after(integrator.zeros(TRANSIT), TRANSIT)
        heights = release.after(integrator.zeros(HEIGHT), HEIGHT)
    if end.stopped:
        outcomes.fate[row.number] = STOPPED
        return RowZeros.of([])

    last = RowMotion.of(end.state, row.k)
    outcomes.state[row.number] = [*last.n, *last.v]
    outcomes.steps[row.number] = end.steps
    if row.compilation.sought:
        count = int(max(end.steps, row.times_swings(_SAMPLES_PER_SWING)))
        samples = np.linspace(0, release.end, count + 1)
        _describe(outcomes, row, samples, transits, heights)
    return transits


def _describe(
    outcomes: Outcomes, row: _Row, times: Array, transits: RowZeros, heights: RowZeros
) -> None:
    """Fill in a row's transits and highest points, from the motion at them and at sampled times."""
    sought = row.compilation.sought
    seen = _seen(row, times, transits, heights)
    if TRANSIT in sought and not row.release.still:
        times = seen.samples.finer(seen.transits)
        if len(times) > len(seen.samples.times):  # the plane passes north-south
            seen = _seen(row, times, transits, heights)
        describe_transits(outcomes, row.number, seen.transits, seen.samples)
    if HEIGHT in sought:
        describe_highest_points(outcomes, row.number, seen.heights, seen.samples)


class _Seen(NamedTuple):
    """A row's motion at samples, its transits, and the zeros of its height's rate."""

    samples: Samples
    transits: FoundZeros
    heights: FoundZeros


def _seen(row: _Row, samples: Array, transits: RowZeros, heights: RowZeros) -> _Seen:
    """Return the motion at all of these times, by one more run."""
    every = np.concatenate([samples, transits.times, heights.times])
    times, places = np.unique(every, return_inverse=True)
    ends = np.cumsum([len(samples), len(transits.times)])
    at_samples, at_transits, at_heights = np.split(places, ends)
    with _lent(row.compilation.without_events) as integrator:
        integrator.begin(row)
        motion = RowMotion.of(integrator.at(times), row.k)
    return _Seen(
        samples=Samples(samples, motion[at_samples]),
        transits=FoundZeros(TRANSIT, row.release, transits, motion[at_transits]),
        heights=FoundZeros(HEIGHT, row.release, heights, motion[at_heights]),
    )
