"""The changes between two versions of a program, by the documents of their scores."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .case import AS_IF
from .thresholds import OF_A_CHANGE

STEPS = 2.0  # ratio of two errors of an integrator that counts as a change
SAME = 1e-9  # relative difference of two inputs that count as one
STEP = "step"
Document = Mapping[str, Any]  # of a score, or of a convention or cause in it


@dataclass(frozen=True)
class Since:
    """The changes since a baseline.

    Attributes:
        name: of the baseline.
        before_m: its largest position error in m, over the span that both have.
        after_m: that of the candidate.
        apart_m: the largest distance in m between both, of a document the difference of their errors; 0 if it is no
            more than rounding.
        worse: what became worse by more than the tolerance; empty if nothing did.
        gains: what became better by more than the tolerance; empty if nothing did.
        changes: what came and what went.
        left_m: what they leave of both errors, at most, in m; None if it is not known.
        complete: whether that is all, down to the tolerance or a tenth of `apart_m`.
    """

    name: str
    before_m: float
    after_m: float
    apart_m: float
    worse: tuple[str, ...] = ()
    gains: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()
    left_m: float | None = None
    complete: bool = False

    @property
    def better(self) -> bool:
        """Whether something became better by more than the tolerance, and nothing worse."""
        return bool(self.gains) and not self.worse

    @property
    def text(self) -> str:
        """All of it in a line."""
        word = "Worse since" if self.worse else "Better since" if self.better else "Since"
        numbers = f"{self.before_m:.3g} → {self.after_m:.3g} m"
        if self.changes:
            left = "not all of it" if self.left_m is None else f"all but {self.left_m:.2g} m"
            rest = "nothing else" if self.complete else f"that explains {left}"
            what = f"{'; '.join(self.changes)}: {numbers}; {rest}"
        elif self.apart_m:
            what = f"{numbers}; what lies between them, {self.apart_m:.2g} m, is no known mistake"
        else:
            what = f"no position changed, {numbers}"
        return f"{word} {self.name}: {what}{''.join(f'; {reason}' for reason in (*self.worse, *self.gains))}"


def _is_doubtful(deviation: Document) -> bool:
    """Return whether the motion is merely like that, or it is one of several."""
    return str(deviation["id"]).startswith(AS_IF) or "|" in deviation["id"]


def _known(document: Document) -> Iterator[Document]:
    """Yield the conventions and causes that are certain of a document's candidate, and its slip."""
    for deviation in (*document["conventions"], *document["causes"]):
        if deviation["text"].startswith("your ") and not _is_doubtful(deviation):
            yield deviation
    if document["slip"]:
        yield {
            "id": "slip",
            "text": f"your program has a slip ({document['slip'].rstrip('.')})",
            "size_m": 0.0,
        }


@dataclass(frozen=True)
class Version:
    """A version of a program: what explains its file, and its largest position error in m.

    Attributes:
        document: of its score, or the part of that which its explanation fills.
        error_m: over the span that both versions have.
    """

    document: Document
    error_m: float

    @property
    def left_m(self) -> float:
        """The error in m that remains once its causes are put right; the whole error if no cause is known."""
        return float((self.document["corrected"] or {"max_error_m": self.error_m})["max_error_m"])


def explain_change(
    old: Version, new: Version, apart_m: float, most_m: float
) -> tuple[tuple[str, ...], float | None]:
    """Return what came and what went, and what that leaves of both errors, in m; None where nothing is known.

    Args:
        old: the baseline.
        new: the candidate.
        apart_m: the largest distance in m between both versions.
        most_m: how far in m a cause may move the bob that came or went.
    """
    texts = tuple(_changes(old, new, most_m))
    if not texts:
        return (), None
    left_m = max(old.left_m, new.left_m) + _unexplained_m(old.document, new.document)
    # a step of no name is known by what its error looks like, and leaves it
    if left_m > OF_A_CHANGE * apart_m and not any(text.startswith("the step") for text in texts):
        return (), None
    return texts, left_m


def _unexplained_m(then: Document, now: Document) -> float:
    """Return how far in m numbers that only one of two documents has may move the bob, their cause not known."""
    here, there = (
        [cause for cause in document["causes"] if _is_doubtful(cause)] for document in (then, now)
    )
    pairs = [(cause, there) for cause in here] + [(cause, here) for cause in there]
    return float(
        sum(
            cause["size_m"]
            for cause, causes in pairs
            if not any(_is_same(cause, other) for other in causes)
        )
    )


def _changes(old: Version, new: Version, most_m: float) -> Iterator[str]:
    """Yield what came and what went; a number that changed has come."""
    before, after = list(_known(old.document)), list(_known(new.document))
    came = [
        deviation for deviation in after if not any(_is_same(deviation, other) for other in before)
    ]
    went = [deviation for deviation in before if _kind(deviation) not in map(_kind, after)]
    for when, deviations, hidden in (("now", came, old.left_m), ("no longer", went, new.left_m)):
        for deviation in deviations:
            # a smaller one may be hidden in what the causes of the other version leave
            if 0 < deviation["size_m"] <= hidden or deviation["size_m"] > most_m:
                continue
            if deviation["id"] == "off_the_sphere" and STEP in map(_kind, deviations):
                continue  # a step takes the bob off the sphere
            text = deviation["text"].partition(" (--set")[0]  # which is advice for a verdict
            text = text.replace("your program", f"it {when}", 1).replace(
                "your file", f"its file {when}", 1
            )
            yield (
                text
                if _kind(deviation) != STEP
                else f"the step ({text})"
                if when == "now"
                else "the step"
            )


def _kind(deviation: Document) -> str:
    """Return the word for a thing of which a program has one: a step, a gravity."""
    kinds = {"integrator_": STEP, "gravity_": "site.gravity"}
    return next(
        (kind for begin, kind in kinds.items() if deviation["id"].startswith(begin)),
        str(deviation["id"]),
    )


def _is_same(deviation: Document, other: Document) -> bool:
    """Return whether two conventions or causes say the same."""
    value, was = deviation.get("value"), other.get("value")
    if (value is None or was is None) and _kind(deviation) == _kind(other) == STEP:
        return bool(1 / STEPS < deviation["size_m"] / other["size_m"] < STEPS)
    if value is None or was is None:
        return bool(deviation["text"] == other["text"])
    doubt = sum(each.get("uncertainty") or 0.0 for each in (deviation, other)) + SAME * abs(value)
    return bool(deviation["id"] == other["id"] and abs(value - was) <= doubt)
