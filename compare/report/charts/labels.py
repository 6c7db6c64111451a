"""Placement of labels beside their lines: near an end of the line, covering neither other labels nor lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

_WIDE, _TALL = 0.64, 1.25  # size of a character over the font size: slightly too large, to allow for other fonts
_GAP = 5.0  # between a marker and its label, in points
_MARKER = 2.5  # half the size of a marker, in points: labels keep this distance from lines
_EVERY = 3.0  # spacing, in points, of the samples that represent a line
_OUTSIDE, _ON_LABEL, _ON_LINE, _AWAY = 1e6, 1e4, 40.0, 8.0  # penalties of a place
_SIDES = (
    (1.0, 0.0), (1.0, 0.8), (1.0, -0.8), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.8), (-1.0, -0.8),
    (1.0, 1.6), (1.0, -1.6), (-1.0, 1.6), (-1.0, -1.6),
)  # fmt: skip


@dataclass(frozen=True)
class Label:
    """Text at a line.

    Attributes:
        text: text of the label.
        colour: colour of the text.
        x: x of the line's points, in data coordinates.
        y: y of the line's points, in data coordinates.
    """

    text: str
    colour: str
    x: Sequence[float]
    y: Sequence[float]


def place(axes: Any, labels: Sequence[Label], lines: Sequence[Label] | None = None, size: float = 8.0) -> None:
    """Put labels at their lines; call it last, when the limits of the axes are final.

    Args:
        axes: matplotlib axes.
        labels: labels with their lines.
        lines: lines that a label should not cover; by default those of `labels`.
        size: font size in points.
    """
    if not labels:
        return
    figure = axes.figure
    figure.get_layout_engine().execute(figure)
    points = 72.0 / figure.dpi
    frame = axes.get_window_extent().extents * points
    samples = np.vstack([_sampled(_places(axes, line) * points) for line in (lines or labels)])
    boxes: list[Any] = []
    for label in labels:
        vertices = _places(axes, label) * points
        box = min(_boxes(label, vertices, frame, size), key=lambda box: _penalty(box, boxes, samples, frame))
        boxes.append(box[0])
        x0, y0, x1, y1 = box[0]
        align = {1.0: "left", -1.0: "right", 0.0: "center"}[box[2]]
        at = {"left": x0, "right": x1, "center": (x0 + x1) / 2}[align]
        corner = axes.transData.inverted().transform((at / points, (y0 + y1) / 2 / points))
        axes.text(*corner, label.text, color=label.colour, fontsize=size, ha=align, va="center_baseline")


def _places(axes: Any, line: Label) -> Any:
    return axes.transData.transform(np.column_stack([line.x, line.y]))


def _sampled(vertices: Any) -> Any:
    """Return closely spaced points along a polyline."""
    parts = [vertices]
    for a, b in pairwise(vertices):
        count = int(np.hypot(*(b - a)) / _EVERY) + 1
        parts.append(a + np.linspace(0, 1, count, endpoint=False)[:, None] * (b - a))
    return np.vstack(parts)


def _boxes(label: Label, vertices: Any, frame: Any, size: float) -> list[tuple[Any, float, float]]:
    """Return places for a label: (x0, y0, x1, y1), the penalty for its distance from the end, and its side."""
    wide, tall = _WIDE * size * len(label.text), _TALL * size
    order = [len(vertices) - 1, 0, *range(len(vertices) - 2, 0, -1)]
    options = []
    for rank, index in enumerate(order):
        x, y = vertices[index]
        if not (frame[0] <= x <= frame[2] and frame[1] <= y <= frame[3]):
            continue
        for turn, (side, up) in enumerate(_SIDES):
            left = x + side * _GAP - (0.0 if side > 0 else wide if side < 0 else wide / 2)
            low = y - tall / 2 + up * (tall / 2 + _GAP * (0.9 if side == 0 else 0.2))
            options.append((np.array([left, low, left + wide, low + tall]), _AWAY * rank + turn, side))
    centre = (frame[:2] + frame[2:]) / 2  # for a line that is wholly outside the axes
    return options or [(np.hstack([centre, centre + np.array([wide, tall])]), 0.0, 1.0)]


def _penalty(option: tuple[Any, float, float], boxes: Sequence[Any], samples: Any, frame: Any) -> float:
    """Return the penalty of a place: outside the axes, on other labels, on lines, and far from the end."""
    box, away, _ = option
    outside = box[0] < frame[0] or box[1] < frame[1] or box[3] > frame[3] or box[2] > frame[2]
    covered = sum(max(0.0, _overlap(box, other)) for other in boxes)
    low, high = box[:2] - _MARKER, box[2:] + _MARKER
    inside = ((samples > low) & (samples < high)).all(axis=1)
    return float(_OUTSIDE * outside + _ON_LABEL * covered + _ON_LINE * inside.sum() + away)


def _overlap(a: Any, b: Any) -> float:
    """Return the area that two boxes share."""
    return float(max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1])))
