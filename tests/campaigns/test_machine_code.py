"""A damaged cache of heyoka's machine code: the same numbers, no traceback, no word."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from places import ROOT

DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda data: b"",
    "cut short": lambda data: data[: len(data) // 2],
    "garbage": lambda data: random.Random(5).randbytes(len(data)),
    "garbage within": lambda data: (
        data[: len(data) // 3] + b"\xff" * 64 + data[len(data) // 3 + 64 :]
    ),
    "last byte": lambda data: data[:-1] + bytes([data[-1] ^ 1]),
}
HEYOKA = [
    "-m",
    "foucault",
    "generate",
    "paris",
    "--t-end",
    "60",
    "--digits",
    "10",
    "--level",
    "computed",
]
HEYOKA += ["--engine", "heyoka", "--json", "--out"]
# what `progress` writes of a run that takes long, as on a busy machine
NOTICE = re.compile(r": about .* after \d+ s$")
MEASURED = (
    "cpu_s",
    "compile_s",
    "load",
    "cpu_spread",
    "run_cpu_s",
    "check_cpu_s",
    "pilot_cpu_s",
    "out",
)


def run(words: list[str], **environment: Path) -> tuple[str, str]:
    """Run Python with these words; return its document without what is measured, and stderr without what takes long."""
    caches = {name: str(path) for name, path in environment.items()}
    command = [sys.executable, *words]
    done = subprocess.run(
        command, cwd=ROOT, env=os.environ | caches, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    said = "".join(line for line in done.stderr.splitlines(True) if not NOTICE.search(line))
    return str(
        {key: value for key, value in json.loads(done.stdout).items() if key not in MEASURED}
    ), said


def test_what_heyoka_kept(
    tmp_path: Path, size: Callable[[int, int], int], tally: Callable[[str], None]
) -> None:
    place = {"XDG_CACHE_HOME": tmp_path / "cache", "FOUCAULT_CACHE": tmp_path / "ours"}
    words = [*HEYOKA, str(tmp_path / "p")]
    good = run(words, **place)
    files = sorted((tmp_path / "cache" / "heyoka" / "foucault").iterdir())
    assert files
    before = {path.name: path.read_bytes() for path in (tmp_path / "p").iterdir()}
    names = list(DAMAGES)[size(2, 0) : size(3, 5)]
    for name in names:
        for path in (tmp_path / "cache" / "heyoka" / "foucault").iterdir():
            path.write_bytes(DAMAGES[name](path.read_bytes()))
        assert run(words, **place) == good
        assert {path.name: path.read_bytes() for path in (tmp_path / "p").iterdir()} == before
    tally(f"heyoka's cache: {len(names)} ways of damage, same dataset")
