"""The exceptions that a run may raise, and the status and reason that it gets then."""

from __future__ import annotations

from reference import FoucaultError, IntegrationError
from reference.status import Status

FAILURES = (FoucaultError, ArithmeticError, ValueError, RuntimeError, MemoryError)


def failure(error: Exception) -> tuple[Status, str]:
    """Return status and reason of a run that raised one of `FAILURES`."""
    if isinstance(error, IntegrationError):
        return Status.GAVE_UP, str(error)
    if isinstance(error, FoucaultError):
        return Status.REFUSED, str(error)
    return Status.GAVE_UP, f"{type(error).__name__}: {error}"
