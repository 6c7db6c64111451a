"""Error against run time: every method over its ladder of settings on one scene.

Methods run one after the other, each in a child process, so that none pays for another's memory or threads and one that
never returns can be killed. Each row is stored at once, so that an interrupted study resumes where it stopped.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from reference import Golden, Scene

from ..methods import METHODS
from ..rhs.swing import suited
from ..truth import golden_of
from .grid import on_doubles
from .isolated import isolated
from .journal import Journal
from .measure import ladder
from .row import Row

LIMIT_S = 8.0  # CPU seconds of one run; a longer one is extrapolated from a part of the span
PATIENCE = 12  # wall-clock limit of one run, in multiples of the CPU limit
FORMULATIONS = ("momentum", "space", "spin", "plane", "angles", "lagrangian")
FORMULATIONS_OF = "heyoka_double"  # the method in which they are compared
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "XLA_FLAGS")
LIBRARIES = (
    "heyoka", "numpy", "numba", "scipy", "numbalsoda", "scikit-sundae", "rebound", "diffrax", "mpmath", "python-flint",
)  # fmt: skip

Item = tuple[str, str, float]  # method, formulation, setting


@dataclass(frozen=True)
class Study:
    """A finished study.

    Attributes:
        scene: as the methods were given it, with inputs read as binary64.
        t_end: end of the span in s.
        limit_s: CPU seconds that one run may take.
        golden: the golden dataset that errors are measured against.
        rows: every method at every setting, failed ones included.
        machine: processor, system and versions of libraries.
    """

    scene: Scene
    t_end: float
    limit_s: float
    golden: Golden
    rows: list[Row] = field(repr=False)
    machine: dict[str, str]

    def document(self) -> dict[str, Any]:
        """Return the JSON document, whose keys are documented."""
        return {
            "scene": self.scene.id,
            "title": self.scene.title,
            "t_end": self.t_end,
            "limit_s": self.limit_s,
            "reference": {
                "level": self.golden.manifest.level,
                "bound_m": float(self.golden.manifest.bounds.position_m),
                "transits": int((self.golden.transits["t"] < self.t_end).sum()),
            },
            "machine": self.machine,
            "rows": [asdict(row) for row in self.rows],
        }


def plan(scene: Scene, methods: Sequence[str] | None = None, formulations: bool = True) -> list[Item]:
    """List the runs: each method over its settings in the formulation that suits it, and one method in all of them.

    Args:
        scene: steps are scaled to its swing, and a formulation must be able to describe its motion.
        methods: ids; all if None.
        formulations: whether to compare the formulations in one method as well.

    Raises:
        InputError: an unknown method.
    """
    items: list[Item] = []
    for name in methods or METHODS:
        method = METHODS[name]
        items += [(name, suited(scene, method.formulations), setting) for setting in method.settings(scene)]
    if formulations and (methods is None or FORMULATIONS_OF in methods):
        one = METHODS[FORMULATIONS_OF]
        words = [word for word in FORMULATIONS if word in one.formulations]
        items += [(FORMULATIONS_OF, word, setting) for word in words for setting in one.settings(scene)]
    return list(dict.fromkeys(items))


def study(
    scene: Scene,
    *,
    items: Sequence[Item] | None = None,
    limit_s: float = LIMIT_S,
    journal_path: Path | None = None,
    digits: int | None = None,
    report: Callable[[int, int, str], None] | None = None,
    announce: Callable[[str], None] | None = None,
) -> Study:
    """Measure methods on a scene.

    Args:
        scene: its inputs are read as binary64, because that is the problem which methods in double solve.
        items: the runs; see `plan`.
        limit_s: CPU seconds for one run.
        journal_path: a file to which rows are appended, and whose rows are not measured again.
        digits: of the truth if it has to be solved for; the scene's own if None.
        report: called with the number of finished rows, of all rows, and the method that runs now.
        announce: called with a message if the truth has to be solved for.
    """
    requested = list(items or plan(scene))
    problem = on_doubles(scene.with_values(["inputs=binary64"]))
    golden = golden_of(problem, digits or problem.run.digits, announce)
    journal = Journal(journal_path, _recipe(problem, limit_s))
    rows = {row.key: row for row in map(Row.parsed, journal)}
    for name, formulation, settings in _grouped([item for item in requested if item not in rows]):
        for row in _measured(problem, golden, limit_s, [(name, formulation, setting) for setting in settings]):
            if report is not None:
                report(len(rows), len(requested), name)
            rows[row.key] = row
            journal.add(asdict(row))
    ordered = [rows[item] for item in requested]
    return Study(problem, float(problem.exact.t_end), limit_s, golden, ordered, machine())


def _grouped(items: Sequence[Item]) -> Iterator[tuple[str, str, list[float]]]:
    groups: dict[tuple[str, str], list[float]] = {}
    for name, formulation, setting in items:
        groups.setdefault((name, formulation), []).append(setting)
    for (name, formulation), settings in groups.items():
        yield name, formulation, settings


def _measured(problem: Scene, golden: Golden, limit_s: float, items: list[Item]) -> Iterator[Row]:
    """Measure the rows of one method in child processes."""

    def failed(item: Item, timed_out: bool, reason: str) -> Row:
        name, formulation, setting = item
        status = "out_of_time" if timed_out else "gave_up"
        return Row(name, formulation, setting, METHODS[name].setting, problem.inputs, status, reason)

    scene = problem.model_dump(exclude_none=True)
    arguments = (scene, golden.path, float(problem.exact.t_end), limit_s)
    return isolated(ladder, arguments, items, PATIENCE * limit_s, failed)


def single_thread() -> None:
    """Limit every library of this process and its children to one thread, so that cost is the CPU time of one core."""
    for name in THREADS[:-1]:
        os.environ[name] = "1"
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")


def machine() -> dict[str, str]:
    """Return processor, system, Python, and the versions of the libraries that are measured."""
    description = {"processor": _processor(), "system": f"{platform.system()} {platform.machine()}"}
    description["python"] = platform.python_version()
    for name in LIBRARIES:
        try:
            description[name] = version(name)
        except PackageNotFoundError:
            description[name] = "not installed"
    return description


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")


def _recipe(problem: Scene, limit_s: float) -> str:
    """Return a hash of problem, limit, machine and versions, which must agree for rows to stand in one study."""
    document = problem.model_dump(mode="json", exclude={"title", "source", "flags"})
    text = json.dumps([document, limit_s, machine()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
