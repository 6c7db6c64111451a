"""Many rows by heyoka, one after the other: one pass finds the zeros by events, one more gives the states there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import heyoka as hy
import numpy as np

from ...model.constants import Constants
from ...numbers.precision import DOUBLE, Array
from ..batch_interface import STOPPED, XDOT, Outcomes, PlumbAxes, Rows, RunOptions, moved, turned
from ..row_zeros import (
    HEIGHT,
    MODEL,
    TRANSIT,
    RowMotion,
    RowRelease,
    RowZeros,
    Samples,
    describe_highest_points,
    describe_transits,
)
from .conversions import Numbers
from .system import as_pairs, rates

PARAMETERS = ("turn_1", "turn_2", "pull_2", "drag")
STEPS_PER_SWING = 1000  # most steps over 2π/√|c|; a small swing takes seven
# at least, between which a rate may dip to zero; a step of a tiny swing lasts half of one
SAMPLES_PER_SWING = 12
LEAST_STEPS = 10_000  # that are granted to any row

# the zeros that are looked for, whether they are those of any form, whether there is drag, and the tolerance
Kind = tuple[tuple[int, ...], bool, bool, float]


class Integrator:
    """The equations compiled once, in the axes of the plumb line; not to be used by two threads at once."""

    def __init__(self, sought: tuple[int, ...], form: bool, drag: bool, tolerance: float) -> None:
        names = PARAMETERS if drag else PARAMETERS[:-1]
        k = Constants.of({name: hy.par[i] for i, name in enumerate(names)})
        state = hy.make_vars(*MODEL.variables)
        n, v = MODEL.cartesian(state, k, hy)
        self._events: dict[int, list[float]] = {kind: [] for kind in sought}
        rate = {TRANSIT: v[0], HEIGHT: v[2]}
        if form:
            numbers = [hy.par[len(names) + i] for i in range(len(XDOT))]
            rate[TRANSIT] = RowMotion(n, v, v).form(numbers)[0]
        events = tuple((rate[kind], _recorder(noted)) for kind, noted in self._events.items())
        system = as_pairs(state, rates(MODEL, k)(state, hy))
        self._ta = Numbers(DOUBLE).integrator(system, [], tol=tolerance, events=events)
        self._parameters = len(names)

    def begin(self, k: Constants, state: Any, form: Any) -> None:
        """Set a row's constants, its state at t = 0 and the form of its section, where there is one."""
        for noted in self._events.values():
            noted.clear()
        self._ta.time = 0.0
        self._ta.state[:] = state
        numbers = (*([*k.turn[1:], k.pull[2], k.drag][: self._parameters]), *form)
        self._ta.pars[:] = numbers[: len(self._ta.pars)]

    def to_end(self, release: RowRelease, most: int) -> tuple[Any, int, bool]:
        """Return the state at the end, the steps taken, and whether the end was not reached.

        A zero at the release may hide the next one from heyoka, if both are in one step: the first one is short.
        """
        short = any(release.zero[kind] for kind in self._events)
        if short:
            self._ta.step(min(release.quiet, release.end))
            if not np.isfinite(self._ta.time):
                return self._ta.state.copy(), 1, True
        outcome, _, _, steps, *_ = self._ta.propagate_until(release.end, max_steps=most)
        state = self._ta.state.copy()
        return (
            state,
            int(steps) + short,
            outcome != hy.taylor_outcome.time_limit or not np.isfinite(state).all(),
        )

    def zeros(self, kind: int) -> RowZeros:
        """Return the zeros of a kind that were passed, in order."""
        return RowZeros.of(self._events.get(kind, []))

    def at(self, times: Array) -> Any:
        """Return the states at increasing times from 0 on, shape (variables, times)."""
        return self._ta.propagate_grid(times)[-1].T


def _recorder(noted: list[float]) -> Callable[[Any, float, int], None]:
    """Return what notes an event; heyoka deep-copies callbacks: a function stays itself, a bound method would not."""

    def record(_: Any, t: float, direction: int) -> None:
        noted.extend((t, direction))

    return record


_free: dict[Kind, list[Integrator]] = {}


@contextmanager
def _lent(*kind: Any) -> Iterator[Integrator]:
    """Lend an integrator of a `Kind` to the calling thread."""
    free = _free.setdefault(kind, [])
    try:
        integrator = free.pop()
    except IndexError:
        integrator = Integrator(*kind)
    yield integrator
    free.append(integrator)


def _sought(options: RunOptions) -> tuple[int, ...]:
    is_sought = {TRANSIT: options.transits or options.times, HEIGHT: options.apsides}
    return tuple(kind for kind, sought in is_sought.items() if sought)


def prepare(options: RunOptions, tolerance: float) -> None:
    """Compile what such rows without drag need in the calling thread."""
    for sought in {_sought(options), ()}:
        with _lent(sought, options.form and bool(sought), False, tolerance):
            pass


def solve(rows: Rows, options: RunOptions, tolerance: float) -> Outcomes:
    """Solve rows to a relative error of a step; see `Batch.solve`."""
    outcomes, axes = Outcomes.empty(len(rows)), PlumbAxes.of(rows)
    numbers = np.array([part.high for part in (*axes.n, *axes.V, *axes.turn, -axes.size)])
    numbers, drags = moved(numbers, options.moved), moved(rows.drag[:, 0], options.moved)
    forms = axes.forms(rows).T if options.form else [XDOT] * len(rows)
    transits: list[RowZeros] = []
    with np.errstate(all="ignore"):
        for row in range(len(rows)):
            n, V, (turn_p, turn_u, pull) = np.split(numbers[:, row], 3)
            k = Constants(turn=(0, turn_p, turn_u), pull=(0, 0, pull), drag=drags[row])
            state = [*n, *np.cross(n, V)]
            release = RowRelease.of(rows, axes, row, RowMotion.of(state, k), forms[row])
            transits.append(_solve(outcomes, row, release, k, state, options, tolerance))
        x, p, u, vx, vp, vu = outcomes.state.T
        sin, cos = axes.sin.high, axes.cos.high
        # in the Earth's axes
        at_end = (x, *turned(p, u, -sin, cos), vx, *turned(vp, vu, -sin, cos))
        outcomes.state[:] = np.transpose(at_end) * rows.length[:, :1]
    if not options.times:
        return outcomes
    return outcomes.with_transits(
        [zeros.times for zeros in transits], [zeros.directions for zeros in transits]
    )


def _solve(
    outcomes: Outcomes,
    row: int,
    release: RowRelease,
    k: Constants,
    state: Any,
    options: RunOptions,
    tolerance: float,
) -> RowZeros:
    """Solve a row, its state at the end left in these axes and over l; return its transits."""
    sought, kind, form = _sought(options), (bool(k.drag), tolerance), release.forms[TRANSIT]
    with _lent(sought, options.form, *kind) as first:
        first.begin(k, state, form)
        most = LEAST_STEPS + STEPS_PER_SWING * release.end * release.rate / (2 * np.pi)
        last, steps, stopped = first.to_end(release, int(most))
        transits, heights = (release.after(first.zeros(zero), zero) for zero in (TRANSIT, HEIGHT))
    if stopped:
        outcomes.fate[row] = STOPPED
        return RowZeros.of([])
    end = RowMotion.of(last, k)
    outcomes.state[row], outcomes.steps[row] = [*end.n, *end.v], steps
    if sought:
        swung = SAMPLES_PER_SWING * release.end * release.rate / (2 * np.pi)
        samples = np.linspace(0, release.end, int(max(steps, swung)) + 1)
        seen, at_transits, at_heights = _seen(samples, transits, heights, k, state, form, kind)
        if TRANSIT in sought and not release.still:
            samples = seen.finer(transits, at_transits, release, TRANSIT)
            if len(samples) > len(seen.times):  # the plane passes north-south
                seen, at_transits, at_heights = _seen(
                    samples, transits, heights, k, state, form, kind
                )
            describe_transits(outcomes, row, release, transits, at_transits, seen)
        if HEIGHT in sought:
            describe_highest_points(outcomes, row, release, heights, at_heights, seen)
    return transits


def _seen(
    samples: Array,
    transits: RowZeros,
    heights: RowZeros,
    k: Constants,
    state: Any,
    form: Any,
    kind: tuple[bool, float],
) -> tuple[Samples, RowMotion, RowMotion]:
    """Return the motion at samples, at transits and at zeros of the height's rate, by one more run."""
    times, places = np.unique(
        np.concatenate([samples, transits.times, heights.times]), return_inverse=True
    )
    at_samples, at_transits, at_heights = np.split(
        places, np.cumsum([len(samples), len(transits.times)])
    )
    with _lent((), False, *kind) as second:
        second.begin(k, state, form)
        motion = RowMotion.of(second.at(times), k)
    return Samples(samples, motion[at_samples]), motion[at_transits], motion[at_heights]
