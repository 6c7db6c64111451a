"""Passages of sections in sweeps: none lost or doubled, every number within its error, by limbs and by scipy."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from passages import found
from random_rows import KINDS, random_kinds, rows_of
from sampled import one_in

from reference import load_scene, solve, sweep
from reference.engines.batch_interface import RunOptions
from reference.engines.registry import batches, engines, run
from reference.sweeps.estimate import errors_by_moved_runs, passages
from reference.sweeps.promote import audited, promoted

ENGINES = [name for name, engine in batches().items() if engine.installed]
SPAN = Fraction(60)
NEAR = 1e-6  # s, of DOP853 in double


@pytest.fixture(scope="module")
def drawn(pytestconfig):
    """Random scenes of all kinds, words of sections, and of each its passages by limbs at 110 bits."""
    first, count = (0, 40) if pytestconfig.getoption("--long") else (len(KINDS), 2 * len(KINDS))
    many, generator = list(random_kinds("sections", count, SPAN))[first:], random.Random("sections")
    words = [
        "highest",
        "lowest",
        "gate 90",
        *(f"{kind} {generator.uniform(-180, 180):.3f}" for kind in ("gate", "turn")),
    ]
    words.append(f"{words[3]}@0")
    limbs = engines()["limbs"]
    plans = [limbs.plan(inputs, 110, (Fraction(0), SPAN)) for inputs in many]
    return many, words, [run(replace(plan, zeros=tuple(words))).zeros for plan in plans]


def mean_interval(times, directions):
    same = [t for t, direction in zip(times, directions, strict=True) if direction == directions[0]]
    return float((same[-1] - same[0]) / (len(same) - 1)) if len(same) > 1 else np.nan


@pytest.mark.parametrize("engine", ENGINES)
def test_passages_of_random_rows_are_those_of_limbs_within_their_errors(drawn, engine, tally):
    many, words, truth = drawn
    solver, rows = batches()[engine], rows_of(many)
    base = solver.solve(rows, RunOptions())
    errors, _ = errors_by_moved_runs(solver, rows, base)
    undecided, worst, count = 0, 0.0, 0
    for word in words:
        columns, unsure = passages(solver, word, rows_of(many, word), base, errors)
        for i, exact in enumerate(truth):
            row = {name.removeprefix(f"{word}: "): values[i] for name, values in columns.items()}
            times, directions = exact[word].table.exact("t"), exact[word].directions
            undecided += bool(unsure[i])
            if unsure[i]:
                continue
            assert row["passages"] == len(times), (word, many[i])
            count += len(times)
            pairs = [("t_first_s", "t_error_s", float(times[0]))] if times else []
            if len(times) > 1:
                pairs.append(("interval_s", "interval_error_s", mean_interval(times, directions)))
            for name, error, value in pairs:
                assert np.isnan(value) == np.isnan(row[name]) == np.isnan(row[error]), (
                    word,
                    many[i],
                )
                worst = np.nanmax([worst, abs(row[name] - value) / row[error]])
    tally(
        f"sections of sweeps, {engine}: {count} passages, {undecided} undecided, largest error {worst:.2f} of its own"
    )
    assert count > 75 * len(many)
    assert worst < 1
    assert undecided < 0.05 * len(many) * len(words)


def test_passages_of_limbs_are_those_of_scipy(drawn):
    many, words, truth = drawn
    # over the top scipy's states leave the sphere, and errors grow by two hundred a turn
    tame = [i for i in range(len(many)) if KINDS[i % len(KINDS)] != "over"]
    for inputs, exact in ((many[i], truth[i]) for i in tame):
        for word, other in found(inputs, words, SPAN).items():
            table, directions, _ = exact[word]
            assert directions == [direction for _, direction in other], (word, inputs)
            assert np.abs(table["t"] - [t for t, _ in other]).max(initial=0) < NEAR, (word, inputs)


WORDS = ["gate 0@0", "gate 90", "highest", "turn 90"]


@cache  # heyoka compiles for each scene
def solved(release, latitude):
    """Times and directions of each section of a scene, of which every engine is to give the same."""
    scene = at_paris(release).with_values([f"site.latitude={latitude}"])
    found = solve(scene, level="computed", digits=22, transits=False).sections
    return {word: (found[word].table.exact("t"), found[word].directions) for word in WORDS}


def at_paris(release):
    return load_scene(
        "paris", ["run.t_end=100", f"run.sections={'; '.join(WORDS)}", *release.split()]
    )


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    "release", ["release.x=0.5 release.y=0", "release.x=0 release.y=0.5", "release.x=1e-9"]
)
def test_a_release_at_rest_in_the_gate_and_a_swing_of_nanometres_are_what_the_solver_gives(
    engine, release, size
):
    latitudes = size(["45"], ["-30", "45", "90"])
    swept = sweep(
        at_paris(release), [f"site.latitude={','.join(latitudes)}"], engine=engine, workers=1
    )
    for latitude, row in zip(latitudes, swept.rows(), strict=True):
        assert row["status"] == "ok", row["reason"]
        for word, (times, directions) in solved(release, latitude).items():
            assert row[f"{word}: passages"] == len(times), word
            if times:
                assert abs(row[f"{word}: t_first_s"] - times[0]) <= row[f"{word}: t_error_s"], word
                interval = mean_interval(times, directions)
                assert (
                    abs(row[f"{word}: interval_s"] - interval) <= row[f"{word}: interval_error_s"]
                ), word


@pytest.mark.parametrize("engine", one_in(2, ENGINES))
def test_a_motion_that_stays_in_the_gate_fails_alone_and_says_so(engine):
    scene = load_scene(
        "paris", ["run.t_end=60", "release.x=0.5", "release.y=0", "run.sections=gate 0@0"]
    )
    swept = sweep(scene, ["site.latitude=0,45"], engine=engine, workers=1)
    assert swept["status"].tolist() == ["doubtful", "ok"]
    assert "the motion never leaves this section" in swept["reason"][0]
    assert swept["gate 0@0: passages"][0] == 0
    assert np.isnan(swept["gate 0@0: t_error_s"][0])
    assert np.isnan(swept["frequency_hz"][0])


def test_rows_of_the_solver_have_the_columns_too_and_an_audit_compares_them():
    scene = load_scene("paris", ["run.t_end=30", "run.sections=gate 90; highest"])
    many = sweep(scene, ["site.latitude=30,60"], engine="heyoka", workers=1, audit_rows=2)
    assert many.audit.wrong == ()
    assert many.audit.worst_ratio < 1
    request, row = many.request, next(many.rows())
    proved = promoted(request, 0, doubtful=False, level="enclosed", digits=12).values
    assert proved["level"] == "enclosed"
    for word in ("gate 90", "highest"):
        assert proved[f"{word}: passages"] == row[f"{word}: passages"] > 1
        for name, error in (("t_first_s", "t_error_s"), ("interval_s", "interval_error_s")):
            gap = abs(proved[f"{word}: {name}"] - row[f"{word}: {name}"])
            assert gap <= proved[f"{word}: {error}"] + row[f"{word}: {error}"]
    spoilt = many.columns()
    spoilt["gate 90: passages"] = spoilt["gate 90: passages"] + [1, 0]
    spoilt["highest: interval_s"] = spoilt["highest: interval_s"] + [0, 1e-9]
    found = audited(request, lambda _: spoilt)
    assert found.wrong == (0, 1)
    assert (found.worst_ratio, found.worst_row) == (np.inf, 0)
