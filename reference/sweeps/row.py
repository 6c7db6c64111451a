"""The columns of a sweep: names, kinds, units and meanings, once for schema, files and docs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numbers.columns import POSITION, VELOCITY
from .values import TEXTS

FREQUENCY, PRECESSION, TRANSITS, STATE, AMPLITUDE = "frequency", "precession", "transits", "state", "amplitude"
TIMES = "transit-times"
WANTS = (FREQUENCY, PRECESSION, TRANSITS, STATE, AMPLITUDE)  # what `all` means; the times of the transits are more

INTEGERS = {"int64": np.int64, "int32": np.int32, "int16": np.int16}


@dataclass(frozen=True)
class Column:
    """One column: its kind is that of Arrow (float64, int32, …, or dictionary for words that repeat)."""

    name: str
    kind: str
    meaning: str
    wants: tuple[str, ...] = ()  # present where one of these is wanted; always if empty


STATE_COLUMNS = tuple([f"{name}_m" for name in POSITION] + [f"{name}_m_s" for name in VELOCITY])

COLUMNS = (
    Column("row", "int64", "number of the row, from 0, the last axis fastest"),
    Column("status", "dictionary", "ok, or what went wrong: a word of `reference.status.Status`"),
    Column("reason", "dictionary", "a sentence where the status is not ok"),
    Column("level", "dictionary", "level of trust: computed, or that of the solver where the row was promoted"),
    Column("engine", "dictionary", "the engine that computed the row"),
    Column("digits", "int16", "significant digits of the largest number; 0 where the level is computed"),
    Column("steps", "int32", "steps taken"),
    Column("transits", "int32", "zeros of xdot in 0 < t <= t_end", (TRANSITS, FREQUENCY)),
    Column("close_pairs", "int32", "pairs of transits nearer than a quarter of a swing", (TRANSITS, FREQUENCY)),
    Column("t_first_s", "float64", "time of the first transit", (TRANSITS, FREQUENCY)),
    Column("t_last_s", "float64", "time of the last transit", (TRANSITS, FREQUENCY)),
    Column("transit_error_s", "float64", "error of the worst transit's time", (TRANSITS, FREQUENCY)),
    Column("frequency_hz", "float64", "(n - 1)/(2 (t_n - t_1)) over the transits", (FREQUENCY,)),
    Column("frequency_error_hz", "float64", "its error", (FREQUENCY,)),
    Column("swing_hz", "float64", "(m - 1)/(2 (τ_m - τ_1)) over the highest points", (FREQUENCY, PRECESSION)),
    Column("swing_error_hz", "float64", "its error", (FREQUENCY, PRECESSION)),
    Column("precession_deg_per_h", "float64", "turn of the highest points' azimuth, east to north", (PRECESSION,)),
    Column("precession_error_deg_per_h", "float64", "its error", (PRECESSION,)),
    Column("precession_ratio", "float64", "precession over -Ω sin(latitude)", (PRECESSION,)),
    *(Column(name, "float64", f"{name.split('_')[0]} at t_end", (STATE,)) for name in STATE_COLUMNS),
    Column("position_error_m", "float64", "error of the position at t_end"),
    Column("velocity_error_m_s", "float64", "error of the velocity at t_end", (STATE,)),
    Column("max_angle_deg", "float64", "largest angle from the plumb line, at the release or a turn", (AMPLITUDE,)),
    Column("max_angle_error_deg", "float64", "its error", (AMPLITUDE,)),
)  # fmt: skip


def columns_for(want: tuple[str, ...], keys: tuple[str, ...]) -> tuple[Column, ...]:
    """Return the columns of a sweep that varies the fields `keys`, in order."""
    varied = [
        Column(key, "dictionary" if key in TEXTS else "float64", f"{key} of the scene, the nearest double")
        for key in keys
    ]
    kept = [column for column in COLUMNS[1:] if not column.wants or set(column.wants) & set(want)]
    return (COLUMNS[0], *varied, *kept)


def empty(column: Column, count: int) -> Any:
    """Return a column with nothing known: NaN, 0, or None."""
    if column.kind == "dictionary":
        return np.full(count, None, dtype=object)
    if column.kind == "float64":
        return np.full(count, np.nan)
    return np.zeros(count, INTEGERS[column.kind])
