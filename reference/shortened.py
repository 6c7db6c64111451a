"""A text of the user's, cut to a length that a message, a table or a chart has room for."""

from __future__ import annotations


def shortened(text: str, most: int) -> str:
    """Return a text of at most `most` characters, which ends in … if it was longer."""
    return text if len(text) <= most else f"{text[: most - 1]}…"
