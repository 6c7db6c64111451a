"""Chart of the growth of an error over a long run, with guide lines of the slopes t, t^1.5 and t² of theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

from ...observed.position_error import largest_so_far
from .drawing import COLOURS, GUIDE, Line, draw, legend, line_style, logarithmic, name_ends, sheet, svg_text
from .ladders import band

SLOPES = ((1.0, "t"), (1.5, "t^1.5"), (2.0, "t²"))
_POINTS = 240  # points of a line
_APART = 1e6  # lines whose errors are closer than this factor where guide lines begin share one fan of them
_FAN, _BEFORE = 50.0, 5.0  # length of the guide lines, and how far before the line's end they end, as factors of time
_ABOVE = 0.045  # distance of the fan from the lines, as a power of the span of errors: room for its names
_OVER = 20.0  # room above the lines, as a factor of error
_BELOW = 1e3  # room below the bound of the reference, for its name, as a factor of error


@dataclass(frozen=True)
class ErrorHistory:
    """An error over time.

    Attributes:
        label: name of the line.
        t: times in s, increasing, shape (rows,).
        error: errors at these times, shape (rows,).
        exponent: p of error ∝ t^p, for the label; None if it is not known.
    """

    label: str
    t: Array
    error: Array
    exponent: float | None = None

    def line(self, colour: str, index: int) -> Line:
        """Return the largest error so far as a line, with the exponent in its name."""
        positive = (self.t > 0) & (np.maximum.accumulate(self.error) > 0)
        if not positive.any():
            raise InputError("growth", self.label, "an error above zero at a time above zero")
        t, largest = largest_so_far(self.t[positive], self.error[positive], _POINTS)
        power = "" if self.exponent is None else f", t^{self.exponent:.2f}"
        return Line(f"{self.label}{power}", t.tolist(), largest.tolist(), line_style(colour, index))


def error_growth(histories: Sequence[ErrorHistory], bound_m: float) -> str:
    """Draw errors over time, log-log, with fans of slopes 1, 1.5 (Brouwer's law) and 2 and each line's own exponent.

    Args:
        histories: one for each method, at least one.
        bound_m: bound of the reference in m, drawn as a band.

    Raises:
        InputError: there is nothing to draw.
    """
    if not histories:
        raise InputError("growth", "no lines", "at least one")
    lines = [one.line(COLOURS[i % len(COLOURS)], i) for i, one in enumerate(histories)]
    guides = _guides(lines)
    with sheet((9.5, 6.0)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", min(line.x[0] for line in lines), max(line.x[-1] for line in lines))
        lowest = min(line.y[0] for line in lines) / 5
        lowest = min(lowest, bound_m / _BELOW) if bound_m > lowest else lowest
        logarithmic(axes, "y", lowest, _OVER * max(line.y[-1] for line in (*lines, *guides)), 16)
        band(axes, bound_m)
        draw(axes, [*lines, *guides])
        axes.set(xlabel="time in s", ylabel="largest error of position so far in m")
        legend(axes, sorted(lines, key=lambda line: -line.y[-1]))
        name_ends(axes, guides)
        names = ", ".join(one.label for one in histories)
        return svg_text(figure, "growth", f"Error over time, log-log: {names}.")


def _guides(lines: Sequence[Line]) -> list[Line]:
    """Return fans of guide lines, one fan above each group of lines that have similar errors where the fan begins."""
    groups: list[list[tuple[float, Line]]] = []
    for low, line in sorted(((_error_at(one, one.x[-1]), one) for one in lines), key=itemgetter(0)):
        if groups and low < groups[-1][-1][0] * _APART:
            groups[-1].append((low, line))
        else:
            groups.append([(low, line)])
    guides = []
    above = max(4.0, (max(one.y[-1] for one in lines) / min(one.y[0] for one in lines)) ** _ABOVE)
    for group in groups:
        last = max(line.x[-1] for _, line in group)
        end, low = last / _BEFORE, above * max(_error_at(line, last) for _, line in group)
        guides += [Line(name, [end / _FAN, end], [low, low * _FAN**slope], GUIDE) for slope, name in SLOPES]
    return guides


def _error_at(line: Line, last: float) -> float:
    """Return a line's error where the guide lines begin that belong to lines with this last time."""
    return float(np.interp(last / _BEFORE / _FAN, line.x, line.y))
