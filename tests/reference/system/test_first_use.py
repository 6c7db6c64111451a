"""Compiling is announced once, to whoever listens, and only where it takes long."""

from __future__ import annotations

import importlib.util

import pytest

from reference.system import first_use

FUNCTION = """
import numba
from reference.system.machine_code import kept

with kept({words}):
    @numba.njit(cache=True)
    def double(x):
        return 2 * x
"""


@pytest.fixture(autouse=True)
def nothing_announced(monkeypatch):
    monkeypatch.setattr(first_use, "_announced", set())


def test_who_listens_is_told_once():
    told: list[str] = []
    first_use.announce("limbs", 20)  # nobody listens
    with first_use.announced_to(told.append):
        first_use.announce("limbs", 20)
        first_use.announce("limbs", 20)
        first_use.announce("", 0)
    first_use.announce("others", 5)
    assert told == ["First use on this machine: limbs are compiled, once, for about 20 seconds."]


@pytest.mark.parametrize(("words", "count"), [('"functions", 3', 1), ("", 0)])
def test_a_function_that_is_kept_on_disk_is_not_announced_again(words, count, tmp_path):
    pytest.importorskip("numba")
    path = tmp_path / "doubled.py"
    path.write_text(FUNCTION.format(words=words))
    told: list[str] = []
    for _ in range(2):
        spec = importlib.util.spec_from_file_location("doubled", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        with first_use.announced_to(told.append):
            assert module.double(21) == 42
        first_use._announced.clear()
    assert len(told) == count
