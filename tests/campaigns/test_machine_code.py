"""Damaged caches of machine code, numba's and heyoka's: the same numbers, no traceback, no word."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from places import ROOT

pytest.importorskip("numba")

DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda data: b"",
    "cut short": lambda data: data[: len(data) // 2],
    "garbage": lambda data: random.Random(5).randbytes(len(data)),
    "garbage within": lambda data: data[: len(data) // 3] + b"\xff" * 64 + data[len(data) // 3 + 64 :],
    "last byte": lambda data: data[:-1] + bytes([data[-1] ^ 1]),
}
LIMBS = """
import reference
solution = reference.solve(reference.load_scene("paris"), t_end="60", digits=25, level="computed", engine="limbs")
print(solution.grid.exact("x"), solution.transits.exact("t"))
"""
STUDY = ["-m", "foucault", "study", "paris", "--t-end", "60", "--methods", "rk4", "--no-formulations", "--json"]
HEYOKA = ["-m", "foucault", "generate", "paris", "--t-end", "60", "--digits", "10", "--level", "computed"]
HEYOKA += ["--engine", "heyoka", "--json", "--out"]
NOTICE = re.compile(r": about .* after \d+ s$")  # what `progress` writes of a run that takes long, as on a busy machine
MEASURED = ("cpu_s", "compile_s", "load", "cpu_spread", "run_cpu_s", "check_cpu_s", "pilot_cpu_s", "out")


def run(words: list[str], **environment: Path) -> tuple[str, str]:
    """Run Python with these words; return its stdout, without what is measured, and stderr, without what takes long."""
    caches = {name: str(path) for name, path in environment.items()}
    command = [sys.executable, *words]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | caches, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = "".join(line for line in done.stderr.splitlines(True) if not NOTICE.search(line))
    if not done.stdout.startswith("{"):
        return done.stdout, said
    document = json.loads(done.stdout)
    parts = [document, *document.get("rows", [])]
    return str([{key: part[key] for key in part if key not in (*MEASURED, "rows")} for part in parts]), said


@pytest.mark.parametrize("suffix", [pytest.param("nbi", marks=pytest.mark.long), "nbc"])
def test_what_numba_kept_of_a_method(
    suffix: str, tmp_path: Path, size: Callable[[int, int], int], tally: Callable[[str], None]
) -> None:
    place = {"FOUCAULT_CACHE": tmp_path / "cache"}
    good = run(STUDY, **place)
    names = list(DAMAGES)[size(3, 0) : size(4, 5)]
    tally(f"numba's {suffix} of rk4: {damaged(STUDY, names, suffix, good, place)}")


@pytest.mark.long
def test_what_numba_kept_of_limbs(tmp_path: Path, tally: Callable[[str], None]) -> None:
    place = {"NUMBA_CACHE_DIR": tmp_path / "cache"}
    good = run(["-c", LIMBS], **place)
    tally(f"numba's nbc of limbs: {damaged(['-c', LIMBS], ['garbage within'], 'nbc', good, place)}")


def damaged(words: list[str], names: list[str], suffix: str, good: tuple[str, str], place: dict[str, Path]) -> str:
    """Damage every file of a kind in each of some ways, and run again; return what was done."""
    (folder,) = place.values()
    files = sorted(folder.rglob(f"*.{suffix}"))
    assert files
    for name in names:
        for path in files:
            path.write_bytes(DAMAGES[name](path.read_bytes()))
        assert run(words, **place) == good
    return f"{len(files)} files, {len(names)} ways of damage, same result"


@pytest.mark.long
def test_what_numba_kept_whole_is_used_again_and_a_swapped_file_is_not(tmp_path: Path) -> None:
    place = {"FOUCAULT_CACHE": tmp_path / "cache"}
    good = run(STUDY, **place)
    files = {path: path.read_bytes() for path in (tmp_path / "cache").rglob("*.nb?")}
    assert files
    stamps = {path: path.stat().st_mtime_ns for path in files}
    run(STUDY, **place)
    assert {path: path.stat().st_mtime_ns for path in files} == stamps
    first, *others = sorted(path for path in files if path.suffix == ".nbc")
    for path in others:
        shutil.copy(first, path)
    assert others and run(STUDY, **place) == good
    assert all(path.stat().st_mtime_ns != stamps[path] for path in others)


def test_what_heyoka_kept(tmp_path: Path, size: Callable[[int, int], int], tally: Callable[[str], None]) -> None:
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
