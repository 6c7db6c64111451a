"""Long work says how long it will still take, by the rate of its last seconds; short work says nothing."""

from __future__ import annotations

import io
import sys
import time

import pytest

import reference
from reference.commands.narrowing import Narrowing
from reference.commands.progress import Work, duration_in_words, progress
from reference.system.channel import ACTIVITY


class Clock:
    """A clock that a test sets."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr("time.monotonic", clock)
    return clock


def test_steady_work_is_expected_at_its_rate(clock):
    work = Work("paris", 100.0)
    for second in range(11):
        clock.now = 100.0 + second
        work.move(float(second))
    assert work.remaining_s() == pytest.approx(90.0)
    assert (
        work.remaining() == "about 90 seconds left" or work.remaining() == "about 1.5 minutes left"
    )


def test_a_slow_start_is_forgotten_after_five_seconds(clock):
    """Ten seconds for the first per cent, then ten per cent a second."""
    work = Work("pantheon", 100.0)
    work.move(0.0)
    clock.now = 110.0
    work.move(1.0)
    for second in range(1, 7):
        clock.now = 110.0 + second
        work.move(1.0 + 10.0 * second)
    assert work.remaining_s() == pytest.approx(3.9)


def test_coarse_ticks_count_down_between_them(clock):
    """A sweep's block every thirty seconds: between two ticks the remaining time goes down with the clock."""
    work = Work("sweep", 4, "blocks")
    work.move(0)
    clock.now = 130.0
    work.move(1)
    assert work.remaining_s() == pytest.approx(90.0)
    clock.now = 150.0
    assert work.remaining_s() == pytest.approx(70.0)
    clock.now = 190.0  # it has become slower: one block in ninety seconds
    assert work.remaining_s() == pytest.approx(3 * 90.0)


def test_runs_that_differ_are_expected_to_take_as_long_as_all_before(clock):
    """Ten slow runs in 100 s, ten fast ones in a second: the next may be either."""
    work = Work("paris", 60, "runs")
    for done in range(11):
        clock.now = 100.0 + 10.0 * done
        work.move(done)
    for done in range(10, 21):
        clock.now = 200.0 + 0.1 * (done - 10)
        work.move(done)
    assert work.remaining_s() == pytest.approx(40 * 101.0 / 20)


def test_what_comes_before_the_first_progress_tells_nothing_about_its_rate(clock):
    """A sweep compiles for eight seconds, and then solves ten rows a second."""
    work = Work("sweep", 100, "rows")
    work.move(0)
    clock.now = 108.0
    work.begin("solving rows")
    clock.now = 110.0
    work.move(20)
    assert work.remaining_s() == pytest.approx(8.0)


def test_what_follows_a_piece_of_work_is_counted(clock):
    """A sweep of 100 rows at ten a second, and an audit that takes as long as 40 rows."""
    work = Work("sweep", 100, "rows", later=40)
    for second in range(11):
        clock.now = 100.0 + second
        work.move(10.0 * second)
    assert (work.remaining_s(), work.counted) == (pytest.approx(4.0), "100 of 100 rows")
    clock.now = 112.0
    work.move(120.0, item="auditing 2 rows")  # half of the audit
    assert (work.remaining_s(), work.counted) == (pytest.approx(2.0), "100 of 100 rows")


def test_work_that_starts_again_is_estimated_from_its_new_start(clock):
    work = Work("hard", 100.0)
    work.move(0.0)
    clock.now = 119.0
    work.move(90.0)
    clock.now = 121.0
    work.move(1.0)  # the precision was raised
    assert work.remaining_s() is None
    clock.now = 131.0
    work.move(11.0)
    assert work.remaining_s() == pytest.approx(89.0)


def test_what_was_stored_before_costs_nothing(clock):
    work = Work("paris", 130, "runs")
    for done in range(30, 51):
        work.move(done, item="rk4")
        clock.now += 1.0
    assert work.remaining_s() == pytest.approx(80.0 - 1.0)
    assert (work.description, work.counted) == ("paris: rk4", "50 of 130 runs")


def test_a_line_comes_after_twenty_seconds_and_then_at_twice_the_time(clock, capsys):
    with progress() as show:
        move = show("creeping", 86400.0)
        ACTIVITY.send("proving")
        for second in range(100):
            clock.now = 100.0 + second
            move(144.0 * second)
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == [
        "creeping: proving: about 9.7 minutes left, 4 % of the simulated 86,400 s after 21 s",
        "creeping: proving: about 9.3 minutes left, 7 % of the simulated 86,400 s after 43 s",
        "creeping: proving: about 8.6 minutes left, 14 % of the simulated 86,400 s after 87 s",
    ]


class Terminal(io.StringIO):
    """A terminal that keeps what is written to it."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


def written_in_two_seconds(terminal: Terminal) -> str:
    """Return what a terminal shows from now on, at most for two seconds, until it shows something."""
    start = len(terminal.getvalue())
    end = time.perf_counter() + 2.0
    while time.perf_counter() < end and len(terminal.getvalue()) == start:
        time.sleep(0.02)
    return terminal.getvalue()[start:]


def test_a_terminal_gets_a_sign_of_life_while_files_are_written_after_the_work(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress() as show:
        solving = show("the truth", 60.0)
        drawing = show("paris", 60.0)
        solving(60.0)
        drawing(60.0)
        ACTIVITY.send("writing")
        time.sleep(0.3)  # what was drawn before
        shown = written_in_two_seconds(terminal)
    assert "paris: writing" in shown
    assert "the truth" not in shown


def test_short_work_gets_no_line(clock, capsys):
    with progress() as show:
        move = show("paris", 3600.0)
        for second in range(21):
            clock.now = 100.0 + second
            move(180.0 * second)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (41.7, "42 seconds"),
        (651.0, "11 minutes"),
        (5000.0, "83 minutes"),
        (12600.0, "3.5 hours"),
        (2e5, "2.3 days"),
    ],
)
def test_a_rough_time_has_two_digits_and_the_unit_that_suits_it(seconds, words):
    assert duration_in_words(seconds) == words


def test_the_search_for_narrower_inputs_moves_on_within_a_proof_and_ends_by_its_total():
    scene = reference.load_scene("two_radians", ["run.t_end=2", "run.grid_step=2"])
    reports = []
    narrowing = Narrowing(
        scene, {"release.angle": "2"}, 1, lambda done, total: reports.append((done, total))
    )
    narrowing.for_the_run(0.0)
    assert any(completed % 1 for completed, _ in reports)
    assert all(completed <= total for completed, total in reports)
