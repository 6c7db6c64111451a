"""The standard rows by others, as a table in Markdown: time a row, its ratio to octet's, error at the end, transits.

    python tests/bench/peers.py [ROWS]

Rows are those of `octet.py`; errors are against limbs at 110 bits. All take turns, ROUNDS times in one process; time
and ratio are the medians over the rounds. Compiling is not counted. Boost, numbalsoda and diffrax stand in the table
where they are: `make peers` makes an environment that has all of them, .venv-peers.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import heyoka as hy
import numpy as np
from octet import SPAN, ScalarLoop, cpu_s, many_rows

from compare.methods.library import BOOST, compiler
from reference.engines.batch_interface import Rows, RunOptions
from reference.engines.heyoka.batch import BATCH as HEYOKA
from reference.engines.octet.batch import BATCH as OCTET
from reference.engines.registry import engines
from reference.scenes.scene import load_scene

ROUNDS = 5
TOLERANCES = (1e-11, 1e-12, 1e-13)
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class Peer:
    """A line of the table: its name, which transits it locates, the work, and what it does.

    `work` returns CPU seconds and the positions at the end in m, shape (rows, 3), or None.
    """

    name: str
    transits: str
    work: Callable[[], tuple[float, Any]]


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the CPU seconds of a call, and what it returned."""
    found: list[Any] = []
    return cpu_s(lambda: found.append(work())), found[0]


def numbers_of(rows: Rows) -> Any:
    """Return n, H, Ω and c of rows, the components that are not zero, shape (rows, 10)."""
    n, inertial = rows.n[..., 0], rows.V[..., 0]
    return np.hstack([n, np.cross(n, inertial), rows.turn[:, 1:, 0], rows.pull[:, 1:, 0]])


def truth(count: int) -> Any:
    """Return the positions at the end in m by limbs, shape (rows, 3)."""
    limbs, paris = engines()["limbs"], load_scene("paris").exact
    found = []
    for i in range(count):
        inputs = replace(
            paris, t_end=Fraction(SPAN), latitude=Fraction(-90) + Fraction(180 * i, count - 1)
        )
        run = limbs.run(limbs.plan(inputs, 110, (Fraction(0), Fraction(SPAN))))
        found.append([float(run.grid[name][-1]) for name in ("x", "y", "z")])
    return np.array(found)


def boost(rows: Rows, folder: str) -> list[Peer]:
    """Compile the program for Boost; return it at several tolerances."""
    words = compiler()
    if words is None or BOOST.missing:
        return []
    program, source = Path(folder) / "peers", Path(__file__).with_suffix(".cpp")
    subprocess.run(
        [*words, "-O3", "-march=native", "-I", str(BOOST.folder), source, "-o", program], check=True
    )
    table = "\n".join(" ".join(map(repr, row)) for row in numbers_of(rows).tolist())

    def work(tolerance: float) -> tuple[float, Any]:
        text = f"{tolerance} {SPAN}\n{table}"
        lines = subprocess.run(
            [program], check=True, input=text, capture_output=True, text=True
        ).stdout.splitlines()
        return float(lines[0]), rows.length[:, :1] * np.array(
            [line.split() for line in lines[1:]], dtype=float
        )

    return [
        Peer(f"Boost odeint, RKF78, tolerance {one:g}", "none", lambda one=one: work(one))
        for one in TOLERANCES
    ]


def numbalsoda(rows: Rows) -> list[Peer]:
    """Return numbalsoda's loops over the rows, compiled, at several tolerances."""
    os.environ.setdefault("GFORTRAN_UNBUFFERED_PRECONNECTED", "y")
    try:
        import numba as nb
        from numbalsoda import dop853, lsoda, lsoda_sig
    except ImportError:
        return []

    @nb.cfunc(lsoda_sig)  # type: ignore[untyped-decorator]
    def rates(_: Any, s: Any, d: Any, k: Any) -> None:
        x, y, z, hx, hy_, hz = s[0], s[1], s[2], s[3], s[4], s[5]
        wy, wz = hy_ - k[0], hz - k[1]
        d[0], d[1], d[2] = wy * z - wz * y, wz * x - hx * z, hx * y - wy * x
        d[3] = y * k[3] - z * k[2] + hy_ * k[1] - hz * k[0]
        d[4], d[5] = -x * k[3] - hx * k[1], x * k[2] + hx * k[0]

    address, times = rates.address, np.array([0.0, float(SPAN)])
    numbers, lengths = numbers_of(rows), np.ascontiguousarray(rows.length[:, 0])

    def loop(solve: Any) -> Any:
        @nb.njit  # type: ignore[untyped-decorator]
        def run(numbers: Any, tolerance: float) -> Any:
            ends = np.full((len(numbers), 3), np.nan)
            for i in range(len(numbers)):
                u0, data = numbers[i, :6].copy(), numbers[i, 6:].copy()
                states, good = solve(address, u0, times, data, tolerance, tolerance, MOST_STEPS)
                if good:
                    ends[i] = states[1, :3] * lengths[i]
            return ends

        run(numbers[:1], 1e-6)
        return run

    eighth, multistep = loop(dop853), loop(lsoda)
    runs = [*(("DOP853", eighth, one) for one in TOLERANCES), ("LSODA", multistep, TOLERANCES[1])]

    def work(run: Any, tolerance: float) -> tuple[float, Any]:
        return timed(lambda: run(numbers, tolerance))

    return [
        Peer(
            f"numbalsoda, {word}, tolerance {one:g}",
            "none",
            lambda run=run, one=one: work(run, one),
        )
        for word, run, one in runs
    ]


def diffrax(rows: Rows) -> list[Peer]:
    """Return diffrax's Dopri8 over all rows at once by vmap, on one thread, at several tolerances."""
    os.environ.setdefault(
        "XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    )
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    try:
        import diffrax as dfx
        import jax
        import jax.numpy as jnp
    except ImportError:
        return []
    jax.config.update("jax_enable_x64", True)

    def rates(_: Any, s: Any, k: Any) -> Any:
        x, y, z, hx, hy_, hz = s
        wy, wz = hy_ - k[0], hz - k[1]
        turned = (
            y * k[3] - z * k[2] + hy_ * k[1] - hz * k[0],
            -x * k[3] - hx * k[1],
            x * k[2] + hx * k[0],
        )
        return jnp.stack([wy * z - wz * y, wz * x - hx * z, hx * y - wy * x, *turned])

    def run(numbers: Any, tolerance: Any) -> Any:
        controller = dfx.PIDController(rtol=tolerance, atol=tolerance)
        term, solver, end = dfx.ODETerm(rates), dfx.Dopri8(), float(SPAN)

        def one(row: Any) -> Any:
            found = dfx.diffeqsolve(
                term, solver, 0.0, end, 0.1, row[:6], row[6:], stepsize_controller=controller, max_steps=None,
                throw=False, adjoint=dfx.ForwardMode(),
            )  # fmt: skip
            return found.ys[0, :3]

        return jax.vmap(one)(numbers)

    numbers = jnp.asarray(numbers_of(rows))
    compiled = jax.jit(run).lower(numbers, 1e-12).compile()

    def work(tolerance: float) -> tuple[float, Any]:
        return timed(lambda: np.array(compiled(numbers, tolerance)) * rows.length[:, :1])

    return [
        Peer(f"diffrax vmap, Dopri8, tolerance {one:g}", "none", lambda one=one: work(one))
        for one in TOLERANCES
    ]


def ensemble(rows: Rows, loop: ScalarLoop) -> None:
    """Solve rows by heyoka's ensemble, on one thread."""

    def begin(ta: Any, i: int) -> Any:
        n = rows.n[i, :, 0]
        ta.time, ta.state[:] = 0.0, [*n, *np.cross(n, rows.V[i, :, 0])]
        ta.pars[:] = [*rows.turn[i, 1:, 0], *rows.pull[i, 1:, 0]]
        return ta

    hy.ensemble_propagate_until(loop.integrator, float(SPAN), len(rows), begin, max_workers=1)


def own(rows: Rows) -> list[Peer]:
    """Return octet, and heyoka in all its forms."""
    OCTET.prepare(RunOptions())
    silent, located, whole, bare = (
        ScalarLoop(False),
        ScalarLoop(True),
        RunOptions(),
        RunOptions(False, False),
    )
    for options in (bare, whole):
        HEYOKA.solve(rows[:8], options)

    def batch(engine: Any, options: RunOptions) -> tuple[float, Any]:
        seconds, run = timed(lambda: engine.solve(rows, options))
        return seconds, run.state[:, :3]

    return [
        Peer("octet, all wanted", "all located", lambda: batch(OCTET, whole)),
        Peer("the engine heyoka, all wanted", "all located", lambda: batch(HEYOKA, whole)),
        Peer("the engine heyoka, states alone", "none", lambda: batch(HEYOKA, bare)),
        Peer(
            "heyoka, scalar loop with events",
            "all located",
            lambda: timed(lambda: located.solve(rows)),
        ),
        Peer("heyoka, scalar loop", "none", lambda: timed(lambda: silent.solve(rows))),
        Peer("heyoka, ensemble, one thread", "none", lambda: timed(lambda: ensemble(rows, silent))),
    ]


def main(count: int = 181) -> None:
    """Print the table, and the load of the machine over it."""
    rows, exact, loads = many_rows(count), truth(count), [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as folder:
        peers = [*own(rows), *boost(rows, folder), *numbalsoda(rows), *diffrax(rows)]
        rounds = []
        for _ in range(ROUNDS):
            rounds.append([peer.work() for peer in peers])
            loads.append(os.getloadavg()[0])
    print(
        "| | ms a row | error at the end, m | transits | octet's speed over it |\n| --- | --- | --- | --- | --- |"
    )
    for i, peer in enumerate(peers):
        seconds = statistics.median(one[i][0] for one in rounds)
        ratios = sorted(one[i][0] / one[0][0] for one in rounds)
        ends = rounds[0][i][1]
        error = "" if ends is None else f"{np.linalg.norm(ends - exact, axis=1).max():.1e}"
        spread = f"{statistics.median(ratios):.1f} ({ratios[0]:.1f} to {ratios[-1]:.1f})"
        print(
            f"| {peer.name} | {seconds / count * 1e3:.2f} | {error} | {peer.transits} | {spread} |"
        )
    print(f"\n{ROUNDS} rounds, load {min(loads):.1f} to {max(loads):.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
