"""The outcome of one run among many, in studies and sweeps: a word, its meaning, and what to do about it."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """Outcome of a run; equal to its word, so that it stands in JSON and CSV as it is.

    Attributes:
        meaning: a phrase that says what happened, such as "stopped by itself, without a result".
        advice: a sentence that says what to do; empty where nothing has to be done.
    """

    meaning: str
    advice: str

    def __new__(cls, word: str, meaning: str = "", advice: str = "") -> Status:
        """Make a member from its word, its meaning and its advice."""
        member = str.__new__(cls, word)
        member._value_, member.meaning, member.advice = word, meaning, advice
        return member

    OK = "ok", "as it should be"
    EXTRAPOLATED = (
        "extrapolated",
        "cost extrapolated from a part of the span",
        "Allow more CPU seconds (--limit) to have the whole span measured.",
    )
    INVALID = "invalid", "the scene has a wrong field", "Correct the field that the reason names."
    REFUSED = "refused", "cannot describe the motion", "Take another formulation or method."
    NOT_INSTALLED = "not_installed", "its library is missing", "Install the extra that the reason names."
    NOT_FINITE = "not_finite", "ended in NaN or infinity", "Shorten the step or tighten the tolerance."
    GAVE_UP = (
        "gave_up",
        "stopped by itself, without a result",
        "Shorten the step or change the tolerance; the reason is as the library gave it.",
    )
    OUT_OF_TIME = (
        "out_of_time",
        "took longer than allowed",
        "Allow more CPU seconds (--limit), or ask for a shorter span.",
    )
    MISSED_TRANSITS = (
        "missed_transits",
        "missed, doubled or misplaced a transit",
        "Shorten the step or tighten the tolerance.",
    )
    SILENTLY_WRONG = (
        "silently_wrong",
        "reports success with an error far above what was asked for",
        "Do not trust this method here.",
    )
    ILL_CONDITIONED = (
        "ill_conditioned",
        "the motion itself magnifies errors",
        "Take a number type with more digits: in this one no method can do better.",
    )
    DOUBTFUL = "doubtful", "two computations disagree", "Ask for a higher level."
    UNREACHABLE = "unreachable", "asks for more than can be computed", "Ask for fewer digits or a shorter run."
    CRASHED = "crashed", "its process died", "Run it alone to see why."

    @property
    def words(self) -> str:
        """Return the word as it is read, such as "out of time"."""
        return self.value.replace("_", " ")
