"""`reference.sweep` and `reference.load_sweep`: many pendulums in one call, in memory or into a folder."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..engines import AUTO
from ..errors import InputError
from ..scenes.scene import Scene
from ..system.imports import missing
from ..system.workers import usable_cores
from .driver import Executor, Tally, drive, joined
from .local import LocalExecutor
from .part import Part
from .promote import Audit, resolved
from .request import Request, default_audit, request
from .swept import Swept

if TYPE_CHECKING:
    from .store import Store

MOST_IN_MEMORY = 100_000  # rows
PIECES, LEAST_PIECE = 16, 256  # pieces of a sweep in memory, and rows of one at least

Report = Callable[[int], None]


def sweep(
    scene: Scene,
    over: Iterable[str] = (),
    *,
    rows: str | Path | None = None,
    out: str | Path | None = None,
    want: Sequence[str] = ("all",),
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
        scene: what is varied, and the span: its `t_end`.
        over: words KEY=START:STOP:STEP, KEY=V1,V2,… or KEY=@FILE.csv; all combinations are rows, the last fastest.
        rows: instead, a CSV or Parquet file whose columns are fields, one row a scene.
        out: a folder for the rows, in Parquet; needed beyond 100,000 rows. A folder of the same sweep is gone on with.
        want: quantities: frequency, precession, transits, state, amplitude, all of these, transit-times.
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
    asked = asked_for(
        scene,
        over,
        Path(rows) if rows is not None else None,
        Path(out) if out is not None else None,
        want=want,
        level=level,
        digits=digits,
        tolerance=tolerance,
        engine=engine,
        audit=audit_rows,
    )
    folder = Path(out) if out is not None else None
    return run(asked, folder, workers, cluster, report)


def asked_for(
    scene: Scene, over: Iterable[str], rows: Path | None, out: Path | None, *, audit: int | None, **options: Any
) -> Request:
    """Return a sweep, checked, its parts cut and its audit chosen for a folder or for memory; see `request.request`.

    Raises:
        InputError: a wrong axis or option, or more rows than memory should hold.
    """
    if out is not None and options.get("engine", AUTO) == AUTO and (out / "plan.json").exists():
        options["engine"] = opened(out).request.engine  # a sweep goes on as it began
    asked = request(scene, over, rows, audit=audit, **options)
    count = asked.table.count
    if out is None:
        if count > MOST_IN_MEMORY:
            raise InputError("--out", "nothing", f"a folder, for more than {MOST_IN_MEMORY:,} rows", "Give --out DIR.")
        return replace(asked, rows_per_part=min(asked.rows_per_part, max(LEAST_PIECE, -(-count // PIECES))))
    return replace(asked, audit=default_audit(count)) if audit is None else asked


def load_sweep(folder: str | Path) -> Swept:
    """Return the sweep in a folder.

    Raises:
        InputError: there is none, or it is not done yet.
    """
    store = opened(Path(folder))
    left = len(store.missing())
    if left:
        advice = f"Go on with `foucault sweep --out {folder}`."
        raise InputError(
            "sweep", str(folder), "a sweep that is done", f"{left} of {store.request.parts} parts miss. {advice}"
        )
    return Swept(store.request, store=store)


def opened(folder: Path) -> Store:
    """Open the folder of a sweep, done or not.

    Raises:
        InputError: there is none.
    """
    need_pyarrow()
    from .store import Store

    return Store.opened(folder)


def need_pyarrow() -> None:
    """Refuse what needs a folder where pyarrow is not installed.

    Raises:
        InputError: it is not.
    """
    if missing(["pyarrow"]):
        advice = "Install it with pip install 'foucault-reference[sweep]'."
        raise InputError("--out", "no pyarrow", "the package pyarrow, which writes Parquet", advice)


def run(
    asked: Request,
    out: Path | None,
    workers: int | None = None,
    cluster: str | None = None,
    report: Report = lambda _: None,
) -> Swept:
    """Do what of a sweep is not done yet, and audit it; arguments and errors as those of `sweep`."""
    started = time.perf_counter()
    store, parts = None, list(range(asked.parts))
    if out is not None:
        need_pyarrow()
        from .store import Store

        store = Store.begun(out, asked)
        store.check_versions()
        parts = store.missing()
        report(asked.table.count - sum(len(asked.rows_of(part)) for part in parts))
    kept: dict[int, Part] = {}
    keep = kept.__setitem__ if store is None else store.save
    tally, compile_s = Tally(), 0.0
    if parts:
        with ExitStack() as stack:
            executor = _executor(asked, out, workers, cluster, len(parts), stack)
            tally = drive(asked, parts, executor, keep, report)
        compile_s = executor.compile_s
    done = joined([kept[part] for part in sorted(kept)]) if store is None else Part({})
    swept = Swept(asked, tally, None, store, compile_s, 0.0, done.columns, done.transits)
    found = resolved(asked, _reader(swept)) if asked.audit else None
    swept = Swept(asked, tally, found, store, compile_s, time.perf_counter() - started, done.columns, done.transits)
    if store is not None:
        store.summarize(_summary(swept))
    return swept


def _executor(
    asked: Request, out: Path | None, workers: int | None, cluster: str | None, parts: int, stack: ExitStack
) -> Executor:
    if cluster is not None:
        from .cluster import ClusterExecutor

        return stack.enter_context(ClusterExecutor(asked, out, cluster))
    return stack.enter_context(LocalExecutor(asked, out, min(workers or usable_cores(), parts)))


def _reader(swept: Swept) -> Callable[[int], Mapping[str, Any]]:
    """Return what reads one row of a sweep."""
    if swept.store is None:
        return lambda number: {name: values[number] for name, values in swept.kept.items()}
    store, known = swept.store, dict[int, dict[str, Any]]()

    def read(number: int) -> Mapping[str, Any]:
        part, place = divmod(number, store.request.rows_per_part)
        if part not in known:
            known.clear()  # the rows come in order
            known[part] = store.read_part(part)
        return {name: values[place] for name, values in known[part].items()}

    return read


def _summary(swept: Swept) -> dict[str, Any]:
    """Return what became of all rows: the same whoever computed them."""
    return {
        "rows": len(swept),
        "counts": swept.counts,
        "audit": swept.audit.document if isinstance(swept.audit, Audit) else None,
    }
