"""`compare.plot`: a motion, or the errors of a score, as a picture that a notebook shows and that can be saved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reference import Golden, Solution, load
from reference.dataset.place import golden_folder
from reference.numbers.precision import Array
from reference.plain_text import shortened
from reference.scenes.scene import AnyScene, as_scene

from ..candidates.candidate import Candidate
from ..score.verdict import Score
from ..truth import Progress, golden_of
from .drawing import (
    COLOURS,
    GUIDE,
    ChartLine,
    band,
    check_target,
    draw,
    line_style,
    logarithmic,
    name_beside,
    picture,
    sheet,
)
from .folder import write_file
from .motion import PicturedMotion
from .motion_pictures import motion_picture, panels, time_ticks, time_unit

_LONGEST_NAME = 32  # characters of a file's name beside its line
_LINE_WIDTH = 1.3  # points
_WIDEST = 5.0  # points


@dataclass(frozen=True)
class Picture:
    """A picture: shown by a notebook, written by `save`.

    Attributes:
        title: what it shows.
        content: returns the content of a file, whose name says which form it has.
    """

    title: str
    content: Callable[[Path], bytes]

    def __repr__(self) -> str:
        return f"Picture({self.title})"

    def _repr_svg_(self) -> str:
        return self.content(Path("picture.svg")).decode()

    def save(self, path: str | Path) -> None:
        """Write it as .svg, .png or .pdf.

        Raises:
            InputError: another form, or no such folder.
        """
        check_target(Path(path), "path")
        write_file(Path(path), self.content(Path(path)), "path")


def plot(source: Score | Candidate | Golden | Solution | AnyScene) -> Picture:
    """Draw the errors of a score against time, or a motion: its path, swing plane and transits.

    Args:
        source: a score, a solution, a dataset, a candidate, or a scene, which is solved if no
            dataset has its motion.

    Raises:
        InputError: the source is something else, or matplotlib is not installed.
    """
    if isinstance(source, Score):
        return Picture(
            f"errors of {source.candidate.name}", lambda path: error_picture([source], path)
        )
    motion = motion_of(source)
    return Picture(
        f"motion of {motion.name}", lambda path: motion_picture(motion, list(panels(motion)), path)
    )


def motion_of(
    source: Candidate | Golden | Solution | AnyScene,
    announce: Callable[[str], None] | None = None,
    report: Callable[[float], None] | None = None,
) -> PicturedMotion:
    """Return the motion of a candidate, a solution or a dataset, or of a scene, which is solved if no dataset has it.

    Args:
        source: what moves.
        announce: called with a message when a scene has to be solved.
        report: called with the simulated time reached, in s.
    """
    if isinstance(source, Candidate):
        return PicturedMotion.of_candidate(source)
    if isinstance(source, str | Path) and golden_folder(source).is_dir():
        return PicturedMotion.of_golden(load(source))
    if isinstance(source, Golden | Solution):
        return PicturedMotion.of_golden(source)
    scene = as_scene(source)
    golden = golden_of(scene, progress=Progress(announce, report), grid=True)
    return PicturedMotion.of_golden(golden, float(scene.exact.t_end))


def error_picture(scores: Sequence[Score], target: Path) -> bytes:
    """Return the content of a picture: the position errors of candidates against time, the reference's bound a band."""
    with sheet((8, 4.5)) as figure:
        _draw(figure.subplots(), scores)
        return picture(figure, target.suffix[1:].lower())


def _draw(axes: Any, scores: Sequence[Score]) -> None:
    bound_m = max(score.errors.bound_m for score in scores)
    tolerance_m = min(score.tolerance_m for score in scores)
    largest_m = max(score.errors.max_m for score in scores)
    scale, unit = time_unit(max(float(score.errors.t[-1]) for score in scores))
    lowest_m = max(_smallest_m(scores), bound_m / 30)
    top_m = max(10 * bound_m, largest_m)
    lines = _error_lines(scores, lowest_m, scale)
    end = max(line.x[-1] for line in lines)
    if tolerance_m < 100 * top_m:
        name = f"tolerance, {tolerance_m:.1e} m"
        lines.append(ChartLine(name, [0, end], [tolerance_m, tolerance_m], GUIDE))
        top_m = max(top_m, tolerance_m)
        lowest_m = min(lowest_m, tolerance_m)
    logarithmic(axes, "y", lowest_m / 2, 3 * top_m, 12)
    axes.set(xlim=(0, end or 1), xlabel=f"t in {unit}", ylabel="position error in m")
    axes.set_title(f"{scores[0].scene.id}: error against time")
    axes.xaxis.set_major_locator(time_ticks())
    band(axes, bound_m)
    draw(axes, lines)
    name_beside(axes, lines)


def _error_lines(scores: Sequence[Score], lowest_m: float, scale: float) -> list[ChartLine]:
    """Return the lines of the scores' errors, at least `lowest_m`, over times in another unit.

    A release that is right but for its rounding lies below the axis, and is left out.
    """
    smallest_m = _smallest_m(scores)
    # each line is thinner than those below it, so that two that coincide are both seen
    widths = np.linspace(min(_LINE_WIDTH * len(scores), _WIDEST), _LINE_WIDTH, len(scores))
    lines = []
    for i, score in enumerate(scores):
        drawn = score.errors.position >= smallest_m
        if not drawn.any():
            drawn[:] = True
        error_m = np.maximum(score.errors.position[drawn], lowest_m)
        t, error = _thinned(score.errors.t[drawn], error_m)
        name = shortened(Path(score.candidate.name).name, _LONGEST_NAME)
        style = {**line_style(COLOURS[i % len(COLOURS)], i), "linewidth": widths[i]}
        lines.append(ChartLine(name, (t * scale).tolist(), error.tolist(), style))
    return lines


def _smallest_m(scores: Sequence[Score]) -> float:
    """Return the smallest error in m after t = 0, where candidates are given the right position.

    0 if there is none.
    """
    smallest_m = []
    for score in scores:
        later = score.errors.position[score.errors.t > 0]
        smallest_m += later[later > 0].tolist()
    return float(min(smallest_m, default=0.0))


def _thinned(t: Array, error: Array, points: int = 2000) -> tuple[Array, Array]:
    """Return at most `points` points: the largest error in each of as many equal parts, all that a picture resolves."""
    if len(t) <= points:
        return t, error
    edges = np.linspace(0, len(t), points + 1).astype(int)[:-1]
    return t[edges], np.maximum.reduceat(error, edges)
