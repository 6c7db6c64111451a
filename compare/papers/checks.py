"""How a printed formula is judged: a row declares it and how to compute the truth; the verdict is computed.

- `Identity`: an equals sign in print. Both sides are evaluated at random points with 60 digits.
- `Approximate`: an "≈" in print. Its error is taken at the paper's own numbers, and its order is
  measured by making its small parameter smaller.
- `PrintedNumber`: a numeral in print. It is reproduced if it is the recomputed value, rounded or
  cut off.
- `Statement`: a sentence that a computation can refute.

A print that does not hold is a misprint only if the declared correction does hold: a row for which
neither holds raises `UnexplainedError`. So nothing can be listed as wrong, or as right, by hand.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any, Literal

from reference.numbers.precision import fixed_decimal, to_fraction

from .digits import MP, ZERO_BELOW, Value, distance, mpf, shown, size
from .points import Point, points

Verdict = Literal["exact", "reproduced", "approximation", "misprint"]
VERDICTS: tuple[Verdict, ...] = ("exact", "reproduced", "approximation", "misprint")

ORDER_SLACK = 0.2  # |measured order - order|; the next order is 1 away
LOOSE = "0.1"  # "about", "near", "roughly": within a tenth of the scale that the print speaks of


@dataclass(frozen=True)
class JudgedRow:
    """One judged line.

    Attributes:
        id: paper and place in one word.
        place: paper, section, equation.
        printed: as printed, short.
        recomputed: to 18 digits, at the first random point or with the paper's numbers.
        verdict: one of `VERDICTS`.
        error: of an approximation, with its measured order where it has one.
        correction: of a misprint; it was checked like the print.
        remark: anything else worth knowing.
    """

    id: str
    place: str
    printed: str
    recomputed: str
    verdict: Verdict
    error: str = ""
    correction: str = ""
    remark: str = ""


class UnexplainedError(ValueError):
    """Neither the printed formula nor its declared correction agrees with the truth."""


@dataclass(frozen=True)
class Check(ABC):
    """A declared row.

    Attributes:
        id: paper and place in one word; as declared in a section its end.
        place: paper, section, equation; as declared in a section its end.
        printed: as printed, short.
        remark: anything else worth knowing.
    """

    id: str
    place: str
    printed: str
    remark: str = field(default="", kw_only=True)

    @abstractmethod
    def row(self) -> JudgedRow:
        """Judge the printed line."""

    def judged(self, recomputed: str, verdict: Verdict, **more: str) -> JudgedRow:
        """Return the row with its verdict and the facts that support it.

        The remark is the declared one unless given.
        """
        return JudgedRow(
            self.id, self.place, self.printed, recomputed, verdict, **{"remark": self.remark} | more
        )


def section(prefix: str, place: str, *rows: Check) -> list[Check]:
    """Return rows with full ids and places, which are declared by their ends: "13" at "(13)", or at ""."""
    spaces = ("" if row.place[:1] in ("", ",") else " " for row in rows)
    return [
        replace(row, id=prefix + row.id, place=place + s + row.place)
        for row, s in zip(rows, spaces, strict=True)
    ]


def largest_gap(first: Sequence[Value], second: Sequence[Value]) -> Any:
    """Return the largest relative difference of two formulas' values at the same points."""
    pairs = zip(first, second, strict=True)
    return max(distance(a, b) / max(size(a), size(b), MP.mpf("1e-3")) for a, b in pairs)


def component(function: Callable[[Point], Value], i: int) -> Callable[[Point], Any]:
    """Return one component of a vector formula."""
    return lambda p: function(p)[i]


def over(
    family: Callable[[Any], Point],
    formula: Callable[[Point], Value],
    truth: Callable[[Point], Value],
) -> Callable[[Any], tuple[Value, Value]]:
    """Return the `pair` of an `Approximate` from formulas at points that the small parameter gives."""
    return lambda s: (formula(family(s)), truth(family(s)))


@dataclass(frozen=True)
class Identity(Check):
    """Printed with an equals sign: `formula` as printed, `truth` derived, `corrected` where the print fails."""

    formula: Callable[[Point], Value]
    truth: Callable[[Point], Value]
    correction: str = ""
    corrected: Callable[[Point], Value] | None = None

    def row(self) -> JudgedRow:
        """Judge the identity: exact, or a misprint whose correction is exact."""
        sample = points()
        printed, truth = [self.formula(p) for p in sample], [self.truth(p) for p in sample]
        gap, recomputed = largest_gap(printed, truth), shown(truth[0])
        if gap < ZERO_BELOW:
            if self.corrected is not None:
                raise UnexplainedError(
                    f"{self.id}: the printed formula is right, although a correction is declared"
                )
            return self.judged(recomputed, "exact")
        if (
            self.corrected is None
            or largest_gap([self.corrected(p) for p in sample], truth) >= ZERO_BELOW
        ):
            raise UnexplainedError(
                f"{self.id}: the printed formula has a relative error of {shown(gap, 3)}, "
                "and no declared correction removes it"
            )
        note = f"as printed {shown(printed[0], 6)}"
        remark = f"{self.remark} ({note})" if self.remark else note
        return self.judged(recomputed, "misprint", correction=self.correction, remark=remark)


@dataclass(frozen=True)
class Approximate(Check):
    """Printed with "≈": `pair(s)` gives print and truth with the small parameter s times the paper's own.

    The error must shrink as s**order. `unit` is that of the error, which is relative if there is
    none.
    """

    pair: Callable[[Any], tuple[Value, Value]]
    order: int
    small: str
    unit: str = ""

    def error(self, s: Any) -> Any:
        """Return the size of the error at s, relative unless there is a unit."""
        formula, truth = self.pair(MP.mpf(s))
        return distance(formula, truth) / (1 if self.unit else size(truth))

    def row(self) -> JudgedRow:
        """Judge the approximation: its error must have the declared order."""
        # where one power dominates
        coarse, fine = (self.error(MP.mpf(2) ** -halvings) for halvings in (10, 11))
        slope = MP.log(coarse / fine) / MP.log(2)
        if abs(slope - self.order) >= ORDER_SLACK:
            raise UnexplainedError(
                f"{self.id}: the error shrinks with order {shown(slope, 4)}, not {self.order}"
            )
        error = f"{shown(self.error(1), 3)}{' ' + self.unit if self.unit else ' (relative)'}"
        order = f"order {shown(slope, 3)} in {self.small}"
        return self.judged(shown(self.pair(MP.one)[1]), "approximation", error=f"{error}; {order}")


@dataclass(frozen=True)
class PrintedNumber(Check):
    """A number in print (`numeral`: the same in ASCII); `value` recomputes it.

    `about`: the print says "about" or "near", and this is the scale it speaks of. `from_inputs`:
    the value from the rounded inputs that the paper itself states (`inputs`), tried where the exact
    inputs do not give the print.
    """

    numeral: str
    value: Callable[[], Any]
    about: Callable[[], Any] | None = None
    from_inputs: Callable[[], Any] | None = None
    inputs: str = ""
    decimals: int | None = None  # of the correction, where one more than printed is needed

    @property
    def number(self) -> Any:
        """The printed number."""
        return mpf(self.numeral)

    @property
    def last_place(self) -> int:
        """The power of ten of the last printed digit."""
        return int(Decimal(self.numeral).as_tuple().exponent)

    def fits(self, value: Any) -> str:
        """Return how the printed number follows from a value: "equal", "rounded", "cut off", or "" if it does not."""
        if value == self.number:
            return "equal"
        left = (value - self.number) / MP.mpf(10) ** self.last_place
        if abs(left) <= 0.5:
            return "rounded"
        return "cut off" if 0 < left * MP.sign(value) < 1 else ""

    def row(self) -> JudgedRow:
        """Judge the number: equal, reproduced, close enough for an "about", or a misprint."""
        value = self.value()
        how, recomputed = self.fits(value), shown(value)
        if how in ("equal", "rounded"):
            return self.judged(recomputed, "exact" if how == "equal" else "reproduced")
        note = how and "cut off, not rounded"
        if not how and self.from_inputs is not None and self.fits(self.from_inputs()):
            note = f"from {self.inputs}: {shown(self.from_inputs(), 8)}"
        if note:
            return self.judged(
                recomputed, "reproduced", remark="; ".join(filter(None, (note, self.remark)))
            )
        off = abs(self.number - value)
        if self.about is not None and off <= mpf(LOOSE) * abs(self.about()):
            error = f"{shown(off, 3)}, {shown(off / abs(value), 2)} (relative)"
            return self.judged(recomputed, "approximation", error=error)
        return self.judged(recomputed, "misprint", correction=self.rounded(value))

    def rounded(self, value: Any) -> str:
        """Return the value with as many digits as are printed."""
        if self.decimals is None and "e" in self.numeral:
            return shown(value, len(Decimal(self.numeral).as_tuple().digits))
        decimals = -self.last_place if self.decimals is None else self.decimals
        return fixed_decimal(to_fraction(value), max(0, decimals))


@dataclass(frozen=True)
class Answer:
    """The result of checking a statement: whether it is true, and the number that decides."""

    holds: bool
    recomputed: str
    error: str = ""


@dataclass(frozen=True)
class Statement(Check):
    """A sentence, and a computation that can refute it.

    `by_run`: it rests on a run and not on an identity.
    """

    test: Callable[[], Answer]
    correction: str = ""
    corrected: Callable[[], bool] | None = None
    by_run: bool = False

    def row(self) -> JudgedRow:
        """Judge the sentence: exact or reproduced, an approximation if an error is left, or a misprint."""
        finding = self.test()
        if finding.holds:
            if self.corrected is not None:
                raise UnexplainedError(
                    f"{self.id}: the sentence is true, although a correction is declared"
                )
            if finding.error:
                return self.judged(finding.recomputed, "approximation", error=finding.error)
            return self.judged(finding.recomputed, "reproduced" if self.by_run else "exact")
        if self.corrected is None or not self.corrected():
            raise UnexplainedError(
                f"{self.id}: neither the sentence nor a declared correction is true"
            )
        return self.judged(finding.recomputed, "misprint", correction=self.correction)
