"""Work in other processes: it streams its results, a death is told, and it ends with its parent."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import CancelledError, Future
from pathlib import Path

import child
import pytest
from child import count_to, die, die_once, doubled, finalise, freeze, refuse
from places import ROOT

from reference.errors import IntegrationError
from reference.system.workers import Pool, Worker, WorkerDied, as_done


def test_results_come_in_order_and_end_with_the_function():
    worker = Worker(count_to, 5)
    assert list(worker) == [1, 2, 3, 4, 5]
    worker.stop()
    assert worker.ended


def test_a_child_takes_objects_while_it_works_and_ends_when_its_parent_stops():
    worker = Worker(doubled, 3)
    worker.send(2)
    worker.send("ab" * 500_000)  # more than a pipe holds
    assert worker.receive() == 6
    assert worker.receive() == "ab" * 1_500_000
    worker.send(5)
    assert worker.receive() == 15
    worker.stop()
    assert worker.ended


def parent(code: str) -> list[str]:
    """Return the command of a process that has children: a program that may use what tests run in them."""
    return [
        sys.executable,
        "-c",
        f"import sys; sys.path.insert(0, {str(HELPERS)!r})\n{BEGUN}{code}",
    ]


HELPERS = Path(child.__file__).parent
BEGUN = """
import os, signal
from child import DeadlyArgument, doubled, hold
from reference.system.workers import Worker
"""


def test_a_child_whose_parent_ends_before_it_sends_anything_ends_without_a_word():
    # returns when the child, too, has closed its stderr
    ended = subprocess.run(
        parent("Worker(doubled, DeadlyArgument())"), capture_output=True, cwd=ROOT, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (-signal.SIGKILL, b"", b"")


SIGNALLED = """
worker = Worker(doubled, 3)
if {started}:
    worker.send(1)
    assert worker.receive() == 3
signal.signal({number}, lambda *_: print("signalled"))
os.killpg(0, {number})
worker.send(2)
print(worker.receive())
worker.stop()
"""


@pytest.mark.parametrize(
    ("number", "started"),
    [
        (signal.SIGINT, False),
        (signal.SIGTERM, False),
        (signal.SIGHUP, False),
        (signal.SIGINT, True),
    ],
)
def test_a_signal_to_the_whole_group_leaves_the_end_of_a_child_to_its_parent(number, started):
    """Ctrl-C reaches children too, also while they begin; a child that ended by itself would look like a crash."""
    program = parent(SIGNALLED.format(number=int(number), started=started))
    ended = subprocess.run(
        program, capture_output=True, text=True, cwd=ROOT, start_new_session=True, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "signalled\n6\n", "")


def test_a_child_that_is_in_a_finaliser_as_its_parent_stops_ends_without_a_word(capfd):
    worker = Worker(finalise)
    assert worker.receive() == "finalising"
    worker.stop()
    assert capfd.readouterr().err == ""


@pytest.mark.skipif(sys.platform != "linux", reason="signals to threads")
def test_a_child_clears_away_what_it_began_when_its_parent_is_killed(tmp_path):
    holding = parent(f"""
worker = Worker(hold, {str(tmp_path)!r})
print(worker.receive(), flush=True)
worker.receive()
""")
    with subprocess.Popen(holding, stdout=subprocess.PIPE, cwd=ROOT) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"held\n"
        process.kill()
        assert process.stdout.read() == b""
    end = time.monotonic() + 60
    # the child ends a moment after its parent
    while not (tmp_path / "cleared").exists() and time.monotonic() < end:
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
    with pytest.raises(IntegrationError, match="ended before it returned a result"):
        list(worker)
    worker.stop()


@pytest.mark.long
def test_a_child_that_does_not_end_is_killed_even_while_a_thread_waits_for_it():
    """After ten seconds."""
    worker = Worker(freeze)
    os.waitid(os.P_PID, worker.receive(), os.WSTOPPED | os.WNOWAIT)
    waiting = threading.Thread(target=receive_nothing, args=(worker,), daemon=True)
    waiting.start()
    worker.stop()
    waiting.join(5)
    assert worker.ended
    assert not waiting.is_alive()


def receive_nothing(worker: Worker) -> None:
    # the latter if the pipe is closed before it waits
    with contextlib.suppress(IntegrationError, ValueError):
        worker.receive()


def test_a_result_that_takes_too_long_is_not_waited_for():
    worker = Worker(doubled, 1)
    with pytest.raises(TimeoutError):
        worker.receive(0.01)
    worker.send(2)
    assert worker.receive(60) == 2
    worker.stop()


def test_a_pool_gives_results_and_tells_a_death_that_happens_twice(tmp_path):
    with Pool(2) as pool:
        sums = [pool.submit(sum, [number, 1]) for number in range(5)]
        killed, second = pool.submit(die), pool.submit(die_once, str(tmp_path))
        assert [future.result() for future in sums] == [1, 2, 3, 4, 5]
        with pytest.raises(WorkerDied, match="ended before it returned a result"):
            killed.result()
        assert second.result() == "alive"
        with pytest.raises(FileNotFoundError):
            pool.submit(os.stat, str(tmp_path / "none")).result()


def test_a_worker_that_is_killed_while_idle_costs_no_try(tmp_path):
    with Pool(1) as pool:
        idle = pool.submit(os.getpid).result()
        os.kill(idle, signal.SIGKILL)
        os.waitid(os.P_PID, idle, os.WEXITED | os.WNOWAIT)
        assert pool.submit(die_once, str(tmp_path)).result() == "alive"
        assert pool.submit(os.getpid).result() != idle


def test_a_pool_that_is_interrupted_ends_what_is_begun_and_begins_nothing_again():
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt), Pool(2) as pool:
        sleeping = [pool.submit(time.sleep, 600) for _ in range(4)]
        while not all(future.running() for future in sleeping[:2]):
            time.sleep(0.01)
        raise KeyboardInterrupt
    assert time.monotonic() - started < 60
    for future in sleeping:
        with pytest.raises(CancelledError):
            future.result(timeout=0)


def test_what_is_done_comes_first_and_no_more_is_begun_at_once_than_asked():
    begun: list[Future[int]] = []

    def unfinished() -> list[Future[int]]:
        return [future for future in begun if not future.done()]

    def begin(item: int) -> Future[int]:
        begun.append(Future())
        assert len(unfinished()) <= 3
        if item == 2:
            begun[-1].set_result(0)
        return begun[-1]

    order = []
    for item, future in as_done(begin, range(5), 3):
        assert future.done()
        order.append(item)
        for last in unfinished()[-1:]:
            last.set_result(0)
    assert order == [2, 1, 3, 4, 0]


def test_where_nothing_will_come_any_more_the_wait_ends():
    """It looks every five seconds."""

    def lost() -> None:
        raise ConnectionError

    with pytest.raises(ConnectionError):
        list(as_done(lambda _: Future(), range(1), 1, lost))
