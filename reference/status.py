"""The outcome of one run of many: a word, its meaning, and what to do about it."""

from __future__ import annotations

from enum import StrEnum

from .system.documents import texts_of

_TEXTS = texts_of(__file__)


class Status(StrEnum):
    """Outcome of a run; equal to its word, so that JSON and CSV contain the word."""

    OK = "ok"
    EXTRAPOLATED = "extrapolated"
    INVALID = "invalid"
    REFUSED = "refused"
    NOT_INSTALLED = "not_installed"
    NOT_FINITE = "not_finite"
    GAVE_UP = "gave_up"
    OUT_OF_TIME = "out_of_time"
    MISSED_TRANSITS = "missed_transits"
    SILENTLY_WRONG = "silently_wrong"
    ILL_CONDITIONED = "ill_conditioned"
    DOUBTFUL = "doubtful"
    UNREACHABLE = "unreachable"
    CRASHED = "crashed"

    @property
    def meaning(self) -> str:
        """A phrase that says what happened, such as "stopped by itself, without a result"."""
        return str(_TEXTS[self]["meaning"])

    @property
    def advice(self) -> str:
        """A sentence that says what to do; empty where nothing has to be done."""
        return str(_TEXTS[self]["advice"])

    @property
    def words(self) -> str:
        """The word with spaces, for people, such as "out of time"."""
        return self.value.replace("_", " ")
