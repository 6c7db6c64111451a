"""Engines are found by their folders; each keeps the same contract; the cheapest that serves is taken."""

from __future__ import annotations

import sys
from fractions import Fraction
from itertools import pairwise

import pytest
from places import ROOT

from reference.engines import AUTO, engine_names
from reference.engines.registry import checked, engines, fastest, run
from reference.errors import InputError
from reference.numbers.columns import RUN
from reference.numbers.taylor_step import EARTH, LOCAL
from reference.scenes.scene import load_scene

TIMES = (Fraction(0), Fraction(7), Fraction(60))


@pytest.fixture(params=engine_names())
def engine(request):
    one = engines()[request.param]
    if not one.installed:
        pytest.skip(f"needs {', '.join(one.requires)}")
    return one


def test_an_engine_is_a_folder_with_a_declaration():
    folders = {path.parent.name for path in (ROOT / "reference/engines").glob("*/engine.py")}
    assert set(engine_names()) == folders == set(engines()) >= {"heyoka", "limbs"}
    for name, one in engines().items():
        assert one.name == name


@pytest.mark.parametrize("name", ["paris", "damped", "two_radians"])
def test_every_engine_gives_the_same_digits_and_transits(engine, name):
    scene = load_scene(name).exact
    plan = engine.plan(scene, 128, TIMES, ("xdot",))
    assert plan.engine == engine.name
    result = run(plan)
    other = run(engines()["heyoka"].plan(scene, 160, TIMES, ("xdot",)))
    assert result.grid.columns == RUN
    assert result.transits.columns == ("t", *RUN)
    assert max(other.grid.distance(result.grid).largest().values()) < Fraction(1, 10**33)
    assert max(other.transits.distance(result.transits).largest().values()) < Fraction(1, 10**32)
    assert result.directions == other.directions
    assert (result.tension > 0) == (name != "two_radians")  # there the rod pushes


def test_every_engine_gives_the_taylor_steps_of_its_run(engine, paris):
    chain, steps = engine.taylor_steps(paris.exact, TIMES, 128, 148), []
    while True:
        try:
            steps.append(next(chain))
        except StopIteration as end:
            result = end.value
            break
    assert steps[0].centre == 0
    assert all(a.centre + a.h == b.centre for a, b in pairwise(steps))
    assert steps[-1].centre + steps[-1].h > 60
    for step in steps:
        assert step.columns in (LOCAL, EARTH)
        assert (step.low, step.high) == (0, 1)
        x = Fraction(step.coefficients[0][0], 2**step.bits) * 67
        assert abs(x) < Fraction(51, 100)
    assert [float(t) for t in result.plan.times] == [0, 7, 60]
    assert len(result.grid) == 3


def test_the_cheapest_engine_that_serves_is_taken():
    assert fastest(53).name == fastest(64, "limbs").name == "heyoka"
    assert fastest(160, "heyoka").name == "heyoka"
    assert fastest(5000, "limbs").name == "heyoka"  # limbs have not so many bits
    limbs = engines()["limbs"]
    assert fastest(160).name == (limbs.name if limbs.installed else "heyoka")
    # limbs take longer to start than heyoka to arrive
    assert fastest(160, steps=100).name == "heyoka"
    assert fastest(108, steps=800).name == fastest(108, steps=100, proof=True).name == "heyoka"
    # a proof has fewer and cheaper steps of limbs
    assert fastest(108, steps=800, proof=True).name == fastest(160).name
    assert fastest(160, "limbs", steps=100).name == fastest(160).name
    assert limbs.expected_s(1000, 160) < engines()["heyoka"].expected_s(1000, 160)


def test_an_engine_that_is_not_there_is_refused(monkeypatch):
    assert checked(None) == checked(AUTO) == AUTO
    with pytest.raises(InputError, match=r"one of auto, .*heyoka, .*limbs"):
        checked("abacus")
    monkeypatch.setitem(sys.modules, "numba", None)  # as where it is not installed
    with pytest.raises(InputError, match=r"foucault-reference\[fast\]"):
        checked("limbs")
    assert fastest(160, "limbs").name == "heyoka"


def test_without_numbas_compiler_heyoka_computes_and_limbs_is_refused_with_the_reason(monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert fastest(160).name == fastest(160, "limbs").name == "heyoka"
    with pytest.raises(InputError, match="expected NUMBA_DISABLE_JIT not to be set"):
        checked("limbs")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    assert fastest(160).name == ("limbs" if engines()["limbs"].installed else "heyoka")
