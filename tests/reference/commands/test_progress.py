"""Long work says once how long it will take; short work says nothing."""

from __future__ import annotations

import pytest

from reference.commands.progress import in_words, notice, progress


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


def test_long_work_gets_one_line_and_no_more(clock, capsys):
    move = notice("creeping", 86400.0)
    for seconds in range(200):
        clock.now = 100.0 + seconds
        move(144.0 * seconds)
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "creeping: about 10 minutes: 3,024 of 86,400 s simulated after 21 s\n"


def test_short_work_gets_none(clock, capsys):
    move = notice("paris", 3600.0)
    for seconds in range(21):
        clock.now = 100.0 + seconds
        move(180.0 * seconds)
    assert capsys.readouterr().err == ""


def test_work_that_begins_late_is_estimated_from_its_own_rate(clock, capsys):
    """Compilation took 40 s before the first step; then 10 s for a tenth of the way: 90 s remain, 140 s in all."""
    move = notice("creeping", 100.0)
    clock.now = 140.0
    move(0.0)
    clock.now = 144.0
    move(4.0)
    assert capsys.readouterr().err == ""  # too early for an estimate
    clock.now = 150.0
    move(10.0)
    assert (
        capsys.readouterr().err == "creeping: about 2.3 minutes: 10 of 100 s simulated after 50 s\n"
    )


def test_work_that_starts_again_is_estimated_from_its_new_start(clock, capsys):
    move = notice("hard", 100.0)
    move(0.0)
    clock.now = 119.0
    move(90.0)
    clock.now = 121.0
    move(1.0)  # the precision was raised
    clock.now = 131.0
    move(11.0)
    assert capsys.readouterr().err == "hard: about 2 minutes: 11 of 100 s simulated after 31 s\n"


def test_the_first_steps_are_too_few_for_an_estimate_unless_they_take_a_minute(clock, capsys):
    move = notice("creeping", 100.0)
    for seconds in range(100):
        clock.now = 100.0 + seconds
        move(0.004 * seconds)
    assert (
        capsys.readouterr().err == "creeping: about 6.9 hours: 0.24 of 100 s simulated after 61 s\n"
    )


def test_runs_are_counted_and_those_that_were_stored_cost_nothing(clock, capsys):
    move = notice("paris", unit="runs")
    for done in range(30, 60):
        move(done, 130, "rk4")
        clock.now += 1.0
    assert capsys.readouterr().err == "paris: about 1.7 minutes: 51 of 130 runs after 21 s\n"


def test_without_a_terminal_the_notice_is_what_moves(capfd):
    with progress() as show:
        move = show("paris", 60.0)
        move(30.0)
    assert capfd.readouterr().err == ""


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
    assert in_words(seconds) == words
