"""The status of a run that raised: who stopped it decides, the integrator or whoever refused to start."""

from __future__ import annotations

import pytest

from compare.studies.row import FAILURES, failure
from reference import InputError, IntegrationError, UnreachableError
from reference.status import Status


@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (IntegrationError("heyoka stopped at t = 9.8 s."), Status.GAVE_UP, "heyoka stopped at t = 9.8 s."),
        (UnreachableError("no circle.", "Take another."), Status.REFUSED, "no circle. Take another."),
        (InputError("t_end", "0", "a time above 0"), Status.REFUSED, "t_end: got '0', expected a time above 0."),
        (ZeroDivisionError("division by zero"), Status.GAVE_UP, "ZeroDivisionError: division by zero"),
    ],
)
def test_an_integrator_gives_up_and_a_method_refuses(error, status, reason):
    assert isinstance(error, FAILURES)
    assert failure(error) == (status, reason)
