"""The changes between two versions of a program, by the documents of their scores."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .explanation.case import AS_IF

STEPS = 2.0  # ratio of two errors of an integrator that counts as a change
SAME = 1e-9  # relative difference of two inputs that count as one
STEP = "step"
Told = Mapping[str, Any]  # a convention or a cause, as in the document


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
        better: whether it became better by more than the tolerance.
        changes: what came and what went.
        left_m: what they leave of both errors, at most, in m; None if it is not known.
        complete: whether that is all, down to the tolerance or a tenth of `apart_m`.
    """

    name: str
    before_m: float
    after_m: float
    apart_m: float
    worse: tuple[str, ...] = ()
    better: bool = False
    changes: tuple[str, ...] = ()
    left_m: float | None = None
    complete: bool = False

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
            what = f"nothing changed, {numbers}"
        return f"{word} {self.name}: {what}{''.join(f'; {reason}' for reason in self.worse)}"


def _told(said: Mapping[str, Any]) -> Iterator[Told]:
    """Yield what a document says for certain of its candidate: of the file, of the program."""
    for one in (*said["conventions"], *said["causes"]):
        if one["text"].startswith("your ") and not one["id"].startswith(AS_IF):
            yield one
    if said["slip"]:
        yield {"id": "slip", "text": f"your program has a slip ({said['slip'].rstrip('.')})", "size_m": 0.0}


def left_of(said: Mapping[str, Any], error_m: float) -> float:
    """Return what the causes of a document leave in m; all of its error where none is known."""
    return float((said["corrected"] or {"max_error_m": error_m})["max_error_m"])


def untold_m(then: Told, now: Told) -> float:
    """Return how far in m numbers that only one of two documents has may move the bob, their cause not known."""
    here, there = ([one for one in said["causes"] if one["id"].startswith(AS_IF)] for said in (then, now))
    pairs = [(one, there) for one in here] + [(one, here) for one in there]
    return float(sum(one["size_m"] for one, others in pairs if not any(_is_same(one, other) for other in others)))


def changes(then: Told, now: Told, left: tuple[float, float], most: float) -> Iterator[str]:
    """Yield what came and what went; a number that changed has come.

    Args:
        then: the document of the baseline.
        now: that of the candidate.
        left: what the causes of each leave in m: a smaller one may be in it untold.
        most: how far in m one may move the bob.
    """
    before, after = list(_told(then)), list(_told(now))
    came = [one for one in after if not any(_is_same(one, other) for other in before)]
    went = [one for one in before if _kind(one) not in map(_kind, after)]
    for when, ones, hidden in (("now", came, left[0]), ("no longer", went, left[1])):
        for one in ones:
            if 0 < one["size_m"] <= hidden or one["size_m"] > most:
                continue
            if one["id"] == "off_the_sphere" and STEP in map(_kind, ones):
                continue  # a step takes the bob off the sphere
            text = one["text"].partition(" (--set")[0]  # which is advice for a verdict
            text = text.replace("your program", f"it {when}", 1).replace("your file", f"its file {when}", 1)
            yield text if _kind(one) != STEP else f"the step ({text})" if when == "now" else "the step"


def _kind(one: Told) -> str:
    """Return the word for a thing of which a program has one: a step, a gravity."""
    kinds = {"integrator_": STEP, "gravity_": "site.gravity"}
    return next((kind for begin, kind in kinds.items() if one["id"].startswith(begin)), str(one["id"]))


def _is_same(one: Told, other: Told) -> bool:
    """Return whether two explanations tell the same."""
    value, was = one.get("value"), other.get("value")
    if (value is None or was is None) and _kind(one) == _kind(other) == STEP:
        return bool(1 / STEPS < one["size_m"] / other["size_m"] < STEPS)
    if value is None or was is None:
        return bool(one["text"] == other["text"])
    doubt = sum(part.get("uncertainty") or 0.0 for part in (one, other)) + SAME * abs(value)
    return bool(one["id"] == other["id"] and abs(value - was) <= doubt)
