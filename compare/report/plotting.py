"""What every picture begins and ends with: matplotlib without a window, colours that all can tell apart, SVG text."""

from __future__ import annotations

import io
from typing import Any

from reference import InputError

# Okabe and Ito's colours, told apart by the colour-blind; line styles tell them apart in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
SAME_BYTES = {"svg.hashsalt": "foucault", "svg.fonttype": "none"}  # for the same picture


def pyplot(field: str) -> Any:
    """Import matplotlib, which will open no window.

    Args:
        field: of the message: what asked for a picture.

    Raises:
        InputError: it is not installed.
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
    """A figure as SVG text, without date; drawn in a context of `SAME_BYTES`."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue()
