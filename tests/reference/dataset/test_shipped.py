"""The golden datasets that come with the project pass every check, and recomputing them gives the same bytes."""

from __future__ import annotations

import pytest

import reference
from reference.columns import STATE
from reference.dataset.recompute import recompute
from reference.dataset.record import AUDIT
from reference.dataset.verify import problems_of
from reference.shipped import data_root, seals

SHIPPED = sorted(seals())


def test_paris_is_among_them_with_its_whole_day():
    paris = reference.load("paris")
    assert "paris" in SHIPPED
    assert paris.manifest.level in ("confirmed", "enclosed")
    assert paris.manifest.digits == 40
    assert paris.t[-1] == 86400
    assert paris.manifest.counts.transits == len(paris.transits["t"]) == 10514


@pytest.mark.parametrize("name", SHIPPED)
def test_it_passes_every_check(name):
    assert problems_of(data_root() / "golden" / name) == []


@pytest.mark.parametrize("name", SHIPPED)
def test_a_proof_that_ships_was_audited(name):
    manifest = reference.load(name).manifest
    assert (AUDIT in manifest.command.split()) == (manifest.level == "enclosed")


@pytest.mark.parametrize("name", SHIPPED)
def test_its_first_hour_made_again_agrees_within_the_bounds(name):
    golden = reference.load(name)
    again = reference.solve(golden.scene, t_end="3600", transits=True)
    transits = len(again.directions)
    assert transits == 438
    assert again.directions == [int(sign) for sign in golden.transits["direction"][:transits]]
    pairs = (
        (again.grid, golden.grid, 61, STATE),
        (again.transits, golden.transits, transits, ("t", "x", "y", "z", "vy")),
    )
    for ours, theirs, rows, columns in pairs:
        for column in columns:
            bounds = zip(ours.bound(column), theirs.bound(column), strict=False)
            values = zip(ours.exact(column), theirs.exact(column), strict=False)
            near = [abs(a - b) <= sum(bound) for (a, b), bound in zip(values, bounds, strict=True)]
            assert len(near) == rows and all(near), column


@pytest.mark.campaign
@pytest.mark.parametrize("name", SHIPPED)
def test_made_again_it_has_the_same_bytes(name, pytestconfig):
    if not pytestconfig.getoption("--long"):
        pytest.skip("under --long; `make golden` makes paris again, and .ci/run compares its bytes")
    assert recompute(data_root() / "golden" / name) == []
