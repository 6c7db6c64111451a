"""Draw the position error of scored candidates against time (matplotlib, extra `plot`)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from reference import InputError

from ..report.plotting import COLOURS, SAME_BYTES, pyplot
from .judge import Score

STYLES = ("-", "--", "-.", ":")
SUFFIXES = (".svg", ".png", ".pdf")


def check_target(path: Path) -> None:
    """Check, before anything is computed, that the picture can be written.

    Raises:
        InputError: matplotlib is missing, the suffix is no picture's, or there is no such folder.
    """
    pyplot("--plot")
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("--plot", str(path), f"a path that ends in {', '.join(SUFFIXES)}")
    if path.is_dir() or not path.absolute().parent.is_dir():
        raise InputError("--plot", str(path), "a file in a folder that exists")


def error_picture(scores: Sequence[Score], path: Path) -> None:
    """Draw each candidate's position error against time, with the reference's bound as a band."""
    plt = pyplot("--plot")
    with plt.rc_context(SAME_BYTES):
        figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
        _draw(axes, scores)
        _save(figure, path)
        plt.close(figure)


def _draw(axes: Any, scores: Sequence[Score]) -> None:
    bound = max(score.errors.bound_m for score in scores)
    top = max([10 * bound, *(score.errors.max_m for score in scores)])
    for i, score in enumerate(scores):
        t, error = _thinned(score.errors.t, np.maximum(score.errors.position, bound / 30))
        style = {"color": COLOURS[i % len(COLOURS)], "linestyle": STYLES[i % len(STYLES)], "linewidth": 1.2}
        axes.plot(t, error, label=Path(score.candidate.name).name, **style)
    axes.axhspan(bound / 30, bound, color="0.85", label=f"bound of the reference, {bound:.1e} m")
    tolerance = min(score.tolerance_m for score in scores)
    if tolerance < 100 * top:
        axes.axhline(
            tolerance, color="0.4", linewidth=0.8, linestyle=(0, (1, 2)), label=f"tolerance, {tolerance:.1e} m"
        )
    axes.set(yscale="log", ylim=(bound / 30, 3 * top), xlabel="t in s", ylabel="position error in m")
    axes.set_title(f"{scores[0].scene.id}: error against time", loc="left")
    axes.legend(frameon=False, fontsize="small", loc="best")
    axes.spines[["top", "right"]].set_visible(False)


def _thinned(t: Any, error: Any, points: int = 2000) -> tuple[Any, Any]:
    """Return at most `points` points: the largest error in each of as many equal parts, all that a picture resolves."""
    if len(t) <= points:
        return t, error
    edges = np.linspace(0, len(t), points + 1).astype(int)[:-1]
    return t[edges], np.maximum.reduceat(error, edges)


def _save(figure: Any, path: Path) -> None:
    try:
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=150)
    except (OSError, ValueError) as error:
        raise InputError("--plot", str(path), "a path that ends in .svg, .png or .pdf", f"{error}.") from None
