"""Change one place of the source at a time, in a copy of the project, and see whether the tests of that file notice.

    python tests/mutants.py --count 60 --seed 1                  # as many from each file of `TESTS` as far as possible
    python tests/mutants.py --module checks/tables --count 20    # from the files whose path contains that

The tests run without any change first. What ends a run in an error, or takes five times as long, was noticed. Mutants
that no test could tell from the source are left out: `equivalent_mutants.toml` names them, each with a reason.
"""

from __future__ import annotations

import argparse
import ast
import copy
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from queue import Queue
from typing import Any, NamedTuple

ROOT, WORKERS = Path(__file__).parent.parent, 2
EQUIVALENTS = Path(__file__).parent / "equivalent_mutants.toml"
SPARE_S, LONGER = 30, 5  # what the tests of a mutant may take: some CPU seconds, and times what they take without it
DATASET, SCORE, SOLVER = "tests/reference/dataset/test_", "tests/compare/score/test_", "tests/reference/solver/test_"
LIMITS, FILES, BITS = f"{DATASET}limits.py", f"{DATASET}write_and_read.py", "tests/test_architecture.py"
NUMBERS, FUNCTION = "tests/reference/numbers/test_", f"{DATASET}function.py"
VERIFY, INDEX = f"{DATASET}verify.py", f"{DATASET}index.py"
TIGHT, NAMING = f"{DATASET}tight_checks.py", "tests/compare/candidates/test_naming.py"
PASSAGES = "tests/reference/engines/test_passages.py"
TESTS = {  # files by folder, and what tests them, the quick ones first
    "reference/dataset/checks: physics": f"{TIGHT} {VERIFY}",
    "reference/dataset/checks: scene_check": f"{LIMITS} {TIGHT} {BITS} {VERIFY} {SOLVER}confirming.py {FUNCTION}",
    "reference/dataset/checks: motion": f"{BITS} {TIGHT} {VERIFY} {FUNCTION} {SOLVER}sections.py",
    "reference/dataset: verify files golden place render manifest": f"{LIMITS} {FILES} {INDEX} {VERIFY} {FUNCTION}",
    "reference/dataset: sheets write": f"{FILES} {VERIFY}",
    "compare/score: transit_matching": f"{SCORE}transit_errors.py {SCORE}verdict.py {SCORE}judge.py",
    "compare/score: errors": f"{SCORE}errors.py",
    "compare/score: verdict judge": f"{SCORE}verdict.py {SCORE}judge.py {SCORE}input_floor.py {NAMING}",
    "compare/score: document input_floor": f"{SCORE}verdict.py {SCORE}judge.py {SCORE}input_floor.py",
    "compare/score: since": f"{SCORE}verdict.py {SCORE}baseline.py",
    "reference/numbers: precision": f"{NUMBERS}precision.py {NUMBERS}table.py {BITS}",
    "reference/engines: passages": f"{PASSAGES} {SOLVER}sections.py",
    "reference/solver: solution": f"{SOLVER}solution.py {FILES} {SOLVER}solve.py",
    "reference/solver: agreement": f"{SOLVER}agreement.py {SOLVER}sections.py {SOLVER}solve.py",
    "reference/solver: solve": f"{BITS} {SOLVER}solve.py {SOLVER}pilot.py",
}
SLOW = "ships few_digits killed two_processes script same_command ten_times picture collinear 1000000 recomputing "
SLOW += "large_angles loses_every thirty_digits effective_gravity every_transit"
SWAPPED: dict[type, type] = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq}
SWAPPED |= {ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In}
SWAPPED |= {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.And: ast.Or, ast.Or: ast.And}


class Mutant(NamedTuple):
    file: str
    number: int
    line: str
    change: str  # before -> after
    index: int  # among those of its file
    tests: str

    def __str__(self) -> str:
        return f"{self.file}:{self.number}: {self.line}   [{self.change}]"

    @property
    def key(self) -> tuple[str, str, str]:
        """What an entry of the table of equivalents names; the number of a line may change."""
        return self.file, self.line, self.change

    @property
    def source(self) -> str:
        """The whole file with the change, written out when asked for: that takes far longer than the change."""
        tree = ast.parse((ROOT / self.file).read_text())
        next(islice(changes(tree), self.index, None))
        return ast.unparse(tree)


def others(node: Any) -> Iterator[Any]:
    """Yield what may stand in a node's place."""
    match node:
        case ast.Compare():
            for i, one in enumerate(node.ops):
                yield _with(node, ops=[*node.ops[:i], SWAPPED[type(one)](), *node.ops[i + 1 :]])
        case ast.BinOp() | ast.BoolOp() | ast.AugAssign() if type(node.op) in SWAPPED:
            yield _with(node, op=SWAPPED[type(node.op)]())
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            yield from (ast.Constant(node.value * factor or factor) for factor in (2, 100))
        case ast.UnaryOp(op=ast.Not()):
            yield node.operand
        case ast.If() | ast.IfExp() if not isinstance(node.test, ast.UnaryOp):
            yield _with(node, test=ast.UnaryOp(ast.Not(), node.test))
        case ast.Return() | ast.Expr(value=ast.Yield() | ast.YieldFrom()):
            yield ast.Pass()
        case ast.Call(func=ast.Name(id="min" | "max" as name)):
            yield _with(node, func=ast.Name("max" if name == "min" else "min"))


def _with(node: Any, **fields: Any) -> Any:
    changed = copy.copy(node)
    vars(changed).update(fields)
    return changed


def places(node: Any) -> Iterator[tuple[Any, str, int | None]]:
    """Yield where another node may be put, as parent, field and index; not in annotations and texts for people."""
    spared = isinstance(node, ast.JoinedStr) or getattr(node, "name", "") in ("__repr__", "__str__")
    spared = spared or "TYPE_CHECKING" in ast.unparse(getattr(node, "test", ast.Pass()))
    for field, value in () if spared else ast.iter_fields(node):
        for i, child in enumerate(value if isinstance(value, list) else [value]):
            if isinstance(child, ast.AST) and field not in ("annotation", "returns"):
                yield node, field, i if isinstance(value, list) else None
                yield from places(child)


def changes(tree: ast.Module) -> Iterator[tuple[Any, Any]]:
    """Yield each node that may be changed and what stands in its place, which it does until the next is asked for."""
    for parent, field, i in places(tree):
        old = getattr(parent, field)
        node = old if i is None else old[i]
        for new in others(node):
            setattr(parent, field, new if i is None else [*old[:i], new, *old[i + 1 :]])
            yield node, new
            setattr(parent, field, old)


def mutants(file: str, tests: str) -> Iterator[Mutant]:
    """Yield every mutant of a file."""
    source = (ROOT / file).read_text()
    lines = source.splitlines()
    for index, (node, new) in enumerate(changes(ast.parse(source))):
        before, after = (ast.unparse(part).partition("\n")[0] for part in (node, new))
        yield Mutant(file, node.lineno, lines[node.lineno - 1].strip(), f"{before} -> {after}", index, tests)


def every_mutant() -> Iterator[list[Mutant]]:
    """Yield all mutants of each file of `TESTS`."""
    for files, tests in TESTS.items():
        folder, _, names = files.partition(": ")
        for name in names.split():
            yield list(mutants(f"{folder}/{name}.py", tests))


def equivalents() -> list[dict[str, str]]:
    """Return the entries of the table of equivalents."""
    return list(tomllib.loads(EQUIVALENTS.read_text())["mutant"])


def stale(entries: list[dict[str, str]], files: list[list[Mutant]]) -> Iterator[str]:
    """Yield what is wrong with the table: each entry has a reason, and is exactly one mutant of today's source."""
    found = Counter(mutant.key for every in files for mutant in every)
    for entry in entries:
        key = entry["file"], entry["line"], entry["change"]
        if found[key] != 1:
            yield f"{EQUIVALENTS.name}: {found[key]} mutants of today's source are {': '.join(key[:2])}   [{key[2]}]"
        if not entry["why"].strip():
            yield f"{EQUIVALENTS.name}: no reason for {': '.join(key[:2])}   [{key[2]}]"
        found[key] = min(found[key], 0)  # an entry that stands there twice


def drawn(count: int, seed: int, module: str) -> tuple[list[Mutant], int]:
    """Draw mutants, as many from each file as far as possible; return also how many equivalents were left out."""
    draw, found, left_out = random.Random(seed), [], 0
    entries, files = equivalents(), list(every_mutant())
    if problems := list(stale(entries, files)):
        raise SystemExit("\n".join(problems))
    known = {(entry["file"], entry["line"], entry["change"]) for entry in entries}
    for every in files:
        telling = [mutant for mutant in every if mutant.key not in known]
        draw.shuffle(telling)
        chosen = [(i, draw.random(), mutant) for i, mutant in enumerate(telling) if module in mutant.file]
        left_out += len(every) - len(telling) if chosen else 0
        found += chosen
    return [mutant for _, _, mutant in sorted(found)[:count]], left_out


def status_of(tests: str, folder: Path, most: int, output: int | None = subprocess.DEVNULL) -> int:
    """Return the exit status of tests in a copy of the project, ended after `most` CPU s or ten times that of wall."""
    limits = ["timeout", "--signal=KILL", str(10 * most), "sh", "-c", f'ulimit -t {most}; exec "$@"', "sh"]
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
    file = folder / mutant.file
    good = file.read_bytes()
    file.write_text(mutant.source)
    status = status_of(mutant.tests, folder, most)
    file.write_bytes(good)
    return "survived" if status == 0 else "killed" if 0 < status < 128 else "timeout"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--count", type=int, default=60)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--module", default="", help="part of the paths to choose")
    chosen = options.parse_args()
    every, left_out = drawn(chosen.count, chosen.seed, chosen.module)
    copies, found = Queue[Path](), Counter[tuple[str, str]]()

    def run(mutant: Mutant) -> str:
        folder = copies.get()
        try:
            what = outcome(folder, mutant, LONGER * cpu_s[mutant.tests] + SPARE_S)
        finally:
            copies.put(folder)
        if what != "killed":
            print(f"{what:9} {mutant}", flush=True)
        return what

    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(WORKERS) as pool:
        for i in range(WORKERS):
            copies.put(Path(shutil.copytree(ROOT, f"{place}/{i}", ignore=shutil.ignore_patterns(".*"))))
        cpu_s = {tests: cpu_of(tests, Path(place, "0")) for tests in dict.fromkeys(mutant.tests for mutant in every)}
        for mutant, what in zip(every, pool.map(run, every), strict=True):
            found[mutant.file, what] += 1
    for file in sorted({file for file, _ in found}):
        print(f"{file:45}", *(f"{found[file, what]:3} {what}" for what in ("killed", "timeout", "survived")))
    survived = sum(found[file, what] for file, what in found if what == "survived")
    print(f"{len(every)} mutants, {survived} survived; {left_out} equivalents left out of the population")


if __name__ == "__main__":
    main()
