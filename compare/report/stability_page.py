"""Report of `foucault stability`: silently wrong runs first, its charts, reasons of failures, and long runs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import median
from typing import Any

from pydantic import TypeAdapter

from reference import load_scene
from reference.commands.layout import paragraph as as_lines
from reference.plain_text import shortened
from reference.solver.doubles import double_reach
from reference.status import Status

from ..studies.campaign import machine
from ..studies.long_runs import LongRun, laws
from ..studies.stability import WRONG, Cell
from ..studies.users_program import DIGITS, NUMBER
from .folder import Report
from .page import Html, PageTable, facts, figure, findings, page, paragraph, section
from .pareto import tidy
from .stability_charts import LETTERS, LONGEST_NAME, error_growth, heat_map
from .study_tables import LONGEST_COMMAND, advice, busy, cpu, setting, words

_COUNTED = (Status.SILENTLY_WRONG, Status.ILL_CONDITIONED)  # statuses with a count of their own
_NOT_TRIED = (Status.NOT_INSTALLED, Status.REFUSED, Status.UNREACHABLE)
_LEAD_OF_PROGRAMS = (
    f" A program of --run was asked for {DIGITS:g} digits: a millionth of the amplitude. Its CPU "
    "seconds are those of the whole process."
)
_LOST = math.log10(WRONG)  # digits below those asked for with which a run still counts as ok
_OK = (
    f"its error is at most {WRONG} times what was asked for, which is {_LOST:g} digits fewer "
    "(`foucault score` allows only a millionth of the amplitude)"
)
_PAIRS = (
    ("scipy_radau", "scipy_dop853"),
    ("scipy_bdf", "scipy_rk45"),
    ("cvode_bdf", "cvode_adams"),
)


def document_of(
    cells: Sequence[Cell], runs: Sequence[LongRun], programs: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Return the JSON document of the command."""
    statuses = Counter(cell.status for cell in cells)
    return {
        "programs": dict(programs or {}),
        "rows": [asdict(cell) for cell in cells],
        **{status.value: statuses[status] for status in _COUNTED},
        "long_runs": [run.document() for run in runs],
        "machine": machine(),
    }


def headlines(cells: Sequence[Cell]) -> list[str]:
    """Return the main results as sentences: failures of methods first, then ill-conditioned motions."""
    tried = [cell for cell in cells if cell.status not in _NOT_TRIED]
    wrong = [cell for cell in tried if cell.status == Status.SILENTLY_WRONG]
    magnified = [cell for cell in tried if cell.status == Status.ILL_CONDITIONED]
    sentences = list(_programs_broken(cells))
    sentences.append(
        f"{len(wrong)} of {len(tried)} runs{_not_tried(cells)} are silently wrong: they report "
        f"success, but the error is over {WRONG} times what was asked for, and over what the "
        "motion makes of such an error at the release."
    )
    if magnified:
        scenes = Counter(cell.scene for cell in magnified)
        sentences.append(
            f"{len(magnified)} more are as far off because the motion itself magnifies what was "
            f"asked by more than the error: {_ranking(scenes)}."
        )
    if wrong:
        methods = Counter(map(_run_names(cells), wrong))
        sentences.append(f"Silently wrong most often: {_ranking(methods, 6)}.")
    sentences += _stiffness(cells)
    return sentences


def _ranking(counts: Counter[str], most: int | None = None) -> str:
    """Return names with their counts, the most frequent first."""
    return ", ".join(f"{name} ({count})" for name, count in counts.most_common(most))


def _not_tried(cells: Sequence[Cell]) -> str:
    """Return in brackets how many cells have no run, and why; "" if all have one."""
    counts = Counter(cell.status.words for cell in cells if cell.status in _NOT_TRIED)
    if not counts:
        return ""
    reasons = ", ".join(f"{count} more were {words}" for words, count in counts.items())
    return f" ({reasons})"


def _run_names(cells: Sequence[Cell]) -> Callable[[Cell], str]:
    """Return a function that names a cell's method, with the precision if the method has several."""
    runs = {(cell.method, cell.precision) for cell in cells}
    precisions = Counter(method for method, _ in runs)

    def name(cell: Cell) -> str:
        if precisions[cell.method] > 1:
            return f"{cell.method}, {cell.precision}"
        return cell.method

    return name


def _programs_broken(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield for each program of the user's a sentence: on which scenes it breaks, and how."""
    for name in dict.fromkeys(cell.method for cell in cells if cell.precision == NUMBER):
        tried = [cell for cell in cells if cell.method == name and cell.status not in _NOT_TRIED]
        failures = [_failure(cell) for cell in tried if cell.status != Status.OK]
        listed = f": {', '.join(failures)}" if failures else ""
        yield f"{name} breaks on {len(failures)} of {len(tried)} scenes{listed}."


def _failure(cell: Cell) -> str:
    """Return the scene of a failed run, and in brackets how it failed."""
    if cell.wrong_from_s is None:
        return f"{cell.scene} ({cell.status.words})"
    return f"{cell.scene} (wrong from t = {cell.wrong_from_s:g} s on)"


def _stiffness(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield a sentence per pair of methods: how the costs compare on stiff scenes and on others."""
    costs = {(cell.scene, cell.method): cell.cpu_s for cell in cells if cell.cpu_s}
    scenes = {cell.scene for cell in cells}
    stiff = {scene for scene in scenes if "stiff" in load_scene(scene).flags}
    for implicit, explicit in _PAIRS:
        gains = {
            scene: costs[scene, explicit] / costs[scene, implicit]
            for scene in scenes
            if (scene, explicit) in costs and (scene, implicit) in costs
        }
        on_stiff = [gain for scene, gain in gains.items() if scene in stiff]
        on_others = [gain for scene, gain in gains.items() if scene not in stiff]
        if on_stiff and on_others:
            yield (
                f"{implicit} compared with {explicit}, median CPU time: "
                f"{_times(median(on_stiff))} on stiff scenes ({len(on_stiff)} of them), "
                f"{_times(median(on_others))} on the others ({len(on_others)})."
            )


def _times(gain: float) -> str:
    comparison = "cheaper" if gain >= 1 else "more expensive"
    two_digits = float(f"{max(gain, 1 / gain):.2g}")
    return f"{two_digits:g} times {comparison}"


def _cells_of(document: dict[str, Any]) -> list[Cell]:
    return TypeAdapter(list[Cell]).validate_python(document["rows"])


def _long_runs_of(document: dict[str, Any]) -> list[LongRun]:
    return TypeAdapter(list[LongRun]).validate_python(document["long_runs"])


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML."""
    cells = _cells_of(document)
    programs = document["programs"]
    parts = [
        section("Findings", findings(headlines(cells))),
        section("Digits kept", figure(heat_map(cells), _heat_map_caption())),
        *_failure_sections(cells),
        section("What each run was asked for, and what it kept", _runs(cells)),
        section("What the words mean", words({cell.status for cell in cells}, {Status.OK: _OK})),
        section("Scenes", _scenes(cells)),
        *_long_run_sections(_long_runs_of(document)),
    ]
    if programs:
        parts.append(section("Programs", _programs_table(programs)))
    parts.append(section("Measured on", facts({**document["machine"], "load": busy(cells)})))
    lead = paragraph(
        "Each method was asked for the same number of digits on every scene, and its result was "
        f"compared with the reference solution.{_LEAD_OF_PROGRAMS if programs else ''}"
    )
    return page("Stiff and extreme scenes: what breaks, and when", parts, lead=lead)


def _heat_map_caption() -> str:
    letters = "; ".join(f"{letter}: {status.words}" for status, letter in LETTERS.items())
    return (
        "Digits of the amplitude that a run kept, rounded down, or a letter for how it failed. "
        f"{letters}."
    )


def _failure_sections(cells: Sequence[Cell]) -> list[Html]:
    """Return the sections on silently wrong, ill-conditioned and other failed runs."""
    failures = [cell for cell in cells if cell.reason and cell.status != Status.NOT_INSTALLED]
    wrong = [cell for cell in failures if cell.status == Status.SILENTLY_WRONG]
    magnified = [cell for cell in failures if cell.status == Status.ILL_CONDITIONED]
    others = [cell for cell in failures if cell.status not in _COUNTED]
    parts = [section("Silently wrong", _runs(wrong, reasons=True))]
    if magnified:
        heading = "Ill-conditioned: the motion magnifies errors"
        parts.append(section(heading, _runs(magnified, reasons=True)))
    parts.append(section("Other failures", _runs(others, reasons=True)))
    return parts


def _long_run_sections(runs: Sequence[LongRun]) -> list[Html]:
    """Return the section on long runs; none if no growth of the error was measured."""
    measured = [run for run in runs if run.exponent is not None]
    if not measured:
        return []
    caption = (
        "Largest position error so far against time, with the slopes of t, t^1.5 (Brouwer's law) "
        "and t²."
    )
    picture = figure(error_growth(measured), caption)
    return [section("Long runs", picture, findings(laws(runs)))]


def _programs_table(programs: Mapping[str, str]) -> Html:
    rows = [(name, shortened(command, LONGEST_COMMAND)) for name, command in programs.items()]
    return PageTable({"name": "wrapped", "command": "wrapped"}, rows).html()


def _runs(cells: Sequence[Cell], reasons: bool = False) -> Html:
    """Return a table of runs: the digits asked for and kept, and if wanted why a run failed."""
    if not cells:
        return paragraph("None.")
    columns = dict.fromkeys(("scene", "method", "precision", "setting", "status"), "")
    columns |= dict.fromkeys(("asked for", "kept", "CPU s"), "number")
    if reasons:
        columns["reason"] = "prose"
    rows = []
    for cell in cells:
        run = (cell.scene, cell.method, cell.precision, setting(cell), cell.status.words)
        measured = (f"{cell.asked:.1f}", _kept(cell), cpu(cell.cpu_s))
        rows.append((*run, *measured, cell.reason) if reasons else (*run, *measured))
    return PageTable(columns, rows).html()


def _scenes(cells: Sequence[Cell]) -> Html:
    rows = []
    for name in dict.fromkeys(cell.scene for cell in cells):
        scene = load_scene(name)
        statuses = [cell.status for cell in cells if cell.scene == name]
        tried = [status for status in statuses if status not in _NOT_TRIED]
        correct = tried.count(Status.OK)
        failed = len(tried) - correct
        doubles = double_reach(scene).in_words
        rows.append((name, scene.title, ", ".join(scene.flags), doubles, correct, failed))
    columns = {
        "scene": "",
        "description": "prose",
        "flags": "prose",
        "in doubles, at best": "",
        "correct": "number",
        "failed": "number",
    }
    explained = paragraph(
        "In doubles, at best: how far a program can follow the whole scene if it rounds the inputs "
        "once and nothing else (docs/doubles.md)."
    )
    return Html(explained + PageTable(columns, rows).html())


def text_table(document: dict[str, Any]) -> str:
    """Return main results and one line for each method, as text for a terminal."""
    cells = _cells_of(document)
    runs = _long_runs_of(document)
    statuses = {cell.status for cell in cells}
    present = [status for status in Status if status in statuses]
    lines = []
    for text in headlines(cells):
        lines += as_lines(text, hanging="  ")
    lines += ["", *_outcome_table(cells, present).lines(keys=2), ""]
    for name in document["programs"]:
        lines += [*_program_lines(name, cells), ""]
    if Status.OK in present:
        lines += as_lines(f"ok: {_OK}.", hanging="  ")
    for text in advice(present):
        lines += as_lines(text, hanging="  ")
    for text in laws(runs):
        lines += ["", *as_lines(text, hanging="  ")]
    lines += ["", *as_lines(f"load: {busy(cells)}", hanging="  ")]
    return "\n".join(lines)


def _outcome_table(cells: Sequence[Cell], present: Sequence[Status]) -> PageTable:
    """Return a table of how many runs of each method have each of the outcomes."""
    rows = []
    for method, precision in dict.fromkeys((cell.method, cell.precision) for cell in cells):
        group = [cell for cell in cells if (cell.method, cell.precision) == (method, precision)]
        counts = Counter(cell.status for cell in group)
        outcomes = [counts[status] or "" for status in present]
        rows.append((method, precision, _settings(group), f"{group[0].asked:.1f}", *outcomes))
    numbers = ("setting", "asked", *(status.words for status in present))
    return PageTable({"method": "", "precision": "", **dict.fromkeys(numbers, "number")}, rows)


def _program_lines(name: str, cells: Sequence[Cell]) -> list[str]:
    """Return a line for each scene of a program: the digits that it kept, and how it failed, if it did."""
    own = [cell for cell in cells if cell.method == name and cell.precision == NUMBER]
    rows = []
    for cell in own:
        scene = shortened(Path(cell.scene).name, LONGEST_NAME)  # of a file without its folder
        rows.append((scene, setting(cell), _kept(cell), cell.status.words))
    columns = {name: "", "setting": "number", "digits kept": "number", "status": ""}
    lines = PageTable(columns, rows).lines()
    for cell in own:
        if cell.reason:
            lines += as_lines(f"{cell.scene}: {cell.reason}", "  ", hanging="  ")
    return lines


def _kept(cell: Cell) -> str:
    return "" if cell.digits is None else f"{cell.digits:.1f}"


def _settings(cells: Sequence[Cell]) -> str:
    """Return the setting of a method's cells, or its range: a step depends on the scene's times."""
    settings = sorted({cell.setting for cell in cells if cell.setting is not None})
    if not settings:
        return ""
    unit = {"step": " s", "precision": " bits"}.get(cells[0].kind, "")
    smallest = tidy(settings[0])
    largest = tidy(settings[-1])
    span = smallest if smallest == largest else f"{smallest}–{largest}"
    return span + unit


REPORT = Report("stability.json", text_table, page_text)
