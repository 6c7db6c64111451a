"""Chart of the growth of an error over a long run, with guide lines of the slopes t, t^1.5 and t² of theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reference import InputError

from ..plotting import COLOURS
from .drawing import BAND, FAINT, logarithmic, sheet, svg_text
from .families import line_style
from .labels import Label, place

SLOPES = ((1.0, "t"), (1.5, "t^1.5"), (2.0, "t²"))
_POINTS = 240  # points of a line, evenly spaced in the logarithm of time
_APART = 1e3  # lines whose last errors are closer than this factor share one fan of guide lines
_FAN = 50.0  # length of the guide lines, as a factor of time
_ABOVE = 4.0  # distance of the fan from the lines, as a factor of error


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
    t: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    exponent: float | None = None

    def so_far(self) -> tuple[list[float], list[float]]:
        """Return times and the largest error up to each of them, thinned to at most `_POINTS` points."""
        largest = np.maximum.accumulate(self.error)
        positive = (self.t > 0) & (largest > 0)
        t, largest = self.t[positive], largest[positive]
        if not len(t):
            raise InputError("growth", self.label, "an error above zero at a time above zero")
        marks = np.geomspace(t[0], t[-1], _POINTS)
        at = np.unique(np.searchsorted(t, marks * (1 - 1e-12)).clip(0, len(t) - 1))
        return t[at].tolist(), largest[at].tolist()


def error_growth(
    lines: Sequence[ErrorHistory], bound_m: float, *, quantity: str = "largest error of position so far in m"
) -> str:
    """Draw errors over time, log-log, with fans of slopes 1, 1.5 (Brouwer's law) and 2 and each line's own exponent.

    Args:
        lines: one for each method, at least one.
        bound_m: bound of the reference in m, drawn as a band.
        quantity: label of the vertical axis.

    Raises:
        InputError: there is nothing to draw.
    """
    if not lines:
        raise InputError("growth", "no lines", "at least one")
    curves = [(line.label, *line.so_far()) for line in lines]
    with sheet((9.5, 6.0)) as (figure, grid):
        axes = grid[0, 0]
        times, errors = [t for _, ts, _ in curves for t in ts], [e for _, _, es in curves for e in es]
        logarithmic(axes, "x", min(times), max(times) * 6)
        fans = _fans(curves)
        top = max([*errors, *(low * _FAN ** SLOPES[-1][0] for _, low in fans)])
        logarithmic(axes, "y", min(errors) / 5, top * 5, 16)
        if axes.get_ylim()[0] < bound_m:
            axes.axhspan(axes.get_ylim()[0], bound_m, color=BAND, linewidth=0, zorder=0)
        labels, guides = [], []
        for i, (label, t, error) in enumerate(curves):
            look = line_style(COLOURS[i % len(COLOURS)], i) | {"marker": ""}
            axes.plot(t, error, **look, zorder=3)
            power = "" if lines[i].exponent is None else f", t^{lines[i].exponent:.2f}"
            labels.append(Label(f"{label}{power}", look["color"], t, error))
        for end, low in fans:
            for slope, name in SLOPES:
                x, y = [end / _FAN, end], [low, low * _FAN**slope]
                axes.plot(x, y, color=FAINT, linewidth=0.8, linestyle=(0, (1, 2)), zorder=2)
                guides.append(Label(name, FAINT, x, y))
        axes.set(xlabel="time in s", ylabel=quantity)
        ends = [Label(one.text, one.colour, one.x[-1:], one.y[-1:]) for one in guides]
        place(axes, [*ends, *labels], [*labels, *guides])
        return svg_text(figure, "growth", f"Error over time, log-log: {', '.join(label for label, *_ in curves)}.")


def _fans(curves: Sequence[tuple[str, list[float], list[float]]]) -> list[tuple[float, float]]:
    """Return the end time and the lowest error of each fan of guide lines, one above each group of lines."""
    groups: list[list[tuple[list[float], list[float]]]] = []
    for _, t, error in sorted(curves, key=lambda one: one[2][-1]):
        if groups and error[-1] < groups[-1][-1][1][-1] * _APART:
            groups[-1].append((t, error))
        else:
            groups.append([(t, error)])
    ends = [max(t[-1] for t, _ in group) for group in groups]
    return [
        (end, _ABOVE * max(float(np.interp(end / _FAN, t, error)) for t, error in group))
        for end, group in zip(ends, groups, strict=True)
    ]
