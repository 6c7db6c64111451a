"""Signals that end a run: none is lost while they are held back, and the alarms of others go on."""

from __future__ import annotations

import os
import signal
import sys

import pytest

from reference.system.interruption import held, terminable


@pytest.fixture
def received():
    """Signals that arrive, whose handlers are replaced for a test."""
    numbers = []
    before = {}
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGALRM):
        before[number] = signal.signal(number, lambda number, _: numbers.append(number))
    yield numbers
    signal.setitimer(signal.ITIMER_REAL, 0)
    for number, handler in before.items():
        signal.signal(number, handler)


def test_every_signal_that_was_held_back_is_handled_in_its_order(received):
    with held():
        os.kill(os.getpid(), signal.SIGALRM)
        os.kill(os.getpid(), signal.SIGALRM)
        assert received == []
    assert received == [signal.SIGALRM, signal.SIGALRM]


def test_a_signal_that_was_held_back_is_handled_after_an_exception(received):
    with pytest.raises(ValueError, match="of the body"), held():
        os.kill(os.getpid(), signal.SIGALRM)
        raise ValueError("of the body")
    assert received == [signal.SIGALRM]


def test_a_held_signal_that_ends_the_run_does_so_in_the_place_of_an_exception():
    with pytest.raises(SystemExit) as end, terminable(), held():
        os.kill(os.getpid(), signal.SIGTERM)
        raise ValueError("of the body")
    assert end.value.code == 128 + signal.SIGTERM


def test_an_alarm_with_a_handler_of_its_own_is_left_alone(received):
    signal.setitimer(signal.ITIMER_REAL, 600)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with pytest.raises(SystemExit), terminable():
        os.kill(os.getpid(), signal.SIGTERM)
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 0


def test_an_alarm_without_a_handler_is_set_again(received):
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, 600)
    with pytest.raises(SystemExit), terminable():
        os.kill(os.getpid(), signal.SIGTERM)
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 1


def test_what_reports_unraisable_exceptions_is_as_it_was():
    hook = sys.unraisablehook
    with pytest.raises(ValueError, match="of the body"), terminable():
        assert sys.unraisablehook is not hook
        raise ValueError("of the body")
    assert sys.unraisablehook is hook
