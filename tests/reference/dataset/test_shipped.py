"""The golden datasets that come with the project pass every check, and recomputing them gives the same bytes."""

from __future__ import annotations

import pytest

import reference
from reference.dataset.recompute import recompute
from reference.dataset.verify import problems_of
from reference.shipped import data_root

SHIPPED = sorted(path.name for path in (data_root() / "golden").glob("[a-z]*"))


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


@pytest.mark.campaign
@pytest.mark.parametrize("name", SHIPPED)
def test_made_again_it_has_the_same_bytes(name, pytestconfig):
    if name == "paris" and not pytestconfig.getoption("--long"):
        pytest.skip("`make golden` makes it again, and .ci/run compares the bytes; here under --long")
    assert recompute(data_root() / "golden" / name) == []
