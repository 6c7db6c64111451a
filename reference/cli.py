"""Commands that make the truth: scenes, show, generate, verify. Results on stdout, progress on stderr."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from .errors import InputError
from .scene import LEVELS, Scene, data_root, load_scene, scene_ids

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)

Level = StrEnum("Level", list(LEVELS))  # type: ignore[misc]  # the functional form is fine at run time


class Engine(StrEnum):
    """What integrates; auto is limbs where numba is installed."""

    auto = "auto"
    heyoka = "heyoka"
    limbs = "limbs"


SceneWord = Annotated[str, typer.Argument(metavar="SCENE", help="A scene's id, or the path of a TOML file.")]
Assignments = Annotated[
    list[str] | None, typer.Option("--set", metavar="section.key=value", help="Replace one field of the scene.")
]
AsJson = Annotated[bool, typer.Option("--json", help="One JSON document on stdout, nothing else.")]


def emit(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(json.dumps(document, indent=1, ensure_ascii=False))


@contextmanager
def progress(label: str, total: float) -> Iterator[Callable[[float], None] | None]:
    """A bar with the simulated time on stderr, or None where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:,.0f} of {task.total:,.0f} s simulated"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=total)
        yield lambda t: bar.update(task, completed=t)


@app.command()
def scenes(as_json: AsJson = False) -> None:
    """List the scenes that come with the project."""
    found = [load_scene(name) for name in scene_ids()]
    if as_json:
        emit({"scenes": [scene.model_dump(exclude_none=True) for scene in found]})
        return
    width = max((len(scene.id) for scene in found), default=0)
    for scene in found:
        flags = f"  [{', '.join(scene.flags)}]" if scene.flags else ""
        typer.echo(f"{scene.id:{width}}  {scene.title}{flags}")


@app.command()
def show(
    scene_word: SceneWord,
    equations: Annotated[bool, typer.Option("--equations", help="The compiled lines, and what was left out.")] = False,
    sensitivity: Annotated[
        bool, typer.Option("--sensitivity", help="How many digits the flow costs between release and end.")
    ] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Show a scene: its inputs, what follows from them, and with --equations what is compiled for it."""
    scene = load_scene(scene_word, set_ or ())
    document: dict[str, Any] = {**scene.model_dump(exclude_none=True), "derived": _derived(scene)}
    if equations:
        from .equations import lines_and_left_out

        document["equations"], document["left_out"] = lines_and_left_out(scene, "momentum")
    if sensitivity:
        from .growth import digits_lost

        document["digits_lost"] = round(digits_lost(scene.exact, tuple(scene.exact.grid)), 1)
    if as_json:
        emit(document)
        return
    from .render import scene_inputs

    typer.echo(f"{scene.id}: {scene.title}")
    if scene.source:
        typer.echo(f"source: {scene.source}")
    typer.echo(f"inputs are read as: {scene.inputs}")
    for section, table in scene_inputs(scene).items():
        typer.echo(f"[{section}] " + ", ".join(f"{key} = {value}" for key, value in table.items()))
    typer.echo("[derived] " + ", ".join(f"{key} = {value}" for key, value in document["derived"].items()))
    if sensitivity:
        lost = document["digits_lost"]
        typer.echo(f"sensitivity: the flow costs {lost:.1f} digits between release and end: for n digits of a result")
        typer.echo(f"  the inputs have to be right to n + {lost:.1f}")
    if equations:
        typer.echo("compiled (momentum form; n = r/l, H = n × (n' + Ω × n), c = pull/l):")
        for line in document["equations"]:
            typer.echo(f"  {line}")
        typer.echo("left out:")
        for line in document["left_out"] or ["nothing"]:
            typer.echo(f"  {line}")


def _derived(scene: Scene) -> dict[str, str]:
    """Distance from the axis, apparent gravity at the pivot, rest position, small-swing period; 15 digits."""
    from .constants import constants
    from .mechanics import rest_position
    from .precision import context

    ctx = context(96)
    k = constants(scene.exact, ctx)

    def text(value: Any) -> str:
        return str(ctx.nstr(ctx.mpf(value), 15))

    derived = {"axis_distance_m": text(k.axis_distance * k.length)}
    strength = ctx.sqrt(sum(part * part for part in k.pull))
    derived["pivot_gravity_m_s2"] = text(strength * k.length)
    if strength:
        derived["small_swing_period_s"] = text(2 * ctx.pi / ctx.sqrt(strength))
    try:
        _, y, z = rest_position(k, ctx)
    except ValueError:
        return derived
    return derived | {"rest_y_m": text(y * k.length), "rest_z_m": text(z * k.length)}


@app.command()
def generate(
    scene_word: SceneWord,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="The dataset's folder.")] = None,
    t_end: Annotated[str | None, typer.Option("--t-end", metavar="S", help="End of the run in s.")] = None,
    digits: Annotated[str | None, typer.Option("--digits", metavar="D", help="Digits of each column.")] = None,
    level: Annotated[Level | None, typer.Option("--level", metavar="L", help=", ".join(LEVELS))] = None,
    engine: Annotated[Engine, typer.Option("--engine", help="What integrates.")] = Engine.auto,
    no_transits: Annotated[bool, typer.Option("--no-transits", help="Do not look for xdot = 0.")] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene and write its golden dataset."""
    from .engines import engine_of
    from .golden import read_manifest
    from .publish import check_target, default_folder, write

    asked = {"t_end": t_end, "digits": digits, "level": level, "transits": "false" if no_transits else None}
    changes = [*(set_ or ()), *(f"run.{key}={value}" for key, value in asked.items() if value is not None)]
    scene = load_scene(scene_word, changes)
    as_shipped = scene_word in scene_ids() and not set_ and t_end is None and not no_transits
    folder = out or default_folder(scene, as_shipped or set_ == ["inputs=binary64"])
    check_target(folder)
    from .solver import solve

    with progress(scene.id, float(scene.exact.t_end)) as report:
        solution = solve(scene, engine=engine.value, report=report)
    write(solution, folder)
    count = len(solution.directions)
    bound = read_manifest(folder).bounds.position_m
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
                "engine": engine_of(solution.run.number),
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


@app.command()
def verify(
    paths: Annotated[list[str] | None, typer.Argument(metavar="[PATH]...", help="Datasets; all by default.")] = None,
    recompute: Annotated[bool, typer.Option("--recompute", help="Solve again and compare every byte.")] = False,
    as_json: AsJson = False,
) -> None:
    """Check datasets: schema, hashes, physics; with --recompute the same bytes again."""
    from .golden import golden_folder, read_manifest, scene_of
    from .publish import recompute as recomputed
    from .verify import problems_of

    folders = [golden_folder(path) for path in paths or ()] or sorted((data_root() / "golden").glob("[a-z]*"))
    if not folders:
        raise InputError("PATH", "nothing", "a golden dataset", "Make one with `foucault generate`.")
    rows = []
    for folder in folders:
        problems = problems_of(folder)
        if recompute and not problems:
            with progress(folder.name, float(scene_of(read_manifest(folder)).exact.t_end)) as report:
                problems = recomputed(folder, report)
        rows.append({"path": str(folder), "ok": not problems, "problems": problems})
        if not as_json:
            typer.echo(f"{folder}: {'ok' if not problems else 'WRONG'}")
            for problem in problems:
                typer.echo(f"  {problem}")
    if as_json:
        emit({"rows": rows})
    if not all(row["ok"] for row in rows):
        raise typer.Exit(1)
