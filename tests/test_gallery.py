"""The notebooks of docs/gallery: each runs, and prints what it keeps as its output."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from notebooks import NOTEBOOKS, code_cells, outputs, run, text_of
from places import ROOT

MOST_BYTES = 40_000
WITHOUT_FLINT = "no FLINT for C here"
HALF_A_LETTER = 3  # pixels of a figure
TINY = 1e-9  # of a distance in m: below it rounding decides what is printed


def same(kept: str, printed: str) -> bool:
    """Whether two outputs have the same words and, but for rounding, the same numbers."""
    pairs = [*zip(kept.split(), printed.split(), strict=False)]
    return len(kept.split()) == len(printed.split()) and all(_alike(*pair) for pair in pairs)


def _alike(one: str, other: str) -> bool:
    try:
        return float(one) == pytest.approx(float(other), rel=2e-3, abs=TINY)
    except ValueError:
        return one == other


LONG = {"error_against_time"}  # `compare.judge` of files by name alone, as in first_verdict


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=[pytest.mark.long] * (path.stem in LONG), id=path.stem)
        for path in NOTEBOOKS
    ],
)
def test_every_cell_prints_what_the_notebook_keeps(
    path: Path, size: Callable[[Any, Any], Any]
) -> None:
    """Pictures, which are not compared, are drawn under --long; test_python.py draws each kind."""
    pytest.importorskip("matplotlib")
    cells = code_cells(json.loads(path.read_text(encoding="utf-8")))
    for cell, (printed, value) in zip(cells, run(path), strict=True):
        now = text_of({"outputs": outputs(printed, value, with_pictures=size(False, True))})
        if hasattr(value, "draw_without_rendering"):
            assert labels_apart(value)
        optional = "optional" in cell["metadata"].get("tags", ())
        assert same(text_of(cell), now) or (optional and WITHOUT_FLINT in now), (
            "run: python tests/helpers/notebooks.py"
        )


def labels_apart(figure: Any) -> bool:
    """Whether between any two tick labels of an axis there is the room of a letter."""
    figure.draw_without_rendering()
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        labels = [*axis.get_ticklabels(), *axis.get_ticklabels(minor=True)]
        boxes = [
            label.get_window_extent().padded(HALF_A_LETTER) for label in labels if label.get_text()
        ]
        if any(one.overlaps(other) for one, other in combinations(boxes, 2)):
            return False
    return True


def test_a_number_or_a_word_that_is_another_is_found() -> None:
    assert same("x = 0.5 m, within 5.7e-14 m", "x = 0.5001 m, within 3e-14 m")
    assert not same("x = 0.5 m", "x = 0.502 m")
    assert not same("x = 0.5 m", "y = 0.5 m")
    assert not same("x = 0.5 m", "x = 0.5 m more")


def test_the_gallery_lists_five_small_notebooks_with_pictures() -> None:
    listed = (ROOT / "docs/gallery/README.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) == 5
    for path in NOTEBOOKS:
        assert f"({path.name})" in listed
        assert path.stat().st_size < MOST_BYTES
    assert sum("image/png" in path.read_text(encoding="utf-8") for path in NOTEBOOKS) == 4
