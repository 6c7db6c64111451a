"""A program as a method: its command is run at a setting, and its output read as a candidate."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np

from reference import InputError
from reference.numbers.precision import Array
from reference.plain_text import shortened
from reference.status import Status

from ..candidates.external import SETTING, arguments, failure_of, run_program
from ..candidates.read import read_stream
from .method import Method, RunOutcome, Work, failed, leading
from .rhs.problem import Problem

LONGEST_NAME = 24  # characters of a program's name in tables and charts
SCRIPTS = (".py", ".js", ".mjs", ".ts", ".jl", ".rb", ".r", ".m", ".pl", ".lua", ".sh", ".jar")
# relative difference of times that count as equal, for programs that print few decimals
SAME_TIME = 1e-9


def file_name(command: str) -> str:
    """Return the shortened name of the file that a command runs: the script, not its interpreter."""
    words = shlex.split(command)
    script = next((word for word in words if Path(word).suffix.lower() in SCRIPTS), words[0])
    return shortened(Path(script).name, LONGEST_NAME)


def external(command: str, *, name: str = "external") -> Method:
    """Declare a method that runs a command, whose output is read as a candidate.

    `name` is its id in tables.

    It may use the placeholders of `foucault score --run`, and {setting} for the step that a study
    varies. It has to print the scene's grid times; {t_end} and {grid_step} are those of the
    problem's times.
    """
    return Method(
        id=name,
        title=command,
        setting="step",
        ladder=(),  # a study is given the settings
        source="the user's",
        licence="the user's",
        prepare=lambda problem, value: _prepare(problem, value, command),
        formulations=("momentum",),
    )


def _prepare(problem: Problem, value: float, command: str) -> Work:
    times = problem.times.tolist()
    scene = problem.scene.with_values(
        [f"run.t_end={times[-1]!r}", f"run.grid_step={times[1] - times[0]!r}"]
    )
    words = arguments(command.replace(SETTING, repr(value)), scene)

    def work() -> RunOutcome:
        try:
            output, cpu_s, _ = run_program(words, limit="")
            with output:
                candidate = read_stream(output, "the program's output")
            states = _at(problem, candidate.t, candidate.columns)
        except InputError as error:  # a study reports a program that fails as a row
            return failed(problem, failure_of(error))
        if not len(states):
            return failed(problem, "the output does not begin at t = 0")
        status, reason = Status.OK, ""
        if len(states) < len(problem.times):
            status, reason = Status.GAVE_UP, "the output lacks a grid time"
        return RunOutcome(
            status, float(problem.times[len(states) - 1]), lambda: states, reason, cpu_s=cpu_s
        )

    return work


def _at(problem: Problem, t: Array, columns: dict[str, Array]) -> Array:
    """Return the states at the problem's times, up to the first missing one.

    Columns not printed are derived.
    """
    places = np.clip(np.searchsorted(t, problem.times * (1 - SAME_TIME)), 0, len(t) - 1)
    present = np.abs(t[places] - problem.times) <= SAME_TIME * problem.times
    printed = {name: column[places] for name, column in columns.items()}
    x, y = printed["x"], printed["y"]
    unknown = np.full(len(x), np.nan)  # a velocity that was not printed
    vx, vy = printed.get("vx", unknown), printed.get("vy", unknown)
    z = printed.get("z", -np.sqrt(np.maximum(problem.constants.length**2 - x * x - y * y, 0.0)))
    vz = printed.get("vz", -(x * vx + y * vy) / z)
    return np.array([x, y, z, vx, vy, vz]).T[: leading(present)].copy()
