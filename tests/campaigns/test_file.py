"""A file removed, renamed, exchanged, of another run, in the way or foreign: every file of every format."""

from __future__ import annotations

import random
import shutil
from collections import Counter
from pathlib import Path

import pytest
from formats import files_of, restored

SEED = 11


def removed(path: Path, other: Path, names: list[Path]) -> None:
    path.unlink()


def renamed(path: Path, other: Path, names: list[Path]) -> None:
    path.rename(path.with_name(f"{path.name}.bak"))


def exchanged(path: Path, other: Path, names: list[Path]) -> None:
    """Exchange it with the file after it, or with the one of that name in another folder of the format."""
    after = names[(names.index(path) + 1) % len(names)]
    data = path.read_bytes()
    path.write_bytes(after.read_bytes())
    after.write_bytes(data)


def of_another_run(path: Path, other: Path, names: list[Path]) -> None:
    shutil.copy(other, path)


def a_folder(path: Path, other: Path, names: list[Path]) -> None:
    path.unlink()
    path.mkdir()


def a_link_to_nowhere(path: Path, other: Path, names: list[Path]) -> None:
    path.unlink()
    path.symlink_to("nowhere")


FAULTS = (removed, renamed, exchanged, of_another_run, a_folder, a_link_to_nowhere)


def damaged(folder: Path, name: str, fault, other: Path) -> bool:
    """Damage a file; return False if it is as before: equal in the other run."""
    path = folder / name
    before = path.read_bytes()
    fault(path, other / name, [folder / other_name for other_name in files_of(folder)])
    return not path.is_file() or path.read_bytes() != before


def test_a_file_that_is_none_of_its_folder_is_told(made, tmp_path, size, tally):
    """Every fault in every run, and of each the files in turn; under --long each of every file."""
    folder, counts = tmp_path / "damaged", Counter()
    cases = [(fault, name) for fault in FAULTS for name in files_of(made.whole)]
    for fault, name in cases[:: size(len(files_of(made.whole)) + 1, 1)]:
        restored(folder, made.whole)
        if damaged(folder, name, fault, made.other):
            refused = made.is_told(folder, of_another_run=fault is of_another_run)
            counts["refused" if refused else "the same numbers"] += 1
    tally(f"files of a {made.format.name}: {dict(counts)}")


def test_the_same_command_makes_a_file_again_or_says_what_is_in_the_way(
    made, tmp_path, size, tally
):
    chance, folder, counts = random.Random(SEED), tmp_path / "damaged", Counter()
    cases = [(name, fault) for name in files_of(made.whole) for fault in FAULTS]
    for name, fault in chance.sample(cases, min(size(1, 20), len(cases))):
        restored(folder, made.whole)
        if damaged(folder, name, fault, made.other):
            counts["whole again" if made.goes_on(folder) else "refused"] += 1
    tally(f"files of a {made.format.name}, and the same command: {dict(counts)}")


def test_a_foreign_file_is_told_and_never_lost(made, tmp_path):
    """Beside the files, and beside the parts of a sweep, whose readers would take its rows."""
    folder = restored(tmp_path / "foreign", made.whole)
    beside = [folder, *(path for path in folder.iterdir() if path.is_dir())][-1]
    (beside / "mine.parquet").write_text("years of work")
    made.is_told(folder)
    made.foucault(*made.format.command(folder))
    assert (beside / "mine.parquet").read_text() == "years of work"


def test_files_of_somebody_else_are_left_alone(made, tmp_path):
    folder = tmp_path / "theirs"
    folder.mkdir()
    (folder / "mine.txt").write_text("years of work")
    status, _, err = made.foucault(*made.format.command(folder))
    if status == 0:
        assert made.format.name == "study"  # whose report goes beside other files
    else:
        assert status == 2 and "foucault: --out: " in err
    assert (folder / "mine.txt").read_text() == "years of work"


def test_a_folder_of_another_command_is_not_replaced(made, tmp_path):
    if made.format.name == "study":
        pytest.skip("its report goes beside other files")
    folder = restored(tmp_path / "taken", made.whole)
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    words = ["sweep", "paris", "--over", "latitude=0,1"]
    if made.format.name == "sweep":
        words = ["generate", "paris", "--t-end", "20", "--digits", "6", "--level", "computed"]
    status, _, err = made.foucault(*words, "--out", folder)
    assert status == 2 and "foucault: --out: " in err
    assert {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before
