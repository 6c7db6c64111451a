"""The making of datasets where one scene kills its process, and another is out of reach."""

from __future__ import annotations

import os
import signal
from typing import Any


def serve(parent: Any) -> None:
    """Make datasets as `shipping.serve` does, but fail at two of them."""
    from reference.dataset.shipping import Made, made
    from reference.status import Status

    for job in parent:
        if job.name == "conical":
            os.kill(os.getpid(), signal.SIGKILL)
        unreachable = Made(status=Status.UNREACHABLE, reason="So many digits cannot be reached.")
        parent(unreachable if job.name == "pantheon" else made(job))
