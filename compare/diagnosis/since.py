"""The changes between two versions of a program, by the documents of their scores."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .case import AS_IF
from .thresholds import NEEDED, OTHER_STEP

# what is said of a difference that no change explains
NOT_SOUGHT = "is not explained: its cause was not looked for"
ROUNDING = "is no more than the rounding of the printed numbers"
_NOT_CERTAIN = "is not explained: its cause is not certain"
_UNKNOWN = "is explained by nothing that was tried"

_SAME = 1e-9  # relative difference of two inputs that count as one
_STEP = "step"
_UNNAMED_STEP = "integrator_loose"
_MORE = ", and "  # between the first thing that a text says and the next
_ADVICE = re.compile(r" \(--set [^)]*\)")  # for a verdict, inside a text
_Document = Mapping[str, Any]  # of a score, or of a convention or cause in it


@dataclass(frozen=True)
class Since:
    """The changes since a baseline.

    Attributes:
        name: of the baseline.
        before_m: its largest position error in m, over the span that both have.
        after_m: that of the candidate.
        apart_m: the largest distance in m between both, or the difference of their errors if the
            baseline is a document; 0 if it is no more than rounding.
        worse: what became worse by more than the tolerance; empty if nothing did.
        gains: what became better by more than the tolerance; empty if nothing did.
        changes: what came and what went.
        left_m: the larger error in m that remains without them; None if it is not known.
        complete: whether that is all, down to the tolerance or a tenth of `apart_m`.
        unexplained: what is said of the difference if there are no changes.
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
    unexplained: str = NOT_SOUGHT

    @property
    def better(self) -> bool:
        """Whether something became better by more than the tolerance, and nothing worse."""
        return bool(self.gains) and not self.worse

    @property
    def text(self) -> str:
        """All of it in a line."""
        begin = "Since"
        if self.worse:
            begin = "Worse since"
        elif self.better:
            begin = "Better since"
        errors = f"{self.before_m:.3g} → {self.after_m:.3g} m"
        if self.changes:
            change = f"{'; '.join(self.changes)}: {errors}; {self._explained}"
        elif self.apart_m:
            change = f"{errors}; what lies between them, {self.apart_m:.2g} m, {self.unexplained}"
        else:
            change = f"no position changed, {errors}"
        reasons = "".join(f"; {reason}" for reason in (*self.worse, *self.gains))
        return f"{begin} {self.name}: {change}{reasons}"

    @property
    def _explained(self) -> str:
        """How much of the difference the changes explain."""
        if self.complete:
            return "nothing else"
        if self.left_m is None:
            return "it is not certain that this is all"
        return f"that explains all but {self.left_m:.2g} m"


def _is_doubtful(deviation: _Document) -> bool:
    """Return whether the motion is merely like that, or it is one of several."""
    return str(deviation["id"]).startswith(AS_IF) or "|" in deviation["id"]


def _all(document: _Document) -> Sequence[_Document]:
    """Return the conventions and causes of a document's candidate."""
    return [*document["conventions"], *document["causes"]]


def _known(document: _Document) -> Iterator[_Document]:
    """Yield the conventions and causes of a document's candidate that are certain, and its slip."""
    for deviation in _all(document):
        if deviation["text"].startswith("your ") and not _is_doubtful(deviation):
            yield deviation
    if document["slip"]:
        text = f"your program has a slip ({document['slip'].rstrip('.')})"
        yield {"id": "slip", "text": text, "size_m": 0.0}


@dataclass(frozen=True)
class Version:
    """A version of a program: what explains its file, and its largest position error in m.

    Attributes:
        document: of its score, or the part of that which its explanation fills.
        error_m: over the span that both versions have.
    """

    document: _Document
    error_m: float

    @property
    def left_m(self) -> float:
        """The error in m that remains without its causes; the whole error if no cause is known."""
        return float((self.document["corrected"] or {"max_error_m": self.error_m})["max_error_m"])

    @property
    def is_doubtful(self) -> bool:
        """Whether a part of its explanation is not certain."""
        return any(map(_is_doubtful, _all(self.document)))

    def is_explained(self, allowed_m: float) -> bool:
        """Return whether certain sentences, or none, explain its file down to a distance in m."""
        return self.left_m <= allowed_m and not self.is_doubtful


@dataclass(frozen=True)
class _Differences:
    """The certain findings that two versions do not share.

    Attributes:
        came: of the new one; a number that changed has come.
        went: of the old one.
        before: all that the old one has.
        after: all that the new one has.
        are_all: whether these are all. The longer form of what the other version has is left out
            beside another difference: of a file that does not tell, the shorter form is said.
    """

    came: Sequence[_Document]
    went: Sequence[_Document]
    before: Sequence[_Document]
    after: Sequence[_Document]
    are_all: bool = True

    @classmethod
    def of(cls, old: Version, new: Version) -> _Differences:
        """Return the differences of two versions that are certain."""
        before = list(_known(old.document))
        after = list(_known(new.document))
        kinds = [_kind(deviation) for deviation in after]
        came = [deviation for deviation in after if not _is_in(deviation, before)]
        gone = [deviation for deviation in before if not _is_in(deviation, after)]
        went = [deviation for deviation in gone if _kind(deviation) not in kinds]

        sure_came = [deviation for deviation in came if not _shorter_form(deviation, before)]
        sure_went = [deviation for deviation in went if not _shorter_form(deviation, after)]
        count = len(came) + len(went)
        if count == 1 or len(sure_came) + len(sure_went) == count:
            return cls(came, went, before, after)
        return cls(sure_came, sure_went, before, after, are_all=False)


def explain_change(
    old: Version, new: Version, apart_m: float, most_m: float
) -> tuple[tuple[str, ...], float | None]:
    """Return what came and what went, and the larger error in m that remains without it; None if unknown.

    Args:
        old: the baseline.
        new: the candidate.
        apart_m: the largest distance in m between both versions.
        most_m: how far in m a cause may move the bob that came or went.
    """
    differences = _Differences.of(old, new)
    texts = tuple(_changes(old, new, differences, most_m))
    if not texts:
        return (), None
    left_m = max(old.left_m, new.left_m) + _unexplained_m(old.document, new.document)
    # a step error of unknown method is known by its pattern alone: it is not corrected
    if NEEDED * left_m > apart_m and not any(text.startswith("the step") for text in texts):
        return (), None
    return texts, left_m if differences.are_all else None


def unexplained(old: Version, new: Version) -> str:
    """Return what is said of a difference between two versions that no change explains."""
    differences = _Differences.of(old, new)
    differ = differences.came or differences.went or not differences.are_all
    if differ or old.is_doubtful or new.is_doubtful:
        return _NOT_CERTAIN
    return _UNKNOWN


def _unexplained_m(old: _Document, new: _Document) -> float:
    """Return how far in m doubtful numbers of only one of two documents may move the bob."""
    old_causes = [cause for cause in old["causes"] if _is_doubtful(cause)]
    new_causes = [cause for cause in new["causes"] if _is_doubtful(cause)]
    came = [cause for cause in new_causes if not _is_in(cause, old_causes)]
    went = [cause for cause in old_causes if not _is_in(cause, new_causes)]
    return float(sum(cause["size_m"] for cause in [*went, *came]))


def _changes(old: Version, new: Version, differences: _Differences, most_m: float) -> Iterator[str]:
    """Yield what came and what went."""
    for deviation in _visible(differences.came, old.left_m, most_m):
        text = _changed(deviation, "now", differences.before)
        yield f"the step ({text})" if _kind(deviation) == _STEP else text
    for deviation in _visible(differences.went, new.left_m, most_m):
        text = _changed(deviation, "no longer", differences.after)
        yield "the step" if _kind(deviation) == _STEP else text


def _visible(
    deviations: Sequence[_Document], hidden_m: float, most_m: float
) -> Iterator[_Document]:
    """Yield the deviations of one version that the other would show.

    Args:
        deviations: that only one version has.
        hidden_m: the error in m that remains of the other without its causes: it may hide smaller ones.
        most_m: how far in m a cause may move the bob that came or went.
    """
    kinds = [_kind(deviation) for deviation in deviations]
    for deviation in deviations:
        if 0 < deviation["size_m"] <= hidden_m or deviation["size_m"] > most_m:
            continue
        if deviation["id"] == "off_the_sphere" and _STEP in kinds:
            continue  # a step takes the bob off the sphere
        yield deviation


def _changed(deviation: _Document, when: str, others: Sequence[_Document]) -> str:
    """Return the sentence on a deviation, about a program that does so now, or no longer.

    What the other version does as well is left out.

    Args:
        deviation: of one version.
        when: "now" or "no longer".
        others: all deviations of the other version.
    """
    text = str(deviation["text"])
    shorter = _shorter_form(deviation, others)
    if shorter:
        subject = " ".join(text.split()[:2])  # your program, or your file
        text = f"{subject} {text.removeprefix(shorter + _MORE)}"
    text = _ADVICE.sub("", text)
    text = text.replace("your program", f"it {when}", 1)
    return text.replace("your file", f"its file {when}", 1)


def _shorter_form(deviation: _Document, others: Sequence[_Document]) -> str:
    """Return the text of the deviation that this one adds to, or "" if it adds to none."""
    shorter = (str(other["text"]) for other in others if _says_as_much(deviation, other))
    return next(shorter, "")


def _says_as_much(deviation: _Document, other: _Document) -> bool:
    """Return whether a deviation says all that another one says, and more."""
    return str(deviation["text"]).startswith(f"{other['text']}{_MORE}")


def _kind(deviation: _Document) -> str:
    """Return the word for a thing of which a program has one: a step, a gravity."""
    if deviation["id"].startswith("integrator_"):
        return _STEP
    if deviation["id"].startswith("gravity_"):
        return "site.gravity"
    return str(deviation["id"])


def _is_in(deviation: _Document, deviations: Sequence[_Document]) -> bool:
    """Return whether one of several deviations says the same as this one, or that and more."""
    return any(
        _is_same(deviation, other) or _says_as_much(other, deviation) for other in deviations
    )


def _is_same(deviation: _Document, other: _Document) -> bool:
    """Return whether two conventions or causes say the same."""
    both_ids = (deviation["id"], other["id"])
    if _UNNAMED_STEP in both_ids and _kind(deviation) == _kind(other):
        return bool(1 / OTHER_STEP < deviation["size_m"] / other["size_m"] < OTHER_STEP)
    new_value = deviation.get("value")
    old_value = other.get("value")
    if new_value is None or old_value is None:
        return bool(deviation["text"] == other["text"])
    uncertainty = sum(document.get("uncertainty") or 0.0 for document in (deviation, other))
    same = abs(new_value - old_value) <= uncertainty + _SAME * abs(new_value)
    return bool(deviation["id"] == other["id"] and same)
