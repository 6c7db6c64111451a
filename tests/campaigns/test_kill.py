"""A command that is killed, or ended by Ctrl-C, SIGTERM or SIGHUP, at any moment: every format.

Nothing half written is taken for whole, nothing runs on, and the same command gives what it would have given. In every
run once for each format: as files are put in place, or once something is stored. Under --long at moments of the whole
run, and at its last events, which are those that touch the folder.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
from formats import FORMATS, Made, contents, litter, restored, stored
from interruption import gone_within, interrupted
from moments import Ended, chosen, ended_at, undisturbed
from places import ROOT

from reference.scenes.shipped import golden_root

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/stat").exists(), reason="counts processes in /proc"
)

ORPHANS_END_S = 10.0
SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OFTEN = {
    ("dataset", signal.SIGKILL),
    ("sweep", signal.SIGINT),
}
ENDS = [
    pytest.param(
        name,
        number,
        id=f"{name} {number.name}",
        marks=[] if (name, number) in OFTEN else pytest.mark.long,
    )
    for name in [*FORMATS, "sweep in processes"]
    for number in SIGNALS
]
MOVED_ASIDE = 1  # of the renames of a dataset: the old one was moved, the new one is not there yet


def ended_once_stored(words: list[str], folder: Path, number: signal.Signals) -> Ended:
    """Run a command, and end it once it has stored something."""
    group = number != signal.SIGKILL
    status, err, pid = interrupted(
        words, lambda *_: bool(stored(folder)), number, whole_group=group
    )
    return Ended(status, "", err.decode(), pid)


def stops(
    made: Made, words: list[str], folder: Path, number: signal.Signals, note: Path, long: bool
):
    """Return what runs the command and ends it, once for each moment."""
    if not long and made.format.resumes:
        return [lambda: ended_once_stored(words, folder, number)]
    if not long:
        return [lambda: ended_at(MOVED_ASIDE, number, words, "os.rename")]
    _, times = undisturbed(note, words)
    last = [len(times) - 1 - 4 * k for k in range(3)]
    return [
        lambda event=event: ended_at(event, number, words)
        for event in [*chosen(times, 4, 1), *last]
    ]


def well_ended(ended: Ended, number: signal.Signals, folder: Path, threads: bool = False) -> None:
    """Check how a command ended that was told to: in one line, and with all that it had started.

    Threads that save a part are not waited for; the hidden folder of one goes with the next run.
    """
    assert ended.status in (0, -number, 128 + number), ended.err
    assert "Traceback" not in ended.err
    assert gone_within(ended.group, ORPHANS_END_S), "processes run on"
    assert len(litter(folder.parent)) <= (threads or number == signal.SIGKILL)
    messages = [
        line
        for line in ended.err.splitlines()
        if line.startswith("foucault: ") and ": about " not in line
    ]
    assert len(messages) <= 1 and all("stopped" in message for message in messages), ended.err
    assert messages or number != signal.SIGINT or ended.status in (0, -number), ended.err


@pytest.mark.parametrize(("made", "number"), ENDS, indirect=["made"])
def test_nothing_half_is_whole_and_the_same_command_goes_on(made, number, tmp_path, size, tally):
    counts: Counter[str] = Counter()
    folder = made.begun(tmp_path / "place")
    words = made.format.command(folder)
    for stop in stops(made, words, folder, number, tmp_path / "note", size(False, True)):
        made.begun(tmp_path / "place")
        ended = stop()
        well_ended(ended, number, folder, threads=made.format.name == "sweep")
        counts["ended at work"] += ended.status != 0
        counts[made.is_nothing_half(folder)] += 1
        before = stored(folder)
        assert made.foucault(*words)[0] == 0
        made.is_whole(folder)
        assert [path.name for path in folder.parent.iterdir()] == ["out"]
        if made.format.name == "study" and ended.status != 0:  # nothing was measured twice
            after = stored(folder)
            assert before.items() <= after.items()
            assert len(after) == len(stored(made.whole))
    assert counts["ended at work"]
    tally(f"{number.name} of a {made.format.name}: {dict(counts)}")


def test_a_score_after_a_kill_is_the_same(tmp_path, monkeypatch, foucault):
    """It is killed as the solved scene is being kept in the cache."""
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    candidate = tmp_path / "mine.csv"
    candidate.write_text("t,x,y\n0,0.3,0.4\n30,0.1,0.1\n60,0.2,-0.3\n")
    words = [
        "score",
        "paris",
        str(candidate),
        "--set",
        "site.latitude=40",
        "--set",
        "run.t_end=60",
        "--json",
    ]
    words += ["--tolerance", "1e-15", "--no-diagnosis"]
    status, whole, _ = foucault(*words)
    shutil.rmtree(tmp_path / "cache" / "golden")
    kept = (tmp_path / "cache").glob
    interrupted(words, lambda *_: any(kept("golden/*")), signal.SIGKILL)
    # in another process: this one knows the truth, and reads no cache
    again = ended_at(-1, signal.SIGKILL, words)
    assert (again.status, json.loads(again.out)) == (status, json.loads(whole))
    assert litter(tmp_path / "cache") == []


@pytest.mark.long
@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_each_page_of_an_atlas_is_the_old_or_the_new_one(number, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    data, old, out = tmp_path / "data", tmp_path / "old", tmp_path / "out"
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    for scene in ("conical", "pantheon", "paris"):
        shutil.copytree(golden_root() / scene, data / scene)
    first = ["atlas", "--data", str(data), "--out", str(out), "--files"]
    assert ended_at(-1, number, [*first, "https://example.org/old"]).status == 0
    out.rename(old)
    words = [*first, "https://example.org/new"]
    assert ended_at(-1, number, words).status == 0
    whole, before = contents(out), contents(old)
    assert whole.keys() == before.keys() and whole != before
    restored(out, old)
    _, times = undisturbed(tmp_path / "note", words)
    for event in [*chosen(times, 3, 7), *(len(times) - 6 - 5 * k for k in range(4))]:
        restored(out, old)
        ended = ended_at(event, number, words)
        well_ended(ended, number, out)
        assert list(temporary.iterdir()) == []
        pages = {name: data for name, data in contents(out).items() if "partial-" not in name}
        assert all(page in (before[name], whole[name]) for name, page in pages.items())
        again = ended_at(-1, number, words)
        assert again.status == 0, again.err
        assert contents(out) == whole


def children(parent: int) -> list[int]:
    """Return the processes that a process has started."""
    return [
        int(word)
        for path in Path(f"/proc/{parent}/task").glob("*/children")
        for word in path.read_text().split()
    ]


@pytest.mark.skipif(
    not Path(f"/proc/self/task/{os.getpid()}/children").exists(), reason="lists processes in /proc"
)
@pytest.mark.long
@pytest.mark.parametrize("made", ["sweep in processes"], indirect=True)
def test_a_worker_that_is_killed_at_work_costs_no_row_and_no_byte(made, tmp_path):
    source, killed = random.Random(8), 0
    for number in range(5):
        folder = tmp_path / str(number)
        made.format.prepare(folder)
        command = [
            sys.executable,
            "-m",
            "foucault",
            "sweep",
            "--workers",
            "2",
            "--out",
            str(folder),
        ]
        at_work = source.randrange(3)
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as process:
            while process.poll() is None and killed == number:
                workers = children(process.pid)
                if len(stored(folder)) >= at_work and workers:
                    time.sleep(source.uniform(0.0, 0.3))
                    os.kill(source.choice(workers), signal.SIGKILL)  # its parent still waits for it
                    killed += 1
                time.sleep(0.01)
        assert process.returncode == 0
        made.is_whole(folder)
    assert killed == 5
