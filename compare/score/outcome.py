"""The outcome of judging a candidate: a score, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from reference import FoucaultError
from reference.status import Status

from .scored import Since
from .verdict import Score, document, lines

REFUSED = Status.REFUSED.value  # the verdict on a candidate that could not be judged


@dataclass(frozen=True)
class Outcome:
    """The result of judging one candidate: a score, or the reason why there is none.

    Attributes:
        name: of the candidate.
        scene: id of the scene.
        score: None if it could not be judged.
        error: why it could not.
    """

    name: str
    scene: str
    score: Score | None = None
    error: FoucaultError | None = None

    @property
    def verdict(self) -> str:
        """'agrees' (as a model too, where that is enough), 'disagrees' or 'refused'."""
        if self.score is None:
            return REFUSED
        return "agrees" if self.score.passes else self.score.verdict

    @property
    def exit_status(self) -> int:
        """0: agrees, or no worse than its baseline; 1: disagrees, or worse; 2 or 3: could not be judged."""
        return int(not self.score.accepted) if self.score is not None else self.error.exit_status if self.error else 0

    @property
    def since(self) -> Since | None:
        """The changes since a baseline, if there is one."""
        return None if self.score is None else self.score.since

    @property
    def lines(self) -> list[str]:
        """The lines for people, the verdict first; details are indented."""
        if self.score is not None:
            return list(lines(self.score))
        return [f"{self.name} was not judged by {self.scene}: {self.error}"]

    @property
    def main_lines(self) -> list[str]:
        """The lines for people without details."""
        first, *others = self.lines
        return [first, *(line for line in others if not line.startswith("  "))]

    def document(self) -> dict[str, Any]:
        """Return it as a row of the JSON document."""
        if self.score is not None:
            return document(self.score)
        return {"scene": self.scene, "candidate": self.name, "verdict": REFUSED, "error": str(self.error)}
