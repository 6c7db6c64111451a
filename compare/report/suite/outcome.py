"""The outcome of judging a candidate: its score, or why it could not be judged; one does not stop the others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from reference import FoucaultError
from reference.errors import Stopped
from reference.status import Status

from ...score.document import document
from ...score.scored import Score
from ...score.verdict import lines

REFUSED = Status.REFUSED.value  # the verdict on a candidate that could not be judged
ORDER = ("agrees", "disagrees", REFUSED)  # from best to worst


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
        """0: agrees, 1: disagrees, 2 or 3: could not be judged."""
        return self.error.exit_status if self.error is not None else int(self.verdict != "agrees")

    @property
    def lines(self) -> list[str]:
        """The lines for people, the verdict first."""
        if self.score is not None:
            return list(lines(self.score))
        return [f"{self.name} was not judged by {self.scene}: {self.error}"]

    def document(self) -> dict[str, Any]:
        """Return it as a row of the JSON document."""
        if self.score is not None:
            return document(self.score)
        return {"scene": self.scene, "candidate": self.name, "verdict": REFUSED, "error": str(self.error)}


def outcome(name: str, scene: str, judged: Callable[[], Score]) -> Outcome:
    """Judge a candidate; an error in it becomes the outcome, an interruption ends all."""
    try:
        score = judged()
    except Stopped:
        raise
    except FoucaultError as error:
        return Outcome(name, scene, error=error)
    return Outcome(score.candidate.name, score.scene.id, score)


def worst_verdict(outcomes: Sequence[Outcome]) -> str:
    """Return the verdict on all together: the worst."""
    return max((one.verdict for one in outcomes), key=ORDER.index, default="agrees")


def text_lines(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Yield the lines of each outcome."""
    for one in outcomes:
        yield from one.lines
