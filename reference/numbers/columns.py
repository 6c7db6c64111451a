"""The columns of tables: their names, kinds and units, listed once.

CONTRIBUTING.md says what else one more column of `grid.csv` takes.
"""

from __future__ import annotations

POSITION = ("x", "y", "z")
VELOCITY = ("vx", "vy", "vz")
STATE = POSITION + VELOCITY
RUN = (*STATE, "ax")  # an engine's results at each output time, and after t at each transit

GRID = STATE  # of grid.csv, after t
TRANSITS = ("t", "x", "y", "z", "vy", "ax")  # of transits.csv, beside number, direction and bound

UNITS = {("t",): "s", POSITION: "m", VELOCITY: "m/s", ("ax",): "m/s^2"}  # of the columns of each kind
KINDS = {name: kind for kind in UNITS for name in kind}  # the columns of a column's kind, whose sizes are alike
HORIZONTAL = {name: pair for pair in (("x", "y"), ("vx", "vy")) for name in pair}  # the same errors are assumed of both
