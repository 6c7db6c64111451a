"""`foucault generate`: solve a scene and write its golden dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..engines import AUTO, engine_names
from ..errors import InputError
from ..nearest import in_words
from ..scene import LEVELS, load_scene
from ..shipped import scene_ids
from .progress import progress
from .terminal import AsJson, Assignments, EndTime, SceneWord, chosen, completion, emit, replacements, stoppable

ENGINES = (AUTO, *engine_names())


def command(
    scene_word: SceneWord,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Write the dataset to this folder (default: golden/SCENE, or data/golden/SCENE in a checkout).",
        ),
    ] = None,
    t_end: EndTime = None,
    digits: Annotated[
        str | None,
        typer.Option(
            "--digits",
            metavar="D",
            help="Significant digits of the largest number in each column (default: the scene's).",
        ),
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(
            "--level",
            metavar="L",
            help=f"How far to trust the numbers: {in_words(LEVELS)} (default: the scene's).",
            autocompletion=completion(lambda: LEVELS),
        ),
    ] = None,
    engine: Annotated[
        str,
        typer.Option(
            "--engine",
            metavar="E",
            help=f"Integrate with {in_words(engine_names())}; auto takes the fastest that is installed.",
            autocompletion=completion(lambda: ENGINES),
        ),
    ] = AUTO,
    no_transits: Annotated[bool, typer.Option("--no-transits", help="Do not look for transits, xdot = 0.")] = False,
    audit: Annotated[
        bool,
        typer.Option(
            "--audit",
            help="At the level enclosed, prove it again by FLINT alone: the same digits; always for what ships.",
        ),
    ] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene and write its golden dataset."""
    from ..columns import POSITION
    from ..dataset.place import dataset_id, default_folder, ships
    from ..dataset.sheets import column_bounds
    from ..dataset.write import check_target, write

    options = {
        "--t-end": ("run.t_end", t_end),
        "--digits": ("run.digits", digits),
        "--level": ("run.level", level and chosen("--level", level, LEVELS)),
        "--no-transits": ("run.transits", "false" if no_transits else None),
    }
    chosen("--engine", engine, ENGINES)
    scene = load_scene(scene_word, replacements(set_, options))
    name = dataset_id(scene, load_scene(scene_word) if scene_word not in scene_ids() else None)
    folder = out or default_folder(scene, name)
    check_target(folder)
    audit = audit or (scene.run.level == "enclosed" and ships(folder))
    from ..solver.rounding import grid_decimals
    from ..solver.solve import solve

    with stoppable("nothing was written"), progress() as show:
        solution = solve(scene, engine=engine, audit=audit, report=show(scene.id, float(scene.exact.t_end)))
    if engine not in (AUTO, solution.run.engine):
        few = f"So few digits need only {solution.run.number}, which {engine} does not have."
        raise InputError("--engine", engine, f"{AUTO} or {solution.run.engine}", few)
    with stoppable("nothing half was written"):
        write(solution, folder, name)
    count = len(solution.directions)
    bounds = column_bounds(solution.grid, grid_decimals(solution))
    bound = max((bounds[column] for column in POSITION), key=float)
    checks_s = sum(check.cpu_s for check in solution.checks) + sum(
        (solution.proof.cpu_s if solution.proof else {}).values()
    )
    if as_json:
        emit(
            {
                "scene": scene.id,
                "out": str(folder),
                "level": solution.level,
                "digits": scene.run.digits,
                "engine": solution.run.engine,
                "transits": count,
                "bound_m": float(bound),
                "cpu_s": solution.pilot_s + solution.run.cpu_s + checks_s,
                "run_cpu_s": solution.run.cpu_s,
                "check_cpu_s": checks_s,
                "pilot_cpu_s": solution.pilot_s,
                "compile_s": solution.run.compile_s,
                "number": solution.run.number,
                "steps": solution.run.steps,
            }
        )
        return
    source = solution.run
    rows = f"{len(solution.times)} grid times, {count} transits"
    typer.echo(f"{folder}: {rows}, {scene.run.digits} digits, {solution.level}")
    if solution.not_checked:
        typer.echo(
            f"The proof finds all transits; no run with event detection confirms them: {solution.not_checked}", err=True
        )
    typer.echo(f"every position within {bound} m; {source.formulation}, {source.number}, {source.steps} steps")
    typer.echo(f"CPU: run {solution.run.cpu_s:.2f} s, check {checks_s:.2f} s, pilot {solution.pilot_s:.2f} s")
