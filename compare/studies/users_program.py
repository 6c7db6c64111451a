"""A user's program or file on one scene: its output compared with the truth at its own times.

Unlike `methods.method.external`, which has a study time a program at the golden grid times, this
asks only where it breaks, or how far a file is off.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from reference import Golden, InputError, Scene
from reference.errors import Described
from reference.plain_text import plain, shortened
from reference.status import Status

from ..candidates.candidate import Candidate, NotFiniteError
from ..candidates.external import (
    SETTING,
    CrashedError,
    OutOfTimeError,
    arguments,
    failure_of,
    run_program,
)
from ..candidates.read import read, read_stream
from ..methods import METHODS
from ..methods.external import LONGEST_NAME
from ..truth import truth_at
from .campaign import load_per_core
from .row import UNKNOWN, Row
from .study_plan import parsed

# that a program is asked for: the millionth of the amplitude that `foucault score` allows
DIGITS = 6.0
_PATIENCE = 3  # wall-clock seconds for each CPU second that is allowed
NUMBER = "program"  # what stands for a program's number type
FILE = "file"  # kind of the row of a file, which has no setting
_STATUSES = {
    OutOfTimeError: Status.OUT_OF_TIME,
    NotFiniteError: Status.NOT_FINITE,
    CrashedError: Status.CRASHED,
}
STATED = "the CPU seconds are those that were stated"


@dataclass(frozen=True)
class ProgramRun:
    """One run of a program.

    Attributes:
        name: its name in the row.
        command: with placeholders, and {setting} for the step.
        step_s: value of {setting}, in s.
        limit_s: CPU seconds that it may take.
    """

    name: str
    command: str
    step_s: float
    limit_s: float


def measured(
    program: ProgramRun, scene: Scene, golden: Golden, wrong_m: float
) -> tuple[Row, float | None]:
    """Run a program on a scene.

    Return its row, and the first time in s at which it is wrong, None if it never is.

    A failure of any kind becomes the row's status and reason.

    Args:
        program: what is run, and its limits.
        scene: as the program is given it.
        golden: its truth.
        wrong_m: position error in m above which it is wrong.
    """
    step_s = program.step_s
    base = Row(program.name, NUMBER, step_s, "step", scene.inputs, Status.OK, load=load_per_core())
    try:
        words = arguments(program.command.replace(SETTING, repr(step_s)), scene)
        limit = f"{_PATIENCE} times --limit"
        output, cpu_s, _ = run_program(words, _PATIENCE * program.limit_s, limit)
        with output:
            candidate = read_stream(output, "its output")
        return _against(base, candidate, cpu_s, scene, golden, wrong_m)
    except InputError as error:
        if isinstance(error, NotFiniteError):
            reason = f"{error.field}: {error.got}"
        else:
            reason = failure_of(error)
        return replace(base, status=_STATUSES.get(type(error), Status.GAVE_UP), reason=reason), None


def files_of(
    paths: Sequence[str], cpu: str | None, taken: Collection[str]
) -> dict[str, tuple[Candidate, float | None]]:
    """Read files of somebody's output.

    Return each, with the CPU seconds that are stated, by the name of its row.

    Args:
        paths: of the files; the name of a row is that of its file, shortened.
        cpu: CPU seconds of each, separated by commas, - where nobody knows; None for all of them.
        taken: names that other rows have, beside those of the methods.

    Raises:
        InputError: a file cannot be read or has no positions, two have the same name, or the
            seconds are not as many.
    """
    seconds = _stated_seconds(cpu, len(paths))
    files: dict[str, tuple[Candidate, float | None]] = {}
    for path, cpu_s in zip(paths, seconds, strict=True):
        name = shortened(plain(Path(path).name), LONGEST_NAME)
        if name in files or name in taken or name in METHODS:
            raise InputError(
                "--candidates",
                path,
                "a file with a name of its own",
                "Rename the file: another row has this name.",
            )
        candidate = read(path)
        if not candidate.positions:
            raise InputError(
                "--candidates", path, "a file with positions", "It contains only times of transits."
            )
        files[name] = candidate, cpu_s
    return files


def _stated_seconds(cpu: str | None, count: int) -> Sequence[float | None]:
    """Return the CPU seconds that a user states for each of his files; None where nobody knows."""
    if cpu is None:
        return [None] * count
    seconds = parsed(cpu.split(","), _seconds_or_unknown)
    valid = all(value is None or 0 < value < math.inf for value in seconds)
    if not valid or len(seconds) != count:
        expected = f"{count} positive numbers of seconds, or - where the time is unknown"
        raise InputError("--cpu", cpu, expected)
    return seconds


def _seconds_or_unknown(word: str) -> float | None:
    return None if word.strip() == "-" else float(word)


def file_row(
    name: str, candidate: Candidate, cpu_s: float | None, scene: Scene, golden: Golden
) -> Row:
    """Return the row of a file: its error against the truth at its own times.

    Args:
        name: its name in the row.
        candidate: its content.
        cpu_s: CPU seconds that somebody says it took; None if nobody does.
        scene: that it is of.
        golden: its truth.
    """
    base = Row(name, UNKNOWN, 0.0, FILE, scene.inputs, Status.OK, "" if cpu_s is None else STATED)
    try:
        row, _ = _against(base, candidate, cpu_s, scene, golden, math.inf)
    except InputError as error:
        return replace(base, status=Status.GAVE_UP, reason=str(error))
    return replace(row, reason=row.reason or base.reason)


def _against(
    base: Row,
    candidate: Candidate,
    cpu_s: float | None,
    scene: Scene,
    golden: Golden,
    wrong_m: float,
) -> tuple[Row, float | None]:
    """Return the row of somebody's output, and the first time in s at which its error exceeds `wrong_m`."""
    end_s = float(scene.exact.t_end)
    step_s = float(scene.exact.grid_step)
    within = candidate.t <= end_s + step_s / 2
    t = candidate.t[within]
    if not len(t) or not t[-1] > 0:
        got = Described("no row after t = 0")
        raise InputError("its output", got, f"rows up to t = {end_s:g} s")
    truth = truth_at(golden, t)
    differences = [
        candidate.columns[name][within] - truth.states[:, i]
        for i, name in enumerate("xyz")
        if name in candidate.columns
    ]
    errors_m = np.linalg.norm(differences, axis=0)
    row = replace(
        base,
        error_m=float(errors_m.max()),
        end_error_m=float(errors_m[-1]),
        cpu_s=cpu_s,
        reached_t=float(t[-1]),
    )
    if t[-1] < end_s - step_s:
        reason = f"its output ends at t = {t[-1]:g} s of {end_s:g} s"
        row = replace(row, status=Status.GAVE_UP, reason=reason)
    else:
        row = replace(row, status=Status.OK, reason="")
    wrong = errors_m > wrong_m
    wrong_from_s = float(t[np.argmax(wrong)]) if wrong.any() else None
    return row, wrong_from_s
