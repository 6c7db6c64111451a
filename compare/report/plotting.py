"""Shared matplotlib setup and SVG export: no window, colours for colour-blind readers, the same bytes every time."""

from __future__ import annotations

import io
from typing import Any

from reference import InputError

# Okabe and Ito's palette for colour-blind readers; in grey the line styles tell lines apart
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
SAME_BYTES = {"svg.hashsalt": "foucault", "svg.fonttype": "none"}  # the same picture gives the same SVG bytes


def pyplot(field: str) -> Any:
    """Return matplotlib.pyplot, set up to open no window.

    Args:
        field: option or function that needs the picture, for the error message.

    Raises:
        InputError: matplotlib is not installed.
    """
    try:
        import matplotlib
    except ImportError:
        advice = "pip install 'foucault-reference[plot]'."
        raise InputError(field, "no matplotlib", "the extra plot", advice) from None
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt


def svg_of(figure: Any) -> str:
    """Return a figure as SVG text without a date; call it in an rc context with `SAME_BYTES`."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue()
