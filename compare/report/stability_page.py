"""Report of `foucault stability`: silently wrong runs first, its charts, reasons of failures, and long runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from statistics import median
from typing import Any

from pydantic import TypeAdapter

from reference import load_scene
from reference.plain_text import shortened
from reference.status import Status

from ..studies.campaign import machine
from ..studies.long_runs import LongRun, laws
from ..studies.stability import WRONG, Cell
from ..studies.users_program import NUMBER
from .folder import Report
from .page import Html, PageTable, facts, figure, findings, page, paragraph, section
from .pareto import tidy
from .stability_charts import LETTERS, error_growth, heat_map
from .study_tables import LONGEST_COMMAND, advice, busy, cpu, setting, words

COUNTED = (Status.SILENTLY_WRONG, Status.ILL_CONDITIONED)
NOT_TRIED = (Status.NOT_INSTALLED, Status.REFUSED, Status.UNREACHABLE)
_LEAD_OF_PROGRAMS = (
    "; a program of --run for a millionth of the amplitude, as `foucault score` asks for"
)
PAIRS = (("scipy_radau", "scipy_dop853"), ("scipy_bdf", "scipy_rk45"), ("cvode_bdf", "cvode_adams"))


def document_of(
    cells: Sequence[Cell], runs: Sequence[LongRun], programs: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Return the JSON document of the command."""
    return {
        "programs": dict(programs or {}),
        "rows": [asdict(cell) for cell in cells],
        **{status.value: sum(cell.status == status for cell in cells) for status in COUNTED},
        "long_runs": [run.document() for run in runs],
        "machine": machine(),
    }


def headlines(cells: Sequence[Cell]) -> list[str]:
    """Return the main results as sentences: the methods' own failures first, then what no method could have kept."""
    wrong = [cell for cell in cells if cell.status == Status.SILENTLY_WRONG]
    tried = [cell for cell in cells if cell.status not in NOT_TRIED]
    runs = Counter(map(_named(cells), wrong))
    sentences = [
        *_programs_broken(cells),
        f"{len(wrong)} of {len(tried)} runs{_not_tried(cells)} are silently wrong: they report "
        f"success, but the error is over {WRONG} times what was asked for, and over what the motion makes of such an "
        "error at the release.",
    ]
    magnified = [cell for cell in tried if cell.status == Status.ILL_CONDITIONED]
    if magnified:
        where = Counter(cell.scene for cell in magnified)
        scenes = ", ".join(f"{name} ({count})" for name, count in where.most_common())
        sentences.append(
            f"{len(magnified)} more are as far off because the motion itself magnifies what was asked by more than "
            f"the error: {scenes}."
        )
    if runs:
        worst = ", ".join(f"{name} ({count})" for name, count in runs.most_common(6))
        sentences.append(f"Silently wrong most often: {worst}.")
    return sentences + list(_stiffness(cells))


def _not_tried(cells: Sequence[Cell]) -> str:
    """Return in brackets how many cells have no run, and why; "" if all have one."""
    counts = Counter(cell.status.words for cell in cells if cell.status in NOT_TRIED)
    return (
        f" ({', '.join(f'{count} more were {words}' for words, count in counts.items())})"
        if counts
        else ""
    )


def _named(cells: Sequence[Cell]) -> Callable[[Cell], str]:
    """Return a function that names a cell's run: its method, with the formulation where that method has several."""
    several = Counter(method for method, _ in {(cell.method, cell.precision) for cell in cells})
    return lambda cell: f"{cell.method}{f', {cell.precision}' if several[cell.method] > 1 else ''}"


def _programs_broken(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield for each program of the user's a sentence: on which scenes it breaks, and how."""
    for name in dict.fromkeys(cell.method for cell in cells if cell.precision == NUMBER):
        tried = [cell for cell in cells if cell.method == name and cell.status not in NOT_TRIED]
        breaks = []
        for cell in tried:
            if cell.status != Status.OK:
                how = (
                    cell.status.words
                    if cell.wrong_from_s is None
                    else f"wrong from t = {cell.wrong_from_s:g} s on"
                )
                breaks.append(f"{cell.scene} ({how})")
        yield f"{name} breaks on {len(breaks)} of {len(tried)} scenes{': ' if breaks else ''}{', '.join(breaks)}."


def _stiffness(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield for each pair a sentence: is the implicit method cheaper on stiff scenes, and more expensive on others?"""
    costs = {(cell.scene, cell.method): cell.cpu_s for cell in cells if cell.cpu_s}
    stiff = {
        scene for scene in {cell.scene for cell in cells} if "stiff" in load_scene(scene).flags
    }
    for implicit, explicit in PAIRS:
        ratios: dict[bool, list[float]] = {True: [], False: []}
        for (scene, method), cpu_s in costs.items():
            if method == implicit and (scene, explicit) in costs:
                ratios[scene in stiff].append(costs[scene, explicit] / cpu_s)
        if ratios[True] and ratios[False]:
            yield (
                f"{implicit} compared with {explicit}, median CPU time: {_times(median(ratios[True]))} on stiff scenes "
                f"({len(ratios[True])} of them), {_times(median(ratios[False]))} on the others ({len(ratios[False])})."
            )


def _times(gain: float) -> str:
    factor = f"{float(f'{max(gain, 1 / gain):.2g}'):g}"
    return f"{factor} times {'cheaper' if gain >= 1 else 'more expensive'}"


def _parsed(document: dict[str, Any]) -> tuple[list[Cell], list[LongRun]]:
    cells, runs = TypeAdapter(list[Cell]), TypeAdapter(list[LongRun])
    return cells.validate_python(document["rows"]), runs.validate_python(document["long_runs"])


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML."""
    cells, runs = _parsed(document)
    letters = "; ".join(f"{letter}: {status.words}" for status, letter in LETTERS.items())
    kept = f"Digits of the amplitude that a run kept, rounded down, or a letter for how it failed. {letters}."
    failures = [cell for cell in cells if cell.reason and cell.status != Status.NOT_INSTALLED]
    wrong, magnified = ([cell for cell in failures if cell.status == status] for status in COUNTED)
    parts = [
        section("Findings", findings(headlines(cells))),
        section("Digits kept", figure(heat_map(cells), kept)),
        section("Silently wrong", _runs(wrong, reasons=True)),
    ]
    if magnified:
        parts.append(
            section("Ill-conditioned: the motion magnifies errors", _runs(magnified, reasons=True))
        )
    parts += [
        section(
            "Other failures",
            _runs([cell for cell in failures if cell.status not in COUNTED], reasons=True),
        ),
        section("What each run was asked for, and what it kept", _runs(cells)),
        section("What the words mean", words({cell.status for cell in cells})),
        section("Scenes", _scenes(cells)),
    ]
    measured = [run for run in runs if run.exponent is not None]
    if measured:
        caption = "Largest position error so far against time, with the slopes of t, t^1.5 (Brouwer's law) and t²."
        picture = figure(error_growth(measured), caption)
        parts.append(section("Long runs", picture, findings(laws(runs))))
    programs = document["programs"]
    if programs:
        rows = [(name, shortened(command, LONGEST_COMMAND)) for name, command in programs.items()]
        parts.append(
            section("Programs", PageTable({"name": "wrapped", "command": "wrapped"}, rows).html())
        )
    parts.append(section("Measured on", facts({**document["machine"], "load": busy(cells)})))
    lead = paragraph(
        "Each method was asked for the same number of digits on every scene, and its result was compared with the "
        f"reference solution{_LEAD_OF_PROGRAMS if programs else ''}."
    )
    return page("Stiff and extreme scenes: what breaks, and when", parts, lead=lead)


def _runs(cells: Sequence[Cell], reasons: bool = False) -> Html:
    """Return runs, the digits that they were asked for and kept, and on demand why they failed."""
    if not cells:
        return paragraph("None.")
    texts, numbers = (
        ("scene", "method", "precision", "setting", "status"),
        ("asked for", "kept", "CPU s"),
    )
    columns = (
        dict.fromkeys(texts, "")
        | dict.fromkeys(numbers, "number")
        | ({"reason": "prose"} if reasons else {})
    )
    rows = []
    for cell in cells:
        kept = "" if cell.digits is None else f"{cell.digits:.1f}"
        run = (cell.scene, cell.method, cell.precision, setting(cell), cell.status.words)
        rows.append((*run, f"{cell.asked:.1f}", kept, cpu(cell.cpu_s), cell.reason)[: len(columns)])
    return PageTable(columns, rows).html()


def _scenes(cells: Sequence[Cell]) -> Html:
    rows = []
    for name in dict.fromkeys(cell.scene for cell in cells):
        scene = load_scene(name)
        statuses = [cell.status for cell in cells if cell.scene == name]
        correct, failed = (
            statuses.count(Status.OK),
            sum(status not in (Status.OK, *NOT_TRIED) for status in statuses),
        )
        rows.append((name, scene.title, ", ".join(scene.flags), correct, failed))
    columns = {
        "scene": "",
        "description": "prose",
        "flags": "prose",
        "correct": "number",
        "failed": "number",
    }
    return PageTable(columns, rows).html()


def text_table(document: dict[str, Any]) -> str:
    """Return main results and one line for each method, as text for a terminal."""
    cells, runs = _parsed(document)
    present = [status for status in Status if status in {cell.status for cell in cells}]
    rows = []
    for method, precision in dict.fromkeys((cell.method, cell.precision) for cell in cells):
        group = [cell for cell in cells if (cell.method, cell.precision) == (method, precision)]
        counts = Counter(cell.status for cell in group)
        outcomes = [counts[status] or "" for status in present]
        rows.append((method, precision, _settings(group), f"{group[0].asked:.1f}", *outcomes))
    numbers = ("setting", "asked", *(status.words for status in present))
    table = PageTable({"method": "", "precision": "", **dict.fromkeys(numbers, "number")}, rows)
    lines = [*headlines(cells), f"load: {busy(cells)}", "", *table.lines()]
    return "\n".join([*lines, "", *advice(present), *([""] if runs else []), *laws(runs)])


def _settings(cells: Sequence[Cell]) -> str:
    """Return the setting of a method's cells, or from which to which they go: steps are parts of a scene's times."""
    settings = sorted({cell.setting for cell in cells if cell.setting is not None})
    if not settings:
        return ""
    unit = {"step": " s", "precision": " bits"}.get(cells[0].kind, "")
    return "–".join(tidy(value) for value in dict.fromkeys((settings[0], settings[-1]))) + unit


REPORT = Report("stability.json", text_table, page_text)
