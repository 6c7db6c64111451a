"""Clusters through dask.distributed, to which this is the only door: a scheduler somewhere, or one on this machine.

dask sends a part again when its worker is lost. A part that was lost as often as dask allows has killed its workers.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Future
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
from ..system.workers import WorkerDied
from .driver import work
from .local import Isolated, prepared, request_of, text_of
from .request import Request

LOCAL = "local:"
SCHEMES = ("tcp://", "tls://", "ucx://", "inproc://")
PACKAGES = ("foucault-reference", "heyoka", "numba", "numpy", "python-flint", "mpmath", "pyarrow")  # alike everywhere
WAIT_S = 10.0  # for an answer of the scheduler
FOREVER_S = 1e7
RETRIES = 3  # of a part that raised an error which is none of this project's
LOST = "the scheduler was lost; what is done stays, and the same command goes on."


class ClusterError(FoucaultError):
    """The scheduler was lost; what is done stays."""

    exit_status = 2


class Scheduler:
    """A scheduler and its workers, all with the versions that are here.

    Args:
        address: tcp://HOST:PORT of a scheduler, or local:N for N processes of one thread on this machine.

    Raises:
        InputError: no scheduler answers there, it has no workers, or their versions differ from those here.
    """

    def __init__(self, address: str) -> None:
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # a lost scheduler is told in one line
        with ExitStack() as stack:
            self._client = _connected(address, stack)
            self.workers = self._threads(address)
            self._check_versions()
            self._stack = stack.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | TracebackType | BaseException | None) -> None:
        """Leave the scheduler; end one that was started here."""
        self._stack.close()

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin a call on some worker; its future may raise `WorkerDied` or `ClusterError`."""
        future: Future[Any] = Future()
        there = self._client.submit(function, *arguments, pure=False, retries=RETRIES)
        there.add_done_callback(partial(_settle, future))
        return future

    def check(self) -> None:
        """Raise if the scheduler is lost.

        Raises:
            ClusterError: it is.
        """
        if self._client.status != "running":
            raise ClusterError(LOST)

    def _threads(self, address: str) -> int:
        """Return how many threads the workers have together."""
        try:
            self._client.wait_for_workers(1, timeout=WAIT_S)
        except TimeoutError:
            advice = "Start them: `dask worker ADDRESS`."
            raise InputError("--cluster", address, "a scheduler with workers", advice) from None
        return sum(self._client.nthreads().values())

    def _check_versions(self) -> None:
        versions = self._client.get_versions(packages=PACKAGES)
        here = versions["client"]["packages"]
        for worker, there in versions["workers"].items():
            for name in PACKAGES:
                if (got := there["packages"][name]) != here[name]:
                    advice = "Install the same versions everywhere."
                    raise InputError("--cluster", f"{name} {got} on {worker}", f"{name} {here[name]}, as here", advice)


class ClusterExecutor(Scheduler):
    """The workers of a scheduler that compute the rows of a sweep.

    Args:
        request: the sweep.
        folder: where parts are saved: by the workers if they see it, else here.
        address: as of `Scheduler`, whose errors are raised.
    """

    def __init__(self, request: Request, folder: Path | None, address: str) -> None:
        super().__init__(address)
        self._document = text_of(request)
        try:
            self.compile_s = max(self._client.run(_prepare, self._document).values())
            self._folder = self._shared(folder)
        except BaseException:
            self._stack.close()
            raise

    def begin(self, rows: range) -> Future[Any]:
        """Begin a part, or some of its rows, on some worker."""
        return self.submit(compute, self._document, rows, self._folder)

    def _shared(self, folder: Path | None) -> Path | None:
        """Return the folder if every worker sees it; a file of a random name tells."""
        if folder is None:
            return None
        folder = folder.resolve()
        nonce = folder / f".seen-by-workers-{token_hex(8)}"
        nonce.touch()
        try:
            return folder if all(self._client.run(nonce.exists).values()) else None
        finally:
            nonce.unlink()


def _settle(future: Future[Any], there: Any) -> None:
    """Give a future the outcome of dask's; what was lost with its worker meanwhile is waited for."""
    try:
        future.set_result(there.result())
    except KilledWorker:
        future.set_exception(WorkerDied("its workers died"))
    except distributed.client.FutureCancelledError:
        future.set_exception(ClusterError(LOST))
    except BaseException as error:
        future.set_exception(error)


def _connected(address: str, stack: ExitStack) -> Any:
    """Return a client of the scheduler that answers at an address, or of one that is started here."""
    if address.startswith(LOCAL):
        count = address[len(LOCAL) :]
        if not count.isdigit() or not int(count):
            raise InputError("--cluster", address, "local:N with a number of workers from 1")
        # dask gives a local worker up that is being started again some seconds after its death: the last one, too
        stack.enter_context(dask.config.set({"distributed.deploy.lost-worker-timeout": FOREVER_S}))
        cluster = distributed.LocalCluster(
            n_workers=int(count), threads_per_worker=1, dashboard_address=None, silence_logs=50
        )
        return stack.enter_context(distributed.Client(stack.enter_context(cluster)))
    if not address.startswith(SCHEMES):
        raise InputError("--cluster", address, "tcp://HOST:PORT of a scheduler of dask, or local:N")
    try:
        return stack.enter_context(distributed.Client(address, timeout=WAIT_S))
    except (OSError, ValueError):
        advice = "Start one with `dask scheduler`, and workers with `dask worker ADDRESS`."
        raise InputError("--cluster", address, f"a scheduler that answers within {WAIT_S:g} s", advice) from None


_promote = Isolated()


def _prepare(document: str) -> float:
    """Compile on a worker, once."""
    return prepared(request_of(document))


def compute(document: str, rows: range, folder: Path | None) -> Any:
    """Compute rows on a worker."""
    return work(request_of(document), rows, folder, _promote)
