"""What the kernel octet costs beside heyoka, as ratios of CPU times in one process.

    python tests/bench/octet.py [ROWS] [PAIRS]

Rows are paris over 12,000 s at latitudes from -90 to 90. The two sides of a ratio take turns, PAIRS times (5), and the
median of the ratios is printed, with the demand where there is one; compiling is done before.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from reference.engines.batch_interface import Rows, RunOptions
from reference.engines.heyoka.batch import BATCH as HEYOKA
from reference.engines.octet.batch import BATCH as OCTET
from reference.engines.octet.rows import RESULTS, outcomes, packed
from reference.model.constants import Constants
from reference.model.formulations import FORMULATIONS
from reference.numbers.double_double import DoubleDouble
from reference.scenes.scene import load_scene
from reference.sweeps.estimate import MOVED, errors, errors_by_moved_runs
from reference.sweeps.part import solve_part
from reference.sweeps.request import Settings, request
from reference.sweeps.row_constants import columns_of, row_constants

SPAN = 12_000
MOMENTUM = FORMULATIONS["momentum"]


class ScalarLoop:
    """heyoka compiled once, a row after the other; with events, each transit calls a Python function."""

    def __init__(self, events: bool) -> None:
        state = hy.make_vars(*MOMENTUM.variables)
        pars = [hy.par[i] for i in range(4)]
        k = Constants(turn=(0, pars[0], pars[1]), pull=(0, pars[2], pars[3]))
        self.times: list[float] = []
        _, v = MOMENTUM.cartesian(state, k, hy)
        found = [hy.nt_event(v[0], lambda _, t, direction: self.times.append(t))] if events else []
        equations = list(zip(state, MOMENTUM.derivatives(state, k, hy), strict=True))
        self.integrator: Any = hy.taylor_adaptive(
            equations, [0.0] * 6, pars=[0.0] * 4, nt_events=found
        )

    def solve(self, rows: Rows) -> None:
        """Solve rows."""
        for n, inertial, turn, pull in zip(
            *(a[..., 0] for a in (rows.n, rows.V, rows.turn, rows.pull)), strict=True
        ):
            self.times.clear()
            self.integrator.time = 0.0
            self.integrator.state[:] = [*n, *np.cross(n, inertial)]
            self.integrator.pars[:] = [*turn[1:], *pull[1:]]
            self.integrator.propagate_until(float(SPAN))


def many_rows(count: int) -> Rows:
    """Return the standard rows."""
    columns = columns_of(load_scene("paris", [f"run.t_end={SPAN}", f"run.grid_step={SPAN}"]).exact)
    latitudes = [Fraction(-90) + Fraction(180 * i, count - 1) for i in range(count)]
    return row_constants(columns | {"latitude": DoubleDouble.of(latitudes)}, "ellipsoid", count)


def cpu_s(work: Callable[[], object]) -> float:
    """Return the CPU seconds of a call."""
    start = time.process_time()
    work()
    return time.process_time() - start


def show(
    name: str, over: Callable[[], object], under: Callable[[], object], pairs: int, demand: str
) -> None:
    """Print the median of the ratios of two calls that take turns."""
    found = [(cpu_s(over), cpu_s(under)) for _ in range(pairs)]
    ratios = sorted(a / b for a, b in found)
    spread = f"{ratios[0]:.2f} … {ratios[-1]:.2f}"
    ms = "ms {:8.1f} over {:8.1f}".format(
        *(1e3 * statistics.median(side) for side in zip(*found, strict=True))
    )
    print(f"{name:66} {statistics.median(ratios):7.2f}   ({spread}; {ms})   {demand}", flush=True)


def not_integration(count: int) -> float:
    """Return the CPU microseconds of a default row for all but the kernel: constants, packing, outcomes, errors."""
    results = np.zeros((count, RESULTS))
    results[:, 6] = 1.0
    rows = many_rows(count)
    columns = columns_of(load_scene("paris").exact)
    columns["latitude"] = DoubleDouble(np.linspace(-90, 90, count), np.zeros(count))
    run = OCTET.solve(rows[:1], RunOptions())
    several = type(run)(*(np.repeat(getattr(run, name), count, axis=0) for name in vars(run)))

    def once() -> None:
        own = row_constants(columns, "ellipsoid", count)
        for moved in (0, 1):
            outcomes(own, packed(own, RunOptions(moved=moved)), results, (results[:0, 0],) * 3)
        errors(own, several, several)

    with np.errstate(all="ignore"):
        return statistics.median(cpu_s(once) for _ in range(5)) / count * 1e6


def main(count: int = 181, pairs: int = 5) -> None:
    """Print all ratios."""
    rows = many_rows(count)
    bare, transits, whole = RunOptions(False, False), RunOptions(apsides=False), RunOptions()
    first = cpu_s(lambda: OCTET.prepare(whole))
    print(f"{count} rows, {pairs} pairs; octet compiled or read in {first:.2f} CPU s")
    silent, located = ScalarLoop(False), ScalarLoop(True)

    def octet(options: RunOptions) -> Callable[[], object]:
        return lambda: OCTET.solve(rows, options)

    def heyoka(options: RunOptions) -> Callable[[], object]:
        return lambda: HEYOKA.solve(rows, options)

    def default(engine: Any) -> Callable[[], object]:
        return lambda: errors_by_moved_runs(engine, rows, engine.solve(rows, whole))

    for options in (bare, transits, whole, MOVED):
        HEYOKA.solve(rows[:8], options)
        OCTET.solve(rows[:8], options)

    def with_events() -> None:
        located.solve(rows)

    show(
        "heyoka's scalar loop with events / octet, all transits",
        with_events,
        octet(transits),
        pairs,
        ">= 9.5",
    )
    show(
        "heyoka's scalar loop with events / octet, with precession",
        with_events,
        octet(whole),
        pairs,
        ">= 6.5",
    )
    show(
        "heyoka's scalar loop / octet, no events",
        lambda: silent.solve(rows),
        octet(bare),
        pairs,
        ">= 6.5",
    )
    show("the engine heyoka / octet, no events", heyoka(bare), octet(bare), pairs, "")
    show("the engine heyoka / octet, all transits", heyoka(transits), octet(transits), pairs, "")
    show("the engine heyoka / octet, with precession", heyoka(whole), octet(whole), pairs, "")
    show(
        "octet, default row (with its error) / bare row",
        default(OCTET),
        octet(whole),
        pairs,
        "<= 1.7",
    )
    if 180 % (count - 1) == 0:
        scene, over = (
            load_scene("paris", [f"run.t_end={SPAN}"]),
            [f"site.latitude=-90:90:{180 // (count - 1)}"],
        )
        sweeps = [
            request(scene, over, settings=Settings(engine=name)) for name in ("heyoka", "octet")
        ]
        sides = [lambda sweep=sweep: solve_part(sweep, range(count)) for sweep in sweeps]
        show("sweep in one process, default rows: heyoka / octet", *sides, pairs, ">= 3")
    print(
        f"{'all but the integration of a default row':66} {not_integration(8192):7.2f} us a row   <= 10"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
