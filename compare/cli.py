"""Commands that judge: score. Results on stdout, progress on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reference import InputError, Scene, load_scene, scene_ids
from reference.cli import AsJson, Assignments, SceneWord, emit, progress

from .paper.command import register as register_paper
from .pend.command import register as register_pend

if TYPE_CHECKING:
    from .candidates.candidate import Candidate
    from .candidates.external import Timing

MAX_REPEATS = 1000

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
    approximation: Annotated[
        str | None, typer.Option("--approximation", metavar="ID", help="Score one of the seeds' approximations.")
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
    {rotation_rate} {equatorial_radius} {inverse_flattening} {angle} {azimuth} {angle_rate} {azimuth_rate}
    {t_end} {grid_step}.
    """
    scene = load_scene(scene_word, set_ or ())
    if tolerance is not None and not 0 < tolerance < float("inf"):
        raise InputError("--tolerance", f"{tolerance:g}", "a positive number of metres")
    if not candidates and run is None and approximation is None:
        raise InputError(
            "CANDIDATE", "nothing", "a file, - for stdin, --run or --approximation", "Name what is to be scored."
        )
    if [*(candidates or ()), transits].count("-") > 1:
        raise InputError("CANDIDATE", "- more than once", "standard input once", "It can be read only once.")
    if not 0 < timeout < float("inf"):
        raise InputError("--timeout", f"{timeout:g}", "a positive number of seconds")
    if not 0 <= repeats <= MAX_REPEATS:
        raise InputError("--repeats", repeats, f"a whole number from 0 to {MAX_REPEATS}")
    if plot is not None:
        from .verdicts.pictures import check_target

        check_target(plot)
    from .score import score as judge
    from .trajectory import read, read_stream, read_transits
    from .verdicts.document import document
    from .verdicts.verdict import lines

    zeros = None if transits is None else read_transits(transits)
    found: list[tuple[Candidate, Timing | None]] = [(read(name), None) for name in candidates or ()]
    made = []
    if run is not None:
        from .candidates.external import arguments, timed

        output, took = timed(arguments(run, scene), timeout, repeats)
        with output:
            found.append((read_stream(output, "the program"), took))
    if approximation is not None:
        from .approximations.candidate import candidate_of

        found.append((candidate_of(approximation, scene), None))
    for candidate, timing in found:
        with progress(f"solve {scene.id}", float(scene.run.t_end)) as report:
            result = judge(
                candidate,
                scene,
                transits=zeros,
                tolerance=tolerance,
                inputs=inputs.value,
                explain=not no_diagnosis,
                announce=_announce,
                report=report,
            )
        made.append(replace(result, timing=timing))
    if plot is not None:
        from .verdicts.pictures import error_picture

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


def _listed(text: str | None, field: str, known: Iterable[str]) -> list[str] | None:
    """The words of a comma-separated option, each of them known."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",") if word.strip()]
    allowed = list(known)
    for word in words or [""]:
        if word not in allowed:
            raise InputError(field, word, f"of {', '.join(allowed)}", "Separate several with commas.")
    return words


@contextmanager
def _counting(label: str) -> Iterator[Callable[[int, int, str], None]]:
    """A bar of measurements done on stderr where it is a terminal, else nothing."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done, total, now: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total, now: bar.update(task, completed=done, total=total, description=f"{label}: {now}")


def _announce(text: str) -> None:
    typer.echo(text, err=True)


@app.command()
def study(
    scene_word: SceneWord,
    methods: Annotated[str | None, typer.Option("--methods", metavar="A,B,…", help="Ids; all by default.")] = None,
    precisions: Annotated[
        str | None, typer.Option("--precisions", metavar="53,113,…", help="Bits: time against achieved digits.")
    ] = None,
    approximations: Annotated[
        bool, typer.Option("--approximations", help="The seeds' approximations instead: where each stops being good.")
    ] = False,
    run: Annotated[
        list[str] | None, typer.Option("--run", metavar="'COMMAND'", help="A program of yours; {setting} is its step.")
    ] = None,
    settings: Annotated[
        str, typer.Option("--settings", metavar="0.1,0.01,…", help="What {setting} of --run takes.")
    ] = "0.1,0.01",
    t_end: Annotated[str | None, typer.Option("--t-end", metavar="S", help="End of the span in s.")] = None,
    limit: Annotated[float, typer.Option("--limit", metavar="S", help="CPU seconds of one run.")] = 8.0,
    no_formulations: Annotated[
        bool, typer.Option("--no-formulations", help="Leave the comparison of formulations out.")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="CSV, JSON and an HTML page.")] = None,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Report error against run time: every method over its settings, in one run; resumes with the same --out."""
    changes = [*(set_ or ()), *([] if t_end is None else [f"run.t_end={t_end}"])]
    scene = load_scene(scene_word, changes)
    if not 0 < limit < float("inf"):
        raise InputError("--limit", f"{limit:g}", "a positive number of seconds")
    if approximations:
        _study_approximations(scene, out, as_json)
        return
    from .methods import EXTERNAL, METHODS
    from .study import plan, single_thread
    from .study import study as measure

    single_thread()
    problem, digits = scene, None
    items = plan(scene, _listed(methods, "--methods", METHODS), not no_formulations)
    if precisions is not None:
        from .measuring.precisions import bits_of, precision_items, precision_scene

        bits = bits_of(precisions)
        items = precision_items(bits)
        problem, digits = precision_scene(scene, bits, whole=t_end is not None)
    for command in run or ():
        items += [(f"{EXTERNAL}{command}", "momentum", setting) for setting in _numbers(settings, "--settings")]
    with _counting(scene.id) as report:
        found = measure(
            problem,
            items=items,
            limit_s=limit,
            kept=_inside(out, "rows.jsonl"),
            digits=digits,
            report=report,
            announce=_announce,
        )
    _shown(found.document(), out, as_json)


def _study_approximations(scene: Scene, out: Path | None, as_json: bool) -> None:
    from .pages import approximation_report

    made = approximation_report.document(scene)
    if out is not None:
        approximation_report.write(scene, made, out)
    if as_json:
        emit(made)
        return
    typer.echo(approximation_report.text_table(made))
    if out is not None:
        typer.echo(f"{out / approximation_report.PAGE}: the report")


def _numbers(text: str, field: str) -> list[float]:
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        found = []
    if not found or not all(0 < value < float("inf") for value in found):
        raise InputError(field, text, "positive numbers", "Separate several with commas.")
    return found


def _shown(document: dict[str, Any], out: Path | None, as_json: bool) -> None:
    from .report import text_table, write_report

    if out is not None:
        write_report(document, out)
    if as_json:
        emit(document)
        return
    typer.echo(text_table(document))
    if out is not None:
        typer.echo(f"{out / 'index.html'}: the report")


@app.command()
def stability(
    scenes: Annotated[
        str | None, typer.Option("--scenes", metavar="A,B,…", help="Ids; all with flags by default.")
    ] = None,
    methods: Annotated[str | None, typer.Option("--methods", metavar="A,B,…", help="Ids; all by default.")] = None,
    limit: Annotated[float, typer.Option("--limit", metavar="S", help="CPU seconds of one run.")] = 3.0,
    long: Annotated[
        bool, typer.Option("--long", help="Also the growth of errors over 30 days (minutes more).")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="CSV, JSON and an HTML page.")] = None,
    as_json: AsJson = False,
) -> None:
    """Every method on stiff and extreme scenes: digits kept, or how it failed; resumes with the same --out."""
    from .measuring.longrun import over_thirty_days
    from .methods import METHODS
    from .pages import stability_report
    from .stability import default_scenes
    from .stability import stability as measure
    from .study import machine, single_thread

    if not 0 < limit < float("inf"):
        raise InputError("--limit", f"{limit:g}", "a positive number of seconds")
    single_thread()
    chosen = _listed(scenes, "--scenes", scene_ids()) or default_scenes()
    wanted = _listed(methods, "--methods", METHODS)
    with _counting("stability") as report:
        cells = measure(chosen, wanted, limit_s=limit, kept=_inside(out, "cells.jsonl"), report=report)
        runs = over_thirty_days(wanted, kept=_inside(out, "long.jsonl"), report=report) if long else []
    made = stability_report.document(cells, runs, machine())
    if out is not None:
        stability_report.write(made, cells, runs, out)
    if as_json:
        emit(made)
        return
    typer.echo(stability_report.text_table(cells, runs))
    if out is not None:
        typer.echo(f"{out / stability_report.PAGE}: the report")


def _inside(folder: Path | None, name: str) -> Path | None:
    return None if folder is None else folder / name


register_pend(app)
register_paper(app)
