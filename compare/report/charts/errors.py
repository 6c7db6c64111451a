"""Charts with a single panel: error against evaluations, against tolerance, and of formulations of one system."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...studies.row import Row
from ..pareto import Curve, cost_of, curves, whole_evaluations
from ..plotting import COLOURS
from .drawing import FAINT, limits, logarithmic, sheet, svg_text
from .families import MANY_DIGITS, family_of, line_style, styles
from .labels import Label
from .ladders import CPU, ERROR, Horizontal, Style, band, draw, label, points


def right_hand_sides(rows: Sequence[Row], bound_m: float, t_end: float) -> str | None:
    """Draw error against evaluations of the right-hand side, for methods that count them; None if there are none."""
    own = [one for one in curves(rows) if "(" not in one.label]
    return _single(
        own,
        lambda row: whole_evaluations(row, t_end),
        bound_m,
        ("evaluations", "evaluations of the right-hand side", "Error against evaluations of the right-hand side"),
    )


def achieved_tolerance(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw the error achieved against the relative tolerance asked for; None if no method takes a tolerance."""
    own = [
        one
        for one in curves(rows)
        if "(" not in one.label and one.rows[0].kind == "tolerance" and family_of(one.method).title != MANY_DIGITS
    ]
    words = ("tolerance", "relative tolerance asked for", "Error achieved against the tolerance asked for")
    return _single(own, lambda row: row.setting, bound_m, words, diagonal="error in m = tolerance")


def formulations(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds of formulations of the same equations with one method; None without such rows."""
    every = curves(rows)
    compared = {one.method for one in every if "(" in one.label}
    ladders = [
        Curve(one.method, one.formulation, one.formulation, one.rows)
        for one in every
        if one.method in compared and one.measured
    ]
    words = ("formulations", CPU, "Error against CPU seconds of formulations of the same equations")
    looks = [line_style(COLOURS[i % 6], i) for i in range(len(ladders))]
    return _single(ladders, cost_of, bound_m, words, looks=looks)


def _single(
    ladders: Sequence[Curve],
    x_of: Horizontal,
    bound_m: float,
    words: tuple[str, str, str],
    *,
    looks: Sequence[Style] | None = None,
    diagonal: str = "",
) -> str | None:
    """Draw one panel; `words` are the picture's name, the label of the horizontal axis and the description."""
    ladders = [one for one in ladders if any(x_of(row) for row in one.measured)]
    if not ladders:
        return None
    looks = looks or styles(ladders)
    x, y = zip(*[point for one in ladders for point in zip(*points(one, x_of, bound_m), strict=True)], strict=True)
    with sheet((9.5, 5.6)) as (figure, grid):
        axes = grid[0, 0]
        logarithmic(axes, "x", *limits(x, 0.4, 3.0), 12)
        logarithmic(axes, "y", *limits(y, 0.2, 5.0), 16)
        band(axes, bound_m)
        others = []
        if diagonal:
            low, high = axes.get_xlim()
            ends = np.geomspace(low, high, 9).tolist()
            axes.plot(ends, ends, color=FAINT, linewidth=0.9, linestyle=(0, (1, 2)))
            others.append(Label(diagonal, FAINT, ends, ends))
        draw(axes, ladders, looks, x_of, bound_m)
        axes.set(xlabel=words[1], ylabel=ERROR)
        label(axes, ladders, x_of, bound_m, colours=[look["color"] for look in looks], others=others)
        return svg_text(figure, words[0], f"{words[2]}, log-log: {', '.join(one.label for one in ladders)}.")
