"""`reference.sweep` and `reference.load_sweep`: many pendulums in one call, in memory or into a folder."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, replace
from pathlib import Path

from ..engines import AUTO
from ..errors import InputError, check_whole, checked_path
from ..scenes.scene import AnyScene, Scene, Words, as_scene, words_of
from ..system.imports import needed
from ..system.workers import usable_cores
from .driver import Executor, drive, on_this_machine
from .part import Part, Tally
from .promote import audited
from .request import Request, Settings, request
from .store import PLAN, Store
from .swept import Swept

MOST_IN_MEMORY = 100_000  # rows
PIECES, LEAST_PIECE = 16, 256  # pieces of a sweep in memory, and rows of one at least
ROWS_OF_FRAME = "Of a data frame write rows.to_csv(FILE, index=False), and give FILE."
# audited rows: at least, at most, else one in AUDITED
LEAST_AUDIT, MOST_AUDIT, AUDITED = 8, 1000, 1000

Report = Callable[[int], None]


def sweep(
    scene: AnyScene,
    over: Words = (),
    *,
    t_end: str | float | None = None,
    rows: str | Path | None = None,
    out: str | Path | None = None,
    want: Sequence[str] = ("all",),
    sections: str | Sequence[str] | None = None,
    level: str = "computed",
    digits: int | None = None,
    tolerance: float | None = None,
    engine: str = "auto",
    audit_rows: int | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    report: Report = lambda _: None,
) -> Swept:
    """Solve a scene for many values of some of its fields.

    Args:
        scene: what is varied, and the span: its `t_end`; a scene, its id, the path of a TOML file, or nested mappings.
        over: a mapping from fields to values, `{"site.latitude": range(-90, 91, 10)}`, or words KEY=START:STOP:STEP,
            KEY=V1,V2,… or KEY=@FILE.csv; all combinations are rows, the last fastest.
        t_end: end of each run in s, where it is not the scene's.
        rows: instead, a CSV or Parquet file whose columns are fields, one row a scene.
        out: a folder for the rows, in Parquet; needed beyond 100,000 rows. A folder of the same sweep is gone on with.
        want: quantities: frequency, precession, transits, state, amplitude, all of these, transit-times.
        sections: other moments to find, such as ["highest", "gate 30"], instead of the scene's.
        level: level of trust; above computed every row goes through `solve`.
        digits: significant digits, of every row through `solve`; None for double.
        tolerance: rows with a larger error of the position in m go through `solve` as well.
        engine: the engine that solves many rows at once; "auto" takes the one that is expected to be done first.
        audit_rows: how many rows are solved again in many digits; None for a thousandth with `out`, none without.
        workers: threads, or processes where rows go through `solve`; None for one a core.
        cluster: address of a scheduler of dask.distributed, or "local:N" for one of N workers on this machine.
        report: called with the number of rows that were done since the last call.

    Returns:
        A `Swept`: columns as arrays; a row that failed has a status and a reason, and no numbers.

    Raises:
        InputError: a wrong axis, option or folder; before any work.
    """
    file = (
        None if rows is None else checked_path("rows", rows, "a CSV or Parquet file", ROWS_OF_FRAME)
    )
    folder = None if out is None else checked_path("out", out, "a folder")
    if workers is not None:
        check_whole("workers", workers, words="a whole number from 1, or None for one a core")
    settings = Settings(
        want=want.split(",") if isinstance(want, str) else words_of(want),
        level=level,
        digits=digits,
        tolerance=tolerance,
        engine=engine,
        audit=audit_rows,
    )
    run_values = {"run.t_end": t_end, "run.sections": sections}
    scene = as_scene(scene).with_values(
        {key: value for key, value in run_values.items() if value is not None}
    )
    request = checked_request(scene, words_of(over), file, folder, settings)
    return run(request, folder, workers, cluster, report)


def checked_request(
    scene: Scene,
    over: Iterable[str],
    rows: Path | None,
    out: Path | None,
    settings: Settings,
) -> Request:
    """Return the request of a sweep into a folder, or in memory without one; arguments as those of `sweep`.

    Raises:
        InputError: a wrong axis or option, or more rows than memory should hold.
    """
    if out is None:
        return _in_memory(request(scene, over, rows, settings))
    if settings.engine == AUTO and (out / PLAN).exists():
        # a sweep goes on with the engine that it began with
        settings = replace(settings, engine=Store.opened(out).request.engine)
    checked = request(scene, over, rows, settings)
    if settings.audit is not None:
        return checked
    count = checked.table.count
    audit = max(count // AUDITED, LEAST_AUDIT)
    return replace(checked, audit=min(audit, MOST_AUDIT, count))


def _in_memory(checked: Request) -> Request:
    """Return a request with parts small enough for all workers to have some.

    Raises:
        InputError: there are too many rows.
    """
    count = checked.table.count
    if count > MOST_IN_MEMORY:
        expected = f"a folder, for more than {MOST_IN_MEMORY:,} rows"
        raise InputError("--out", "nothing", expected, "Give --out DIR.")
    piece = max(LEAST_PIECE, -(-count // PIECES))
    return replace(checked, rows_per_part=min(checked.rows_per_part, piece))


def load_sweep(folder: str | Path) -> Swept:
    """Return the sweep in a folder.

    Raises:
        InputError: there is none, or it is not done yet, or a part of it was damaged.
    """
    store = Store.opened(checked_path("folder", folder, "the folder of a sweep"))
    count = len(store.missing())
    if count:
        advice = f"{count} of {store.request.parts} are missing or damaged. Go on with `foucault sweep --out {folder}`."
        raise InputError("sweep", str(folder), "a sweep whose parts are all there", advice)
    return Swept(store.request, store)


def run(
    request: Request,
    out: Path | None,
    workers: int | None = None,
    cluster: str | None = None,
    report: Report = lambda _: None,
) -> Swept:
    """Do what of a sweep is not done yet, and audit it; arguments and errors as those of `sweep`."""
    started = time.perf_counter()
    store, parts = None, list(range(request.parts))
    if out is not None:
        store = Store.begun(out, request)
        parts = store.missing()
        report(request.table.count - sum(len(request.rows_of(part)) for part in parts))
    in_memory: dict[int, Part] = {}
    save = store.save if store is not None else in_memory.__setitem__
    tally, compile_s = Tally(), 0.0
    if parts:
        with _workers(request, out, workers, cluster, len(parts)) as executor:
            tally = drive(request, parts, executor, save, report)
        compile_s = executor.compile_s
    audit, audit_from = None, time.process_time()
    if request.audit:
        audit = audited(
            request, lambda part: store.read(parts=[part]) if store else in_memory[part].columns
        )
    solved = Part.joined([in_memory[part] for part in sorted(in_memory)]) if in_memory else Part()
    audit_s, wall_s = time.process_time() - audit_from, time.perf_counter() - started
    swept = Swept(request, store, solved, tally, audit, compile_s, audit_s, wall_s)
    if store is not None:
        document = asdict(audit) if audit is not None else None
        store.finish({"rows": len(swept), "counts": swept.counts, "audit": document})
    return swept


def _workers(
    request: Request, out: Path | None, workers: int | None, cluster: str | None, parts: int
) -> AbstractContextManager[Executor]:
    if cluster is not None:
        needed("distributed", "cluster", "--cluster", "sending rows to a cluster")
        from .cluster import on_cluster

        return on_cluster(request, out, cluster)
    return on_this_machine(request, out, min(workers or usable_cores(), parts))
