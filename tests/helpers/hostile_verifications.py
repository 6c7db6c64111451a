"""Verify and load hostile datasets in a process of limited memory: what becomes of each."""

from __future__ import annotations

import contextlib
import io
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

from draft import Draft
from hostile_datasets import CASES

import reference
from reference.errors import FoucaultError

LIMIT_S = 10  # CPU seconds
HANG_S = 100
LIMIT_BYTES = 500 << 20
NOBODY = 65534
SEED = 3


def chosen(pairs: int) -> Iterator[tuple[str, ...]]:
    """Yield the names of every case by itself, and of seeded pairs."""
    draw = random.Random(SEED)
    yield from ((name,) for name in CASES)
    for _ in range(pairs):
        yield tuple(draw.sample(sorted(CASES), 2))


def attempt(folder: Path) -> tuple[int, str, str]:
    """Return the exit status of `foucault verify`, what it said, and what `load` did: "read", "refused"."""
    from foucault import main

    sys.argv = ["foucault", "verify", str(folder)]
    out, err, status = io.StringIO(), io.StringIO(), 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
        except SystemExit as stop:
            status = int(stop.code or 0)
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        golden = reference.load(folder)
        assert len(golden.x) == len(golden.exact("t")) == golden.manifest.counts.grid
        assert len(golden.transits) in (0, golden.manifest.counts.transits)
        loaded = "read"
    except FoucaultError:
        loaded = "refused"
    return status, out.getvalue() + err.getvalue(), loaded


def measured(folder: Path) -> dict[str, Any]:
    """Return CPU seconds, outcome and words of one attempt, as somebody without privileges."""
    start, before = time.process_time(), os.geteuid()
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    signal.setitimer(signal.ITIMER_REAL, HANG_S)
    try:
        if before == 0:
            os.seteuid(NOBODY)
        status, said, loaded = attempt(folder)
        outcome = {0: "passed", 1: "found", 2: "refused"}.get(status, f"exit status {status}")
    except BaseException:  # everything else is what the campaign looks for
        outcome, said, loaded = "wrong", traceback.format_exc()[-3000:], ""
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        if before == 0:
            os.seteuid(before)
    return {"seconds": time.process_time() - start, "outcome": outcome, "said": said[:6000], "loaded": loaded}


def main(source: Path, work: Path, pairs: int) -> None:
    """Print one JSON document: what became of every dataset, and the peak memory."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {LIMIT_S} CPU seconds, or a hang")

    signal.signal(signal.SIGALRM, stop)
    signal.signal(signal.SIGPROF, stop)
    assert attempt(source)[0] == 0, "the good dataset does not pass"  # loads and compiles everything
    work.chmod(0o755)
    "\n".encode("unicode_escape")  # loads the codec, which somebody without privileges may not read
    before = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (before + LIMIT_BYTES,) * 2)
    only = os.environ.get("ONLY", "")
    results = []
    for names in chosen(pairs):
        if only and only not in " ".join(names):
            continue
        draft, folder = Draft.of(source), work / "hostile"
        t0 = time.process_time()
        try:
            for name in names:
                CASES[name](draft)
            draft.write(folder)
            made = ""
        except Exception:
            made = traceback.format_exc()[-1500:]
        made_s = time.process_time() - t0
        del draft
        Path("/proc/self/clear_refs").write_text("5")
        results.append({"names": names, "made": made, "made_s": made_s, **(measured(folder) if folder.is_dir() else {"outcome": "not made", "seconds": 0, "said": "", "loaded": ""})})
        results[-1]["peak_mb"] = int(re.findall(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[0]) // 1024
        print(json.dumps(results[-1]), flush=True)
        if folder.is_dir():
            folder.chmod(0o755)
            shutil.rmtree(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
