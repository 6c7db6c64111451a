"""Verify and load hostile datasets in a process of limited memory: what becomes of each."""

from __future__ import annotations

import contextlib
import json
import os
import random
import re
import resource
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from child import said_by
from draft import Draft
from hostile_datasets import CASES

import reference
from reference.errors import FoucaultError, is_plain

LIMIT_S = 10  # CPU seconds: others use the machine too
HANG_S = 100
LIMIT_BYTES = 500 << 20
NOBODY = 65534
OF_OTHERS = {"a file without permissions", "a folder without permissions"}
SEED = 3


def chosen(pairs: int) -> Iterator[tuple[str, ...]]:
    """Yield the name of every case, and of seeded pairs."""
    draw = random.Random(SEED)
    yield from ((name,) for name in CASES)
    for _ in range(pairs):
        yield tuple(draw.sample(sorted(CASES), 2))


def make(source: Path, folder: Path, names: tuple[str, ...]) -> bool:
    """Write a dataset with some changes; return whether they can be made together."""
    draft = Draft.of(source)
    try:
        for name in names:
            CASES[name](draft)
        draft.write(folder)
    except (LookupError, ValueError, OSError, FoucaultError):
        if len(names) == 1:
            raise
        return False
    return True


def attempt(folder: Path) -> tuple[str, str]:
    """Return what became of a dataset, and what `foucault verify` said.

    "found" by `verify`, which lists what is wrong; "refused" as no dataset; "passed". `load` refuses it, or reads as
    many numbers as are counted.
    """
    status, said = said_by(["verify", str(folder)])
    assert status in (0, 1, 2), status
    assert "Traceback" not in said, said
    assert all(map(is_plain, said.splitlines())), ascii(said)
    assert (status == 1) == (f"{folder}: WRONG\n  " in said), said
    with contextlib.suppress(FoucaultError):
        golden = reference.load(folder)
        assert status < 2
        assert len(golden.x) == len(golden.exact("t")) == golden.manifest.counts.grid
        assert len(golden.transits) in (0, golden.manifest.counts.transits)
    return ("passed", "found", "refused")[status], said[:2000]


def measured(folder: Path, user: int) -> tuple[str, str, float]:
    """Return outcome, words and CPU seconds of one attempt, made as a user (of those that root may become)."""
    start, before = time.process_time(), os.geteuid()
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    signal.setitimer(signal.ITIMER_REAL, HANG_S)
    try:
        os.seteuid(user)
        outcome, said = attempt(folder)
    except BaseException:  # everything else is what the campaign looks for
        outcome, said = "wrong", traceback.format_exc()[-3000:]
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        os.seteuid(before)
    return outcome, said, time.process_time() - start


def memory(field: str) -> int:
    """Return a line of this process's status in bytes."""
    return int(re.findall(rf"{field}:\s+(\d+) kB", Path("/proc/self/status").read_text())[0]) << 10


def main(source: Path, pairs: int) -> None:
    """Print one JSON document: what became of every dataset, its CPU seconds, and the MB that it took.

    They are made in the working folder, which a user without privileges then needs no others to reach.
    """

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {LIMIT_S} CPU seconds, or a hang")

    signal.signal(signal.SIGALRM, stop)
    signal.signal(signal.SIGPROF, stop)
    assert attempt(source)[0] == "passed"  # loads and compiles everything
    folder, root = Path("hostile"), os.geteuid()
    Path.cwd().chmod(0o755)
    resource.setrlimit(resource.RLIMIT_AS, (memory("VmSize") + LIMIT_BYTES,) * 2)
    results: list[dict[str, Any]] = []
    for names in chosen(pairs):
        made = make(source, folder, names)
        user = NOBODY if root == 0 and OF_OTHERS & set(names) else root  # root may read everything
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        before = memory("VmRSS")
        outcome, said, seconds = measured(folder, user) if made else ("not made", "", 0.0)
        megabytes = (memory("VmHWM") - before) >> 20
        results.append({"names": names, "outcome": outcome, "said": said, "seconds": seconds, "mb": megabytes})
        if folder.is_dir():
            folder.chmod(0o755)
            shutil.rmtree(folder)
    print(json.dumps(results))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
