"""The cache: entries whole or not at all, never another's, and a place for them whatever the disk allows."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from reference.system import cache
from reference.system.workspace import replace_file

SPARE = "FOUCAULT_SPARE_CACHE"


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv(SPARE, "")
    return tmp_path / "cache"


def made() -> dict[str, np.ndarray]:
    return {"x": np.arange(3.0)}


def refuse() -> dict[str, np.ndarray]:
    raise RuntimeError


def test_what_fails_leaves_nothing_behind(own_cache):
    with pytest.raises(RuntimeError):
        cache.arrays("kind", "name", refuse)

    def half(path: Path) -> None:
        replace_file(path, lambda stream: [stream.write(b"half"), refuse()])

    with pytest.raises(RuntimeError):
        cache.store("kind", "name", half)
    assert list((own_cache / "kind").iterdir()) == []


def test_an_entry_is_computed_once(own_cache):
    assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
    assert {key: value.tolist() for key, value in cache.arrays("kind", "name", refuse).items()} == {"x": [0, 1, 2]}


def test_old_entries_go(own_cache, monkeypatch):
    monkeypatch.setattr(cache, "KEEP", 3)
    for i in range(6):
        cache.arrays("kind", str(i), made)
        os.utime(own_cache / "kind" / str(i), (i, i))
    assert sorted(path.name for path in (own_cache / "kind").iterdir()) == ["3", "4", "5"]


def test_the_cache_is_its_owners_alone(own_cache):
    old = os.umask(0o002)
    try:
        cache.store("kind", "name", lambda path: path.write_text("code"), executed=True)
    finally:
        os.umask(old)
    assert own_cache.stat().st_mode & 0o777 == 0o700
    assert cache.entry("kind", "name", executed=True) == own_cache / "kind" / "name"


@pytest.mark.parametrize("place", [".", "kind", "kind/__pycache__"])
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o1777])
def test_no_code_is_taken_from_where_others_can_write(own_cache, place, mode, capfd):
    (own_cache / "kind" / "__pycache__").mkdir(parents=True)
    (own_cache / "kind" / "name").write_text("planted")
    (own_cache / place).chmod(mode)
    assert cache.entry("kind", "name") == own_cache / "kind" / "name"
    assert cache.entry("kind", "name", executed=True) is None
    for _ in range(2):
        path = cache.store("kind", "name", lambda path: path.write_text("code"), executed=True)
        assert path is not None
        assert not path.is_relative_to(own_cache)
        assert path.parents[1].stat().st_mode & 0o777 == 0o700
        assert cache.entry("kind", "name", executed=True) == path
    assert (own_cache / "kind" / "name").read_text() == "planted"
    err = capfd.readouterr().err
    assert err.startswith("foucault: code is not taken from ")
    assert len(err.splitlines()) == 1


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_no_code_is_taken_from_another_users_folder(own_cache, capfd):
    (own_cache / "kind").mkdir(parents=True)
    (own_cache / "kind" / "name").write_text("planted")
    os.chown(own_cache, 54321, -1)
    assert cache.entry("kind", "name", executed=True) is None
    assert cache.store("kind", "name", lambda path: path.write_text("code"), executed=True) != own_cache / "kind/name"
    assert "belongs to another user" in capfd.readouterr().err


WITHOUT_HOME = """
import os
import numpy as np
from reference.system import cache
os.setgroups([])
os.setgid(54321)
os.setuid(54321)
for name in ("a", "b"):
    cache.arrays("kind", name, lambda: {"x": np.arange(3.0)})
    assert cache.entry("kind", name)
print(cache.root())
"""


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become a user without a passwd entry")
def test_without_a_home_a_temporary_folder_serves_and_goes():
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # the folder of this run is closed to other users
        Path(folder).chmod(0o777)
        environment = {"PATH": os.environ["PATH"], "TMPDIR": folder, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", WITHOUT_HOME]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stderr.startswith("foucault: this user has no home folder")
        assert len(done.stderr.splitlines()) == 1
        assert Path(done.stdout.strip()).parent == Path(folder)
        assert list(Path(folder).iterdir()) == []


CHILD = """
import numpy as np
from reference.system import cache
cache.arrays("kind", "theirs", lambda: {"x": np.arange(3.0)})
print(cache.entry("kind", "theirs"))
"""


def test_a_child_uses_the_temporary_folder_of_its_parent_and_says_nothing(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("FOUCAULT_CACHE", "/proc/nothing")
    cache.arrays("kind", "ours", made)
    done = subprocess.run([sys.executable, "-c", CHILD], capture_output=True, text=True, check=True)
    ours = cache.entry("kind", "ours")
    assert ours is not None
    assert Path(done.stdout.strip()) == ours.with_name("theirs")
    assert done.stderr == ""
    assert cache.arrays("kind", "theirs", refuse)["x"].tolist() == [0, 1, 2]
    assert len(capfd.readouterr().err.splitlines()) == 1


def test_where_nothing_can_be_kept_the_result_stands(monkeypatch, capfd):
    monkeypatch.setenv("FOUCAULT_CACHE", "/proc/nothing")
    with monkeypatch.context() as patch:
        patch.setattr("tempfile.gettempdir", lambda: "/proc")
        for _ in range(2):
            assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
        assert cache.store("kind", "name", lambda path: path.write_text("code"), executed=True) is None
    assert len(capfd.readouterr().err.splitlines()) == 1


NOT_YET = pytest.mark.xfail(strict=True, reason="arrays are taken from any folder")


@NOT_YET
@pytest.mark.parametrize("place", [".", "kind"])
def test_no_numbers_are_taken_from_where_others_can_write(own_cache, place, capfd):
    cache.arrays("kind", "name", lambda: {"x": np.zeros(3)})
    (own_cache / "kind").chmod(0o755)
    own_cache.chmod(0o755)
    (own_cache / place).chmod(0o777)
    for _ in range(2):
        assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
    err = capfd.readouterr().err
    assert f"others can write into {own_cache / place}" in err
    assert len(err.splitlines()) == 1


@NOT_YET
@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_no_numbers_are_taken_from_another_users_folder(own_cache, capfd):
    cache.arrays("kind", "name", lambda: {"x": np.zeros(3)})
    os.chown(own_cache, 54321, -1)
    assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
    assert "belongs to another user" in capfd.readouterr().err


@pytest.mark.parametrize("text", [b"", b"no archive", bytes(100)])
def test_a_damaged_entry_is_made_again(own_cache, text):
    for _ in range(2):
        assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
        (own_cache / "kind" / "name").write_bytes(text)


def test_an_entry_under_anothers_name_is_made_again(own_cache):
    cache.arrays("kind", "other", lambda: {"x": np.zeros(3)})
    (own_cache / "kind" / "other").rename(own_cache / "kind" / "name")
    assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
