"""Eight scenes side by side in heyoka: one pass that finds the zeros by events, one more for the states there."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import heyoka as hy
import numpy as np

from ...model.algebra import cross, dot
from ...model.constants import Constants
from ...model.formulations import FORMULATIONS
from ...numbers.precision import DOUBLE, Array
from ..batch_interface import DOUBTFUL, OK, STOPPED, Batch, Outcomes, Rows, Wanted
from .batch_tolerances import MOVED_TOLERANCE, TOLERANCE
from .batch_zeros import TRANSIT, TURNING, by_lane, describe
from .machine_code import keep_on_disk
from .shared_log import SHARED_LOG
from .system import as_pairs, rates

MODEL = FORMULATIONS["momentum"]
LANES = Batch.lanes
STEPS_PER_SWING = 1000  # most steps over 2π/√|c|; a small swing takes seven
LEAST_STEPS = 10_000  # that are granted to any row
BEYOND = 1e-6  # of the span: where a lane without a zero is sampled beyond its end, while others have one
_PARAMETERS = ("turn_1", "turn_2", "pull_1", "pull_2", "drag")
_MOVED = ("drag", "turn", "pull", "n", "V")


class Integrator:
    """One compiled batch; not to be used by two threads at once.

    Args:
        events: kinds of zeros to find, of `TRANSIT`, `TURNING`.
        drag: whether the equations hold drag.
        tolerance: relative error of a step.
    """

    def __init__(self, events: tuple[int, ...], drag: bool, tolerance: float) -> None:
        self.zeros: dict[int, list[list[float]]] = {kind: [[] for _ in range(LANES)] for kind in events}
        names = _PARAMETERS if drag else _PARAMETERS[:-1]
        k = Constants.of({name: hy.par[i] for i, name in enumerate(names)})
        state = hy.make_vars(*MODEL.variables)
        _, v = MODEL.cartesian(state, k, hy)
        functions = {TRANSIT: v[0], TURNING: -dot(v, k.pull)}
        keywords: dict[str, Any] = {"tol": tolerance}
        if events:
            keywords["nt_events"] = [self._event(kind, functions[kind]) for kind in events]
        equations = as_pairs(state, rates(MODEL, k)(state, hy))
        with SHARED_LOG.alone():
            keep_on_disk(DOUBLE)
            self._ta: Any = hy.taylor_adaptive_batch(equations, np.zeros((len(state), LANES)), **keywords)
        self._parameters = len(names)

    def _event(self, kind: int, function: Any) -> Any:
        zeros = self.zeros[kind]  # heyoka deep-copies callbacks: a function stays itself, a bound method would not

        def record(_: Any, t: float, direction: int, lane: int) -> None:
            zeros[lane] += (t, direction)

        both = hy.event_direction.any if kind == TRANSIT else hy.event_direction.negative
        return hy.nt_event_batch(function, callback=record, direction=both)

    def _reset(self, rows: Rows) -> None:
        k = rows.k
        for lanes in self.zeros.values():
            for lane in lanes:
                lane.clear()
        self._ta.set_time(0.0)
        n, V = (tuple(vector[..., 0].T) for vector in (rows.n, rows.V))
        self._ta.state[:] = [*n, *cross(n, V)]
        self._ta.pars[:] = [*k.turn[1:], *k.pull[1:], k.drag][: self._parameters]

    def to_end(self, rows: Rows, most: int) -> tuple[Any, Any, Any]:
        """Return the states at the ends, shape (variables, lanes), each lane's steps, and whether it stopped before."""
        self._reset(rows)
        self._ta.propagate_until(rows.t_end[:, 0], max_steps=most)
        outcomes, steps = zip(*((one[0], one[3]) for one in self._ta.propagate_res), strict=True)
        state = self._ta.state.copy()
        stopped = np.array([one == hy.taylor_outcome.err_nf_state for one in outcomes]) | ~np.isfinite(state).all(
            axis=0
        )
        if not stopped.any():  # else it is those alone that made all others stop
            stopped = np.array([one != hy.taylor_outcome.time_limit for one in outcomes])
        return state, np.array(steps), stopped

    def at(self, rows: Rows, times: list[Array], most: int) -> Any:
        """Return the states at increasing times of each lane, shape (1 + the most times, variables, lanes)."""
        self._reset(rows)
        count = max(map(len, times))
        ends = rows.t_end[:, 0]
        grid = ends * (1 + BEYOND * np.arange(1, count + 2))[:, None]
        grid[0] = 0.0
        for lane, own in enumerate(times):
            grid[1 : 1 + len(own), lane] = own
        return self._ta.propagate_grid(grid, max_steps=most)[1]


_turn = threading.Lock()
_free: dict[tuple[tuple[int, ...], bool, bool], list[Integrator]] = {}


@contextmanager
def _integrator(events: tuple[int, ...], drag: bool, moved: bool) -> Iterator[Integrator]:
    """Lend an integrator of a kind to the calling thread."""
    with _turn:
        free = _free.setdefault((events, drag, moved), [])
        integrator = free.pop() if free else None
    if integrator is None:
        integrator = Integrator(events, drag, MOVED_TOLERANCE if moved else TOLERANCE)
    try:
        yield integrator
    finally:
        with _turn:
            free.append(integrator)


def _events(wanted: Wanted) -> tuple[int, ...]:
    asked = {TRANSIT: wanted.transits or wanted.times, TURNING: wanted.apsides}
    return tuple(kind for kind, wish in asked.items() if wish)


def prepare(wanted: Wanted, drag: bool) -> float:
    """Compile what such rows need in the calling thread; return the CPU seconds that it took."""
    started = time.thread_time()
    for events in {_events(wanted), ()}:
        with _integrator(events, drag, bool(wanted.moved)):
            pass
    return time.thread_time() - started


def solve(rows: Rows, wanted: Wanted) -> Outcomes:
    """Solve rows, eight at a time, those that swing about as often together; see `Batch.solve`."""
    prepare(wanted, bool(rows.drag.any()))
    rows = _moved(rows, wanted.moved) if wanted.moved else rows
    outcomes = Outcomes.empty(len(rows))
    listed: list[tuple[int, Array, Array]] = []
    order = np.argsort(rows.swings, kind="stable")
    with SHARED_LOG.watched():
        for drag in (False, True):
            kind = order[(rows.drag[order, 0] != 0) == drag]
            for start in range(0, len(kind), LANES):
                _eight(rows, kind[start : start + LANES], wanted, outcomes, listed)
    return outcomes.with_transits(listed if wanted.times else [])


def _eight(rows: Rows, part: Any, wanted: Wanted, outcomes: Outcomes, listed: list[tuple[int, Array, Array]]) -> None:
    """Solve at most eight rows; those that stop are taken out, and the others solved again without them."""
    count, chosen = len(part), rows[np.resize(part, LANES)]
    limits = LEAST_STEPS + STEPS_PER_SWING * chosen.swings[:count]
    drag = bool(chosen.drag.any())
    with _integrator(_events(wanted), drag, bool(wanted.moved)) as first:
        (state, steps, stopped), logged = SHARED_LOG.seen(lambda: first.to_end(chosen, int(limits.max())))
        zeros = by_lane(first.zeros, chosen)
    stopped = stopped[:count] | (steps[:count] > limits)
    if stopped.any():
        outcomes.fate[part[stopped]] = STOPPED
        if not stopped.all():
            _eight(rows, part[~stopped], wanted, outcomes, listed)
        return
    n, v = cartesian(state, chosen)
    outcomes.state[part] = (np.concatenate([n, v]) * chosen.length[:, 0]).T[:count]
    outcomes.steps[part] = steps[:count]
    outcomes.fate[part] = DOUBTFUL if logged else OK
    if not _events(wanted):
        return
    times = [one.times for one in zeros]
    if any(map(len, times)):
        with _integrator((), drag, bool(wanted.moved)) as second:
            states = second.at(chosen, times, int(2 * limits.max()))
    else:
        states = state[None]
    for lane, row in enumerate(part):
        own = slice(lane, lane + 1)
        n, v = cartesian(states[1 : 1 + len(times[lane]), :, lane].T, chosen[own])
        transits = describe(outcomes, row, chosen[own], wanted, zeros[lane], n, v)
        if wanted.times:
            listed.append((int(row), *transits))


def cartesian(state: Any, rows: Rows) -> tuple[Array, Array]:
    """Return n and n' of states of shape (variables, …), each of shape (3, …)."""
    n, v = MODEL.cartesian(tuple(state), rows.k, np)
    return np.array(n), np.array(v)


def _moved(rows: Rows, way: int) -> Rows:
    """Return the rows with every number one ulp further from zero, or nearer to it where `way` is -1."""

    def one(numbers: Array) -> Array:
        moved = numbers.copy()
        high = numbers[..., 0]
        moved[..., 0] = np.where(high == 0, 0.0, np.nextafter(high, np.copysign(np.inf, high) if way > 0 else 0.0))
        return moved

    return replace(rows, **{name: one(getattr(rows, name)) for name in _MOVED})
