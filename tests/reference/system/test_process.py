"""A child process: it takes objects while it works, streams its results, and ends with its parent."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import child
import pytest
from child import count_to, doubled, finalise, freeze, refuse
from places import ROOT

from reference.errors import IntegrationError
from reference.system import process
from reference.system.process import Worker


def test_results_come_in_order_and_end_with_the_function():
    worker = Worker(count_to, 5)
    assert list(worker) == [1, 2, 3, 4, 5]
    worker.stop()
    assert worker._process.returncode == 0


def test_a_child_takes_objects_while_it_works_and_ends_when_its_parent_stops():
    worker = Worker(doubled, 3)
    worker.send(2)
    worker.send("ab" * 500_000)  # more than a pipe holds
    assert worker.receive() == 6
    assert worker.receive() == "ab" * 1_500_000
    worker.send(5)
    assert worker.receive() == 15
    worker.stop()
    assert worker._process.poll() is not None


def test_a_child_whose_parent_ends_before_it_sends_anything_ends_without_a_word():
    command = [sys.executable, "-c", process._START, *sys.path]
    child = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    assert (child.returncode, child.stdout, child.stderr) == (1, b"", b"")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("started", [False, True])
def test_a_signal_to_the_whole_group_leaves_the_end_of_a_child_to_its_parent(number, started, capfd):
    """Ctrl-C reaches children too, also while they begin; a child that ended by itself would look like a crash."""
    worker = Worker(doubled, 3)
    if started:
        worker.send(1)
        assert worker.receive() == 3
    os.kill(worker._process.pid, number)
    worker.send(2)
    assert worker.receive() == 6
    worker.stop()
    assert worker._process.returncode == 0
    assert capfd.readouterr().err == ""


def test_a_child_that_is_in_a_finaliser_as_its_parent_stops_ends_without_a_word(capfd):
    worker = Worker(finalise)
    assert worker.receive() == "finalising"
    worker.stop()
    assert capfd.readouterr().err == ""


@pytest.mark.skipif(sys.platform != "linux", reason="signals to threads")
def test_a_child_clears_away_what_it_began_when_its_parent_is_killed(tmp_path):
    code = f"""
import sys; sys.path.insert(0, {str(Path(child.__file__).parent)!r})
from child import hold
from reference.system.process import Worker
worker = Worker(hold, {str(tmp_path)!r})
print(worker.receive(), flush=True)
worker.receive()
"""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, cwd=ROOT) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"held\n"
        parent.kill()
        assert parent.stdout.read() == b""
    end = time.monotonic() + 60
    while not (tmp_path / "cleared").exists() and time.monotonic() < end:  # the child ends a moment after its parent
        time.sleep(0.01)
    assert (tmp_path / "cleared").exists()


def test_an_error_of_the_function_arrives_as_an_integration_error():
    worker = Worker(refuse)
    with pytest.raises(IntegrationError, match="a length above 0"):
        worker.receive()
    worker.stop()


def test_a_child_that_is_killed_is_an_error_and_no_silence():
    worker = Worker(doubled, 1)
    worker.kill()
    with pytest.raises(IntegrationError, match="ended without a result"):
        list(worker)
    worker.stop()


def test_a_child_that_does_not_end_is_killed_even_while_a_thread_waits_for_it(monkeypatch):
    monkeypatch.setattr(process, "GRACE_S", 0.2)
    worker = Worker(freeze)
    os.waitid(os.P_PID, worker._process.pid, os.WSTOPPED | os.WNOWAIT)
    waiting = threading.Thread(target=_receive_nothing, args=(worker,), daemon=True)
    waiting.start()
    worker.stop()
    waiting.join(5)
    assert worker._process.returncode == -9
    assert not waiting.is_alive()


def _receive_nothing(worker: Worker) -> None:
    with contextlib.suppress(IntegrationError, ValueError):  # the latter if the pipe is closed before it waits
        worker.receive()
