"""Lines of a chart: how they are drawn, and how they are named, in a legend or beside their ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

_FAINT = 0.35  # opacity of faint markers
_GAP = 5  # between a line's end and its name, in points


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    Attributes:
        name: its name, in one or more lines of text.
        x: x of its points, in data coordinates.
        y: y of its points, in data coordinates.
        style: matplotlib's keywords, with the colour; see `line_style`.
        faint: for each point whether its marker is drawn faint; empty for a line without markers.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    style: Mapping[str, Any]
    faint: Sequence[bool] = ()


def draw(axes: Any, lines: Sequence[Line]) -> None:
    """Draw lines with their markers."""
    for line in lines:
        axes.plot(line.x, line.y, **{**line.style, "marker": ""}, zorder=3)
        for faint, alpha in ((False, 1.0), (True, _FAINT)):
            marked = [i for i, one in enumerate(line.faint) if one == faint]
            if marked:
                style = {**line.style, "linestyle": "none"}
                axes.plot(line.x, line.y, **style, markevery=marked, alpha=alpha, zorder=4)


def legend(axes: Any, lines: Sequence[Line], *, size: float = 8.0, inside: bool = False) -> None:
    """Name lines in a legend right of the axes, or inside them where they leave most room."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], label=line.name, **(line.style if line.faint else {**line.style, "marker": ""}))
        for line in lines
    ]
    where = {"loc": "best"} if inside else {"loc": "upper left", "bbox_to_anchor": (1, 1)}
    axes.legend(handles=handles, fontsize=size, labelspacing=0.35, handlelength=3, **where)


def name_ends(axes: Any, lines: Sequence[Line], *, size: float = 8.0) -> None:
    """Write the name of each line beside its end: right of it, or left of it where x is below zero."""
    for line in lines:
        side = -1 if line.x[-1] < 0 else 1
        axes.annotate(
            line.name, (line.x[-1], line.y[-1]), (side * _GAP, 0), textcoords="offset points", fontsize=size,
            color=line.style["color"], ha="left" if side > 0 else "right", va="center_baseline",
        )  # fmt: skip
