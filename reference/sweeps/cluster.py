"""Clusters through dask.distributed, to which this is the only door: a scheduler somewhere, or one on this machine.

dask sends a part again when its worker is lost. A part that was lost as often as dask allows has killed its workers.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from secrets import token_hex
from types import TracebackType
from typing import Any, Self

import dask
import distributed
from distributed.scheduler import KilledWorker

from ..errors import FoucaultError, InputError
from ..system.pool import WorkerDied
from .driver import work
from .isolated import Isolated
from .local import prepared
from .request import Request

LOCAL = "local:"
SCHEMES = ("tcp://", "tls://", "ucx://", "inproc://")
WAIT_S = 10.0  # for an answer of the scheduler
FOREVER_S = 1e7
RETRIES = 3  # of a part that raised an error which is none of this project's
LOST = "the scheduler was lost; what is done stays, and the same command goes on."
_NONCE = ".seen-by-workers"


class ClusterError(FoucaultError):
    """The scheduler was lost; what is done stays."""

    exit_status = 2


class Scheduler:
    """A scheduler and its workers, all with the versions that are here.

    Args:
        address: tcp://HOST:PORT of a scheduler, or local:N for N processes of one thread on this machine.
        versions: returns what has to be alike everywhere, as text.

    Raises:
        InputError: no scheduler answers there, it has no workers, or their versions differ from those here.
    """

    def __init__(self, address: str, versions: Callable[[], str]) -> None:
        self._stack = ExitStack()
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # a lost scheduler is told in one line
        try:
            self._client = self._connected(address)
            self.workers = self._check_workers(address, versions)
        except BaseException:
            self._stack.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: TracebackType | BaseException | None) -> None:
        """Leave the scheduler; end one that was started here."""
        self._stack.close()

    def begin(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Begin a call on some worker; return its future."""
        return _Awaited(self._client.submit(function, *arguments, pure=False, retries=RETRIES))

    def check(self) -> None:
        """Raise if the scheduler is lost.

        Raises:
            ClusterError: it is.
        """
        if self._client.status != "running":
            raise ClusterError(LOST)

    def _connected(self, address: str) -> Any:
        if address.startswith(LOCAL):
            count = address[len(LOCAL) :]
            if not count.isdigit() or not int(count):
                raise InputError("--cluster", address, "local:N with a number of workers from 1")
            # dask gives a local worker up that is being started again some seconds after its death: the last one, too
            self._stack.enter_context(dask.config.set({"distributed.deploy.lost-worker-timeout": FOREVER_S}))
            cluster = distributed.LocalCluster(
                n_workers=int(count), threads_per_worker=1, dashboard_address=None, silence_logs=50
            )
            self._stack.enter_context(cluster)
            return self._stack.enter_context(distributed.Client(cluster))
        if not address.startswith(SCHEMES):
            raise InputError("--cluster", address, "tcp://HOST:PORT of a scheduler of dask, or local:N")
        try:
            return self._stack.enter_context(distributed.Client(address, timeout=WAIT_S))
        except (OSError, ValueError):
            advice = "Start one with `dask scheduler`, and workers with `dask worker ADDRESS`."
            raise InputError("--cluster", address, f"a scheduler that answers within {WAIT_S:g} s", advice) from None

    def _check_workers(self, address: str, versions: Callable[[], str]) -> int:
        """Return how many threads the workers have together, all with the versions that are here."""
        try:
            self._client.wait_for_workers(1, timeout=WAIT_S)
            threads = self._client.nthreads()
        except TimeoutError:
            threads = {}
        if not threads:
            raise InputError("--cluster", address, "a scheduler with workers", "Start them: `dask worker ADDRESS`.")
        here = versions()
        for worker, there in self._client.run(_versions_or_error, versions).items():
            if there != here:
                advice = "Install the same versions everywhere."
                raise InputError("--cluster", f"{there} on {worker}", f"{here}, as here", advice)
        return sum(threads.values())


class ClusterExecutor(Scheduler):
    """The workers of a scheduler that compute the rows of a sweep.

    Args:
        request: the sweep.
        folder: where parts are saved: by the workers if they see it, else here.
        address: as of `Scheduler`, whose errors are raised.
    """

    def __init__(self, request: Request, folder: Path | None, address: str) -> None:
        super().__init__(address, partial(versions, request.engine))
        self._document = request.document()
        try:
            self.compile_s = max(self._client.run(_prepare, self._document).values())
            self._folder = self._shared(folder)
        except BaseException:
            self._stack.close()
            raise

    def submit(self, rows: range) -> Any:
        """Begin a part, or some of its rows, on some worker."""
        return self.begin(compute, self._document, rows, self._folder)

    def _shared(self, folder: Path | None) -> Path | None:
        """Return the folder if every worker sees it; a file of a random name tells."""
        if folder is None:
            return None
        folder = folder.resolve()
        nonce = folder / f"{_NONCE}-{token_hex(8)}"
        nonce.touch()
        try:
            return folder if all(self._client.run(nonce.exists).values()) else None
        finally:
            nonce.unlink()


class _Awaited:
    """A future of dask as `driver.drive` takes them: its own errors are told apart."""

    def __init__(self, future: Any) -> None:
        self._future = future

    def add_done_callback(self, call: Callable[[Any], None]) -> None:
        """Have `call` called with this when it is done."""
        self._future.add_done_callback(lambda _: call(self))

    def result(self) -> Any:
        """Return what was computed; if it was lost with its worker meanwhile, wait until dask has it again.

        Raises:
            WorkerDied: it killed its workers.
            ClusterError: the scheduler was lost.
        """
        if self._future.status == "cancelled":
            raise ClusterError(LOST)
        try:
            return self._future.result()
        except KilledWorker:
            raise WorkerDied("its workers died") from None
        except distributed.client.FutureCancelledError:
            raise ClusterError(LOST) from None


def versions(engine: str) -> str:
    """Return what has to be alike on all machines: this project, the engine, pyarrow."""
    from importlib.metadata import version

    from ..engines.registry import batches
    from ..system.imports import missing

    arrow = "" if missing(["pyarrow"]) else f"; pyarrow {version('pyarrow')}"
    return f"{batches()[engine].identity}{arrow}"


def solving_versions() -> str:
    """Return what has to be alike on all machines that solve scenes: this project and what it solves with."""
    from importlib.metadata import PackageNotFoundError, version

    found = []
    for package in ("foucault-reference", "heyoka", "numba", "python-flint", "mpmath"):
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            found.append(f"no {package}")
    return "; ".join(found)


def _versions_or_error(versions: Callable[[], str]) -> str:
    try:
        return versions()
    except Exception as error:  # whatever it lacks
        return f"{type(error).__name__}: {error}"


def _prepare(document: dict[str, Any]) -> float:
    """Compile on a worker, once."""
    return prepared(Request.of(document))


_promote = Isolated()
_requests: dict[str, Request] = {}
_turn = threading.Lock()


def compute(document: dict[str, Any], rows: range, folder: Path | None) -> Any:
    """Compute rows on a worker."""
    key = repr(document)
    with _turn:
        if key not in _requests:
            _requests.clear()
            _requests[key] = Request.of(document)
        request = _requests[key]
    return work(request, rows, folder, _promote)
