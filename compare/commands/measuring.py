"""`foucault score` of what is measured: passages of a section; and files, where inputs are uncertain."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from reference import InputError, Ranges, Scene, load_ranges
from reference.commands.progress import progress
from reference.commands.terminal import emit, refuse, stoppable
from reference.dataset.place import RANGES, golden_folder
from reference.solver.ranges import Intervals
from reference.solver.widths import exact_texts, widths_of

from ..candidates.layout import Naming
from ..candidates.read import read, read_transits
from ..score.measured import APART, measured
from ..score.passages import score_passages
from .options import announce


def ranges_named(word: str | None) -> Ranges | None:
    """Return the ranges that a word names, an id or a folder; None if it names none."""
    folder = None if word is None else golden_folder(word)
    return load_ranges(folder) if folder is not None and (folder / RANGES).is_file() else None


def ranges_to_prove(scene: Scene, widths: dict[str, str]) -> Ranges:
    """Return ranges that have no times yet.

    Raises:
        InputError: an input, or a width.
    """
    return Ranges(scene, exact_texts(widths_of(scene, widths)), (), Intervals((), ()), Intervals((), ()), [], (), "")


def hold(
    files: list[str],
    transits: str | None,
    section: str | None,
    ranges: Ranges,
    naming: Naming,
    tolerance: float | None,
    as_json: bool,
) -> None:
    """Hold files, or transits alone, against ranges, and print what comes of it; exit status 1 where one disagrees."""
    if not files and transits is None:
        raise InputError("CANDIDATE", "nothing", "a file, - for stdin, or --transits", "Name what was measured.")
    if section is not None:
        section = _word(section, transits, ranges.scene)
    times, found = None if transits is None else read_transits(transits, naming.units), []
    names: list[str | None] = [*files] or [None]
    for file in names:
        rows = None if file is None else read(Path(file), columns=naming.columns, units=naming.units)
        with stoppable("nothing was written"), progress() as show:
            report: Any = show(f"the proof of {ranges.scene.id}", float(ranges.scene.exact.t_end))
            found.append(measured(rows, times, ranges, tolerance or 0.0, str(transits), report, section))
    if as_json:
        emit(found[0].document() if len(found) == 1 else {"rows": [one.document() for one in found]})
    else:
        for line in (line for one in found for line in one.lines()):
            typer.echo(line)
    if any(one.verdict == APART for one in found):
        raise typer.Exit(1)


def hold_passages(
    transits: str | None, section: str, scene: Scene, naming: Naming, tolerance: float | None, as_json: bool
) -> None:
    """Score the passages of a section, and print what comes of it; exit status 1 where they disagree."""
    section = _word(section, transits, scene)
    times = read_transits(str(transits), naming.units)
    with stoppable("nothing was written"), progress() as show:
        report = show(f"the truth of {scene.id}", float(scene.exact.t_end))
        found = score_passages(str(transits), times, scene, section, tolerance, announce, report)
    if as_json:
        emit(found.document())
    else:
        for line in found.lines():
            typer.echo(line)
    if not found.agrees:
        raise typer.Exit(1)


def _word(section: str, transits: str | None, scene: Scene) -> str:
    """Return the word of the one section that transits are passages of, as scenes write it."""
    if transits is None:
        refuse({"--section": section}, "without --transits")
    words = scene.with_values({"run.sections": section}).run.sections or ()
    if len(words) != 1:
        raise InputError("--section", section, "one section", "Score the passages of each by themselves.")
    return words[0]
