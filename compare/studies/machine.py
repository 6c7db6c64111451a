"""The machine that measures: its description, its load, and one thread for every library: cost is that of one core."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ..methods import METHODS

TRUTH_LIBRARIES = {"heyoka", "python-flint"}  # of the reference
ONE_THREAD = {
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"),
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
}


@contextmanager
def single_thread() -> Iterator[None]:
    """Have processes that are started meanwhile use one thread in every library; the user's own XLA_FLAGS stay."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update({name: value for name, value in ONE_THREAD.items() if name != "XLA_FLAGS" or not before[name]})
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def machine() -> dict[str, str]:
    """Return processor, system, Python, and the versions of the libraries that are measured."""
    description = {"processor": _processor(), "system": f"{platform.system()} {platform.machine()}"}
    description["python"] = platform.python_version()
    for name in sorted(TRUTH_LIBRARIES.union(*(method.libraries for method in METHODS.values()))):
        try:
            description[name] = version(name)
        except PackageNotFoundError:
            description[name] = "not installed"
    for library in {method.native.name: method.native for method in METHODS.values() if method.native}.values():
        description[library.name] = library.version or "not installed"
    return description


def load_per_core() -> float | None:
    """Return how many processes wanted to run in the last minute, over the cores; None where the system does not tell.

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
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")
