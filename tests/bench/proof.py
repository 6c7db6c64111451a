"""What proofs and many digits cost beside heyoka's unproven run; how long a short command takes. Ratios, load stated.

    python tests/bench/proof.py [--t-end 86400] [--pairs 5] [--only proof limbs pilot latency]

Each pair is measured in turn, so that both sides meet the same load; the median of the ratios counts.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from statistics import median

import reference
from reference.engines.plan import Plan
from reference.engines.registry import engines, run
from reference.numbers.precision import real
from reference.solver.pilot import run_pilot

DIGITS = (32, 45, 60)  # of a day that limbs and heyoka compute
SHORT = ("--t-end", "60", "--digits", "10")  # the command whose latency counts


def cpu_s() -> float:
    """Return the CPU seconds so far, of this process and of its children that have ended."""
    return sum(os.times()[:4])


def load() -> str:
    """Return how busy the machine is."""
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def proved(t_end: str, engine: str = "auto") -> tuple[float, float, reference.Solution]:
    """Return the CPU and wall seconds of a proof, all in all and of all processes, and the solution."""
    cpu, wall = cpu_s(), time.perf_counter()
    solution = reference.solve(
        reference.load_scene("paris"), level="enclosed", t_end=t_end, engine=engine
    )
    return cpu_s() - cpu, time.perf_counter() - wall, solution


def proof(t_end: str, pairs: int) -> None:
    """Print a proof's CPU seconds over those of heyoka's unproven run at the same bits, with all transits."""
    proved("60")  # compiles
    _, _, solution = proved(t_end)
    scene, bits = solution.scene, solution.proof.enclosure.bits
    plan = Plan(scene.exact, "momentum", real(bits), solution.times, ("xdot",))
    run(Plan(scene.exact, "momentum", real(bits), solution.times[:2], ("xdot",)))  # compiles
    print(
        f"paris, {t_end} s, {bits} bits, {len(solution.directions)} transits, {solution.proof.enclosure.steps} steps"
    )
    ratios = []
    for _ in range(pairs):
        cpu, _, solution = proved(t_end)
        plain = run(plan).cpu_s
        ratios.append(cpu / plain)
        own = f"{solution.proof.enclosure.cpu_s:.2f} without the approximant"
        print(
            f"  proof {cpu:.2f} s ({own}), unproven {plain:.2f} s: {cpu / plain:.2f}; {load()}",
            flush=True,
        )
    print(f"enclosed over unproven: median of {pairs}: {median(ratios):.2f}")
    cpu, wall, _ = proved(t_end, "heyoka")
    print(
        f"heyoka's approximant, in a process of its own: wall {wall / cpu:.2f} of the CPU time; {load()}"
    )


def limbs(t_end: str, pairs: int) -> None:
    """Print the CPU seconds of limbs over those of heyoka at the same bits, with all transits."""
    scene = reference.load_scene("paris").with_values([f"run.t_end={t_end}"])
    times = tuple(scene.exact.grid)
    pilot = run_pilot(scene.exact, times)
    for digits in DIGITS:
        prec = pilot.bits_for(digits, times[-1], checked=False)
        ours, theirs = (
            engines()[name].plan(scene.exact, prec, times, ("xdot",))
            for name in ("limbs", "heyoka")
        )
        run(ours), run(theirs)  # compile
        ratios = [run(theirs).cpu_s / run(ours).cpu_s for _ in range(pairs)]
        print(
            f"limbs, {digits} digits, {prec} bits: heyoka takes {median(ratios):.0f} times as long; {load()}"
        )


def pilot(t_end: str, pairs: int) -> None:
    """Print the share of the pilot runs in a computed run of 32 digits."""
    scene, shares = reference.load_scene("paris"), []
    for _ in range(pairs + 1):
        solution = reference.solve(scene, t_end=t_end, digits=DIGITS[0], level="computed")
        shares.append(solution.pilot_s / (solution.pilot_s + solution.run.cpu_s))
    print(
        f"the pilot's share of a computed run of {DIGITS[0]} digits: {median(shares[1:]):.2f}; {load()}"
    )


def latency(t_end: str, pairs: int) -> None:
    """Print the CPU and wall seconds of a warm `generate` of a minute at 10 digits, and of the imports alone."""
    with tempfile.TemporaryDirectory() as folder:
        # as on a user's machine: Python keeps what it compiles
        kept = {
            name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
        }
        kept |= {"PYTHONPYCACHEPREFIX": folder}
        commands = {
            "imports": ["-c", "import reference"],
            "generate": [
                "-m",
                "foucault",
                "generate",
                "paris",
                *SHORT,
                "--out",
                str(Path(folder) / "paris"),
            ],
        }
        for name, words in commands.items():
            seconds = []
            for _ in range(pairs + 1):
                cpu, wall = cpu_s(), time.perf_counter()
                subprocess.run([sys.executable, *words], check=True, capture_output=True, env=kept)
                seconds.append((cpu_s() - cpu, time.perf_counter() - wall))
            cpu, wall = (median(part) for part in zip(*seconds[1:], strict=True))
            print(f"{name}: CPU {cpu:.2f} s, wall {wall:.2f} s; {load()}", flush=True)


PARTS: dict[str, Callable[[str, int], None]] = {
    "latency": latency,
    "pilot": pilot,
    "limbs": limbs,
    "proof": proof,
}


def main() -> None:
    """Print each part, or those that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--t-end", default="86400")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    options = parser.parse_args()
    if Fraction(options.t_end) <= 0 or options.pairs < 1:
        parser.error("a time and a number of pairs above zero are needed")
    for part in options.only:
        PARTS[part](options.t_end, options.pairs)


if __name__ == "__main__":
    main()
