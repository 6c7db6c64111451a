"""Run somebody's program (--run): limited in time and output, killed with its descendants, timed (CPU and wall).

The limit on its output is that on any candidate's text (`text.MAX_BYTES`). Its descendants normally
stay in its process group. One that forks into a session of its own leaves the group, and its parent
may have exited: it is recognised by a mark in the environment that it inherited. This process may
itself be killed (SIGKILL) and can then do nothing more: a shell that reads from it by a pipe sees
the end of the pipe, and kills them in its place.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import shlex
import signal
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from subprocess import DEVNULL, PIPE, Popen
from typing import TYPE_CHECKING, Any, BinaryIO

from reference import InputError, Scene
from reference.errors import did_you_mean
from reference.model.start import Start
from reference.numbers.precision import GUARD_BITS, bits_of
from reference.system.interruption import terminable

from .text import MAX_BYTES

if TYPE_CHECKING:
    from psutil import Process

STEPS = 200  # in a period of the fastest rate of the scene, that {setting} asks a program for
SETTING = "{setting}"  # stands in a command for the step, tolerance or precision that is varied
# of a number that follows from a scene's, at least: quadruple precision has 34
PLACEHOLDER_DIGITS = 36
TIMEOUT_S = 600.0
REPEATS = 3
# a program that takes longer than this, in s, is timed once, by the run that is scored
_LONG_S = 20.0
# the variable of the environment that holds the marks of a run and of those around it
MARK = "FOUCAULT_RUN"
# searches for descendants at most: a process may be started while the others are killed
_ROUNDS = 100
# $1 is the mark; a line on stdin is the process group, and its end that of the process which wrote
# it
_GUARD = """
read -r group
read -r end
[ -n "$group" ] && kill -s KILL -- "-$group"
for round in 1 2 3 4 5; do
    for environ in $(grep -ls -e "$1" /proc/[0-9]*/environ); do
        process=${environ#/proc/}
        kill -s KILL "${process%/environ}"
    done
done
"""
_TAIL = 400  # characters of stderr that a message quotes
_FOR_A_SHELL = re.compile(r"\|.*|&&?|;|(\d*|&)[<>].*")  # unquoted words that only a shell obeys
_NO_SHELL = "The command is run without a shell. Quote these characters to pass them on, or run sh -c '...'."
_PLACEHOLDER = re.compile(r"\{(\{\w+\})\}|\{(\w+)\}")  # {{word}} stands for {word} itself


@dataclass(frozen=True)
class Timing:
    """Run time of a program.

    Attributes:
        cpu_s: median CPU seconds of the repeats, children included.
        wall_s: median wall-clock seconds.
        runs: number of runs of which these are the medians.
        spread: largest minus smallest CPU time, over the median.
        warm: whether the run whose output is scored came before them, as a warm-up.
    """

    cpu_s: float
    wall_s: float
    runs: int
    spread: float
    warm: bool = True


class ProgramError(InputError):
    """A program could not be started, failed, or had to be stopped.

    `reason` says why, without its command, for the row of a report.
    """

    def __init__(self, got: str, expected: str, reason: str, advice: str) -> None:
        super().__init__("--run", got, expected, advice)
        self.reason = f"{reason}. {advice}"


class OutOfTimeError(ProgramError):
    """A program took longer than allowed and was stopped."""


class CrashedError(ProgramError):
    """A program was ended by a signal."""


def placeholders(scene: Scene) -> dict[str, str]:
    """Return the scene's value of each placeholder that a command may use.

    A number is as written in the scene. One that follows from others, such as x0 of a release by
    angles, has the scene's digits, or as many as quadruple precision if that is more.
    """
    digits = max(PLACEHOLDER_DIGITS, scene.run.digits)
    start = Start.of(scene.exact, bits_of(digits) + GUARD_BITS)
    names = ("x0", "y0", "z0", "vx0", "vy0", "vz0")
    words = {}
    for name, value in zip(names, (*start.position, *start.velocity), strict=True):
        words[name] = start.ctx.nstr(value, digits)
    release = scene.release.model_dump(exclude_none=True)
    words |= {f"{name}0": text for name, text in release.items() if f"{name}0" in words}
    for name in ("angle", "azimuth", "angle_rate", "azimuth_rate"):
        words[name] = release.get(name, "0")
    words |= scene.pendulum.model_dump() | scene.site.model_dump()
    return words | {"t_end": scene.run.t_end, "grid_step": scene.run.grid_step}


def arguments(command: str, scene: Scene) -> list[str]:
    """Split a command into words and fill in the placeholders; no shell interprets it.

    Raises:
        InputError: a placeholder is unknown, quotes are unbalanced, or the command is empty.
    """
    values = placeholders(scene)
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise InputError("--run", command, "a command with balanced quotes", f"{error}.") from None
    if not words:
        raise InputError(
            "--run", command, "a command", "Write --run './mine {x0} {y0}', for example."
        )
    # a command with escaped quotes cannot be split into quoted and unquoted words
    with contextlib.suppress(ValueError):
        for word in shlex.split(command, posix=False):
            if _FOR_A_SHELL.fullmatch(word):
                expected = f"a program and its arguments, without {word}"
                raise InputError("--run", command, expected, _NO_SHELL)

    def value(match: re.Match[str]) -> str:
        if match[1]:
            return match[1]
        if match[2] not in values:
            names = ", ".join(f"{{{name}}}" for name in (*values, "setting"))
            nearest = did_you_mean(match[2], values, "")
            advice = f"{nearest} To pass {match[0]} itself, write {{{match[0]}}}."
            raise InputError("--run", match[0], f"one of {names}", advice.lstrip())
        return values[match[2]]

    return [_PLACEHOLDER.sub(value, word) for word in words]


def run_program(
    words: list[str], timeout_s: float = TIMEOUT_S, limit: str = "--timeout"
) -> tuple[BinaryIO, float, float]:
    """Run a program once and return its stdout (an open file, at its start), CPU seconds and wall seconds.

    Args:
        words: the program and its arguments.
        timeout_s: wall-clock seconds that it may take.
        limit: what the user changes to allow more, in words; "" if nothing does.

    Raises:
        InputError: it cannot be started, fails, takes too long or writes too much; no process of it
            is left running.
    """
    start = time.monotonic()
    mark = secrets.token_hex(16)
    with (
        tempfile.TemporaryFile() as errors,
        contextlib.ExitStack() as meanwhile,
        contextlib.ExitStack() as stack,
    ):
        output = stack.enter_context(tempfile.TemporaryFile())
        guard = meanwhile.enter_context(_guarded(mark))
        process = _started(words, mark, output, errors)
        try:
            guard(process.pid)
            with terminable():
                usage = _end_of(process, words, output, errors, timeout_s, limit)
        finally:
            wall = time.monotonic() - start
            _end_all(process.pid, mark)  # what it left running in the background
            process.wait()
        if process.returncode:
            ended = f"exit status {process.returncode}"
            error = CrashedError if process.returncode < 0 else ProgramError
            raise error(f"{ended} of {shlex.join(words)}", "exit status 0", ended, _tail(errors))
        output.seek(0)
        stack.pop_all()  # the caller closes it
    return output, usage.ru_utime + usage.ru_stime, wall


def failure_of(error: InputError) -> str:
    """Return why there is no result of a program, for the row of a report."""
    return error.reason if isinstance(error, ProgramError) else str(error)


def _started(words: list[str], mark: str, output: BinaryIO, errors: BinaryIO) -> Popen[bytes]:
    """Start a program in a session of its own, with a mark in its environment.

    Raises:
        InputError: it cannot be started.
    """
    marks = f"{os.environ.get(MARK, '')} {mark}".strip()
    try:
        return Popen(
            words,
            stdin=DEVNULL,
            stdout=output,
            stderr=errors,
            env={**os.environ, MARK: marks},
            start_new_session=True,
        )
    # ValueError: a word with a zero byte, or that is no text
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        expected = "a program that can be started"
        raise ProgramError(words[0], expected, "it cannot be started", f"{why}.") from None


@contextlib.contextmanager
def _guarded(mark: str) -> Iterator[Callable[[int], None]]:
    """Have what bears a mark killed if this process is killed meanwhile.

    Call what this yields with the process group.

    Where there is no /proc, only the group is killed; where there is no shell, nothing is.
    """
    with contextlib.ExitStack() as stack:
        guard = None
        with contextlib.suppress(OSError):
            words = ["/bin/sh", "-c", _GUARD, "sh", mark]
            guard = Popen(words, stdin=PIPE, stdout=DEVNULL, stderr=DEVNULL, start_new_session=True)
            stack.enter_context(guard)
            stack.callback(guard.kill)  # all is ended, or nothing has begun

        def tell(group: int) -> None:
            with contextlib.suppress(OSError):
                if guard is not None and guard.stdin is not None:
                    guard.stdin.write(f"{group}\n".encode())
                    guard.stdin.flush()

        yield tell


def _end_of(
    process: Popen[bytes],
    words: list[str],
    output: BinaryIO,
    errors: BinaryIO,
    timeout_s: float,
    limit: str,
) -> Any:
    """Wait for a process, and return its resources.

    It is looked at often enough to tell its wall-clock time to 2 %, or to 20 ms.

    Raises:
        InputError: it exceeds its time, and has to be killed, or its output.
    """
    start = time.monotonic()
    while True:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            process.returncode = os.waitstatus_to_exitcode(status)
        if max(os.fstat(stream.fileno()).st_size for stream in (output, errors)) > MAX_BYTES:
            expected = f"at most {MAX_BYTES} bytes of output"
            reason = f"it wrote more than {MAX_BYTES} bytes"
            raise ProgramError(shlex.join(words), expected, reason, _tail(errors))
        if ended:
            return usage
        waited = time.monotonic() - start
        if waited > timeout_s:
            within = f"within {timeout_s:g} s ({limit})" if limit else f"within {timeout_s:g} s"
            expected = f"a program that ends {within}"
            reason = f"it did not end {within}"
            raise OutOfTimeError(shlex.join(words), expected, reason, _tail(errors))
        time.sleep(min(0.02, waited / 50))


def _end_all(leader: int, mark: str) -> None:
    """Kill a process group, and every process with the mark, until none is left."""
    import psutil

    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(leader, signal.SIGKILL)
    for _ in range(_ROUNDS):
        processes = list(_marked(mark))
        if not processes:
            return
        for process in processes:
            with contextlib.suppress(psutil.Error):
                process.kill()
        psutil.wait_procs(processes, timeout=0.1)


def _marked(mark: str) -> Iterator[Process]:
    """Yield the processes of this user that have the mark."""
    import psutil

    for process in psutil.process_iter(["environ", "status"]):
        ended = process.info["status"] == psutil.STATUS_ZOMBIE
        if not ended and mark in (process.info["environ"] or {}).get(MARK, ""):
            yield process


def _tail(errors: BinaryIO) -> str:
    # the program may still be writing: its place in the file stays
    size = os.fstat(errors.fileno()).st_size
    text = os.pread(errors.fileno(), _TAIL, max(0, size - _TAIL)).decode(errors="replace").strip()
    return f"Its stderr: {text}" if text else "It printed nothing on stderr."


def timed(
    words: list[str], timeout_s: float = TIMEOUT_S, repeats: int = REPEATS
) -> tuple[BinaryIO, Timing]:
    """Run a program once as a warm-up, whose output is returned, and `repeats` more times to measure its run time."""
    output, cpu, wall = run_program(words, timeout_s)
    if wall > _LONG_S or repeats == 0:
        return output, Timing(cpu, wall, 1, 0.0, warm=False)
    cpus_s = []
    walls_s = []
    for _ in range(repeats):
        repeated, cpu_s, wall_s = run_program(words, timeout_s)
        repeated.close()
        cpus_s.append(cpu_s)
        walls_s.append(wall_s)
    median_s = statistics.median(cpus_s)
    spread = (max(cpus_s) - min(cpus_s)) / median_s if median_s else 0.0
    return output, Timing(median_s, statistics.median(walls_s), repeats, spread)
