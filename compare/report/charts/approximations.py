"""Chart of the errors of approximations over time or one varied quantity; lines that coincide are drawn once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from reference import InputError

from ...studies.approximation_errors import TimeRow
from ...studies.approximation_limits import UNITS, SweepRow
from .drawing import COLOURS, FAINT, GUIDE, Line, draw, legend, limits, line_style, logarithmic, sheet, svg_text

_SAME = 0.15  # relative difference: lines that differ by less everywhere are drawn as one
_WRAP = 2  # names per line of a label
_NAMES = {
    "error_m": "largest error of position up to then, m",
    "plane_error_arcsec": "largest error of the swing plane, arcsec",
}
_MARKS = {"error_m": ((1e-3, "1 mm"), (1e-6, "1 µm")), "plane_error_arcsec": ((1.0, "1 arcsec"),)}


def plot(rows: Sequence[TimeRow | SweepRow], what: str = "error_m", title: str = "") -> str:
    """Return an SVG of the errors in `rows`: those of `error_table` at many times, or of one `sweep`.

    Args:
        rows: rows of one kind; those without an error are left out.
        what: error to draw, `error_m` or `plane_error_arcsec`.
        title: title above the picture.

    Raises:
        InputError: there is nothing to draw, `what` is unknown, or matplotlib is not installed.
    """
    if what not in _NAMES:
        raise InputError("what", what, f"one of {', '.join(_NAMES)}")
    lines = _lines(rows, what)
    if not lines:
        raise InputError("rows", f"{len(rows)} rows", f"some with {what}")
    over = "time" if isinstance(rows[0], TimeRow) else rows[0].over
    with sheet((9.5, max(4.8, 0.3 * sum(line.name.count("\n") + 1 for line in lines) + 3))) as figure:
        axes = figure.subplots()
        logarithmic(axes, "y", *limits([y for line in lines for y in line.y]), 16)
        ends = min(line.x[0] for line in lines), max(line.x[-1] for line in lines)
        if over == "latitude":
            axes.set_xlim(*ends)
            axes.grid(True, axis="x")
        else:
            logarithmic(axes, "x", *ends)
        draw(axes, lines)
        low, high = axes.get_ylim()
        for height, name in _MARKS[what]:
            if low < height < high:
                axes.axhline(height, **GUIDE)
                axes.text(
                    0.995, height, name, transform=axes.get_yaxis_transform(), ha="right", va="bottom", color=FAINT,
                    fontsize=8,
                )  # fmt: skip
        axes.set_xlabel("time since release, s" if over == "time" else f"{over.replace('_', ' ')}, {UNITS[over]}")
        axes.set_ylabel(_NAMES[what])
        axes.set_title(title)
        legend(axes, lines)
        names = ", ".join(line.name.replace("\n", ", ") for line in lines)
        return svg_text(figure, f"{over}-{what}", f"{_NAMES[what].capitalize()}, against {over}: {names}.")


def _lines(rows: Sequence[TimeRow | SweepRow], what: str) -> list[Line]:
    """Return the lines of the rows, the one with the largest last error first."""
    groups: list[tuple[list[str], Any, Any]] = []
    for name in dict.fromkeys(row.approximation for row in rows):
        mine = [row for row in rows if row.approximation == name and getattr(row, what)]
        x = np.array([row.t if isinstance(row, TimeRow) else row.value for row in mine])
        y = np.array([getattr(row, what) for row in mine])
        same = [names for names, u, v in groups if np.array_equal(u, x) and np.all(np.abs(y / v - 1) < _SAME)]
        if same:
            same[0].append(name)
        elif mine:
            groups.append(([name], x, y))
    groups.sort(key=lambda group: -group[2][-1])
    return [
        Line(_wrapped(names), x.tolist(), y.tolist(), line_style(COLOURS[i % len(COLOURS) - 1], i))  # the darkest first
        for i, (names, x, y) in enumerate(groups)
    ]


def _wrapped(names: Sequence[str]) -> str:
    return "\n".join(", ".join(names[i : i + _WRAP]) for i in range(0, len(names), _WRAP))
