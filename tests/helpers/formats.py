"""The formats that foucault writes: the command that makes a small one, what reads it, and what its user relies on.

A test of a kind of damage goes through all of them. Whatever happened to a folder, one of these holds afterwards:
`verify` and what reads it name the file, or the numbers are those of the folder as it was written.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
from places import ROOT

import reference
from reference.numbers.columns import GRID
from reference.sweeps.request import Settings
from reference.sweeps.store import Store
from reference.sweeps.sweep import checked_request
from reference.system.workspace import workspace

Foucault = Callable[..., tuple[int, str, str]]  # runs a command: exit status, stdout, stderr
Contents = dict[str, bytes]

# what a study measures of the machine, and not the same twice
COSTS = {"cpu_s", "compile_s", "load"}
ROWS_PER_PART = 4
# a journal with fewer lines, or fewer checksums, may be of a run that is not done
GROWING = {"rows.jsonl", "SHA256SUMS"}


@dataclass(frozen=True)
class Format:
    """A folder that a command writes.

    Attributes:
        name: of the format.
        words: the command, without `--out FOLDER`.
        other: words that make another one of the same kind.
        read: returns what Python reads of a folder, by the function that checks it; None where commands alone read it.
        begin: makes the folder before the command, given the folder and whether it is the other one.
        resumes: whether an interrupted command leaves what it has done so far.
        needs: modules.
    """

    name: str
    words: tuple[str, ...]
    other: tuple[str, ...]
    read: Callable[[Path], Any] | None
    begin: Callable[[Path, bool], None] | None = None
    resumes: bool = False
    needs: tuple[str, ...] = field(default=())

    def command(self, folder: Path, other: bool = False) -> list[str]:
        """Return the words of the command that fills a folder."""
        return [*self.words, *(self.other if other else ()), "--out", str(folder)]

    def prepare(self, folder: Path, other: bool = False) -> None:
        """Do what comes before the command: nothing, mostly."""
        if self.begin is not None:
            self.begin(folder, other)

    def make(self, folder: Path, other: bool = False) -> Path:
        """Make one in a process of its own."""
        self.prepare(folder, other)
        command = [sys.executable, "-m", "foucault", *self.command(folder, other)]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        return folder

    def result(self, folder: Path) -> Any:
        """Return what the same command gives again: every byte, or every row but what it cost."""
        return rows_of(folder) if self.name == "study" else contents(folder)


def contents(folder: Path) -> Contents:
    """Return the bytes of each file of a folder, by its path there."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def _holds(found: Any, right: Any) -> bool:
    """Return whether a result is the right one; other files may be beside it, such as an old one by another name."""
    return found.items() >= right.items() if isinstance(right, dict) else found == right


def files_of(folder: Path) -> list[str]:
    return [*contents(folder)]


def litter(folder: Path) -> list[str]:
    """Return what an interrupted command left behind."""
    return [path.name for path in folder.rglob(".*partial-*")]


def restored(folder: Path, whole: Path) -> Path:
    """Return a folder that is a copy of another one again."""
    shutil.rmtree(folder, ignore_errors=True)
    return Path(shutil.copytree(whole, folder))


def rows_of(folder: Path) -> list[dict[str, Any]]:
    document = json.loads((folder / "study.json").read_text())
    return [
        {key: value for key, value in row.items() if key not in COSTS} for row in document["rows"]
    ]


def read_dataset(folder: Path) -> Any:
    golden = reference.load(folder)
    tables = {"grid": golden.grid, "transits": golden.transits, **golden.sections}
    printed = {
        name: {column: table.decimals(column) for column in table.columns}
        for name, table in tables.items()
    }
    times = golden.times
    if golden.function is None:
        return golden.scene, printed
    return golden.scene, printed, [getattr(golden.at(times), column).tolist() for column in GRID]


def read_function(folder: Path) -> Any:
    golden = reference.load(folder)
    assert golden.function is not None
    states = golden.at(golden.function.times)
    return golden.scene, [getattr(states, column).tolist() for column in GRID], states.bound


def read_ranges(folder: Path) -> Any:
    ranges = reference.load_ranges(folder)
    tables = [
        (zeros.table.rows, zeros.directions, zeros.possible) for zeros in ranges.sections.values()
    ]
    of_transits = ranges.transits.rows, ranges.directions, ranges.possible
    return ranges.scene, ranges.uncertain, ranges.times, ranges.grid.rows, of_transits, tables


def read_sweep(folder: Path) -> Any:
    return values_of(reference.load_sweep(folder))


def values_of(swept: reference.Swept) -> Any:
    """Return all that a sweep holds."""
    columns = {
        **swept.columns(),
        **{f"transits {name}": values for name, values in swept.transits().items()},
    }
    return {
        name: values.tolist() if values.dtype.kind == "O" else values.tobytes()
        for name, values in columns.items()
    }


def begin_sweep(folder: Path, latitudes: str, **options: Any) -> None:
    """Begin a sweep in small parts, with which the command goes on: by itself it would take one for so few rows."""
    scene = reference.load_scene("paris", ["run.t_end=20"])
    asked = checked_request(
        scene, [f"site.latitude={latitudes}"], None, folder, Settings(audit=0, **options)
    )
    Store.begun(folder, replace(asked, rows_per_part=ROWS_PER_PART))


def side_by_side(folder: Path, other: bool) -> None:
    begin_sweep(
        folder, "1:21:2" if other else "0:20:2", want=("all", "transit-times"), engine="heyoka"
    )


def one_by_one(folder: Path, other: bool) -> None:
    """Rows in more digits than double has go through `solve`, in processes."""
    begin_sweep(
        folder, "1:21:4" if other else "0:20:4", want=("transits", "transit-times"), digits=16
    )


def stored(folder: Path) -> Contents:
    """Return what an interrupted command has done: the parts of a sweep, the whole lines of a journal."""
    done = {name: data for name, data in contents(folder).items() if name.endswith(".parquet")}
    for path in folder.glob("*.jsonl"):
        lines = [
            line for line in path.read_bytes().splitlines(keepends=True) if line.endswith(b"}\n")
        ]
        done |= {f"line {number}": line for number, line in enumerate(lines, 1)}
    return {name: data for name, data in done.items() if "partial-" not in name}


GENERATE = ("generate", "paris", "--digits", "10")
FORMATS = {
    made.name: made
    for made in (
        Format(
            name="dataset",
            words=(*GENERATE, "--level", "confirmed", "--t-end", "30"),
            other=("--t-end", "40"),
            read=read_dataset,
        ),
        Format(
            name="sections",
            words=(*GENERATE, "--t-end", "20", "--no-audit", "--confirm", "none", "--no-function",
                   "--section", "highest", "--section", "gate 30"),
            other=("--t-end", "30"),
            read=read_dataset,
        ),
        Format(
            name="function",
            words=(*GENERATE, "--t-end", "20", "--no-audit", "--confirm", "none", "--function", "--no-tables"),
            other=("--t-end", "30"),
            read=read_function,
        ),
        Format(
            name="ranges",
            words=("generate", "paris", "--t-end", "20", "--uncertain", "length=±0.001", "--section", "highest"),
            other=("--t-end", "30"),
            read=read_ranges,
        ),
        Format(
            name="sweep",
            words=("sweep", "--workers", "1"),
            other=(),
            read=read_sweep,
            begin=side_by_side,
            resumes=True,
            needs=("pyarrow",),
        ),
        Format(
            name="study",
            words=("study", "paris", "--t-end", "20", "--methods", "heyoka_double", "--limit", "0.05",
                   "--no-formulations"),
            other=("--t-end", "30"),
            read=None,
            resumes=True,
        ),
    )
}  # fmt: skip


IN_PROCESSES = replace(FORMATS["sweep"], name="sweep in processes", begin=one_by_one)


@dataclass(frozen=True)
class Made:
    """A folder of a format as its command wrote it, another of its kind, each made once, and what runs a command."""

    format: Format
    place: Path
    foucault: Foucault

    @property
    def whole(self) -> Path:
        """The folder that the command made."""
        return self._made("whole", other=False)

    @property
    def other(self) -> Path:
        """The folder of another run."""
        return self._made("other", other=True)

    def _made(self, name: str, other: bool) -> Path:
        folder = self.place / name
        return folder if folder.exists() else self.format.make(folder, other)

    def changed(self, folder: Path) -> set[str]:
        """Return the names of the files that are not as they were written."""
        now, before = contents(folder), contents(self.whole)
        return {Path(name).name for name in {*now, *before} if now.get(name) != before.get(name)}

    def is_told(self, folder: Path, of_another_run: bool = False) -> bool:
        """Check a folder in which files were changed: return whether it is refused, with the name of one of them.

        Only where nothing but the same numbers can be read of it may it pass. A whole file of another run is found by
        what it does not fit, which may be named instead.
        """
        status, out, err = self.foucault("verify", folder)
        said = f"{out}{err}"
        assert "Traceback" not in said
        assert status in (0, 1, 2), said
        names = self.changed(folder) | (
            {Path(name).name for name in contents(folder)} if of_another_run else set()
        )
        assert status == 0 or any(name in said for name in names), said
        if self.format.read is None:
            written = {Path(name).name for name in contents(self.whole)} & self.changed(folder)
            assert status != 0 or written <= GROWING, said
            return status != 0
        try:
            read = self.format.read(folder)
        except reference.FoucaultError as error:
            assert status != 0, f"{error}: {said}"
            return True
        assert read == self.format.read(self.whole), said
        return status != 0

    def goes_on(self, folder: Path) -> bool:
        """Run the command again on a damaged folder: return whether it made it whole; else it says what is wrong."""
        before = contents(folder)
        status, _, err = self.foucault(*self.format.command(folder))
        assert "Traceback" not in err
        if status == 2:
            assert "foucault: --out: " in err or any(
                f"{name}: " in err for name in self.changed(folder)
            ), err
            assert contents(folder).items() >= before.items()
            return False
        assert status == 0, err
        self.is_whole(folder)
        return True

    def is_whole(self, folder: Path) -> None:
        """Check that a folder holds what the undisturbed command gives, or what is left to do by hand is said.

        The plan of another sweep in its place gives that sweep.
        """
        found = self.format.result(folder)
        assert _holds(found, self.format.result(self.whole)) or _holds(
            found, self.format.result(self.other)
        )
        assert litter(folder) == []
        status, out, _ = self.foucault("verify", folder)
        assert status == 0 or "delete it" in out or "remove it" in out, out

    def begun(self, place: Path) -> Path:
        """Return a folder in a new place as the command finds it: an older one, or one in which nothing is done."""
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        if self.format.resumes:
            self.format.prepare(place / "out")
            return place / "out"
        return restored(place / "out", self.other)

    def is_nothing_half(self, folder: Path) -> str:
        """Check what a command that did not end by itself left behind; return how much it is."""
        if self.format.resumes:
            return self._is_a_part(folder)
        with workspace(folder.parent, folder.name):
            pass  # what the next run begins with: a folder that was just moved aside comes back
        found = contents(folder)
        assert found in (contents(self.whole), contents(self.other))
        assert self.format.read is not None
        self.format.read(folder)
        return "the new one" if found == contents(self.whole) else "the old one"

    def _is_a_part(self, folder: Path) -> str:
        done = stored(folder) if folder.exists() else {}
        every = stored(self.whole)
        assert done.keys() <= every.keys()
        if self.format.read is None:
            return f"{len(done)} rows"
        assert done.items() <= every.items()
        if done.keys() < every.keys():
            with pytest.raises(reference.InputError, match="missing"):
                self.format.read(folder)
        return f"{len(done)} parts"
