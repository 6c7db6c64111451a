"""Charts with a single panel: error against evaluations, against tolerance, and of formulations of one system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from ...methods.method import Family
from ...studies.row import Row
from ..pareto import cost_of, curves, whole_evaluations
from .drawing import COLOURS, GUIDE, limits, line_style, logarithmic, sheet, svg_text
from .ladders import CPU, ERROR, band, error_above, family_of, ladders
from .lines import Line, draw, legend


def right_hand_sides(rows: Sequence[Row], bound_m: float, t_end: float) -> str | None:
    """Draw error against evaluations of the right-hand side, for methods that count them; None if there are none."""
    own = [one for one in curves(rows) if one.own]
    return _single(
        ladders(own, lambda row: whole_evaluations(row, t_end), error_above(bound_m)),
        bound_m,
        ("evaluations", "evaluations of the right-hand side", "Error against evaluations of the right-hand side"),
    )


def achieved_tolerance(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw the error achieved against the relative tolerance asked for; None if no method takes a tolerance."""
    own = [one for one in curves(rows) if one.own and one.kind == "tolerance"]
    coarse = [one for one in own if family_of(one.method) != Family.MANY_DIGITS]
    words = ("tolerance", "relative tolerance asked for", "Error achieved against the tolerance asked for")
    lines = ladders(coarse, attrgetter("setting"), error_above(bound_m))
    return _single(lines, bound_m, words, diagonal="error in m = tolerance")


def formulations(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds of formulations of the same equations with one method; None without such rows."""
    every = curves(rows)
    compared = {one.method for one in every if not one.own}
    ladders_of_all = ladders(
        [one for one in every if one.method in compared], cost_of, error_above(bound_m), attrgetter("formulation")
    )
    words = ("formulations", CPU, "Error against CPU seconds of formulations of the same equations")
    lines = [replace(one, style=line_style(COLOURS[i % 6], i)) for i, one in enumerate(ladders_of_all)]
    return _single(lines, bound_m, words)


def _single(lines: Sequence[Line], bound_m: float, words: tuple[str, str, str], diagonal: str = "") -> str | None:
    """Draw one panel; `words` are the picture's name, the label of the horizontal axis and the description."""
    if not lines:
        return None
    with sheet((9.5, 5.6)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", *limits([x for one in lines for x in one.x], 0.4, 3.0), 12)
        logarithmic(axes, "y", *limits([y for one in lines for y in one.y], 0.2, 5.0), 16)
        axes.set(xlabel=words[1], ylabel=ERROR)
        band(axes, bound_m)
        draw(axes, lines)
        others = []
        if diagonal:
            low, high = axes.get_xlim()
            ends = np.geomspace(low, high, 9).tolist()
            others.append(Line(diagonal, ends, ends, GUIDE))
            draw(axes, others)
        legend(axes, [*lines, *others])
        return svg_text(figure, words[0], f"{words[2]}, log-log: {', '.join(one.name for one in lines)}.")
