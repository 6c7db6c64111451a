"""The golden datasets that come with the project pass every check, and other runs give the same digits."""

from __future__ import annotations

import pytest
from sampled import one_in

import reference
from reference.dataset.verify import problems_of, recompute
from reference.engines import AUTO
from reference.engines.registry import engines, run
from reference.numbers.columns import STATE
from reference.scenes.shipped import data_root, seals
from reference.solver.choice import confirming_plan, first_prec
from reference.solver.pilot import run_pilot

SHIPPED = sorted(seals())
# heyoka would take half an hour for it, and a proof with its audit takes longer
THIRTY_DAYS = "paris_30d"


def test_paris_is_among_them_with_its_whole_day():
    paris = reference.load("paris")
    assert "paris" in SHIPPED
    assert paris.manifest.level in ("confirmed", "enclosed")
    assert paris.manifest.digits == 40
    assert paris.t[-1] == 86400
    assert paris.manifest.counts.transits == len(paris.transits["t"]) == 10514


# test_same_bytes loads each, which checks hash and seal
@pytest.mark.parametrize("name", one_in(8, SHIPPED))
def test_it_passes_every_check(name):
    assert problems_of(data_root() / "golden" / name) == []


@pytest.mark.parametrize("name", one_in(2, ["paris", "paris.binary64"]))
def test_its_first_hour_made_again_agrees_within_the_bounds(name, size):
    """Ten minutes of it in every run."""
    golden, minutes = reference.load(name), size(10, 60)
    again = reference.solve(golden.scene, t_end=str(60 * minutes), level="confirmed")
    transits = len(again.directions)
    assert transits == size(73, 438)
    assert again.directions == [int(sign) for sign in golden.transits["direction"][:transits]]
    pairs = (
        (again.grid, golden.grid, minutes + 1, STATE),
        (again.transits, golden.transits, transits, ("t", "x", "y", "z", "vy")),
    )
    for ours, theirs, rows, columns in pairs:
        for column in columns:
            bounds = zip(ours.bound(column), theirs.bound(column), strict=False)
            values = zip(ours.exact(column), theirs.exact(column), strict=False)
            near = [abs(a - b) <= sum(bound) for (a, b), bound in zip(values, bounds, strict=True)]
            assert len(near) == rows and all(near), column


# those that always run are functions alone, whose transits are looked for in doubles as they are read
ALWAYS = ("conical.binary64", "museum_gate.binary64", "straight_down.binary64")


@pytest.mark.parametrize(
    "name",
    [name if name in ALWAYS else pytest.param(name, marks=pytest.mark.long) for name in SHIPPED],
)
def test_a_run_of_60_bits_more_and_mostly_in_another_formulation_lies_within_every_bound(
    name, tally
):
    golden = reference.load(name)
    scene, times = golden.scene, golden.times
    pilot = run_pilot(scene.exact, times)
    prec = first_prec(scene, pilot, AUTO) + 60
    if name == THIRTY_DAYS:
        finer = run(engines()["limbs"].plan(scene.exact, prec, times))
    else:
        finer = run(confirming_plan(scene, times, pilot, prec))
        assert finer.plan.formulation != golden.manifest.run.formulation
    parts = [(golden.grid, finer.grid, STATE)]
    if golden.manifest.counts.transits:
        assert finer.directions == [int(sign) for sign in golden.transits["direction"]]
        bounded = (
            ("t", "x", "y", "z", "vy")
            if golden.manifest.alone
            else ("t", "x", "y", "z", "vy", "ax")
        )
        parts.append((golden.transits, finer.transits, bounded))
    numbers = 0
    for printed, computed, columns in parts:
        for column in columns:
            rows = zip(
                printed.exact(column), computed.exact(column), printed.bound(column), strict=True
            )
            assert all(abs(ours - theirs) <= bound for ours, theirs, bound in rows), column
            numbers += len(printed.exact(column))
    tally(f"{name}: {numbers} numbers within their bounds of a run in {finer.plan.number}")


@pytest.mark.long  # `make golden` makes paris again, and .ci/run compares its bytes
@pytest.mark.parametrize("name", [name for name in SHIPPED if name != THIRTY_DAYS])
def test_made_again_it_has_the_same_bytes(name):
    assert recompute(data_root() / "golden" / name) == ([], [])
