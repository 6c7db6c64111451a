"""The names nearest to an unknown word, and the error that asks whether one of them was meant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from .errors import InputError

MOST = 5  # names in a message at most
VERY_ALIKE = (1.0, 0.8)  # of difflib, from 0 to 1: names that are as alike as this leave no room for others
LEAST_PART = 3  # characters of a word that is looked for inside the names as well


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """Return at most five names: very like a word, else containing it, else like it; in any case."""
    names = {name.lower(): name for name in known}
    typed = word.lower()
    for likeness in VERY_ALIKE:
        if alike := get_close_matches(typed, names, n=MOST, cutoff=likeness):
            return [names[name] for name in alike]
    containing = sorted((name for name in names if len(typed) >= LEAST_PART and typed in name), key=len)
    return [names[name] for name in (containing or get_close_matches(typed, names, n=MOST))][:MOST]


def did_you_mean(word: str, known: Iterable[str], otherwise: str) -> str:
    """Return the question whether one of the nearest names was meant; `otherwise` if no name is near."""
    names = nearest(word, known)
    return f"Did you mean {in_words(names)}?" if names else otherwise


def in_words(names: Sequence[str]) -> str:
    """Return names as a phrase: a, b or c."""
    return " or ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


def unknown(field: str, word: str, expected: str, known: Iterable[str], otherwise: str) -> InputError:
    """Return the error for a word that is none of the known ones.

    Args:
        field: what the word was given for.
        word: as typed.
        expected: what it should have been.
        known: the names that exist.
        otherwise: advice if no name is near, such as the command that lists them.
    """
    return InputError(field, word, expected, did_you_mean(word, known, otherwise))
