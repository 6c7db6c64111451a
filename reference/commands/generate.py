"""`foucault generate`: solve a scene and write its golden dataset."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..engines import AUTO, engine_names
from ..scene import LEVELS, load_scene
from ..shipped import scene_ids
from .terminal import AsJson, Assignments, SceneWord, emit, progress

Level = StrEnum("Level", list(LEVELS))  # type: ignore[misc]  # the functional form is fine at run time


EngineName = StrEnum("EngineName", [AUTO, *engine_names()])  # type: ignore[misc]
DEFAULT_ENGINE = EngineName(AUTO)


def command(
    scene_word: SceneWord,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Write the dataset to this folder.")] = None,
    t_end: Annotated[str | None, typer.Option("--t-end", metavar="S", help="End the run at this time, in s.")] = None,
    digits: Annotated[
        str | None,
        typer.Option("--digits", metavar="D", help="Significant digits of the largest number in each column."),
    ] = None,
    level: Annotated[Level | None, typer.Option("--level", metavar="L", help=", ".join(LEVELS))] = None,
    engine: Annotated[
        EngineName, typer.Option("--engine", help="Choose the integrator; auto takes the fastest that is installed.")
    ] = DEFAULT_ENGINE,
    no_transits: Annotated[bool, typer.Option("--no-transits", help="Do not look for transits, xdot = 0.")] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene and write its golden dataset."""
    from ..columns import POSITION
    from ..dataset.place import dataset_id, default_folder
    from ..dataset.sheets import column_bounds
    from ..dataset.write import check_target, write

    options = {"t_end": t_end, "digits": digits, "level": level, "transits": "false" if no_transits else None}
    changes = [*(set_ or ()), *(f"run.{key}={value}" for key, value in options.items() if value is not None)]
    scene = load_scene(scene_word, changes)
    name = dataset_id(scene, load_scene(scene_word) if scene_word not in scene_ids() else None)
    folder = out or default_folder(scene, name)
    check_target(folder)
    from ..solver.rounding import grid_decimals
    from ..solver.solve import solve

    with progress(scene.id, float(scene.exact.t_end)) as report:
        solution = solve(scene, engine=engine.value, report=report)
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
    typer.echo(f"every position within {bound} m; {source.formulation}, {source.number}, {source.steps} steps")
    typer.echo(f"CPU: run {solution.run.cpu_s:.2f} s, check {checks_s:.2f} s, pilot {solution.pilot_s:.2f} s")
