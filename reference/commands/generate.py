"""`foucault generate`: solve a scene and write its dataset, or make every one that ships."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..engines import AUTO, engine_names
from ..errors import NOTHING, InputError, counted, in_words
from ..scenes.fields import CONFIRMATIONS, LEVELS
from ..scenes.scene import load_scene, unit_of
from ..scenes.shipped import scene_ids
from ..system.channel import ACTIVITY
from .layout import Fact, echo, facts, heading, paragraph
from .options import Conflict, as_command, refuse_conflicts
from .progress import Move, Show, progress
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
    from ..dataset.making import Making
    from ..scenes.scene import Scene
    from ..solver.ranges import Ranges
    from ..solver.solution import Solution

_WRITING = "writing and checking the files"
_WRITING_SHARE = 0.15  # of the time that solving takes
_ENGINES = (AUTO, *engine_names())
# what a level enclosed is followed by
_CONFIRMED = {
    "whole": "; confirmed by a second run",
    "sampled": "; a sample confirmed by a second run",
    "none": "",
}
_NEXT = "Next: `foucault verify {}` checks it."

_SCENE = scene_argument(value="[SCENE]")
_OUT = option(
    "--out",
    "Write to this folder (default: golden/SCENE, or data/golden/SCENE in a checkout).",
    "DIR",
)
_DIGITS = option(
    "--digits",
    "Significant digits of the largest number in each column (default: the scene's).",
    "D",
)
_LEVEL = option(
    "--level",
    f"How far to trust the numbers: {in_words(LEVELS)} (default: the scene's).",
    "L",
    completion(lambda: LEVELS),
)
_ENGINE = option(
    "--engine",
    f"Integrate with {in_words(engine_names())}; auto: the fastest, or the engine that made the shipped dataset.",
    "E",
    completion(lambda: _ENGINES),
)
_NO_TRANSITS = option("--no-transits", "Do not look for transits, xdot = 0.")
_AUDIT = option(
    "--audit/--no-audit",
    "Check everything that compiled code returns for the proof (default: --audit).",
)
_CONFIRM = option(
    "--confirm",
    f"How much of a proof heyoka confirms: {in_words(CONFIRMATIONS)}; sampled is a tenth of the grid's intervals "
    "(default: sampled; whole for shipped scenes).",
    "C",
    completion(lambda: CONFIRMATIONS),
)
_NO_CONFIRM = option("--no-confirm", "The same as --confirm none.", hidden=True)
_FUNCTION = option(
    "--function/--no-function",
    "Make the golden function of a proof, the motion at any time (default: yes, unless shipped without it).",
)
_NO_TABLES = option("--no-tables", "Write only the golden function.")
_ALL = option("--all", "Make the shipped datasets that are missing or not sealed.")


@dataclass(frozen=True)
class _GenerateOptions:
    """The options of `foucault generate`, and scene, folder and making that follow from them."""

    scene_word: Annotated[str | None, _SCENE] = None
    out: Annotated[Path | None, _OUT] = None
    t_end: EndTime = None
    digits: Annotated[str | None, _DIGITS] = None
    level: Annotated[str | None, _LEVEL] = None
    engine: Annotated[str, _ENGINE] = AUTO
    no_transits: Annotated[bool, _NO_TRANSITS] = False
    section: Sections = None
    audit: Annotated[bool | None, _AUDIT] = None
    confirm: Annotated[str | None, _CONFIRM] = None
    no_confirm: Annotated[bool, _NO_CONFIRM] = False
    function: Annotated[bool | None, _FUNCTION] = None
    no_tables: Annotated[bool, _NO_TABLES] = False
    set_: Assignments = None
    uncertain: Uncertain = None
    every: Annotated[bool, _ALL] = False
    workers: Workers = None
    cluster: Cluster = None
    as_json: AsJson = False

    @property
    def replaced(self) -> list[str]:
        """The fields of the scene that are replaced, by --set and by options of their own."""
        if self.level:
            chosen("--level", self.level, LEVELS)
        fields = {
            "--t-end": ("run.t_end", self.t_end),
            "--digits": ("run.digits", self.digits),
            "--level": ("run.level", self.level),
            "--no-transits": ("run.transits", "false" if self.no_transits else None),
            "--section": ("run.sections", ",".join(self.section) if self.section else None),
        }
        return replacements(self.set_, fields)

    @cached_property
    def scene(self) -> Scene:
        """The scene to solve, its fields replaced."""
        if self.scene_word is None:
            raise InputError(
                "SCENE", NOTHING, "a scene, or --all", "`foucault scenes` lists the scenes."
            )
        return load_scene(self.scene_word, self.replaced)

    @cached_property
    def widths(self) -> dict[str, str] | None:
        """The half-widths of uncertain inputs, by name; None if all inputs are exact."""
        return widths_by_name(self.uncertain, self.scene)

    @property
    def dataset_name(self) -> str:
        """The id of the scene's dataset, which names the fields that were replaced."""
        from ..dataset.place import dataset_id

        if self.scene_word in scene_ids():
            return dataset_id(self.scene)
        return dataset_id(self.scene, load_scene(str(self.scene_word)))

    @cached_property
    def folder(self) -> Path:
        """The folder that the scene's dataset is written to."""
        from ..dataset.place import default_folder

        return self.out or default_folder(self.scene, self.dataset_name)

    @property
    def making(self) -> Making:
        """How the dataset is made: by default (`making_of`), but for what an option chooses."""
        from ..dataset.making import making_of

        if self.confirm is not None:
            chosen("--confirm", self.confirm, CONFIRMATIONS)
        choices: dict[str, Any] = {
            "engine": None if self.engine == AUTO else self.engine,
            "audit": self.audit,
            "confirm": "none" if self.no_confirm else self.confirm,
            "function": self.function,
        }
        choices = {name: value for name, value in choices.items() if value is not None}
        usual = making_of(self.scene, self.dataset_name, self.folder)
        making = replace(usual, **choices, tables=usual.tables and not self.no_tables)

        # the index, too, may leave the tables out
        if not (making.tables or making.function):
            refuse({"--no-tables": True}, "without --function")
        return making


_OF_A_PROOF = "--audit --no-audit --confirm --no-confirm --function --no-function --no-tables"
# in this order: the scene is read where a case first depends on it
_CONFLICTS = (
    Conflict(
        f"SCENE --no-transits {_OF_A_PROOF} --set --section --uncertain",
        "with --all",
        lambda options: options.every,
    ),
    Conflict("--engine", "with --all", lambda options: options.every and options.engine != AUTO),
    Conflict("--workers --cluster", "without --all", lambda options: not options.every),
    Conflict(
        f"--digits {_OF_A_PROOF}",
        BESIDE_RANGES,
        lambda options: not options.every and options.widths,
    ),
    Conflict(
        _OF_A_PROOF,
        "without --level enclosed",
        lambda options: not options.every and options.scene.run.level != "enclosed",
    ),
    Conflict("--confirm", "with --no-confirm", lambda options: options.no_confirm),
)


def _generate(options: _GenerateOptions) -> None:
    """Solve a scene and write its golden dataset.

    If inputs are uncertain (--uncertain, or the scene's [uncertain]), it writes ranges: intervals that are proved
    for every value of these inputs.
    foucault generate --all --workers 2 makes all shipped datasets, in --out.
    """
    refuse_conflicts(options, _CONFLICTS)
    if options.every:
        _generate_all(options)
        return
    chosen("--engine", options.engine, _ENGINES)
    from .cautions import warn

    warn(options.scene, str(options.scene_word))
    if options.widths:
        _generate_ranges(options, options.widths)
    else:
        _generate_dataset(options)


command = as_command(_GenerateOptions, _generate)


def _generate_all(options: _GenerateOptions) -> None:
    """Make every dataset that ships and is missing or not sealed."""
    from .generate_all import generate_all

    generate_all(options.replaced, options.out, options.workers, options.cluster, options.as_json)


def _generate_dataset(options: _GenerateOptions) -> None:
    """Solve a scene, write its dataset, and print what was written.

    Raises:
        InputError: an option, or the folder.
        UnreachableError: the scene cannot be solved as asked; nothing is written.
    """
    from ..dataset.write import check_target, write

    making = options.making
    folder = options.folder
    check_target(folder)
    with progress() as show:
        solution = _solved(options, making, show)
        with stoppable("nothing half was written"):
            ACTIVITY.send(_WRITING)
            write(solution, folder, options.dataset_name, tables=making.tables)
    _print_dataset(solution, folder, options.as_json)


def _report(scene: Scene, show: Show) -> Move:
    """Return the report of a scene that is solved, after which its files are written."""
    t_end = float(scene.exact.t_end)
    return show(scene.id, t_end, later=_WRITING_SHARE * t_end)


def _solved(options: _GenerateOptions, making: Making, show: Show) -> Solution:
    """Return the solution of a scene in the way in which its dataset is made.

    Raises:
        InputError: --engine names an engine without the number type that suffices.
        UnreachableError: the scene cannot be solved as asked.
    """
    from ..solver.solve import solve

    scene = options.scene
    with stoppable("nothing was written"):
        solution = solve(scene, **making.solve_options(scene), report=_report(scene, show))
    run = solution.run
    if options.engine not in (AUTO, run.engine):
        advice = (
            f"So few digits need only numbers of type {run.number}, which {options.engine} lacks."
        )
        raise InputError("--engine", options.engine, f"{AUTO} or {run.engine}", advice)
    return solution


def _print_dataset(solution: Solution, folder: Path, as_json: bool) -> None:
    """Print what was written: rows, digits, level, bound, run and CPU time."""
    from ..dataset.write import summary

    measured = summary(solution, folder)
    if as_json:
        emit(measured)
        return

    heading(f"{folder}: written", wraps=False)
    typer.echo("")
    echo(facts(_dataset_facts(solution, measured)))
    typer.echo("")
    echo(paragraph(_NEXT.format(folder)))
    if solution.not_checked:
        unseen = "The proof finds all transits; no run with event detection confirms them"
        typer.echo(f"{unseen}: {solution.not_checked}", err=True)


def _dataset_facts(solution: Solution, measured: dict[str, Any]) -> Iterator[Fact]:
    """Yield what was written, and how it was made."""
    yield "grid", counted(len(solution.times), "row")
    undecided = f", {measured['possible']} undecided" if measured["possible"] else ""
    yield "transits", f"{measured['transits']}{undecided}"
    for word, zeros in solution.sections.items():
        yield word, counted(len(zeros.table), "passage")
    yield "digits", str(solution.scene.run.digits)
    confirmed = _CONFIRMED[measured["confirmed"]] if solution.proof else ""
    yield "level", f"{solution.level}{confirmed}"
    yield "positions", f"within {measured['bound_m']} m"
    run = solution.run
    yield "run", f"{run.formulation}, {run.number}, {counted(run.steps, 'step')}"
    yield "CPU", f"{solution.cpu_s:.2f} s: {_cpu_times(solution)}"


def _cpu_times(solution: Solution) -> str:
    """Return the CPU seconds of each part of a solution that took any."""
    seconds_by_part = {
        "run": solution.run.cpu_s,
        "checks": solution.check_s,
        "pilot": solution.pilot_s,
        "discarded": solution.discarded_s,
    }
    return ", ".join(
        f"{name} {seconds:.2f}" for name, seconds in seconds_by_part.items() if seconds
    )


def _generate_ranges(options: _GenerateOptions, widths: dict[str, str]) -> None:
    """Prove intervals for uncertain inputs, write them, and print what was written.

    Raises:
        InputError: an input, a width, the level, or the folder.
        UnreachableError: the box is too wide; nothing is written.
    """
    from ..dataset.place import GOLDEN, RANGES
    from ..dataset.ranges import ranges_id, write_ranges
    from ..dataset.write import check_target
    from ..solver.uncertain import prove_ranges

    if options.level not in (None, "enclosed"):
        expected = "enclosed, because inputs are uncertain"
        raise InputError("--level", options.level, expected, "Ranges are always proved.")
    if options.out is not None:
        check_target(options.out, RANGES)
    scene = options.scene
    with progress() as show:
        with stoppable("nothing was written"):
            report = _report(scene, show)
            ranges = prove_ranges(scene, widths, engine=options.engine, report=report)
        folder = options.out or Path(GOLDEN, ranges_id(ranges))
        with stoppable("nothing half was written"):
            ACTIVITY.send(_WRITING)
            write_ranges(ranges, folder)
    _print_ranges(ranges, folder, options.as_json)


def _print_ranges(ranges: Ranges, folder: Path, as_json: bool) -> None:
    """Print what was written: rows, the box, undecided intervals, passages, period and CPU time."""
    from ..dataset.ranges import period_texts, ranges_id

    counts = {
        "grid": len(ranges.times),
        "transits": len(ranges.transits),
        "possible": len(ranges.possible),
    }
    period = period_texts(ranges)
    if as_json:
        emit({"dataset": ranges_id(ranges), "out": str(folder), "period_s": period, **counts})
        return

    heading(f"{folder}: written", wraps=False)
    typer.echo("")
    echo(facts(_ranges_facts(ranges, period)))
    typer.echo("")
    echo(paragraph(_NEXT.format(folder)))


def _ranges_facts(ranges: Ranges, period: list[str] | None) -> Iterator[Fact]:
    """Yield what was proved and written, for which inputs, and how wide it is."""
    for name, width in ranges.uncertain.items():
        yield "for every", f"{name} ±{width} {unit_of(name)}".rstrip()
    yield "grid", counted(len(ranges.times), "row")
    yield "transits", _count(len(ranges.transits), len(ranges.possible))
    for word, passages in ranges.sections.items():
        yield word, _count(len(passages.table), len(passages.possible))
    yield "level", "enclosed"
    if period:
        low, high = period
        yield "period", f"{low} to {high} s"
    yield "positions", _width_at_the_end(ranges)
    yield "CPU", f"{ranges.proof.cpu_s:.2f} s"


def _count(decided: int, possible: int) -> str:
    """Return how many zeros are decided, and how many intervals are left open."""
    if not possible:
        return str(decided)
    return f"{decided}, and {counted(possible, 'interval')} that may contain more"


def _width_at_the_end(ranges: Ranges) -> str:
    """Return how closely the last position is known, in words where that says nothing."""
    from ..numbers.columns import POSITION

    widths = []
    for name in POSITION:
        low, high = ranges.grid.exact(name)[-1]
        widths.append(high - low)
    widest = max(widths)
    text = f"{float(widest):.2g} m wide at the end"
    if widest > ranges.scene.exact.length:
        return f"useless: {text}, wider than the cord is long"
    return text
