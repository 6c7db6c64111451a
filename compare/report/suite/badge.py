"""A badge as SVG: how many scenes agree, to how many digits, by which version of the data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from reference.scenes.shipped import DATA_VERSION

from .outcome import Outcome

LABEL = "Foucault pendulum"
GOOD, BAD = "#2f7d32", "#b3261e"  # white text on them has a contrast above 5 to 1
_WIDTH = 6.2  # px of a letter of 11 px, about; textLength makes it exact
_MARGIN = 8


def fewest_digits(outcomes: Sequence[Outcome]) -> float | None:
    """Return the least digits of the scenes that agree, rounded down to a tenth; None if none does."""
    digits = [one.score.errors.digits for one in outcomes if one.score is not None and one.score.agrees]
    return math.floor(10 * min(digits)) / 10 if digits else None


def message(outcomes: Sequence[Outcome]) -> str:
    """Return what the badge says."""
    agree = sum(one.verdict == "agrees" for one in outcomes)
    scenes = f"{agree} of {len(outcomes)} {'scene' if len(outcomes) == 1 else 'scenes'}"
    digits = fewest_digits(outcomes)
    middle = "" if digits is None else f" · {digits:.1f} digits"
    return f"{scenes}{middle} · data {DATA_VERSION}"


def badge(outcomes: Sequence[Outcome]) -> str:
    """Return the badge as SVG; the same outcomes give the same bytes."""
    right = message(outcomes)
    colour = GOOD if all(one.verdict == "agrees" for one in outcomes) else BAD
    widths = [round(len(text) * _WIDTH) for text in (LABEL, right)]
    first, whole = widths[0] + 2 * _MARGIN, sum(widths) + 4 * _MARGIN
    texts = "".join(
        f'<text x="{x}" y="14" textLength="{width}">{escape(text)}</text>'
        for x, width, text in ((_MARGIN, widths[0], LABEL), (first + _MARGIN, widths[1], right))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="20" role="img" '
        f'aria-label="{escape(f"{LABEL}: {right}")}">\n<title>{escape(f"{LABEL}: {right}")}</title>\n'
        f'<clipPath id="r"><rect width="{whole}" height="20" rx="3"/></clipPath>\n<g clip-path="url(#r)">'
        f'<rect width="{first}" height="20" fill="#444"/><rect x="{first}" width="{whole - first}" height="20" '
        f'fill="{colour}"/></g>\n<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">{texts}</g>'
        "\n</svg>\n"
    )
