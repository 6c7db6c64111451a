"""Commands that judge: score. Results on stdout, progress on stderr."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reference import InputError, load_scene
from reference.cli import AsJson, Assignments, SceneWord, emit

if TYPE_CHECKING:
    from .candidate import Candidate
    from .external import Timing

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)


class Inputs(StrEnum):
    """How the scene's numbers are read."""

    auto = "auto"
    decimal = "decimal"
    binary64 = "binary64"


@app.command()
def score(
    scene_word: SceneWord,
    candidates: Annotated[
        list[str] | None, typer.Argument(metavar="[CANDIDATE]...", help="CSV, foucPend output or .npz; - is stdin.")
    ] = None,
    transits: Annotated[
        str | None, typer.Option("--transits", metavar="FILE", help="CSV with a column t: times of xdot = 0.")
    ] = None,
    run: Annotated[
        str | None, typer.Option("--run", metavar="'COMMAND'", help="Run this program and score what it prints.")
    ] = None,
    tolerance: Annotated[
        float | None, typer.Option("--tolerance", metavar="M", help="Largest position error allowed, in m.")
    ] = None,
    inputs: Annotated[Inputs, typer.Option("--inputs", help="How the scene's numbers are read.")] = Inputs.auto,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE", help="Error against time: svg, png, pdf.")
    ] = None,
    timeout: Annotated[float, typer.Option("--timeout", metavar="S", help="Limit for --run.")] = 600.0,
    repeats: Annotated[int, typer.Option("--repeats", help="Timed runs of --run after a warm-up.")] = 3,
    no_diagnosis: Annotated[bool, typer.Option("--no-diagnosis", help="Do not look for the reason.")] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Score a program's output against the truth; exit status 0 agrees, 1 disagrees.

    --run fills in {x0} {y0} {z0} {vx0} {vy0} {vz0} {length} {drag} {latitude} {altitude} {gravity}
    {rotation_rate} {equatorial_radius} {inverse_flattening} {angle} {azimuth} {t_end} {grid_step}.
    """
    scene = load_scene(scene_word, set_ or ())
    if tolerance is not None and not 0 < tolerance < float("inf"):
        raise InputError("--tolerance", f"{tolerance:g}", "a positive number of metres")
    if not candidates and run is None:
        raise InputError("CANDIDATE", "nothing", "a file, - for standard input, or --run", "Name what is to be scored.")
    from .score import document
    from .score import score as judge
    from .trajectory import read, read_stream, read_transits
    from .verdict import lines

    zeros = None if transits is None else read_transits(transits)
    found: list[tuple[Candidate, Timing | None]] = [(read(name), None) for name in candidates or ()]
    made = []
    if run is not None:
        from .external import arguments, timed

        output, took = timed(arguments(run, scene), timeout, max(0, repeats))
        with output:
            found.append((read_stream(output, "the program"), took))
    for candidate, timing in found:
        result = judge(
            candidate,
            scene,
            transits=zeros,
            tolerance=tolerance,
            inputs=inputs.value,
            explain=not no_diagnosis,
            announce=lambda text: typer.echo(text, err=True),
        )
        made.append(replace(result, timing=timing))
    if plot is not None:
        from .pictures import error_picture

        error_picture(made, plot)
    if as_json:
        documents = [document(result) for result in made]
        verdict = "agrees" if all(result.agrees for result in made) else "disagrees"
        emit(documents[0] if len(documents) == 1 else {"scene": scene.id, "verdict": verdict, "rows": documents})
    else:
        for result in made:
            for line in lines(result):
                typer.echo(line)
    if not all(result.agrees for result in made):
        raise typer.Exit(1)
