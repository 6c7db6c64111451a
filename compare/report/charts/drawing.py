"""Shared parts of the charts: the figure and its colours, logarithmic axes with plain labels, and SVG for a page."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from ..plotting import SAME_BYTES, pyplot, svg_of

# Colours that follow a page's light or dark scheme, by these names: the greys of a figure, and its darkest colour
INKS = {
    "ink": "#1b1b1b", "faint": "#6b6b6b", "rule": "#dcdcdc", "band": "#e9e9e9", "paper": "#fefefe", "blue": "#0072b2",
}  # fmt: skip
INK, FAINT, RULE, BAND, PAPER, _ = INKS.values()

_ROOM = 0.06  # free part of a logarithmic axis at each end
PIXELS = 4 / 3  # CSS pixels in a typographic point
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PARAMETERS = SAME_BYTES | {
    "font.size": 9,
    "font.family": ["DejaVu Sans", "sans-serif"],
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.titlesize": 9,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "grid.color": RULE,
    "grid.linewidth": 0.6,
}


@contextmanager
def sheet(size: tuple[float, float], rows: int = 1, columns: int = 1, **shared: Any) -> Iterator[tuple[Any, Any]]:
    """Yield a figure of this size in inches and its array of axes; close the figure afterwards.

    Raises:
        InputError: matplotlib is not installed.
    """
    plt = pyplot("--out")
    with plt.rc_context(_PARAMETERS):
        figure, axes = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False, **shared)
        figure.patch.set_visible(False)
        try:
            for one in axes.flat:
                one.patch.set_visible(False)
            yield figure, axes
        finally:
            plt.close(figure)


def svg_text(figure: Any, name: str, description: str, kind: str = "lines") -> str:
    """Return the figure as one SVG element that fits into a page.

    Args:
        figure: figure from `sheet`.
        name: prefix of the ids, which keeps them apart from those of other pictures in the page.
        description: text for readers who cannot see the picture.
        kind: CSS class; in class `lines` the page gives text a halo, so that it is legible over lines.
    """
    text = svg_of(figure)
    text = text[text.index("<svg") :]
    text = re.sub(
        r"<metadata>.*?</metadata>\s*|<defs>\s*<style.*?</defs>\s*|<!--.*?-->\s*|(?<=\n) +", "", text, flags=re.DOTALL
    )
    width, height = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', text).groups()  # type: ignore[union-attr]
    opening = (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="0 0 {width} {height}" width="{float(width) * PIXELS:.0f}" class="{kind}" '
        f'style="stroke-linejoin: round" role="img" aria-label="{_quoted(description)}">'
    )
    text = opening + text[text.index(">") + 1 :]
    return _with_inks(_own_ids(text, name)).strip() + "\n"


def _own_ids(text: str, name: str) -> str:
    """Put the picture's name before ids that are referred to, and remove all other ids."""
    targets = set(re.findall(r'(?:href="#|url\(#)([^")]+)', text))
    text = re.sub(r' id="([^"]+)"', lambda match: f' id="{name}-{match[1]}"' if match[1] in targets else "", text)
    return re.sub(r'(href="#|url\(#)([^")]+)', rf"\g<1>{name}-\g<2>", text)


def _with_inks(text: str) -> str:
    """Replace the colours of `INKS` by CSS variables of the page."""
    for word, colour in INKS.items():
        text = text.replace(colour, f"var(--{word}, {colour})")
    return text


def _quoted(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def power_of_ten(value: float, _: Any = None) -> str:
    """Return a tick's label: 0.01, 1 or 100 near 1, and 10⁻⁹ farther away."""
    if value <= 0:
        return ""
    exponent = round(math.log10(value))
    return f"{value:g}" if -3 < exponent < 4 else "10" + str(exponent).translate(_RAISED)


def logarithmic(axes: Any, which: str, low: float, high: float, labels: int = 8) -> None:
    """Make an axis logarithmic between limits, with at most about `labels` labels, at every decade or every n-th."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

    axis = getattr(axes, f"{which}axis")
    getattr(axes, f"set_{which}scale")("log")
    getattr(axes, f"set_{which}lim")(low, high)
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    each = max(1, math.ceil((last - first + 1) / labels))
    axis.set_major_locator(FixedLocator([10.0**n for n in range(first, last + 1) if n % each == 0]))
    axis.set_major_formatter(FuncFormatter(power_of_ten))
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())
    axes.grid(True, axis=which)


def limits(values: Sequence[float], low: float = 0.6, high: float = 1.8) -> tuple[float, float]:
    """Return limits of a logarithmic axis around positive values, wider by these factors, or by more on a long axis."""
    spread = (max(values) / min(values)) ** _ROOM
    return min(values) * min(low, 1 / spread), max(values) * max(high, spread)
