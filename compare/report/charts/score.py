"""Picture of the position errors of scored candidates over time, as a file: SVG, PNG or PDF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from reference import InputError
from reference.precision import Array

from ...score.judge import Score
from .drawing import BAND, COLOURS, GUIDE, check_matplotlib, line_style, picture, sheet

SUFFIXES = (".svg", ".png", ".pdf")


def check_target(path: Path) -> None:
    """Check, before anything is computed, that the picture can be written.

    Raises:
        InputError: matplotlib is missing, the suffix is no picture's, or there is no such folder.
    """
    check_matplotlib("--plot")
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("--plot", str(path), f"a path that ends in {', '.join(SUFFIXES)}")
    if path.is_dir() or not path.absolute().parent.is_dir():
        raise InputError("--plot", str(path), "a file in a folder that exists")


def error_picture(scores: Sequence[Score], path: Path) -> None:
    """Draw each candidate's position error against time, with the reference's bound as a band."""
    with sheet((8, 4.5)) as figure:
        _draw(figure.subplots(), scores)
        content = picture(figure, path.suffix[1:].lower())
    try:
        path.write_bytes(content)
    except OSError as error:
        raise InputError("--plot", str(path), "a file that can be written", f"{error.strerror}.") from None


def _draw(axes: Any, scores: Sequence[Score]) -> None:
    bound = max(score.errors.bound_m for score in scores)
    top = max([10 * bound, *(score.errors.max_m for score in scores)])
    for i, score in enumerate(scores):
        t, error = _thinned(score.errors.t, np.maximum(score.errors.position, bound / 30))
        style = line_style(COLOURS[i % len(COLOURS)], i) | {"marker": ""}
        axes.plot(t, error, label=Path(score.candidate.name).name, **style)
    axes.axhspan(bound / 30, bound, color=BAND, label=f"bound of the reference, {bound:.1e} m")
    tolerance = min(score.tolerance_m for score in scores)
    if tolerance < 100 * top:
        axes.axhline(tolerance, label=f"tolerance, {tolerance:.1e} m", **GUIDE)
    axes.set(yscale="log", ylim=(bound / 30, 3 * top), xlabel="t in s", ylabel="position error in m")
    axes.set_title(f"{scores[0].scene.id}: error against time")
    axes.legend(fontsize="small", loc="best")


def _thinned(t: Array, error: Array, points: int = 2000) -> tuple[Array, Array]:
    """Return at most `points` points: the largest error in each of as many equal parts, all that a picture resolves."""
    if len(t) <= points:
        return t, error
    edges = np.linspace(0, len(t), points + 1).astype(int)[:-1]
    return t[edges], np.maximum.reduceat(error, edges)
