"""The outcome of one run among many, in studies and sweeps: a word, its meaning, and what to do about it."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """Outcome of a run; equal to its word, so that it stands in JSON and CSV as it is.

    Attributes:
        meaning: a phrase for tables and keys, such as "out of time".
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
    REFUSED = "refused", "refused", "Take another formulation or method: this one cannot describe the motion."
    NOT_INSTALLED = "not_installed", "not installed", "Install the extra that the reason names."
    NOT_FINITE = "not_finite", "NaN or infinity", "Shorten the step or tighten the tolerance."
    GAVE_UP = "gave_up", "gave up", "Shorten the step or change the tolerance; the reason is as the library gave it."
    OUT_OF_TIME = "out_of_time", "out of time", "Allow more CPU seconds (--limit), or ask for a shorter span."
    MISSED_TRANSITS = "missed_transits", "missed transits", "Shorten the step or tighten the tolerance."
    SILENTLY_WRONG = (
        "silently_wrong",
        "silently wrong",
        "Do not trust this method here: it reports success with an error far above what was asked for.",
    )
    ILL_CONDITIONED = (
        "ill_conditioned",
        "ill-conditioned",
        "The motion itself magnifies errors: no method in this number type can do better.",
    )
    DOUBTFUL = "doubtful", "doubtful", "Two computations disagree: ask for a higher level."
    UNREACHABLE = "unreachable", "out of reach", "Ask for fewer digits or a shorter run."
    CRASHED = "crashed", "crashed", "The process died: run it alone to see why."
