"""The columns of tables: their names, kinds and units, listed once."""

from __future__ import annotations

POSITION = ("x", "y", "z")
VELOCITY = ("vx", "vy", "vz")
STATE = POSITION + VELOCITY
RUN = (*STATE, "ax")  # an engine's results at each output time, and after t at each transit

GRID = STATE  # of grid.csv, after t
TRANSITS = ("t", "x", "y", "z", "vy", "ax")  # of transits.csv, beside number, direction and bound

KINDS = {"t": ("t",), "ax": ("ax",)} | dict.fromkeys(POSITION, POSITION) | dict.fromkeys(VELOCITY, VELOCITY)
HORIZONTAL = {"x": ("x", "y"), "y": ("x", "y"), "vx": ("vx", "vy"), "vy": ("vx", "vy")}
UNITS = {"t": "s", "ax": "m/s^2"} | dict.fromkeys(POSITION, "m") | dict.fromkeys(VELOCITY, "m/s")
