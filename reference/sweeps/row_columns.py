"""The columns of rows, from what an engine or the solver found and the errors: no value without its error."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..engines.batch_interface import Outcomes, Rows
from .estimate import DEGREES_PER_HOUR, Errors
from .parquet import COLUMNS, STATE_COLUMNS


def columns_of(rows: Rows, run: Outcomes, errors: Errors) -> tuple[dict[str, Any], Any]:
    """Return the columns by name, and in which rows a number has no error: there neither stands.

    Each error includes an ulp of the numbers that it belongs to, for the rounding of the column.
    """
    span, swings = run.t_last - run.t_first, run.apsis_last - run.apsis_first
    with np.errstate(divide="ignore", invalid="ignore"):
        precession = np.where(run.apsides > 1, run.turn / swings * DEGREES_PER_HOUR, np.nan)
        vertical = np.where(rows.turn[:, 2, 0] != 0, -rows.turn[:, 2, 0] * DEGREES_PER_HOUR, np.nan)
        columns = {
            "steps": run.steps,
            "transits": run.transits,
            "close_pairs": run.close_pairs,
            "t_first_s": run.t_first,
            "t_last_s": run.t_last,
            "transit_error_s": errors.transit,
            "frequency_hz": np.where(run.transits > 1, (run.transits - 1) / (2 * span), np.nan),
            "frequency_error_hz": errors.frequency,
            "swing_hz": np.where(run.apsides > 1, (run.apsides - 1) / (2 * swings), np.nan),
            "swing_error_hz": errors.swing,
            "precession_deg_per_h": precession,
            "precession_error_deg_per_h": errors.precession,
            "precession_ratio": precession / vertical,
            "precession_ratio_error": errors.precession / np.abs(vertical),
            **dict(zip(STATE_COLUMNS, run.state.T, strict=True)),
            "position_error_m": errors.position,
            "velocity_error_m_s": errors.velocity,
            "max_angle_deg": np.degrees(run.largest_angle),
            "max_angle_error_deg": errors.angle,
        }
        unknown = np.zeros(len(rows), bool)
        for name in {column.error for column in COLUMNS if column.error}:
            own = [column.name for column in COLUMNS if column.error == name]
            error = columns[name] + np.spacing(np.max(np.abs([columns[value] for value in own]), axis=0))
            none = ~np.isfinite(error)
            unknown |= none & np.isfinite([columns[value] for value in own]).any(axis=0)
            columns |= {value: np.where(none, np.nan, columns[value]) for value in own}
            columns[name] = np.where(none, np.nan, error)
    return columns, unknown
