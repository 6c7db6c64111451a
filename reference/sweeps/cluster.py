"""Clusters through dask.distributed, on this machine or others; the only module that uses dask.

dask sends a part again if its worker is lost. A part that was lost as often as dask allows has
killed its workers.
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

from ..errors import Described, FoucaultError, InputError
from ..system.interruption import held
from ..system.workers import Pool, WorkerDied
from ..system.workspace import workspace
from .driver import Executor, isolated, prepared, solve_and_save
from .part import Part
from .request import Request, request_of

_LOCAL = "local:"
_SCHEMES = ("tcp://", "tls://", "ucx://", "inproc://")
# packages whose versions must be equal everywhere
_PACKAGES = ("foucault-reference", "heyoka", "numba", "numpy", "python-flint", "mpmath", "pyarrow")
_WAIT_S = 10.0  # for an answer of the scheduler
_FOREVER_S = 1e7
_RETRIES = 3  # of a part that raised an error
_LOST = (
    "the connection to the scheduler was lost. Finished parts are kept; the same command resumes."
)


class ClusterError(FoucaultError):
    """The connection to the scheduler was lost; finished parts are kept."""

    exit_status = 2


class Scheduler:
    """A scheduler and its workers.

    Args:
        client: of dask.
        workers: threads that the workers have together.
        versions: of the packages, which every worker must have.
    """

    def __init__(self, client: Any, workers: int, versions: dict[str, Any]) -> None:
        self.client = client
        self.workers = workers
        self.versions = versions

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin a call on some worker; its future may raise `WorkerDied` or `ClusterError`."""
        future: Future[Any] = Future()
        dask_future = self.client.submit(
            _called, self.versions, function, *arguments, pure=False, retries=_RETRIES
        )
        dask_future.add_done_callback(partial(_settle, future))
        return future

    def check(self) -> None:
        """Raise if the scheduler is lost.

        Raises:
            ClusterError: it is.
        """
        if self.client.status != "running":
            raise ClusterError(_LOST)


@contextmanager
def scheduler_at(address: str) -> Iterator[Scheduler]:
    """Yield a scheduler whose workers have the versions of this process; stop it at the end if it was started here.

    Args:
        address: tcp://HOST:PORT of a scheduler, or tls:// with the certificates in dask's
            configuration, or local:N for N processes of one thread on this machine.

    Raises:
        InputError: no scheduler answers there, it has no workers, or their versions differ from
            those here.
    """
    # `ClusterError` reports a lost scheduler in one line
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        client = _connected(address, stack)
        try:
            client.wait_for_workers(1, timeout=_WAIT_S)
        except TimeoutError:
            advice = "Start workers with `dask worker ADDRESS`."
            raise InputError("--cluster", address, "a scheduler with workers", advice) from None
        workers = sum(client.nthreads().values())
        versions = client.get_versions(packages=_PACKAGES)
        here = versions["client"]["packages"]
        for worker, there in versions["workers"].items():
            _check_versions(there["packages"], here, worker)
        yield Scheduler(client, workers, here)


def _connected(address: str, stack: ExitStack) -> Any:
    """Return a client of the scheduler at an address, or of one that is started here."""
    if address.startswith(_LOCAL):
        return _started(address, stack)
    if not address.startswith(_SCHEMES):
        expected = "tcp://HOST:PORT or tls://HOST:PORT of a dask scheduler, or local:N"
        raise InputError("--cluster", address, expected)
    try:
        return stack.enter_context(distributed.Client(address, timeout=_WAIT_S))
    except (OSError, ValueError):
        expected = f"a scheduler that answers within {_WAIT_S:g} s"
        advice = "Start one with `dask scheduler`, and workers with `dask worker ADDRESS`."
        raise InputError("--cluster", address, expected, advice) from None
    except TypeError as error:  # tls:// without certificates
        expected = "certificates in dask's configuration"
        raise InputError("--cluster", address, expected, f"{error}.") from None


def _started(address: str, stack: ExitStack) -> Any:
    """Return a client of a scheduler that is started here, with N workers for local:N."""
    count = address.removeprefix(_LOCAL)
    if not count.isdigit() or not int(count):
        raise InputError("--cluster", address, "local:N, with at least 1 worker")
    # dask waits only some seconds for a worker that is started again after its death, even for the
    # last one
    stack.enter_context(dask.config.set({"distributed.deploy.lost-worker-timeout": _FOREVER_S}))
    scratch = stack.enter_context(workspace(Path(gettempdir()), "foucault-dask"))
    stack.enter_context(dask.config.set({"temporary-directory": str(scratch)}))
    # Ctrl-C reaches the workers as well, and they would print tracebacks. So they begin with
    # signals held back, as do those that replace them, and this process ends them. The resource
    # tracker of multiprocessing lets signals through again in the thread that starts it: it is
    # started before.
    resource_tracker.ensure_running()
    with held():
        try:
            cluster = distributed.LocalCluster(
                n_workers=int(count),
                threads_per_worker=1,
                dashboard_address=None,
                silence_logs=50,
                # any port: dask warns if its usual port is taken
                scheduler_kwargs={"dashboard_address": ":0"},
            )
        except RuntimeError as error:
            expected = "a machine on which dask can start processes"
            raise InputError("--cluster", address, expected, f"{error}") from None
        return stack.enter_context(distributed.Client(stack.enter_context(cluster)))


def _check_versions(there: dict[str, Any], here: dict[str, Any], worker: str) -> None:
    """Refuse a worker whose packages have other versions than here."""
    for name in _PACKAGES:
        if there[name] != here[name]:
            got = Described(f"{name} {there[name]} on {worker}")
            expected = f"{name} {here[name]}, as on this machine"
            raise InputError("--cluster", got, expected, "Install the same versions everywhere.")


def _called(versions: dict[str, Any], function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function on a worker, which may have joined after the others were checked."""
    _check_versions(get_package_info(_PACKAGES), versions, distributed.get_worker().address)
    return function(*arguments)


def _settle(future: Future[Any], dask_future: Any) -> None:
    """Give a future the outcome of dask's."""
    try:
        future.set_result(dask_future.result())
    except KilledWorker:
        future.set_exception(WorkerDied("its workers died"))
    except distributed.client.FutureCancelledError:
        future.set_exception(ClusterError(_LOST))
    except BaseException as error:
        future.set_exception(error)


@contextmanager
def on_cluster(request: Request, folder: Path | None, address: str) -> Iterator[Executor]:
    """Yield the workers of a scheduler, for the rows of a sweep.

    Args:
        request: the sweep.
        folder: where parts are saved: by the workers if they see it, else here.
        address: as of `scheduler_at`, whose errors are raised.
    """
    with scheduler_at(address) as scheduler:
        compile_s = max(scheduler.client.run(_prepare, request.text).values())
        shared = None
        if folder is not None and _is_seen(folder.resolve(), scheduler):
            shared = folder.resolve()

        def begin(rows: range) -> Future[Any]:
            return scheduler.submit(compute, request.text, rows, shared)

        yield Executor(scheduler.workers, begin, scheduler.check, compile_s)


def _is_seen(folder: Path, scheduler: Scheduler) -> bool:
    """Return whether every worker sees a folder: whether a file of a random name exists there."""
    nonce = folder / f".seen-by-workers-{token_hex(8)}"
    nonce.touch()
    try:
        return all(scheduler.client.run(nonce.exists).values())
    finally:
        nonce.unlink()


_alone = Pool(1)  # the process of a worker for rows that the solver solves


def _prepare(text: str) -> float:
    """Compile on a worker, once."""
    return prepared(request_of(text))


def compute(text: str, rows: range, folder: Path | None) -> Part:
    """Compute rows on a worker."""
    return solve_and_save(request_of(text), rows, folder, partial(isolated, _alone))
