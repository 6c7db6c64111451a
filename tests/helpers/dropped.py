"""Files that are dropped on a page: right and wrong ones, in several spellings."""

from __future__ import annotations

import numpy as np


def csv(header, *columns, separator=","):
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return header + "\n" + "".join(separator.join(map(repr, row)) + "\n" for row in rows)


def trajectories(golden):
    """Files at every 48th golden time: right and wrong ones, in several spellings."""
    some = slice(None, None, 48)
    t, x, y, z, vx, vy = (golden.grid[name][some] for name in ("t", "x", "y", "z", "vx", "vy"))
    wave = np.cos(t)
    late = csv("t,x,y", t, x - 0.01 * vx, y - 0.01 * vy)
    return {
        "right": csv("t,x,y,z", t, x + 1e-9 * wave, y, z),
        "wrong": csv("t,x,y,z", t, x, y + 1e-5 * wave * t / t[-1], z),
        "without_z": csv("t,x,y", t, x + 1e-8 * wave, y),
        "exchanged": csv("t,x,y", t, y, x),
        "turned": csv("t,x,y", t, y, -x),
        "centimetres": csv("t,x,y", t, 100 * x, 100 * y),
        "millimetres_west": csv("t,x,y", t, -1000 * x, 1000 * y),
        "minutes": csv("t,x,y", t / 60, x, y),
        "late": late,
        "units": csv("time (ms),pos_x [cm],north/mm", 1000 * t, 100 * (x + 1e-8), 1000 * y),
        "decimal_comma": csv("t;x;y", t, x + 1e-8, y, separator=";").replace(".", ","),
        "fortran": csv("# t x y", t, x + 1e-8, y, separator="  ").replace("e-", "D-"),
        "west": csv("west,t,south", -x + 1e-8, t, -y),
        "no_header": csv("# made by foucPend", t, x + 1e-8, y, z, x, y, z, x, y, z, separator=" "),
        "clock_of_steps": csv("t,x,y", t * (1 + 1e-14), x + 1e-8, y),
        "golden_itself": (golden.path / "grid.binary64.csv").read_text(),
        "first_hour": csv("t,x,y", t[:2], x[:2] + 1e-8, y[:2]),
    }
