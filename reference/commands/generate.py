"""`foucault generate`: solve a scene and write its golden dataset, or make every dataset that ships."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..engines import AUTO, engine_names
from ..errors import InputError, counted, in_words
from ..scenes.fields import CONFIRMATIONS, LEVELS
from ..scenes.scene import load_scene
from ..scenes.shipped import scene_ids
from .progress import progress
from .terminal import (
    BESIDE_RANGES,
    AsJson,
    Assignments,
    Cluster,
    EndTime,
    Sections,
    Uncertain,
    Workers,
    chosen,
    completion,
    emit,
    option,
    refuse,
    replacements,
    scene_argument,
    stoppable,
    widths_by_name,
)

if TYPE_CHECKING:
    from ..scenes.scene import Scene

ENGINES = (AUTO, *engine_names())


SCENE = scene_argument(value="[SCENE]")
OUT = option(
    "--out",
    "Write to this folder (default: golden/SCENE, or data/golden/SCENE in a checkout).",
    "DIR",
)
DIGITS = option("--digits", "Digits of the largest number in a column (default: the scene's).", "D")
LEVEL = option(
    "--level",
    f"How far to trust the numbers: {in_words(LEVELS)} (default: the scene's).",
    "L",
    completion(lambda: LEVELS),
)
ENGINE = option(
    "--engine",
    f"Integrate with {in_words(engine_names())}; auto: the fastest, or what made the dataset that ships.",
    "E",
    completion(lambda: ENGINES),
)
NO_TRANSITS = option("--no-transits", "Do not look for transits, xdot = 0.")
AUDIT = option(
    "--audit/--no-audit", "Prove it again by FLINT alone: the same digits (default: --audit)."
)
CONFIRM = option(
    "--confirm",
    f"What heyoka confirms of a proof: {in_words(CONFIRMATIONS)}; sampled is a tenth of the grid's intervals "
    "(default: sampled; of what ships, the whole).",
    "C",
    completion(lambda: CONFIRMATIONS),
)
NO_CONFIRM = option("--no-confirm", "The same as --confirm none.", hidden=True)
FUNCTION = option(
    "--function/--no-function",
    "Make the golden function, the motion at any time, of a proof (default: but for what ships without it).",
)
NO_TABLES = option("--no-tables", "Write the golden function alone.")
ALL = option("--all", "Make all that ship and are missing or not sealed.")


def command(
    scene_word: Annotated[str | None, SCENE] = None,
    out: Annotated[Path | None, OUT] = None,
    t_end: EndTime = None,
    digits: Annotated[str | None, DIGITS] = None,
    level: Annotated[str | None, LEVEL] = None,
    engine: Annotated[str, ENGINE] = AUTO,
    no_transits: Annotated[bool, NO_TRANSITS] = False,
    section: Sections = None,
    audit: Annotated[bool | None, AUDIT] = None,
    confirm: Annotated[str | None, CONFIRM] = None,
    no_confirm: Annotated[bool, NO_CONFIRM] = False,
    function: Annotated[bool | None, FUNCTION] = None,
    no_tables: Annotated[bool, NO_TABLES] = False,
    set_: Assignments = None,
    uncertain: Uncertain = None,
    every: Annotated[bool, ALL] = False,
    workers: Workers = None,
    cluster: Cluster = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene and write its golden dataset.

    Where inputs are uncertain, by --uncertain or the scene's [uncertain], it writes ranges: intervals that are proved
    for every value of these inputs.
    foucault generate --all --workers 2 makes all that ship, into --out.
    """
    options = {
        "--t-end": ("run.t_end", t_end),
        "--digits": ("run.digits", digits),
        "--level": ("run.level", level and chosen("--level", level, LEVELS)),
        "--no-transits": ("run.transits", "false" if no_transits else None),
        "--section": ("run.sections", ",".join(section) if section else None),
    }
    proving: dict[str, object] = {
        "--audit": audit,
        "--no-audit": audit is False,
        "--confirm": confirm,
    }
    proving |= {
        "--no-confirm": no_confirm,
        "--function": function,
        "--no-function": function is False,
    }
    proving["--no-tables"] = no_tables
    named_engine = None if engine == AUTO else engine
    if every:
        unused: dict[str, object] = {"SCENE": scene_word, "--no-transits": no_transits, **proving}
        unused |= {
            "--set": set_,
            "--section": section,
            "--uncertain": uncertain,
            "--engine": named_engine,
        }
        refuse(unused, "with --all")
        from .generate_all import generate_all

        generate_all(replacements(None, options), out, workers, cluster, as_json)
        return
    refuse({"--workers": workers, "--cluster": cluster}, "without --all")
    if scene_word is None:
        raise InputError("SCENE", "nothing", "a scene, or --all", "`foucault scenes` lists them.")
    chosen("--engine", engine, ENGINES)
    scene = load_scene(scene_word, replacements(set_, options))
    if widths := widths_by_name(uncertain, scene):
        refuse({"--digits": digits, **proving}, BESIDE_RANGES)
        if level not in (None, "enclosed"):
            raise InputError(
                "--level",
                level,
                "enclosed, together with uncertain inputs",
                "Ranges are always proved.",
            )
        _generate_ranges(scene, widths, engine, out, as_json)
        return
    from ..dataset.making import making_of
    from ..dataset.place import dataset_id, default_folder
    from ..dataset.write import check_target, summary, write
    from ..solver.solve import solve

    name = dataset_id(scene, load_scene(scene_word) if scene_word not in scene_ids() else None)
    folder = out or default_folder(scene, name)
    check_target(folder)
    if scene.run.level != "enclosed":
        refuse(proving, "without --level enclosed")
    if no_confirm:
        refuse({"--confirm": confirm}, "with --no-confirm")
    # what ships as the index says; else by the fastest engine, with a function, a tenth of it confirmed
    usual = making_of(scene, name, folder)
    if confirm is not None:
        chosen("--confirm", confirm, CONFIRMATIONS)
    confirm = "none" if no_confirm else confirm
    choices: dict[str, Any] = {
        "engine": named_engine,
        "audit": audit,
        "confirm": confirm,
        "function": function,
    }
    choices = {name: value for name, value in choices.items() if value is not None}
    making = replace(usual, **choices, tables=usual.tables and not no_tables)
    if not (making.tables or making.function):
        refuse({"--no-tables": True}, "without --function")
    with stoppable("nothing was written"), progress() as show:
        report = show(scene.id, float(scene.exact.t_end))
        solution = solve(scene, **making.solve_options(scene), report=report)
    if engine not in (AUTO, solution.run.engine):
        advice = f"So few digits need only {solution.run.number}, which {engine} does not have."
        raise InputError("--engine", engine, f"{AUTO} or {solution.run.engine}", advice)
    with stoppable("nothing half was written"):
        write(solution, folder, name, tables=making.tables)
    measured, run = summary(solution, folder), solution.run
    if as_json:
        emit(measured)
        return
    confirmed = f", confirmation {measured['confirmed']}" if solution.proof else ""
    rows = (
        f"{counted(len(solution.times), 'grid time')}, {counted(measured['transits'], 'transit')}"
    )
    rows += f", {measured['possible']} undecided" if measured["possible"] else ""
    typer.echo(f"{folder}: {rows}, {scene.run.digits} digits, {solution.level}{confirmed}")
    if solution.not_checked:
        unseen = "The proof finds all transits; no run with event detection confirms them"
        typer.echo(f"{unseen}: {solution.not_checked}", err=True)
    typer.echo(
        f"every position within {measured['bound_m']} m; {run.formulation}, {run.number}, {run.steps} steps"
    )
    parts = {
        "run": run.cpu_s,
        "checks": solution.check_s,
        "pilot": solution.pilot_s,
        "discarded": solution.discarded_s,
    }
    told = ", ".join(f"{name} {seconds:.2f}" for name, seconds in parts.items() if seconds)
    typer.echo(f"CPU {solution.cpu_s:.2f} s: {told}")


def _generate_ranges(
    scene: Scene, widths: dict[str, str], engine: str, out: Path | None, as_json: bool
) -> None:
    """Prove intervals for uncertain inputs and write them.

    Raises:
        InputError: an input, a width, or the folder.
        UnreachableError: the box is too wide; nothing is written.
    """
    from ..dataset.place import GOLDEN, RANGES
    from ..dataset.ranges import period_texts, ranges_id, write_ranges
    from ..dataset.write import check_target
    from ..solver.uncertain import prove_ranges

    if out is not None:
        check_target(out, RANGES)
    with stoppable("nothing was written"), progress() as show:
        report = show(scene.id, float(scene.exact.t_end))
        ranges = prove_ranges(scene, widths, engine=engine, report=report)
    folder = out or Path(GOLDEN, ranges_id(ranges))
    with stoppable("nothing half was written"):
        write_ranges(ranges, folder)
    counts = {
        "grid": len(ranges.times),
        "transits": len(ranges.transits),
        "possible": len(ranges.possible),
    }
    period = period_texts(ranges)
    if as_json:
        emit({"dataset": ranges_id(ranges), "out": str(folder), "period_s": period, **counts})
        return
    box = ", ".join(f"{name} ±{width}" for name, width in ranges.uncertain.items())
    rows = f"{counted(counts['grid'], 'grid time')}, {counted(counts['transits'], 'transit')}"
    typer.echo(f"{folder}: {rows}, for every {box}: enclosed")
    if ranges.possible:
        typer.echo(f"intervals that may hold more transits: {counts['possible']}")
    for word, passages in ranges.sections.items():
        undecided = (
            f", intervals that are left open: {len(passages.possible)}" if passages.possible else ""
        )
        typer.echo(f"passages of {word}: {len(passages.table)}{undecided}")
    if period:
        typer.echo(f"period between {period[0]} and {period[1]} s; CPU {ranges.proof.cpu_s:.2f} s")
