"""Compare measurements with proven intervals for uncertain inputs, or passages of a section with the truth."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from reference import InputError, Ranges, Scene, load_ranges
from reference.commands.progress import progress
from reference.commands.terminal import emit, stoppable
from reference.dataset.place import RANGES, golden_folder
from reference.solver.ranges import Intervals
from reference.solver.uncertain import exact_texts, widths_of

from ..candidates.candidate import Candidate, Passages
from ..candidates.names import Naming
from ..candidates.read import read, read_transits
from ..score.measured import DISAGREES, Measured, measured
from ..score.passages import PassageScore, score_passages
from ..truth import Progress
from .options import announce

_STOPPED = "nothing was written"  # what an interruption leaves


def ranges_named(word: str | None) -> Ranges | None:
    """Return the ranges with an id or in a folder; None if there are none."""
    folder = None if word is None else golden_folder(word)
    if folder is None or not (folder / RANGES).is_file():
        return None
    return load_ranges(folder)


def ranges_to_prove(scene: Scene, widths: dict[str, str]) -> Ranges:
    """Return ranges that are still to be proved, without times.

    Raises:
        InputError: an input, or a width.
    """
    uncertain = exact_texts(widths_of(scene, widths))
    return Ranges(scene, uncertain, (), Intervals((), ()), {}, "")


def passages_of(file: str, section: str | None, scene: Scene, naming: Naming) -> Passages:
    """Read passages of a section, or transits, from a file.

    Raises:
        InputError: the file cannot be read, or the word is not that of one section.
    """
    word = None if section is None else _section_word(section, scene)
    return Passages(file, read_transits(file, naming.units), word)


def _section_word(section: str, scene: Scene) -> str:
    """Return the word of one section as scenes write it.

    Raises:
        InputError: it is no section, or it is several.
    """
    words = scene.with_values({"run.sections": section}).run.sections or ()
    if len(words) != 1:
        raise InputError(
            "--section", section, "one section", "Score the passages of each section by themselves."
        )
    return words[0]


def compare_with_ranges(
    files: Sequence[str],
    passages: Passages | None,
    ranges: Ranges,
    tolerance_m: float,
    naming: Naming,
) -> list[Measured]:
    """Compare each file of rows, or passages alone, with ranges.

    Args:
        files: rows of positions.
        passages: of a section, or transits.
        ranges: those that ship, or ranges without times, which are proved now.
        tolerance_m: how far outside a number of a row may be.
        naming: what the user says of the columns of files.

    Raises:
        InputError: no file is given, or one cannot be read or compared.
    """
    candidates: list[Candidate | None] = [None]
    if files:
        candidates = [read(file, columns=naming.columns, units=naming.units) for file in files]

    scores = []
    for candidate in candidates:
        with stoppable(_STOPPED), progress() as show:
            report = show(f"the proof of {ranges.scene.id}", float(ranges.scene.exact.t_end))
            scores.append(measured(candidate, passages, ranges, tolerance_m, report))
    return scores


def compare_passages(passages: Passages, scene: Scene, tolerance_m: float | None) -> PassageScore:
    """Compare passages of a section with those of a scene.

    Raises:
        InputError: no passage is within the scene's span.
    """
    with stoppable(_STOPPED), progress() as show:
        report = show(f"the truth of {scene.id}", float(scene.exact.t_end))
        return score_passages(passages, scene, tolerance_m, Progress(announce, report))


def print_scores(scores: Sequence[Measured | PassageScore], as_json: bool) -> None:
    """Print scores as lines for people, or as one JSON document.

    Raises:
        typer.Exit: one disagrees: exit status 1.
    """
    if as_json:
        documents = [score.document() for score in scores]
        emit(documents[0] if len(documents) == 1 else {"rows": documents})
    else:
        for score in scores:
            for line in score.lines():
                typer.echo(line)
    if any(score.verdict == DISAGREES for score in scores):
        raise typer.Exit(1)
