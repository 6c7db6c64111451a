"""Compiling is announced once, to whoever listens."""

from __future__ import annotations

import pytest

from reference.system import first_use


@pytest.fixture(autouse=True)
def nothing_announced(monkeypatch):
    monkeypatch.setattr(first_use, "_announced", set())


def test_who_listens_is_told_once():
    told: list[str] = []
    first_use.announce("limbs", 20)  # nobody listens
    with first_use.announced_to(told.append):
        first_use.announce("limbs", 20)
        first_use.announce("limbs", 20)
    first_use.announce("others", 5)
    assert told == ["First use on this machine: limbs are compiled, once, for about 20 seconds."]
