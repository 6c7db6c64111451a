"""What a proof costs: CPU seconds of `enclosed` over those of heyoka's unproven run at the same bits, all transits.

    python tests/bench/proof.py [--t-end 86400] [--pairs 5]

Each pair is measured in turn, so that both sides meet the same load; the median of the ratios counts.
"""

from __future__ import annotations

import argparse
import os
from statistics import median

import reference
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.precision import real


def proved(t_end: str) -> tuple[float, reference.Solution]:
    """Return the CPU seconds of a proof, all in all and of all processes, and the solution."""
    before = sum(os.times()[:4])
    solution = reference.solve(reference.load_scene("paris"), level="enclosed", t_end=t_end)
    return sum(os.times()[:4]) - before, solution


def main() -> None:
    """Print the ratio of each pair, and the medians."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--t-end", default="86400")
    parser.add_argument("--pairs", type=int, default=5)
    options = parser.parse_args()
    proved("60")  # compiles
    _, solution = proved(options.t_end)
    scene, bits = solution.scene, solution.proof.prec
    plan = Plan(scene.exact, "momentum", real(bits), solution.times, transits=True)
    run(Plan(scene.exact, "momentum", real(bits), solution.times[:2], transits=True))  # compiles
    print(f"paris, {options.t_end} s, {bits} bits, {len(solution.directions)} transits, {solution.proof.steps} steps")
    rows = []
    for _ in range(options.pairs):
        cpu, solution = proved(options.t_end)
        plain = run(plan).cpu_s
        rows.append((cpu / plain, cpu, plain))
        load = os.getloadavg()[0]
        parts = ", ".join(f"{part} {spent:.2f}" for part, spent in solution.proof.cpu_s.items())
        print(f"proof {cpu:.2f} s ({parts}), unproven {plain:.2f} s: {cpu / plain:.2f}; load {load:.1f}", flush=True)
    print(f"median of {len(rows)}: {median(ratio for ratio, *_ in rows):.2f}")


if __name__ == "__main__":
    main()
