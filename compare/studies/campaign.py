"""A campaign: many measurements in child processes; each result is stored at once, so that it can be resumed.

None pays for another's memory or threads, and a hang (killed after a patience) or a crash loses
only its own item. Cost is that of one core: every library gets one thread. The machine and its load
are part of what is recorded.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import TypeAdapter

from reference import IntegrationError
from reference.errors import usable
from reference.plain_text import finite
from reference.status import Status
from reference.system import cache
from reference.system.checksums import is_sound, sealed_line
from reference.system.documents import json_lines
from reference.system.workers import Emit, Worker

from ..methods import METHODS, library
from .row import grouped

# changes when equal runs are measured or judged otherwise, so that old results are not used again
JUDGED = 3
# wall-clock time for imports and compilation, also on a busy machine, on top of the first patience
_STARTING_S = 180.0
# that are always there, besides those that methods require
_LIBRARIES = {"heyoka", "mpmath", "numpy", "python-flint"}
_DISTRIBUTIONS = {"sksundae": "scikit-sundae"}  # of modules that are called otherwise
_ONE_THREAD = {
    **dict.fromkeys(
        ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
    ),
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
}

Item = TypeVar("Item", bound=tuple[Any, ...])
Result = TypeVar("Result", bound=Any)  # a dataclass with a status
Counted = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Reports:
    """Callbacks of a study.

    Attributes:
        solving: called while the truth is solved for, with what is solved (scenes, or days of one)
            and all of it.
        measuring: called with the number of finished measurements, of all of them, and what runs
            now.
    """

    solving: Callable[[float, float], None] | None = None
    measuring: Counted | None = None


UNREPORTED = Reports()


@dataclass(frozen=True)
class Measurement(ABC, Generic[Item, Result]):
    """The measurement that a campaign repeats; it is sent to the child processes by pickle.

    Attributes:
        recipe: what else than the items decides the results, to be written as JSON; together with
            machine and versions of libraries it must be equal for a stored result to be used again.
        patience_s: wall-clock seconds for one item, on a machine with a core for it; then its
            process is killed.
        commands: of the user's programs, by the words that their items begin with; the command too
            must be equal.
        kind: class of the results.
    """

    recipe: Any
    patience_s: float
    commands: Mapping[str, str]
    kind: ClassVar[type[Any]]

    @abstractmethod
    def measure(self, item: Item) -> Result:
        """Return the result of an item, in a child process."""

    @abstractmethod
    def failed(self, item: Item, status: Status, reason: str) -> Result:
        """Return the result of an item that was lost, from the status OUT_OF_TIME or CRASHED and the reason."""


def campaign(
    measurement: Measurement[Item, Result],
    items: Sequence[Item],
    *,
    journal_path: Path | None = None,
    report: Counted | None = None,
) -> list[Result]:
    """Measure items and return their results in order; those in the journal are not measured again.

    Items that differ in nothing but their last part share a process, one after the other.

    Args:
        measurement: of each item.
        items: tuples of words and numbers, the first of which is shown as what runs now.
        journal_path: a file of JSON lines to which results are appended; None if nothing is to be
            stored.
        report: called before each measurement with the number of finished items, of all items, and
            what runs now.

    Raises:
        InputError: the journal cannot be written.
    """
    common = [JUDGED, measurement.recipe, machine()]
    marks = {item: _mark([*common, measurement.commands.get(item[0])]) for item in items}
    stored = dict(_stored(journal_path, measurement.kind))
    results = {item: stored[mark, item] for item, mark in marks.items() if (mark, item) in stored}
    groups = grouped((item for item in items if item not in results), lambda item: item[:-1])
    cache.check()
    for group in groups.values():
        with closing(_isolated(measurement, group)) as answers:
            for item in group:
                if report is not None:
                    report(len(results), len(items), str(item[0]))
                results[item] = next(answers)
                _store(
                    journal_path,
                    {"recipe": marks[item], "item": item, "result": asdict(results[item])},
                )
    return [results[item] for item in items]


def measured(emit: Emit, measurement: Measurement[Item, Result], items: Sequence[Item]) -> None:
    """Measure items one after the other, in a child process, and send each result."""
    library.isolated = True
    for item in items:
        emit(measurement.measure(item))


def _mark(recipe: Any) -> str:
    return hashlib.sha256(json.dumps(recipe, sort_keys=True).encode()).hexdigest()[:16]


def _stored(
    path: Path | None, kind: type[Any]
) -> Iterator[tuple[tuple[str, tuple[Any, ...]], Any]]:
    """Yield marks with items, and results, in order.

    A line that is no result of this kind, or damaged, is skipped.
    """
    if path is None or not path.exists():
        return
    types = TypeAdapter(kind)
    for record in filter(is_sound, json_lines(path, "--out")):
        with suppress(KeyError, TypeError, ValueError):
            key = record["recipe"], tuple(record["item"])
            hash(key)
            yield key, types.validate_python(record["result"])


def _store(path: Path | None, record: dict[str, Any]) -> None:
    if path is None:
        return
    with usable("--out", path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("ab+") as stream:
            end = stream.seek(0, os.SEEK_END)
            stream.seek(max(0, end - 1))
            # the line before was cut short
            separator = b"" if stream.read(1) in (b"", b"\n") else b"\n"
            line = json.dumps(sealed_line(finite(record)), allow_nan=False)
            stream.write(separator + line.encode() + b"\n")


def _isolated(
    measurement: Measurement[Item, Result], items: Sequence[Item]
) -> Generator[Result, None, None]:
    """Yield the result of each item.

    After a hang or a crash a new process goes on with the next one.
    """
    remaining = list(items)
    while remaining:
        env = {
            name: value
            for name, value in _ONE_THREAD.items()
            if name != "XLA_FLAGS" or not os.environ.get(name)
        }
        worker = Worker(measured, measurement, remaining, env=env)
        starting_s = _STARTING_S
        patience_s = measurement.patience_s
        try:
            while remaining:
                # where processes share a core, all take longer
                patience_s = measurement.patience_s * max(1.0, load_per_core() or 1.0)
                result = worker.receive(patience_s + starting_s)
                starting_s = 0.0
                yield result
                remaining.pop(0)
        except TimeoutError:
            yield measurement.failed(
                remaining.pop(0), Status.OUT_OF_TIME, f"no answer within {patience_s:.3g} s"
            )
        except IntegrationError as error:
            yield measurement.failed(
                remaining.pop(0), Status.CRASHED, f"its process ended: {error}"
            )
        finally:
            worker.kill()
            worker.stop()


def machine() -> dict[str, str]:
    """Return processor, system, Python, and the versions of the libraries that are measured."""
    description = {"processor": _processor(), "system": f"{platform.system()} {platform.machine()}"}
    description["python"] = platform.python_version()
    required = {module for method in METHODS.values() for module in method.requires}
    for name in sorted(_LIBRARIES | {_DISTRIBUTIONS.get(module, module) for module in required}):
        try:
            description[name] = version(name)
        except PackageNotFoundError:
            description[name] = "not installed"
    for native in {
        method.native.name: method.native for method in METHODS.values() if method.native
    }.values():
        description[native.name] = native.version or "not installed"
    return description


def load_per_core() -> float | None:
    """Return the mean number of runnable processes in the last minute, divided by the number of cores.

    None where the system does not tell.

    One process that has a core for itself is 1 over the number of cores.
    """
    try:
        return os.getloadavg()[0] / (os.cpu_count() or 1)
    except (AttributeError, OSError):
        return None


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    return next(
        (line.partition(":")[2].strip() for line in lines if line.startswith("model name")),
        "unknown",
    )
