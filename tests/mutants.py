"""Change one place of the source at a time, in a copy of the project, and see whether the tests of that file notice.

    python tests/mutants.py --count 60 --seed 1                  # as many from each file of `TESTS` as far as possible
    python tests/mutants.py --module checks/tables --count 20    # from the files whose path contains that

The changes are those of `helpers/mutations.py`. The tests run without any change first. What ends a run in an error, or
takes five times as long, was noticed. Mutants that no test could tell from the source are left out:
`equivalent_mutants.toml` names them, each with a reason.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent / "helpers"))

from mutations import Mutation, drawn, equivalents, mutations_of, stale

ROOT = Path(__file__).parent.parent
WORKERS = 2
# what the tests of a mutant may take: some CPU seconds, and times what they take without it
SPARE_S, LONGER = 30, 5
DATASET, SCORE, SOLVER = (
    "tests/reference/dataset/test_",
    "tests/compare/score/test_",
    "tests/reference/solver/test_",
)
LIMITS, FILES, BITS = (
    f"{DATASET}limits.py",
    f"{DATASET}write_and_read.py",
    "tests/test_architecture.py",
)
NUMBERS, FUNCTION = "tests/reference/numbers/test_", f"{DATASET}function.py"
VERIFY, INDEX = f"{DATASET}verify.py", f"{DATASET}index.py"
SUITE = "tests/compare/report/test_suite.py"
TIGHT, NAMING = f"{DATASET}tight_checks.py", "tests/compare/candidates/test_naming.py"
PASSAGES = "tests/reference/engines/test_passages.py"
ENCLOSURE = "tests/reference/enclosure/test_"
FORMULAS = f"{ENCLOSURE}primitives.py {ENCLOSURE}identities.py {ENCLOSURE}formulas.py"
RUNS = f"{ENCLOSURE}enclosed_runs.py {SOLVER}pushed_releases.py"
# of that very module
HOLDS = f"{ENCLOSURE}mutations.py::test_the_module_as_it_is_passes_every_check"
TESTS = {  # files by folder, and what tests them, the quick ones first
    "reference/enclosure/trusted: sections": f"{HOLDS}[sections]",
    "reference/enclosure/trusted: box": f"{HOLDS}[box]",
    "reference/enclosure/trusted: derivatives": f"{HOLDS}[derivatives] {ENCLOSURE}derivatives.py",
    "reference/enclosure/trusted: balls system defect radius tube six_columns": f"{FORMULAS} {RUNS}",
    "reference/enclosure/trusted: zeros": f"{ENCLOSURE}made_up.py {ENCLOSURE}enclosed_transits.py",
    "reference/enclosure/trusted: function": f"{ENCLOSURE}function.py",
    "reference/enclosure/trusted: printed": f"{ENCLOSURE}printed.py",
    "reference/enclosure/trusted: printed_box": f"{ENCLOSURE}printed.py {DATASET}ranges_files.py",
    "reference/dataset/checks: physics": f"{TIGHT} {VERIFY}",
    "reference/dataset/checks: scene_check": f"{LIMITS} {TIGHT} {BITS} {VERIFY} {SOLVER}confirming.py {FUNCTION}",
    "reference/dataset/checks: motion": f"{BITS} {TIGHT} {VERIFY} {FUNCTION} {DATASET}possible.py {SOLVER}sections.py",
    "reference/dataset: verify files golden place render manifest": f"{LIMITS} {FILES} {INDEX} {VERIFY} {FUNCTION}",
    "reference/dataset: sheets write": f"{FILES} {VERIFY}",
    "compare/score: transit_matching": f"{SCORE}transit_errors.py {SCORE}verdict.py {SCORE}judge.py",
    "compare/score: errors": f"{SCORE}errors.py",
    "compare/score: verdict judge": f"{SCORE}verdict.py {SCORE}judge.py {SCORE}input_floor.py {NAMING} {SUITE}",
    "compare/score: remarks time_span": f"{SCORE}judge.py {NAMING}",
    "compare/score: document input_floor": f"{SCORE}verdict.py {SCORE}judge.py {SCORE}input_floor.py",
    "compare/diagnosis: document since": f"{SCORE}verdict.py {SCORE}baseline.py",
    "reference/numbers: precision": f"{NUMBERS}precision.py {NUMBERS}table.py {BITS}",
    "reference/engines: passages": f"{PASSAGES} {SOLVER}sections.py",
    "reference/solver: solution": f"{SOLVER}solution.py {FILES} {SOLVER}solve.py",
    "reference/solver: agreement": f"{SOLVER}agreement.py {SOLVER}solution.py {SOLVER}sections.py {SOLVER}solve.py",
    "reference/solver: solve": f"{BITS} {SOLVER}solve.py {SOLVER}pilot.py",
}
SLOW = "ships few_digits killed two_processes script same_command ten_times picture collinear 1000000 recomputing "
SLOW += "large_angles loses_every thirty_digits effective_gravity every_transit"


class Mutant(NamedTuple):
    mutation: Mutation
    tests: str


def tested_files() -> dict[str, str]:
    """Return the files of `TESTS`, each with its tests."""
    found = {}
    for files, tests in TESTS.items():
        folder, _, names = files.partition(": ")
        found |= {f"{folder}/{name}.py": tests for name in names.split()}
    return found


def chosen_mutants(count: int, seed: int, module: str) -> tuple[list[Mutant], int]:
    """Draw mutants, as many from each file as far as possible; return also how many equivalents were left out."""
    ranked = list[tuple[int, Mutant]]()
    left_out = 0
    for file, tests in tested_files().items():
        if module not in file:
            continue
        every = mutations_of(file)
        telling = [mutation for mutation in every if str(mutation) not in equivalents()]
        left_out += len(every) - len(telling)
        ranked += [
            (rank, Mutant(mutation, tests)) for rank, mutation in enumerate(drawn(telling, seed))
        ]
    ranked.sort(key=lambda pair: pair[0])
    return [mutant for _, mutant in ranked[:count]], left_out


def status_of(tests: str, folder: Path, most: int, output: int | None = subprocess.DEVNULL) -> int:
    """Return the exit status of tests in a copy of the project, ended after `most` CPU s or ten times that of wall."""
    limits = [
        "timeout",
        "--signal=KILL",
        str(10 * most),
        "sh",
        "-c",
        f'ulimit -t {most}; exec "$@"',
        "sh",
    ]
    words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-k"]
    words += [f"not ({SLOW.replace(' ', ' or ')})", *tests.split()]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    call = [*limits, *words]
    return subprocess.run(call, cwd=folder, env=environment, stdout=output, check=False).returncode


def cpu_of(tests: str, folder: Path) -> int:
    """Return the CPU seconds of tests without a change, which have to pass; their output is shown."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    if status := status_of(tests, folder, 3600, output=None):
        raise SystemExit(f"{tests}: exit status {status} without any change")
    return int(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before) + 1


def outcome(folder: Path, mutant: Mutant, most: int) -> str:
    """Return killed, survived or timeout for a mutant in a copy of the project."""
    file = folder / mutant.mutation.file
    good = file.read_bytes()
    file.write_text(mutant.mutation.source())
    status = status_of(mutant.tests, folder, most)
    file.write_bytes(good)
    return "survived" if status == 0 else "killed" if 0 < status < 128 else "timeout"


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--count", type=int, default=60)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--module", default="", help="part of the paths to choose")
    chosen = options.parse_args()
    if problems := stale():
        raise SystemExit("\n".join(problems))
    every, left_out = chosen_mutants(chosen.count, chosen.seed, chosen.module)
    copies, found = Queue[Path](), Counter[tuple[str, str]]()

    def run(mutant: Mutant) -> str:
        folder = copies.get()
        try:
            what = outcome(folder, mutant, LONGER * cpu_s[mutant.tests] + SPARE_S)
        finally:
            copies.put(folder)
        if what != "killed":
            print(f"{what:9} {mutant.mutation}", flush=True)
        return what

    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(WORKERS) as pool:
        for i in range(WORKERS):
            copies.put(
                Path(shutil.copytree(ROOT, f"{place}/{i}", ignore=shutil.ignore_patterns(".*")))
            )
        cpu_s = {
            tests: cpu_of(tests, Path(place, "0"))
            for tests in dict.fromkeys(mutant.tests for mutant in every)
        }
        for mutant, what in zip(every, pool.map(run, every), strict=True):
            found[mutant.mutation.file, what] += 1
    for file in sorted({file for file, _ in found}):
        print(
            f"{file:45}",
            *(f"{found[file, what]:3} {what}" for what in ("killed", "timeout", "survived")),
        )
    survived = sum(found[file, what] for file, what in found if what == "survived")
    print(
        f"{len(every)} mutants, {survived} survived; {left_out} equivalents left out of the population"
    )


if __name__ == "__main__":
    main()
