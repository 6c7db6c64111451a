"""Campaigns that measure in the process of the test: a process for each group of items costs more than most items."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from compare.studies.campaign import Measurement


def measured_here(patch: pytest.MonkeyPatch) -> None:
    """Have campaigns start no processes; test_campaign.py and campaigns/test_kill.py are of those."""

    def isolated(measurement: Measurement[Any, Any], items: Sequence[Any]) -> Iterator[Any]:
        yield from map(measurement.measure, items)

    patch.setattr("compare.studies.campaign._isolated", isolated)
