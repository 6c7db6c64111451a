"""`foucault generate --all`: every dataset that ships and is missing or not sealed, each in an isolated process."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..errors import DatasetError, InputError, UnreachableError
from ..status import Status
from .progress import progress
from .terminal import emit, refuse, stoppable

if TYPE_CHECKING:
    from ..dataset.shipping import Job, Made

Row = dict[str, Any]


def generate_all(
    replaced: Iterable[str], out: Path | None, workers: int | None, cluster: str | None, as_json: bool
) -> None:
    """Make what is missing or not sealed; a scene that fails costs only itself.

    Args:
        replaced: fields of every scene, each as section.key=value.
        out: the folder of all datasets; None for those of `generate`.
        workers: how many processes; None for one a core.
        cluster: the address of a scheduler of dask, or None.
        as_json: print one document instead of text.

    Raises:
        InputError: a wrong option, or a folder that cannot be written.
        UnreachableError: all that failed was out of reach.
        typer.Exit: others failed, with status 1.
    """
    from ..dataset.shipping import is_done, jobs
    from ..dataset.write import check_target

    if workers is not None and cluster is not None:
        refuse({"--workers": workers}, "together with --cluster")
    if workers is not None and workers < 1:
        raise InputError("--workers", workers, "a whole number from 1")
    every = jobs(replaced, out)
    with stoppable("what is done stays, and the same command goes on"), progress() as show:
        left = [job for job in every if not is_done(job)]
        for job in left:
            check_target(job.folder)
        move = show("datasets", len(left), "datasets")

        def report(row: Row, count: int) -> None:
            move(count, item=row["scene"])
            if not as_json:
                typer.echo(_line(row))

        rows = _made(left, workers, cluster, report) if left else []
    failed = [row for row in rows if row["status"] != Status.OK.value]
    counts = {"datasets": len(every), "sealed_before": len(every) - len(left), "failed": len(failed)}
    if as_json:
        emit({"rows": rows, **counts})
    else:
        made = len(left) - len(failed)
        typer.echo(f"{len(every)} datasets: {len(every) - len(left)} were there, {made} made, {len(failed)} failed")
    if failed:
        typer.echo(f"foucault: {len(failed)} of {len(every)} datasets failed, first {failed[0]['dataset']}", err=True)
        unreachable = all(row["status"] == Status.UNREACHABLE.value for row in failed)
        raise typer.Exit(UnreachableError.exit_status if unreachable else 1)


def _made(left: list[Job], workers: int | None, cluster: str | None, report: Callable[[Row, int], None]) -> list[Row]:
    """Make datasets side by side, and write each as it comes: by this process alone, which keeps the index of seals."""
    from ..dataset.shipping import isolated, made
    from ..system.workers import Pool, WorkerDied, as_done, usable_cores

    rows: list[Row] = []
    with ExitStack() as stack:
        if cluster is not None:
            from ..sweeps.cluster import Scheduler

            scheduler = stack.enter_context(Scheduler(cluster))
            begin, check = partial(scheduler.submit, isolated), scheduler.check
        else:
            pool = stack.enter_context(Pool(min(workers or usable_cores(), len(left))))
            begin, check = partial(pool.submit, made), None
        for job, future in as_done(begin, left, len(left), check):
            try:
                row = _written(job, future.result())
            except WorkerDied as death:
                row = _row(job, Status.CRASHED, str(death))
            rows.append(row)
            report(row, len(rows))
    return sorted(rows, key=lambda row: str(row["dataset"]))


def _written(job: Job, made: Made) -> Row:
    """Write a dataset, if there is one; return what became of it."""
    from ..dataset.write import write_texts

    if made.status is not Status.OK:
        return _row(job, made.status, made.reason)
    try:
        write_texts(made.texts, job.folder)
    except DatasetError as error:
        return _row(job, Status.DOUBTFUL, str(error))
    return _row(job, Status.OK, None) | made.document


def _row(job: Job, status: Status, reason: str | None) -> Row:
    return {"dataset": job.name, "scene": job.scene, "out": str(job.folder), "status": status.value, "reason": reason}


def _line(row: Row) -> str:
    if row["status"] != Status.OK.value:
        return f"{row['dataset']}: {Status(row['status']).words}: {row['reason']}"
    return f"{row['out']}: {row['transits']} transits, {row['digits']} digits, {row['level']}, {row['cpu_s']:.1f} CPU s"
