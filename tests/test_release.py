"""The wheel and the source distribution: what they hold, their size, and their commands in an empty folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import citation
import pytest
from hatchling.builders.sdist import SdistBuilder
from places import ROOT

from reference.scenes.shipped import data_root, scene_ids, seals

WHEEL_BYTES, DATA_BYTES = 24_000_000, 37_000_000
COMMANDS = [
    ["--version"],
    ["scenes"],
    ["verify", "hard"],
    [
        "generate",
        "paris",
        "--t-end",
        "60",
        "--digits",
        "10",
        "--level",
        "confirmed",
        "--out",
        "short",
    ],
    ["verify", "short"],
    ["score", "paris", "mine.csv", "--t-end", "60"],
    ["score", "paris", "wrong.csv", "--t-end", "60"],
    ["plot", "mine.csv", "--out", "mine.svg"],
    [
        "sweep",
        "paris",
        "--over",
        "site.latitude=0:40:20",
        "--t-end",
        "60",
        "--engine",
        "heyoka",
        "--json",
    ],
    ["atlas", "--data", ".", "--out", "atlas"],
]
QUICKER = {"score": ["--no-diagnosis"]}  # an explanation reads no file that a verdict does not
SCRIPT = """
import json, sys
from pathlib import Path
import compare, foucault, reference
statuses = []
for words in json.loads(sys.argv[1]):
    sys.argv = ["foucault", *words]
    try:
        foucault.main()
        statuses.append(0)
    except SystemExit as stop:
        statuses.append(int(stop.code or 0))
golden = reference.load("paris")
print(json.dumps({"statuses": statuses, "from": [m.__file__ for m in (foucault, reference, compare)],
                  "release": [float(golden.grid[name][0]) for name in "xy"]}))
"""


def test_what_is_cited_is_what_is_released():
    """One place has version, authors and addresses: pyproject.toml."""
    assert citation.text() == citation.PAGE.read_text(encoding="utf-8"), (
        "run: python tests/helpers/citation.py"
    )


def test_a_person_and_the_addresses_come_from_the_one_place():
    urls = {"Repository": "https://example.org/code", "Documentation": "https://example.org/pages"}
    told = citation.project() | {
        "urls": urls,
        "authors": [{"name": "Ada M. Lovelace", "email": "ada@example.org"}],
    }
    lines = [*citation.lines(told)]
    assert "repository-code: https://example.org/code" in lines
    assert "url: https://example.org/pages" in lines
    assert lines[-1] == "  - family-names: Lovelace\n    given-names: Ada M."


def built(kind: str, folder: Path) -> Path:
    """Build the wheel or the source distribution; return its path."""
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(folder)],
        cwd=ROOT,
        check=True,
    )
    (path,) = folder.iterdir()
    return path


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built("wheel", tmp_path_factory.mktemp("wheel"))


def names_of(root: Path, *parts: str) -> set[str]:
    """Return the files that git keeps below some folders, or all of them where git does not tell."""
    try:
        if not (root / ".git").exists():
            return _all_of(root, *parts)
        listed = subprocess.run(
            ["git", "ls-files", "-z", *parts], cwd=root, capture_output=True, text=True, check=True
        )
        return {name for name in listed.stdout.split("\0") if (root / name).is_file()}
    except (
        FileNotFoundError,
        subprocess.CalledProcessError,
    ):  # no git here, or a checkout of another owner
        return _all_of(root, *parts)


def _all_of(root: Path, *parts: str) -> set[str]:
    files = (path for part in parts for path in [root / part, *(root / part).rglob("*")])
    return {
        str(path.relative_to(root))
        for path in files
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.mark.parametrize("tools", ["", os.environ["PATH"]], ids=["no git", "git refuses"])
def test_files_are_listed_where_git_does_not_tell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tools: str
) -> None:
    monkeypatch.setenv("PATH", tools)
    (tmp_path / ".git").write_text("gitdir: of somebody else")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/page.md").touch()
    (tmp_path / "alone.py").touch()
    assert names_of(tmp_path, "docs", "alone.py") == {"docs/page.md", "alone.py"}


# of docs, by which the pages of the atlas evaluate, and say how rows are printed
OF_DOCS = {
    "compare/report/atlas/function.mjs": "docs/readers/function.mjs",
    "compare/report/atlas/paste.md": "docs/paste.md",
}


def test_the_wheel_holds_every_module_and_all_data_and_no_more(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        found = {name for name in archive.namelist() if ".dist-info/" not in name}
        for name, original in OF_DOCS.items():
            assert archive.read(name) == (ROOT / original).read_bytes()
    code = {*OF_DOCS} | names_of(ROOT, "foucault.py", "reference", "compare")
    data = {f"reference/{name}" for name in names_of(ROOT, "data")}
    assert found >= code | data
    assert {
        name for name in found - code - data if not name.startswith("reference/data/golden/")
    } == set()
    assert wheel.stat().st_size < WHEEL_BYTES
    assert (
        sum(path.stat().st_size for path in data_root().rglob("*") if path.is_file()) < DATA_BYTES
    )


def files_of_sdist() -> set[str]:
    """Return what the source distribution is to hold, as hatchling finds it."""
    return {one.distribution_path for one in SdistBuilder(str(ROOT)).recurse_included_files()}


def test_the_source_distribution_holds_what_makes_and_tests_it(wheel: Path) -> None:
    """The wheel is packed already, with nearly all of the bytes; the rest is compressed here as it would be there."""
    found = files_of_sdist()
    kept = names_of(
        ROOT,
        "foucault.py",
        "reference",
        "compare",
        "data",
        "docs",
        "tests",
        "Makefile",
        "README.md",
    )
    assert kept <= found
    rest = (
        name
        for name in sorted(found)
        if not name.startswith(("foucault.py", "reference/", "compare/", "data/"))
    )
    packed = zlib.compress(b"".join((ROOT / name).read_bytes() for name in rest), 9)
    assert wheel.stat().st_size + len(packed) < WHEEL_BYTES


@pytest.mark.long
def test_the_source_distribution_is_written_as_hatchling_finds_it(tmp_path: Path) -> None:
    path = built("sdist", tmp_path)
    with tarfile.open(path) as archive:
        found = {name.partition("/")[2] for name in archive.getnames()}
    assert (
        found - files_of_sdist() == {"PKG-INFO", "pyproject.toml", ".gitignore"} - files_of_sdist()
    )
    assert files_of_sdist() <= found
    assert path.stat().st_size < WHEEL_BYTES


def test_every_scene_ships_and_every_dataset_that_the_index_names_is_there() -> None:
    assert {name.partition(".")[0] for name in seals()} == set(scene_ids())
    assert {path.name for path in (data_root() / "golden").iterdir() if path.is_dir()} == set(
        seals()
    )


def test_its_commands_work_in_an_empty_folder(
    wheel: Path, tmp_path: Path, size: Callable[[Any, Any], Any]
) -> None:
    """What numba compiles, most of a minute of work, is compiled under --long; its absence is an installation too.

    So is what explains the error of a wrong file.
    """
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    place = tmp_path / "empty"
    place.mkdir()
    (place / "mine.csv").write_text("t,x,y\n0,0.3,0.4\n60,-0.176326733,-0.415867688\n")
    (place / "wrong.csv").write_text("t,x,y\n0,0.3,0.4\n60,-0.176,-0.415\n")
    environment = {
        **os.environ,
        "PYTHONPATH": str(tmp_path / "site"),
        "FOUCAULT_CACHE": str(tmp_path / "cache"),
    }
    environment |= size({"NUMBA_DISABLE_JIT": "1"}, {})
    commands = [[*words, *size(QUICKER.get(words[0], []), [])] for words in COMMANDS]
    done = subprocess.run(
        [sys.executable, "-P", "-c", SCRIPT, json.dumps(commands)],
        cwd=place,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["statuses"] == [int("wrong.csv" in words) for words in COMMANDS], (
        done.stdout + done.stderr
    )
    assert all(path.startswith(str(tmp_path / "site")) for path in found["from"])
    assert found["release"] == [0.3, 0.4]
    assert {path.name for path in place.iterdir()} == {
        "mine.csv",
        "wrong.csv",
        "short",
        "mine.svg",
        "atlas",
    }
    assert (place / "atlas" / "index.html").is_file()
