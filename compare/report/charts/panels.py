"""Panels above one another in one style, for figures after a paper: one of them has a legend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .drawing import Line, draw, legend, limits, logarithmic, name_ends, picture, sheet

WIDE = 4.8  # inches: as wide as a telephone's screen, where the letters then are as large as the text beside them
EDGE = 0.5  # inches of a figure's height that no panel has


@dataclass(frozen=True)
class Panel:
    """One panel.

    Attributes:
        lines: its lines, in data coordinates.
        axes: what matplotlib sets of the axes: labels, title, ends, ticks, and one scale for both ("aspect": "equal").
        named: the lines are named in a legend beside the panel, inside it where both axes have one scale.
        height: in inches.
        log: the y axis is logarithmic.
        bare: no axes; the lines are named beside their ends.
    """

    lines: Sequence[Line]
    axes: Mapping[str, Any]
    named: bool = False
    height: float = 2.6
    log: bool = False
    bare: bool = False


def line(name: str, x: Any, y: Any, colour: str, dashes: Any = "-", width: float = 1.3) -> Line:
    """Return a line without markers."""
    return Line(name, list(map(float, x)), list(map(float, y)), _style(colour, dashes, width))


def dots(name: str, x: Any, y: Any, colour: str, mark: str = ".", size: float = 2.0, dashes: Any = "none") -> Line:
    """Return points, joined if `dashes` says how; dots are faint, other marks hollow."""
    style = {**_style(colour, dashes, 0.7), "marker": mark, "markersize": size}
    if mark != ".":
        style["markerfacecolor"] = "none"
    return Line(name, list(map(float, x)), list(map(float, y)), style, [mark == "."] * len(x))


def drawn(panels: Sequence[Panel]) -> str:
    """Return the panels, the first on top, as SVG.

    Raises:
        InputError: matplotlib is not installed.
    """
    with sheet((WIDE, EDGE + sum(panel.height for panel in panels))) as figure:
        rows = figure.subplots(len(panels), 1, squeeze=False, height_ratios=[panel.height for panel in panels])[:, 0]
        for axes, panel in zip(rows, panels, strict=True):
            _draw(axes, panel)
        return picture(figure).decode()


def _style(colour: str, dashes: Any, width: float) -> dict[str, Any]:
    return {"color": colour, "linestyle": dashes, "linewidth": width}


def _draw(axes: Any, panel: Panel) -> None:
    draw(axes, panel.lines)
    if panel.log:
        logarithmic(axes, "y", *limits([y for line in panel.lines for y in line.y]), 8)
    else:
        axes.ticklabel_format(axis="y", useOffset=False)
    axes.set(**panel.axes)
    names = [line for line in panel.lines if line.name]
    if panel.bare:
        axes.set_axis_off()
        name_ends(axes, names, size=9)
    elif panel.named:
        legend(axes, names, size=9, inside="aspect" in panel.axes)
