"""The tolerances of batches: relative errors of a step."""

from __future__ import annotations

TOLERANCE = 2.0**-52  # of a run: order 20
MOVED_TOLERANCE = 2.0**-61  # of the run that tells the error: order 23
