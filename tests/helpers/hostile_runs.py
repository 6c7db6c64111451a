"""Feed hostile inputs to the functions that the commands call, in a process of limited memory: what becomes of each."""

from __future__ import annotations

import contextlib
import io
import json
import re
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from child import said_by
from hostile_inputs import (
    Chance,
    a_candidate,
    a_command,
    a_command_line,
    a_list_of_transits,
    a_scene,
    an_assignment,
)

from compare.candidates.external import arguments, placeholders, run_program
from compare.candidates.read import read, read_transits
from reference.commands.show import command as show
from reference.errors import FoucaultError, UnreachableError
from reference.scenes.scene import load_scene

LIMIT_S = 10  # CPU seconds: others use the machine too
HANG_S = 100
LIMIT_BYTES = 500 << 20


def examine(word: str, *assignments: str) -> None:
    """Do with a scene what the commands do before they solve it."""
    scene = load_scene(word, assignments)
    with contextlib.suppress(FoucaultError):  # no double is as large
        scene.with_values(["inputs=binary64"])
    placeholders(scene)
    with contextlib.redirect_stdout(io.StringIO()):
        show(word, set_=list(assignments))


def attempts(seed: int, counts: dict[str, int], folder: Path) -> Iterator[tuple[str, str, float, str]]:
    """Yield kind, case, CPU seconds and outcome of each attempt: "read", "refused", or a traceback."""
    file = folder / "input"

    def by_file(made: bytes, use: Callable[[Path], object]) -> object:
        file.write_bytes(made)
        return use(file)

    paris = load_scene("paris")
    kinds: dict[str, tuple[Callable[[Chance], Any], Callable[[Any], object]]] = {
        "scene": (a_scene, lambda made: by_file(made, lambda path: examine(str(path)))),
        "--set": (an_assignment, lambda made: examine("paris", made)),
        "candidate": (a_candidate, lambda made: by_file(made, read)),
        "transits": (a_list_of_transits, lambda made: by_file(made, read_transits)),
        "--run": (a_command, lambda made: run_program(arguments(made, paris))),
        "command line": (lambda chance: a_command_line(chance, file), command_line),
    }
    for kind, count in counts.items():
        make, use = kinds[kind]
        for i in range(count):
            made = make(Chance(f"{seed} {kind} {i}"))
            yield kind, ascii(made)[:2000], *outcome(use, made)


def outcome(use: Callable[[Any], object], made: Any) -> tuple[float, str]:
    """Return CPU seconds and outcome of one attempt; it is stopped after `LIMIT_S`, or `HANG_S` without work."""
    start = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    signal.setitimer(signal.ITIMER_REAL, HANG_S)
    try:
        use(made)
        said = "read"
    except FoucaultError:
        said = "refused"
    except BaseException:  # everything else is what the campaign looks for
        said = traceback.format_exc()[-2000:]
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
    return time.process_time() - start, said


def command_line(words: list[str]) -> None:
    """Run a command in this process; raise an error if a traceback or an escape sequence reaches the terminal."""
    status, said = said_by(words)
    if status not in (0, 2, 3) or "\x1b" in said or "Traceback" in said:
        raise AssertionError(f"exit status {status}: {said[-1000:]!a}")
    if status:
        raise UnreachableError("refused")


def without_solving() -> None:
    """Let every command stop before it solves anything."""
    import compare.score.judge
    import compare.studies.study
    import reference.solver.solve

    def stop(*_: object, **__: object) -> None:
        raise UnreachableError("Nothing is solved here.")

    compare.score.judge.golden_of = stop
    compare.studies.study.golden_of = stop
    reference.solver.solve.solve = stop


def main(seed: int, counts: dict[str, int], folder: Path) -> None:
    """Print one JSON document: attempts and outcomes by kind, what went wrong, the slowest, and the peak memory."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {LIMIT_S} CPU seconds, or a hang")

    signal.signal(signal.SIGALRM, stop)
    signal.signal(signal.SIGPROF, stop)
    without_solving()
    command_line(["show", "paris", "--equations"])  # loads the libraries
    before = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (before + LIMIT_BYTES,) * 2)
    result: dict[str, Any] = {"tried": {}, "wrong": [], "slowest": [0.0, "", ""]}
    for kind, made, seconds, said in attempts(seed, counts, folder):
        tried = result["tried"].setdefault(kind, {"read": 0, "refused": 0, "wrong": 0})
        tried[said if said in tried else "wrong"] += 1
        if said not in ("read", "refused"):
            result["wrong"].append([kind, made, said])
        result["slowest"] = max(result["slowest"], [seconds, kind, made[:200]])
    # of this program alone: getrusage also counts what its parent had before
    result["peak_mb"] = int(re.findall(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[0]) // 1024
    print(json.dumps(result))


if __name__ == "__main__":
    main(int(sys.argv[1]), json.loads(sys.argv[2]), Path(sys.argv[3]))
