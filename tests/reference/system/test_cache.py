"""The cache: entries whole or not at all, never another's; without one the result stands."""

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

SAID = "FOUCAULT_CACHE_SAID"


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv(SAID, "")
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
    assert {key: value.tolist() for key, value in cache.arrays("kind", "name", refuse).items()} == {
        "x": [0, 1, 2]
    }


def test_old_entries_go(own_cache):
    for i in range(cache.KEEP + 3):
        cache.arrays("kind", str(i), made)
        os.utime(own_cache / "kind" / str(i), (i, i))
    left = {int(path.name) for path in (own_cache / "kind").iterdir()}
    assert left == set(range(3, cache.KEEP + 3))


def test_the_cache_is_its_owners_alone(own_cache):
    old = os.umask(0o002)
    try:
        cache.store("kind", "name", lambda path: path.write_text("code"))
    finally:
        os.umask(old)
    assert own_cache.stat().st_mode & 0o777 == 0o700
    assert cache.entry("kind", "name") == own_cache / "kind" / "name"


def test_a_folder_of_one_kind_is_trusted_as_little(own_cache):
    cache.arrays("kind", "name", lambda: {"x": np.zeros(3)})
    (own_cache / "kind").chmod(0o777)
    assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("mode", "why"),
    [(0o777, "others can write into "), (0o775, "others can write into "), (0o700, "another user")],
)
def test_nothing_is_taken_from_where_others_can_write(own_cache, mode, why, capfd):
    if mode == 0o700 and os.getuid() != 0:
        pytest.skip("only root can give a folder away")
    cache.arrays("kind", "name", lambda: {"x": np.zeros(3)})
    (own_cache / "kind" / "code").write_text("planted")
    own_cache.chmod(mode)
    if mode == 0o700:
        os.chown(own_cache, 54321, -1)
    for _ in range(2):
        assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
        assert cache.entry("kind", "code") is None
        assert cache.store("kind", "code", lambda path: path.write_text("code")) is None
    assert (own_cache / "kind" / "code").read_text() == "planted"
    err = capfd.readouterr().err
    assert (
        err.startswith("foucault: running without the cache, which only takes longer: ")
        and why in err
    )
    assert len(err.splitlines()) == 1


WITHOUT_HOME = """
import os
import filelock  # another user may not read where Python is
import numpy as np
from reference.system import cache
os.setgroups([])
os.setgid(54321)
os.setuid(54321)
for name in ("a", "b"):
    assert cache.arrays("kind", name, lambda: {"x": np.arange(3.0)})["x"].tolist() == [0, 1, 2]
    assert cache.entry("kind", name) is None
print(cache.temporary())
"""


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become a user without a passwd entry")
def test_without_a_home_there_is_no_cache_and_a_temporary_folder_goes():
    # the folder of this run is closed to other users
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        Path(folder).chmod(0o777)
        environment = {
            "PATH": os.environ["PATH"],
            "TMPDIR": folder,
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        command = [sys.executable, "-c", WITHOUT_HOME]
        done = subprocess.run(
            command, env=environment, cwd=folder, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert "this user has no home folder" in done.stderr
        assert len(done.stderr.splitlines()) == 1
        assert Path(done.stdout.strip()).parent == Path(folder)
        assert list(Path(folder).iterdir()) == []


CHILD = """
import numpy as np
from reference.system import cache
print(cache.arrays("kind", "theirs", lambda: {"x": np.arange(3.0)})["x"].tolist())
"""


def test_a_child_does_not_say_again_that_there_is_no_cache(monkeypatch, capfd):
    monkeypatch.setenv("FOUCAULT_CACHE", "/proc/nothing")
    cache.check()
    done = subprocess.run([sys.executable, "-c", CHILD], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("[0.0, 1.0, 2.0]\n", "")
    assert len(capfd.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("place", ["/proc/nothing", "/dev/null/x", "file"])
def test_a_cache_that_cannot_be_used_costs_time_only_and_one_line_says_so(
    place, tmp_path, monkeypatch, capfd
):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / place))
    for _ in range(2):
        assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
    assert cache.store("kind", "name", lambda path: path.write_text("code")) is None
    err = capfd.readouterr().err
    assert "cannot be written (" in err
    assert len(err.splitlines()) == 1
    assert (tmp_path / "file").read_text() == "in the way"


def test_a_cache_that_is_there_is_not_mentioned(own_cache, capfd):
    cache.check()
    assert list((own_cache / "generated").iterdir()) == []
    assert capfd.readouterr().err == ""


def test_the_folder_is_that_of_the_variable_or_of_the_user(monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", "~/mine")
    monkeypatch.setenv("HOME", "/somewhere")
    assert cache.root() == Path("/somewhere/mine")
    monkeypatch.delenv("FOUCAULT_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    assert cache.root() == Path("/caches/foucault")
    monkeypatch.delenv("XDG_CACHE_HOME")
    if sys.platform == "linux":
        assert cache.root() == Path("/somewhere/.cache/foucault")


def test_a_damaged_entry_is_made_again(own_cache):
    cache.arrays("kind", "name", made)
    good = (own_cache / "kind" / "name").read_bytes()
    changed = bytearray(good)
    changed[good.index(np.float64(2).tobytes()) + 6] ^= 1
    for data in (b"", b"no archive", bytes(100), good[: len(good) // 2], bytes(changed)):
        (own_cache / "kind" / "name").write_bytes(data)
        assert cache.arrays("kind", "name", made)["x"].tolist() == [0, 1, 2]
        assert (own_cache / "kind" / "name").read_bytes() == good
