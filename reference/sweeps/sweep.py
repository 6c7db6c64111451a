"""`reference.sweep` and `reference.load_sweep`: many pendulums in one call."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ..engines import AUTO
from ..errors import NOTHING, InputError, check_whole, checked_path
from ..scenes.scene import AnyScene, Scene, Words, as_scene, words_of
from ..system.imports import needed
from ..system.workers import usable_cores
from .driver import Executor, drive, on_this_machine
from .part import Part, Tally
from .promote import audited
from .request import Request, Settings, request
from .store import PLAN, Store
from .swept import Swept

_MOST_IN_MEMORY = 100_000  # rows
_ROWS_OF_FRAME = "Of a data frame write rows.to_csv(FILE, index=False), and give FILE."
_AUDITED = 1000  # one row in so many is audited, within these limits
_LEAST_AUDIT = 8  # rows
_MOST_AUDIT = 1000

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
        scene: what is varied, and the span: its `t_end`; a scene, its id, the path of a TOML file,
            or nested mappings.
        over: a mapping from fields to values, `{"site.latitude": range(-90, 91, 10)}`, or words
            KEY=START:STOP:STEP, KEY=V1,V2,… or KEY=@FILE.csv; all combinations are rows, the last
            fastest.
        t_end: end of each run in s; None for the scene's.
        rows: instead, a CSV or Parquet file whose columns are fields, one row a scene.
        out: a folder for the rows, in Parquet; needed for more than 100,000 rows. A sweep in the
            folder is resumed.
        want: quantities: frequency, precession, transits, state, amplitude, all of these,
            transit-times.
        sections: other moments to find, such as ["highest", "gate 30"], instead of the scene's.
        level: level of trust; above computed every row is solved by `solve`.
        digits: significant digits; with them every row is solved by `solve`. None for double.
        tolerance: rows with a larger estimated position error, in m, are solved by `solve` too.
        engine: the engine that solves many rows at once; "auto" takes the one expected to finish
            first.
        audit_rows: number of rows that are solved again in 28 digits; None for a thousandth with
            `out`, and none without.
        workers: number of threads, or of processes for rows solved by `solve`; None for all cores.
        cluster: address of a dask.distributed scheduler, or "local:N" for N workers on this machine.
        report: called with the number of rows that were done since the last call.

    Returns:
        A `Swept`: columns as arrays; a row that failed has a status and a reason, and no numbers.

    Raises:
        InputError: a wrong axis, option or folder; raised before any work.
    """
    file = folder = None
    if rows is not None:
        file = checked_path("rows", rows, "a CSV or Parquet file", _ROWS_OF_FRAME)
    if out is not None:
        folder = checked_path("out", out, "a folder")
    if workers is not None:
        check_whole("workers", workers, words="a whole number, 1 or more, or None for all cores")
    settings = Settings(
        want=want.split(",") if isinstance(want, str) else words_of(want),
        level=level,
        digits=digits,
        tolerance=tolerance,
        engine=engine,
        audit=audit_rows,
    )
    fields = {"run.t_end": t_end, "run.sections": sections}
    replaced = {name: value for name, value in fields.items() if value is not None}
    scene = as_scene(scene).with_values(replaced)
    request = checked_request(scene, words_of(over), file, folder, settings)
    return run(request, folder, workers, cluster, report)


def checked_request(
    scene: Scene,
    over: Iterable[str],
    rows: Path | None,
    out: Path | None,
    settings: Settings,
) -> Request:
    """Return the request of a sweep into a folder or in memory; arguments as those of `sweep`.

    Raises:
        InputError: a wrong axis or option, or more rows than memory should hold.
    """
    if out is None:
        checked = request(scene, over, rows, settings)
        _check_memory(checked.table.count)
        return checked
    if settings.engine == AUTO and (out / PLAN).exists():
        # a sweep goes on with the engine that it began with
        settings = replace(settings, engine=Store.opened(out).request.engine)
    checked = request(scene, over, rows, settings)
    if settings.audit is not None:
        return checked
    count = checked.table.count
    audit = max(count // _AUDITED, _LEAST_AUDIT)
    return replace(checked, audit=min(audit, _MOST_AUDIT, count))


def _check_memory(count: int) -> None:
    """Refuse more rows than memory should hold.

    Raises:
        InputError: there are too many rows.
    """
    if count > _MOST_IN_MEMORY:
        expected = f"a folder, because there are more than {_MOST_IN_MEMORY:,} rows"
        raise InputError("--out", NOTHING, expected, "Give --out DIR.")


def load_sweep(folder: str | Path) -> Swept:
    """Return the sweep in a folder.

    Raises:
        InputError: there is no sweep, it is incomplete, or a part of it is damaged.
    """
    store = Store.opened(checked_path("folder", folder, "the folder of a sweep"))
    count = len(store.missing())
    if count:
        missing = f"{count} of {store.request.parts} parts are missing or damaged."
        advice = f"{missing} Resume with `foucault sweep --out {folder}`."
        raise InputError("sweep", str(folder), "a complete sweep", advice)
    return Swept(store.request, store)


def run(
    request: Request,
    out: Path | None,
    workers: int | None = None,
    cluster: str | None = None,
    report: Report = lambda _: None,
    report_audit: Report = lambda _: None,
) -> Swept:
    """Solve the parts that are missing, then audit; arguments as those of `sweep`.

    `report_audit` is called with the number of rows that were audited.
    """
    started = time.perf_counter()
    store = None
    parts = list(range(request.parts))
    if out is not None:
        store = Store.begun(out, request)
        parts = store.missing()
        missing_rows = sum(len(request.rows_of(part)) for part in parts)
        report(request.table.count - missing_rows)

    in_memory: dict[int, Part] = {}
    keep = store.save if store is not None else in_memory.__setitem__
    tally = Tally()
    compile_s = 0.0
    if parts:
        with _workers(request, out, workers, cluster, len(parts)) as executor:
            tally = drive(request, parts, executor, keep, report)
        compile_s = executor.compile_s

    def columns_of(part: int) -> Mapping[str, Any]:
        return store.read(parts=[part]) if store is not None else in_memory[part].columns

    audit_started = time.process_time()
    audit = audited(request, columns_of, report_audit) if request.audit else None
    audit_s = time.process_time() - audit_started
    solved = Part.joined([in_memory[part] for part in sorted(in_memory)]) if in_memory else Part()
    swept = Swept(
        request=request,
        store=store,
        solved=solved,
        tally=tally,
        audit=audit,
        compile_s=compile_s,
        audit_s=audit_s,
        wall_s=time.perf_counter() - started,
    )
    if store is not None:
        findings = asdict(audit) if audit is not None else None
        store.finish({"rows": len(swept), "counts": swept.counts, "audit": findings})
    return swept


def _workers(
    request: Request, out: Path | None, workers: int | None, cluster: str | None, parts: int
) -> AbstractContextManager[Executor]:
    """Provide the workers of a cluster, or as many of this machine as there are parts for."""
    if cluster is not None:
        needed("distributed", "cluster", "--cluster", "sending rows to a cluster")
        from .cluster import on_cluster

        return on_cluster(request, out, cluster)
    return on_this_machine(request, out, min(workers or usable_cores(), parts))
