"""Kills (SIGKILL) at any moment of a command: nothing is lost, nothing half written, nothing runs on."""

from __future__ import annotations

import json
import random
import shutil
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from interruption import gone_within, interrupted
from moments import Ended, chosen, ended_after, ended_at, undisturbed
from small_scenes import make_scene

import reference
from reference.scenes.shipped import golden_root
from reference.system.workspace import workspace

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="counts processes in /proc")

Size = Callable[[Any, Any], Any]
Foucault = Callable[..., tuple[int, str, str]]  # in the process of the test; compiles what is compiled once
Tally = Callable[[str], None]

ORPHANS_END_S = 10.0
GENERATE = ["generate", "paris", "--t-end", "120", "--digits"]
TIMES = ("cpu_s", "compile_s", "load")  # measured, and not the same twice


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def killed(words: list[object], event: int, named: str = "") -> Ended:
    """Run a command, killed at an event of its run, or of those of a name; nothing that it started runs on."""
    ended = ended_at(event, signal.SIGKILL, words, named)
    assert gone_within(ended.group, ORPHANS_END_S), "processes run on"
    return ended


def killed_when(words: list[object], ready: Callable[[], object]) -> Ended:
    """Run a command, killed once something is ready; nothing that it started runs on."""
    status, err, group = interrupted([*map(str, words)], lambda *_: bool(ready()), signal.SIGKILL)
    assert gone_within(group, ORPHANS_END_S), "processes run on"
    return Ended(status, "", err.decode(), group)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def put_back(target: Path) -> None:
    """Do what the next run begins with, in case that a dataset was just moved aside."""
    with workspace(target.parent, target.name):
        pass


def litter(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".*partial-*")]


def finished(words: list[object]) -> Ended:
    """Run a command to its end in a process of its own, which remembers nothing."""
    return ended_at(-1, signal.SIGKILL, words)


def test_a_dataset_is_the_old_or_the_new_one_and_whole(
    tmp_path: Path, size: Size, tally: Tally, foucault: Foucault
) -> None:
    """In every run once, when the old one is moved aside and the new one is not there yet.

    Under --long at moments of the whole run, and at the last events, which are those that touch the target.
    """
    place = tmp_path / "sets"
    words: list[object] = [*GENERATE, *size(["10", "--level", "computed"], ["21"]), "--out", place / "p"]
    before = reference.write(reference.solve(make_scene(run={"t_end": "60", "digits": 6})), tmp_path / "old")
    assert foucault(*words)[0] == 0
    whole = [contents(before), contents(place / "p")]
    shutil.rmtree(place / "p")
    shutil.copytree(before, place / "p")  # what the killed runs replace: its files are events, too
    named = size("os.rename", "")
    _, times = undisturbed(tmp_path / "note", words, named)
    last = [len(times) - 1 - 5 * i for i in range(size(1, 60))]
    events = [*chosen(times, size(0, 50), 1), *last]
    seen, hits, litters = [0, 0], 0, 0
    for event in events:
        shutil.rmtree(place / "p")
        shutil.copytree(before, place / "p")
        hits += killed(words, event, named).status == -signal.SIGKILL
        assert len(litter(place)) <= 1
        litters += len(litter(place))
        put_back(place / "p")
        seen[whole.index(contents(place / "p"))] += 1  # an error if it is neither
        reference.load(place / "p")
    assert foucault(*words)[0] == 0
    assert contents(place / "p") == whole[1]
    assert [path.name for path in place.iterdir()] == ["p"]
    assert hits >= len(events) - 0.1 * len(last)  # the number of all events varies by a few
    tally(f"generate: {hits} kills, dataset whole {seen[0]} old {seen[1]} new, {litters} left a folder, which went")


SHORT = ["--level", "computed", "--workers", 2, "--digits"]
MANY: dict[str, tuple[list[object], list[object], list[object]]] = {  # command, and what makes old and new ones differ
    "generate --all": (["generate", "--all", *SHORT], [6, "--t-end", 30], [10, "--t-end", 60]),
    "atlas": (["atlas", "--data", "DATA", "--files"], ["https://example.org/old"], ["https://example.org/new"]),
}


def units(folder: Path) -> dict[str, object]:
    """Return the datasets or the pages of a folder."""
    shown = [path for path in folder.iterdir() if path.name not in litter(folder)]
    return {path.name: contents(path) if path.is_dir() else path.read_bytes() for path in shown}


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
@pytest.mark.parametrize("name", MANY)
def test_each_of_many_is_the_old_or_the_new_one_and_the_same_command_goes_on(
    name: str, number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tally: Tally
) -> None:
    """At events, at the last of which files are put in place, and at any moment from outside."""
    pytest.importorskip("matplotlib")
    few, out, old, data = ["conical", "pantheon", "paris"], tmp_path / "out", tmp_path / "old", tmp_path / "data"
    (temporary := tmp_path / "temporary").mkdir()
    for variable, value in (("SCENES_THAT_SHIP", " ".join(few)), ("TMPDIR", str(temporary))):
        monkeypatch.setenv(variable, value)
    for scene in few:
        shutil.copytree(golden_root() / scene, data / scene)
    first, *differences = [[data if word == "DATA" else word for word in part] for part in MANY[name]]
    before, words = ([*first, *difference, "--out", out] for difference in differences)
    assert finished(before).status == 0
    out.rename(old)
    assert finished(words).status == 0
    whole, earlier = units(out), units(old)
    changed = {unit for unit in whole if whole[unit] != earlier[unit]}
    assert whole.keys() == earlier.keys() and len(changed) >= len(few)  # the atlas's first page names no file
    shutil.rmtree(out)
    shutil.copytree(old, out)
    _, times = undisturbed(tmp_path / "note", words)
    source, last = random.Random(f"{name} {number}"), [len(times) - 6 - 5 * i for i in range(4)]
    stops = [partial(ended_at, event) for event in [*chosen(times, 3, 7), *last]]
    stops += [partial(ended_after, source.uniform(0.3, 1.0) * (times[-1] - times[0])) for _ in range(3)]
    hits = news = left = 0
    for stop in stops:
        shutil.rmtree(out)
        shutil.copytree(old, out)
        ended = stop(number, words)
        assert ended.status in (0, -number, 128 + number), ended.err
        assert "Traceback" not in ended.err
        assert gone_within(ended.group, ORPHANS_END_S), "processes run on"
        assert len(litter(out)) <= (number == signal.SIGKILL)
        assert list(temporary.iterdir()) == []
        seen = Path(shutil.copytree(out, tmp_path / "seen"))
        for unit in earlier:
            put_back(seen / unit)
        for unit, content in units(seen).items():
            assert content in (earlier[unit], whole[unit])
            news += unit in changed and content == whole[unit]
        assert units(seen).keys() == earlier.keys()
        shutil.rmtree(seen)
        hits, left = hits + (ended.status != 0), left + len(litter(out))
        again = finished(words)
        assert again.status == 0, again.err
        assert units(out) == whole
        assert litter(out) == []
    tally(
        f"{name}: {hits} of {len(stops)} {number.name} at work, {news} units were new, {left} left a folder, which went"
    )


CAMPAIGNS = {
    "study": ["study", "paris", "--t-end", "60", "--no-formulations", "--methods"],
    "stability": ["stability", "--scenes", "hard", "--methods"],
}


@pytest.mark.parametrize("name", ["study", pytest.param("stability", marks=pytest.mark.long)])
def test_a_campaign_goes_on_where_it_was_killed(
    name: str, tmp_path: Path, size: Size, tally: Tally, foucault: Foucault
) -> None:
    """In every run a study alone is killed once, when its first row was stored; else at any moments."""
    pytest.importorskip("scipy")
    out = tmp_path / "out"
    words = [*CAMPAIGNS[name], ["heyoka_double", "heyoka_double,scipy_dop853"][size(0, 1)], "--json", "--out", out]
    status, text, _ = foucault(*words)
    assert status == 0
    whole = rows(text)
    shutil.rmtree(out)
    stops = size(
        lambda: [partial(killed_when, words, lambda: journal(out))],
        lambda: [partial(killed, words, event) for event in chosen(undisturbed(tmp_path / "note", words)[1], 20, 6)],
    )()
    hits = resumed = kept = 0
    for stop in stops:
        shutil.rmtree(out, ignore_errors=True)
        hits += stop().status == -signal.SIGKILL
        stored = journal(out)
        kept += len(stored)
        assert len(litter(out)) <= 1
        status, text, err = foucault(*words)
        assert status == 0, err
        assert rows(text) == whole
        assert journal(out)[: len(stored)] == stored  # nothing was measured twice
        assert len(journal(out)) == len(whole)
        assert litter(out) == []
        resumed += 1
    assert hits == resumed == len(stops)
    assert kept >= 1
    tally(f"{name}: {hits} kills at work, {kept} of {hits * len(whole)} rows were stored by then, same rows after")


def journal(out: Path) -> list[str]:
    return [line for path in out.glob("*.jsonl") for line in path.read_text().splitlines()] if out.exists() else []


def rows(text: str) -> list[dict[str, Any]]:
    return [{key: row[key] for key in row if key not in TIMES} for row in json.loads(text)["rows"]]


def test_a_score_after_a_kill_is_the_same(
    tmp_path: Path, own_cache: Path, size: Size, tally: Tally, foucault: Foucault
) -> None:
    """In every run it is killed once, when the scene is being stored; else at any moments, and explains the error."""
    candidate = tmp_path / "mine.csv"
    candidate.write_text("t,x,y\n0,0.3,0.4\n30,0.1,0.1\n60,0.2,-0.3\n")
    words: list[object] = ["score", "paris", candidate, "--set", "site.latitude=40", "--set", "run.t_end=60", "--json"]
    words += ["--tolerance", 1e-15, *size(["--no-diagnosis"], [])]  # cheap runs do not decide it, and store nothing
    status, whole, _ = foucault(*words)
    stops = size(
        lambda: [partial(killed_when, words, lambda: list(own_cache.glob("golden/*")))],
        lambda: [partial(killed, words, event) for event in chosen(undisturbed(tmp_path / "note", words)[1], 20, 13)],
    )()
    hits = begun = 0
    for stop in stops:
        for kind in ("golden", "dense", "floor"):
            shutil.rmtree(own_cache / kind, ignore_errors=True)
        hits += stop().status == -signal.SIGKILL
        begun += bool(list(own_cache.glob("golden/*")))
        assert len(litter(own_cache)) <= 1
        again = finished(words)  # this process knows the truth, and reads no cache
        assert (again.status, json.loads(again.out)) == (status, json.loads(whole))
        assert litter(own_cache) == []
    assert hits == len(stops) and begun
    tally(f"score: {hits} kills at work, {begun} of them once the solved scene was being stored, same document after")
