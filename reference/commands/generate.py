"""`foucault generate`: solve a scene and write its golden dataset."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..engines import AUTO, engine_names
from ..scene import LEVELS, load_scene
from ..shipped import scene_ids
from .terminal import AsJson, Assignments, SceneWord, emit, progress, stoppable

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
    from ..dataset.sheets import grid_bound
    from ..dataset.write import check_target, default_folder, write

    options = {"t_end": t_end, "digits": digits, "level": level, "transits": "false" if no_transits else None}
    changes = [*(set_ or ()), *(f"run.{key}={value}" for key, value in options.items() if value is not None)]
    scene = load_scene(scene_word, changes)
    as_shipped = scene_word in scene_ids() and not set_ and t_end is None and not no_transits
    folder = out or default_folder(scene, as_shipped or set_ == ["inputs=binary64"])
    check_target(folder)
    from ..solver.solve import solve

    with stoppable("nothing was written"), progress(scene.id, float(scene.exact.t_end)) as report:
        solution = solve(scene, engine=engine.value, report=report)
    with stoppable("nothing half was written"):
        write(solution, folder)
    count = len(solution.directions)
    bound = grid_bound(solution, POSITION)
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
