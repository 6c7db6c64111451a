"""`foucault generate --all`: make the shipped datasets that are missing or not sealed."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, cast

import typer

from ..dataset.evidence import check_evidence
from ..dataset.files import read_files
from ..dataset.making import making_of
from ..dataset.manifest import Content
from ..dataset.place import dataset_id, default_folder, ships
from ..dataset.render import check_proved, render
from ..dataset.sheets import scene_inputs
from ..dataset.write import check_target, summary, write_texts
from ..engines.registry import checked
from ..errors import DatasetError, FoucaultError, IntegrationError, UnreachableError, counted
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import scene_ids, seals
from ..solver.choice import need_flint
from ..solver.solve import solve
from ..status import Status
from ..system.imports import needed
from ..system.workers import Pool, WorkerDied, as_done, usable_cores
from ..system.workspace import clear
from .layout import echo, paragraph
from .progress import progress
from .terminal import check_workers, emit, stoppable

_Row = dict[str, Any]

_BINARY64 = ".binary64"


@dataclass(frozen=True)
class _Job:
    """A dataset to be made: its scene, its id and its folder."""

    scene: Scene
    name: str
    folder: Path

    def row(self, status: Status, reason: str | None = None) -> _Row:
        """Return what `generate --all --json` prints on the dataset, without what was measured."""
        return {
            "dataset": self.name,
            "scene": self.scene.id,
            "out": str(self.folder),
            "status": status.value,
            "reason": reason,
        }


def jobs(replaced: Sequence[str], out: Path | None) -> list[_Job]:
    """Return the datasets that ship, the longest run first: one of each scene, and sealed ones of other readings.

    Args:
        replaced: fields of every scene, each as section.key=value.
        out: the folder of all; by default each has that which `generate` writes it to.

    Raises:
        InputError: a replaced field is wrong.
    """
    readings = [name.removesuffix(_BINARY64) for name in seals() if name.endswith(_BINARY64)]
    scenes = [load_scene(name, replaced) for name in scene_ids()]
    scenes += [load_scene(name, ["inputs=binary64", *replaced]) for name in readings]
    every = []
    for scene in scenes:
        name = dataset_id(scene)
        folder = out / name if out else default_folder(scene, name)
        every.append(_Job(scene, name, folder))
    return sorted(every, key=lambda job: (-job.scene.exact.t_end, job.name))


def is_done(job: _Job) -> bool:
    """Return whether the dataset exists, is sealed, and has the same inputs.

    Where it ships, its seal must be that in the index.
    """
    try:
        files = read_files(job.folder)
    except FoucaultError:
        return False
    is_sealed = not ships(job.folder) or seals().get(job.name) == files.manifest.seal
    same_inputs = scene_inputs(files.scene) == scene_inputs(job.scene)
    same_reading = files.scene.inputs == job.scene.inputs
    return is_sealed and same_inputs and same_reading and files.manifest.id == job.name


def _made(job: _Job) -> tuple[_Row, dict[str, Content]]:
    """Solve a scene; return the outcome and the files of its dataset, none if it failed."""
    try:
        making = making_of(job.scene, job.name, job.folder)
        solution = solve(job.scene, **making.solve_options(job.scene))
        texts = render(solution, job.name, tables=making.tables)
        # here, where the proof was made; what is written has these hashes
        check_evidence(texts, solution)
        check_proved(texts, solution)
        return job.row(Status.OK) | summary(solution, job.folder), texts
    except UnreachableError as error:
        status = Status.GAVE_UP if isinstance(error, IntegrationError) else Status.UNREACHABLE
        return job.row(status, str(error)), {}
    except FoucaultError as error:
        return job.row(Status.INVALID, str(error)), {}


def _isolated(job: _Job) -> tuple[_Row, dict[str, Content]]:
    """Make a dataset in a process of its own: the solver is not made for several threads."""
    with Pool(1) as pool:
        return cast("tuple[_Row, dict[str, Content]]", pool.submit(_made, job).result())


def _check_installed(job: _Job) -> None:
    """Refuse a dataset for which a package is missing: others would fail by it too.

    Raises:
        InputError: its engine or python-flint is not installed.
    """
    checked(making_of(job.scene, job.name, job.folder).engine)
    if job.scene.run.level == "enclosed":
        need_flint()


def generate_all(
    replaced: Sequence[str],
    out: Path | None,
    workers: int | None,
    cluster: str | None,
    as_json: bool,
) -> None:
    """Make the datasets that are missing or not sealed, each in a process of its own.

    The failure of a scene does not affect the others.

    Raises:
        InputError: a wrong option, or a folder that cannot be written.
        typer.Exit: a dataset failed, with the status of `UnreachableError` if all that failed were
            out of reach.
    """
    check_workers(workers, cluster)
    if cluster is not None:
        needed("distributed", "cluster", "--cluster", "sending scenes to a cluster")
    every = jobs(replaced, out)
    with stoppable("finished datasets are kept; the same command resumes"), progress() as show:
        undone = _undone(every)
        move = show("datasets", len(undone), "datasets")
        rows = []
        with closing(_made_side_by_side(undone, workers, cluster)) as outcomes:
            for row in outcomes:
                rows.append(row)
                move(len(rows), item=row["scene"])
                if not as_json:
                    echo(paragraph(_line(row), hanging="  "))
    rows.sort(key=lambda row: str(row["dataset"]))
    _print_counts(len(every), rows, as_json)


def _undone(every: list[_Job]) -> list[_Job]:
    """Return the datasets to be made, after clearing away what an interrupted command left.

    Raises:
        InputError: a package is missing, or a folder cannot be written.
    """
    for job in every:
        with suppress(OSError):  # no such folder yet
            # a dataset that is done is not written again
            clear(job.folder.parent, job.folder.name)
    undone = [job for job in every if not is_done(job)]
    for job in undone:
        _check_installed(job)
        check_target(job.folder)
    return undone


def _print_counts(count: int, rows: list[_Row], as_json: bool) -> None:
    """Print how many datasets there were, and how many were made, or failed.

    Args:
        count: of all datasets.
        rows: the outcome of each that was not there.
        as_json: whether to print a document with the rows.

    Raises:
        typer.Exit: a dataset failed.
    """
    sealed_before = count - len(rows)
    failed = [row for row in rows if row["status"] != Status.OK.value]
    if as_json:
        counts = {"datasets": count, "sealed_before": sealed_before, "failed": len(failed)}
        emit({"rows": rows, **counts})
    else:
        made = len(rows) - len(failed)
        typer.echo(
            f"{count} datasets: {sealed_before} were there, {made} made, {len(failed)} failed"
        )
    if failed:
        first = failed[0]["dataset"]
        typer.echo(f"foucault: {len(failed)} of {count} datasets failed, first {first}", err=True)
        unreachable = all(row["status"] == Status.UNREACHABLE.value for row in failed)
        raise typer.Exit(UnreachableError.exit_status if unreachable else 1)


def _made_side_by_side(
    undone: list[_Job], workers: int | None, cluster: str | None
) -> Generator[_Row, None, None]:
    """Make datasets side by side, and write each as it comes.

    This process alone writes, since it keeps the index of seals.
    """
    if not undone:
        return
    with ExitStack() as stack:
        if cluster is not None:
            from ..sweeps.cluster import scheduler_at

            scheduler = stack.enter_context(scheduler_at(cluster))
            begin = partial(scheduler.submit, _isolated)
            check = scheduler.check
        else:
            pool = stack.enter_context(Pool(min(workers or usable_cores(), len(undone))))
            begin = partial(pool.submit, _made)
            check = None
        for job, future in as_done(begin, undone, len(undone), check):
            try:
                row, texts = future.result()
                if texts:
                    write_texts(texts, job.folder)
            except WorkerDied as death:
                row = job.row(Status.CRASHED, str(death))
            except DatasetError as error:
                row = job.row(Status.DOUBTFUL, str(error))
            yield row


def _line(row: _Row) -> str:
    """Return what is printed on a dataset that was made, or failed."""
    if row["status"] != Status.OK.value:
        return f"{row['dataset']}: {Status(row['status']).words}: {row['reason']}"
    transits = counted(row["transits"], "transit")
    return f"{row['out']}: {transits}, {row['digits']} digits, {row['level']}, {row['cpu_s']:.1f} CPU s"
