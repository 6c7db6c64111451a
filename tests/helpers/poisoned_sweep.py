"""A worker's part of a sweep in which one row kills the process that computes it."""

from __future__ import annotations

import os
import signal
from typing import Any

POISON = 37  # number of the row


def compute(*arguments: Any) -> Any:
    """Compute rows as `cluster.compute` does, but die at the row."""
    from reference.sweeps import cluster

    _, rows, _ = arguments
    if POISON in rows:
        os.kill(os.getpid(), signal.SIGKILL)
    return cluster.compute(*arguments)


def solved(*_: Any, **__: Any) -> Any:
    """Return a row without numbers."""
    from reference.sweeps.promote import Promoted

    return Promoted({}, ([], []))


def compute_here(document: str, rows: range, folder: Any) -> Any:
    """Compute rows as `driver.compute` does, with a solver that is done at once, but die at the row."""
    from reference.sweeps.driver import solve_and_save
    from reference.sweeps.request import request_of

    if POISON in rows:
        os.kill(os.getpid(), signal.SIGKILL)
    return solve_and_save(request_of(document), rows, folder, solved)
