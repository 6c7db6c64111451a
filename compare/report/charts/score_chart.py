"""Picture of the position errors of scored candidates over time, as a file: SVG, PNG or PDF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from reference.errors import shortened
from reference.numbers.precision import Array

from ...score.verdict import Score
from .drawing import COLOURS, GUIDE, Line, band, draw, legend, line_style, logarithmic, picture, sheet

LONGEST_NAME = 32  # characters of a file's name beside its line


def error_picture(scores: Sequence[Score], target: Path) -> bytes:
    """Return the content of a picture: the position errors of candidates against time, the reference's bound a band."""
    with sheet((8, 4.5)) as figure:
        _draw(figure.subplots(), scores)
        return picture(figure, target.suffix[1:].lower())


def _draw(axes: Any, scores: Sequence[Score]) -> None:
    bound, tolerance = max(score.errors.bound_m for score in scores), min(score.tolerance_m for score in scores)
    top = max([10 * bound, *(score.errors.max_m for score in scores)])
    lines = []
    for i, score in enumerate(scores):
        t, error = _thinned(score.errors.t, np.maximum(score.errors.position, bound / 30))
        style = line_style(COLOURS[i % len(COLOURS)], i)
        lines.append(Line(shortened(Path(score.candidate.name).name, LONGEST_NAME), t.tolist(), error.tolist(), style))
    end = max(line.x[-1] for line in lines)
    if tolerance < 100 * top:
        lines.append(Line(f"tolerance, {tolerance:.1e} m", [0, end], [tolerance, tolerance], GUIDE))
        top = max(top, tolerance)
    logarithmic(axes, "y", bound / 30, 3 * top, 12)
    axes.set(xlim=(0, end or 1), xlabel="t in s", ylabel="position error in m")
    axes.set_title(f"{scores[0].scene.id}: error against time")
    band(axes, bound)
    draw(axes, lines)
    legend(axes, lines)


def _thinned(t: Array, error: Array, points: int = 2000) -> tuple[Array, Array]:
    """Return at most `points` points: the largest error in each of as many equal parts, all that a picture resolves."""
    if len(t) <= points:
        return t, error
    edges = np.linspace(0, len(t), points + 1).astype(int)[:-1]
    return t[edges], np.maximum.reduceat(error, edges)
