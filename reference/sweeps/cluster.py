"""Clusters through dask.distributed, to which this is the only door: a scheduler somewhere, or one on this machine.

dask sends a part again when its worker is lost. A part that was lost as often as dask allows has killed its workers.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import ExitStack, contextmanager
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from secrets import token_hex
from tempfile import gettempdir
from typing import Any

import dask
import distributed
from distributed.scheduler import KilledWorker
from distributed.versions import get_package_info

from ..errors import FoucaultError, InputError
from ..system.interruption import held
from ..system.workers import Pool, WorkerDied
from ..system.workspace import workspace
from .driver import Executor, isolated, prepared, solve_and_save
from .part import Part
from .request import Request, request_of

LOCAL = "local:"
SCHEMES = ("tcp://", "tls://", "ucx://", "inproc://")
# alike everywhere
PACKAGES = ("foucault-reference", "heyoka", "numba", "numpy", "python-flint", "mpmath", "pyarrow")
WAIT_S = 10.0  # for an answer of the scheduler
FOREVER_S = 1e7
RETRIES = 3  # of a part that raised an error which is none of this project's
LOST = "the scheduler was lost; what is done stays, and the same command goes on."


class ClusterError(FoucaultError):
    """The scheduler was lost; what is done stays."""

    exit_status = 2


class Scheduler:
    """A scheduler and its workers.

    Args:
        client: of dask.
        workers: threads that the workers have together.
        versions: of the packages, which every worker must have.
    """

    def __init__(self, client: Any, workers: int, versions: dict[str, Any]) -> None:
        self.client, self.workers, self.versions = client, workers, versions

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin a call on some worker; its future may raise `WorkerDied` or `ClusterError`."""
        future: Future[Any] = Future()
        dask_future = self.client.submit(
            _called, self.versions, function, *arguments, pure=False, retries=RETRIES
        )
        dask_future.add_done_callback(partial(_settle, future))
        return future

    def check(self) -> None:
        """Raise if the scheduler is lost.

        Raises:
            ClusterError: it is.
        """
        if self.client.status != "running":
            raise ClusterError(LOST)


@contextmanager
def scheduler_at(address: str) -> Iterator[Scheduler]:
    """Provide a scheduler whose workers all have the versions that are here; leave it, or end one that is started here.

    Args:
        address: tcp://HOST:PORT of a scheduler, or tls:// with the certificates in dask's configuration, or local:N for
            N processes of one thread on this machine.

    Raises:
        InputError: no scheduler answers there, it has no workers, or their versions differ from those here.
    """
    # a lost scheduler is told in one line
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        client = _connected(address, stack)
        try:
            client.wait_for_workers(1, timeout=WAIT_S)
        except TimeoutError:
            advice = "Start them: `dask worker ADDRESS`."
            raise InputError("--cluster", address, "a scheduler with workers", advice) from None
        workers = sum(client.nthreads().values())
        versions = client.get_versions(packages=PACKAGES)
        here = versions["client"]["packages"]
        for worker, there in versions["workers"].items():
            _check_versions(there["packages"], here, worker)
        yield Scheduler(client, workers, here)


def _connected(address: str, stack: ExitStack) -> Any:
    """Return a client of the scheduler that answers at an address, or of one that is started here."""
    if address.startswith(LOCAL):
        count = address[len(LOCAL) :]
        if not count.isdigit() or not int(count):
            raise InputError("--cluster", address, "local:N with a number of workers from 1")
        # dask gives a local worker up that is being started again some seconds after its death: the last one, too
        stack.enter_context(dask.config.set({"distributed.deploy.lost-worker-timeout": FOREVER_S}))
        scratch = stack.enter_context(workspace(Path(gettempdir()), "foucault-dask"))
        stack.enter_context(dask.config.set({"temporary-directory": str(scratch)}))
        # Ctrl-C reaches the workers as well, which would print where they are: they begin with signals held back, and
        # so do those that replace them. This process ends them. What multiprocessing starts first lets signals through
        # again, in the thread that starts it.
        resource_tracker.ensure_running()
        with held():
            try:
                cluster = distributed.LocalCluster(
                    n_workers=int(count),
                    threads_per_worker=1,
                    dashboard_address=None,
                    silence_logs=50,
                    # any port: dask warns where another has its own
                    scheduler_kwargs={"dashboard_address": ":0"},
                )
            except RuntimeError as error:
                raise InputError(
                    "--cluster", address, "processes that dask can start here", f"{error}"
                ) from None
            return stack.enter_context(distributed.Client(stack.enter_context(cluster)))
    if not address.startswith(SCHEMES):
        raise InputError(
            "--cluster",
            address,
            "tcp://HOST:PORT or tls://HOST:PORT of a scheduler of dask, or local:N",
        )
    try:
        return stack.enter_context(distributed.Client(address, timeout=WAIT_S))
    except (OSError, ValueError):
        advice = "Start one with `dask scheduler`, and workers with `dask worker ADDRESS`."
        raise InputError(
            "--cluster", address, f"a scheduler that answers within {WAIT_S:g} s", advice
        ) from None
    except TypeError as error:  # of tls:// without certificates
        raise InputError(
            "--cluster", address, "certificates in dask's configuration", f"{error}."
        ) from None


def _check_versions(there: dict[str, Any], here: dict[str, Any], worker: str) -> None:
    for name in PACKAGES:
        if (got := there[name]) != here[name]:
            advice = "Install the same versions everywhere."
            raise InputError(
                "--cluster", f"{name} {got} on {worker}", f"{name} {here[name]}, as here", advice
            )


def _called(versions: dict[str, Any], function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function on a worker, which may have come since the versions of the others were checked."""
    _check_versions(get_package_info(PACKAGES), versions, distributed.get_worker().address)
    return function(*arguments)


def _settle(future: Future[Any], dask_future: Any) -> None:
    """Give a future the outcome of dask's; what was lost with its worker meanwhile is waited for."""
    try:
        future.set_result(dask_future.result())
    except KilledWorker:
        future.set_exception(WorkerDied("its workers died"))
    except distributed.client.FutureCancelledError:
        future.set_exception(ClusterError(LOST))
    except BaseException as error:
        future.set_exception(error)


@contextmanager
def on_cluster(request: Request, folder: Path | None, address: str) -> Iterator[Executor]:
    """Provide the workers of a scheduler for the rows of a sweep.

    Args:
        request: the sweep.
        folder: where parts are saved: by the workers if they see it, else here.
        address: as of `scheduler_at`, whose errors are raised.
    """
    with scheduler_at(address) as scheduler:
        compile_s = max(scheduler.client.run(_prepare, request.text).values())
        shared = (
            folder.resolve()
            if folder is not None and _is_seen(folder.resolve(), scheduler)
            else None
        )
        yield Executor(
            scheduler.workers,
            lambda rows: scheduler.submit(compute, request.text, rows, shared),
            scheduler.check,
            compile_s,
        )


def _is_seen(folder: Path, scheduler: Scheduler) -> bool:
    """Return whether every worker sees a folder; a file of a random name tells."""
    nonce = folder / f".seen-by-workers-{token_hex(8)}"
    nonce.touch()
    try:
        return all(scheduler.client.run(nonce.exists).values())
    finally:
        nonce.unlink()


_alone = Pool(1)  # of a worker, for rows that the solver solves by themselves


def _prepare(text: str) -> float:
    """Compile on a worker, once."""
    return prepared(request_of(text))


def compute(text: str, rows: range, folder: Path | None) -> Part:
    """Compute rows on a worker."""
    return solve_and_save(request_of(text), rows, folder, partial(isolated, _alone))
