"""The standard rows by others, as a table in Markdown: time a row, error at the end, what transits are located.

    python tests/bench/peers.py [FOLDER OF BOOST'S HEADERS] [ROWS]

Rows are those of `octet.py`; errors are against limbs at 110 bits. Compiling is not counted. Boost needs g++ and its
headers, such as those of the package libboost-headers.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import heyoka as hy
import numpy as np
from octet import SPAN, ScalarLoop, cpu_s, many_rows

from reference.engines.batch import Rows, Wanted
from reference.engines.heyoka.batch import BATCH as HEYOKA
from reference.engines.octet.batch import BATCH as OCTET
from reference.engines.registry import engines
from reference.scene import load_scene

REPEATS = 3


def best(work: Callable[[], object]) -> float:
    """Return the least CPU seconds of a few calls."""
    return min(cpu_s(work) for _ in range(REPEATS))


def truth(count: int) -> Any:
    """Return the positions at the end over l in limbs, shape (rows, 3)."""
    limbs, paris = engines()["limbs"], load_scene("paris").exact
    found = []
    for i in range(count):
        inputs = replace(paris, t_end=Fraction(SPAN), latitude=Fraction(-90) + Fraction(180 * i, count - 1))
        run = limbs.run(limbs.plan(inputs, 110, (Fraction(0), Fraction(SPAN)), False))
        found.append([float(run.grid[name][-1]) for name in ("x", "y", "z")])
    return np.array(found)


def boost(rows: Rows, headers: str, tolerance: float, folder: str) -> tuple[float, Any]:
    """Return the CPU seconds of Boost's program and the positions at the end over l."""
    program = Path(folder) / "peers"
    if not program.exists():
        source = Path(__file__).with_suffix(".cpp")
        subprocess.run(["g++", "-O3", "-march=native", "-I", headers, source, "-o", program], check=True)
    n, inertial = rows.n[..., 0], rows.V[..., 0]
    numbers = np.hstack([n, np.cross(n, inertial), rows.turn[:, 1:, 0], rows.pull[:, 1:, 0]])
    text = "\n".join([f"{tolerance} {SPAN}", *(" ".join(map(repr, row)) for row in numbers.tolist())])
    keywords: dict[str, Any] = {"input": text, "capture_output": True, "text": True}
    lines = [subprocess.run([program], check=True, **keywords).stdout.splitlines() for _ in range(REPEATS)]
    return min(float(one[0]) for one in lines), np.array([line.split() for line in lines[0][1:]], dtype=float)


def ensemble(rows: Rows, loop: ScalarLoop) -> None:
    """Solve rows by heyoka's ensemble, on one thread."""

    def begin(ta: Any, i: int) -> Any:
        n = rows.n[i, :, 0]
        ta.time, ta.state[:] = 0.0, [*n, *np.cross(n, rows.V[i, :, 0])]
        ta.pars[:] = [*rows.turn[i, 1:, 0], *rows.pull[i, 1:, 0]]
        return ta

    hy.ensemble_propagate_until(loop.integrator, float(SPAN), len(rows), begin, max_workers=1)


def main(headers: str = "", count: int = 181) -> None:
    """Print the table."""
    rows, exact = many_rows(count), truth(count)
    OCTET.prepare(Wanted(), False)
    silent, located, whole = ScalarLoop(False), ScalarLoop(True), Wanted()
    for wanted in (Wanted(False, False), whole):
        HEYOKA.solve(rows[:8], wanted)
    print("| | ms a row | error at the end, m | transits | octet's speed over it |\n| --- | --- | --- | --- | --- |")
    own = best(lambda: OCTET.solve(rows, whole))

    def line(name: str, seconds: float, transits: str, states: Any = None) -> None:
        error = "" if states is None else f"{np.linalg.norm(states - exact, axis=1).max():.1e}"
        print(f"| {name} | {seconds / count * 1e3:.2f} | {error} | {transits} | {seconds / own:.1f} |", flush=True)

    line("octet, all wanted", own, "all located", OCTET.solve(rows, whole).state[:, :3])
    batch = best(lambda: HEYOKA.solve(rows, whole))
    line("heyoka, batch of 8, all wanted", batch, "all located", HEYOKA.solve(rows, whole).state[:, :3])
    line("heyoka, batch of 8", best(lambda: HEYOKA.solve(rows, Wanted(False, False))), "none")
    line("heyoka, scalar loop with events", best(lambda: located.solve(rows)), "all located")
    line("heyoka, scalar loop", best(lambda: silent.solve(rows)), "none")
    line("heyoka, ensemble, one thread", best(lambda: ensemble(rows, silent)), "none")
    if headers:
        with tempfile.TemporaryDirectory() as folder:
            for tolerance in (1e-11, 1e-12, 1e-13):
                seconds, states = boost(rows, headers, tolerance, folder)
                line(f"Boost odeint, RKF78, tolerance {tolerance:g}", seconds, "none", states * rows.length[:, :1])


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:]))
