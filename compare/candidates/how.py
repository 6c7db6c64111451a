"""Three lines of each language that write a candidate's file: the header, a row, and the command that saves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from reference import InputError
from reference.errors import did_you_mean, in_words
from reference.system.documents import texts_of


@dataclass(frozen=True)
class Snippet:
    """Three lines that write a candidate's file.

    Attributes:
        once: prints the header, before the loop over time.
        each: prints a row, at each output time, the release at t = 0 included; t, x, y are doubles.
        shell: runs the program and keeps its output.
        comment: begins a comment in the language.
        also: other names of the language.
    """

    once: str
    each: str
    shell: str
    comment: str = "//"
    also: Sequence[str] = ()


SNIPPETS = {language: Snippet(**lines) for language, lines in texts_of(__file__).items()}


def how(language: str) -> str:
    """Return the three lines for a language, and what a column means.

    Raises:
        InputError: the language is not known.
    """
    word = language.strip().lower()
    snippet = next((lines for name, lines in SNIPPETS.items() if word in (name, *lines.also)), None)
    if snippet is None:
        advice = did_you_mean(word, [*SNIPPETS], "Any other language works too: print a text file.")
        raise InputError("--how", language, in_words([*SNIPPETS]), advice)
    width = max(len(snippet.once), len(snippet.each)) + 2
    return (
        f"{snippet.once:{width}}{snippet.comment} once, before the loop over time\n"
        f"{snippet.each:{width}}{snippet.comment} at every output time, at t = 0 too\n"
        f"{snippet.shell}\n\n"
        "t in s; x east and y north of the suspension, in m; z, vx, vy, vz too if there: z up, so that it is negative\n"
        "below. Any times will do. Then: foucault score paris mine.csv, or have it run by --run 'COMMAND'."
    )
