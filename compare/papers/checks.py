"""How a printed line is judged. A row declares what is printed and how to compute the truth; the verdict is computed.

- `Identity`: an equals sign in print. Both sides are evaluated at random points with 60 digits.
- `Approximate`: an "≈" in print. Its error is taken at the document's own numbers, and its order is measured by
  making its small parameter smaller.
- `Number`: a numeral in print. It is reproduced if it is the recomputed value, rounded or cut off.
- `Statement`: a sentence that a computation can refute.

A print that does not hold is a misprint only if the declared correction does hold: a row for which neither is true
raises. So nothing here can be listed as wrong, or as right, by hand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

from reference.precision import fixed_decimal, to_fraction

from .digits import AGREE_DIGITS, MP, Value, distance, mpf, shown, size
from .points import Point, points

Verdict = Literal["exact", "reproduced", "approximation", "misprint"]
VERDICTS: tuple[Verdict, ...] = ("exact", "reproduced", "approximation", "misprint")

ORDER_SLACK = 0.2  # |measured order - order|; the next order is 1 away
LOOSE = "0.1"  # "about", "near", "roughly": within a tenth of the scale of what is spoken of


@dataclass(frozen=True)
class Row:
    """One judged line.

    Attributes:
        id: document and place in one word.
        place: document, section, equation.
        printed: as printed, short.
        recomputed: to 18 digits, at the first random point or at the document's numbers.
        verdict: one of `VERDICTS`.
        error: of an approximation, with its measured order where it has one.
        correction: of a misprint; it was checked like the print.
        remark: what else to know.
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
    """Neither the print nor its declared correction agrees with the truth."""

    def __init__(self, row: str, why: str) -> None:
        super().__init__(f"{row}: {why}")


class Check(Protocol):
    """A declared row."""

    @property
    def id(self) -> str:
        """Document and place in one word."""

    def row(self) -> Row:
        """Judge it."""


def largest_gap(one: Callable[[Point], Value], other: Callable[[Point], Value], at: Sequence[Point]) -> Any:
    """Largest relative difference of two formulas over points."""
    gaps = []
    for p in at:
        a, b = one(p), other(p)
        gaps.append(distance(a, b) / max(size(a), size(b), MP.mpf("1e-3")))
    return max(gaps)


def component(function: Callable[[Point], Value], i: int) -> Callable[[Point], Any]:
    """One component of a vector formula."""
    return lambda p: function(p)[i]


@dataclass(frozen=True)
class Identity:
    """Printed with an equals sign: `formula` as printed, `truth` derived, `corrected` where the print fails."""

    id: str
    place: str
    printed: str
    formula: Callable[[Point], Value]
    truth: Callable[[Point], Value]
    correction: str = ""
    corrected: Callable[[Point], Value] | None = None
    remark: str = ""

    def row(self) -> Row:
        """Exact, or a misprint whose correction is exact."""
        at = points()
        gap = largest_gap(self.formula, self.truth, at)
        recomputed, agree = shown(self.truth(at[0])), MP.mpf(10) ** -AGREE_DIGITS
        if gap < agree:
            if self.corrected is not None:
                raise UnexplainedError(self.id, "the print is right and a correction is declared")
            return Row(self.id, self.place, self.printed, recomputed, "exact", remark=self.remark)
        if self.corrected is None or largest_gap(self.corrected, self.truth, at) >= agree:
            raise UnexplainedError(self.id, f"the print is off by {shown(gap, 3)} and no correction mends it")
        there = f"as printed {shown(self.formula(at[0]), 6)}"
        remark = f"{self.remark} ({there})" if self.remark else there
        return Row(self.id, self.place, self.printed, recomputed, "misprint", correction=self.correction, remark=remark)


@dataclass(frozen=True)
class Approximate:
    """Printed with "≈": `pair(s)` gives print and truth with the small parameter s times the document's own.

    The error must shrink as s**order. `unit` is that of the error; relative if empty.
    """

    id: str
    place: str
    printed: str
    pair: Callable[[Any], tuple[Value, Value]]
    order: int
    small: str
    unit: str = ""
    remark: str = ""

    def error(self, s: Any) -> Any:
        """Size of the error at s, relative unless there is a unit."""
        formula, truth = self.pair(MP.mpf(s))
        return distance(formula, truth) / (1 if self.unit else size(truth))

    def measured_order(self) -> Any:
        """Slope of log error over log s, far down where one power rules."""
        coarse, fine = MP.mpf(2) ** -10, MP.mpf(2) ** -11
        return MP.log(self.error(coarse) / self.error(fine)) / MP.log(2)

    def row(self) -> Row:
        """An approximation of the order it should have."""
        slope = self.measured_order()
        if abs(slope - self.order) >= ORDER_SLACK:
            raise UnexplainedError(self.id, f"the error shrinks with order {shown(slope, 4)}, not {self.order}")
        error = f"{shown(self.error(1), 3)}{' ' + self.unit if self.unit else ' of it'}"
        order = f"order {shown(slope, 3)} in {self.small}"
        recomputed = shown(self.pair(MP.one)[1])
        return Row(
            self.id, self.place, self.printed, recomputed, "approximation", f"{error}; {order}", remark=self.remark
        )


@dataclass(frozen=True)
class Number:
    """A printed numeral (`numeral`: the same in ASCII), `value` its recomputation.

    `about`: the print says "about" or "near", and this is the scale it speaks of. `as_given`: the value from the
    rounded inputs that the document itself states, tried where the exact inputs do not give the print.
    """

    id: str
    place: str
    printed: str
    numeral: str
    value: Callable[[], Any]
    about: Callable[[], Any] | None = None
    as_given: Callable[[], Any] | None = None
    given: str = ""
    decimals: int | None = None  # of the correction, where one more than printed is needed
    remark: str = ""

    def fits(self, value: Any) -> str:
        """How the numeral follows from a value: "equal", "rounded", "cut off", or "" if it does not."""
        if value == mpf(self.numeral):
            return "equal"
        signed = value / self.unit
        if MP.nint(signed) * self.unit == mpf(self.numeral) or abs(signed - mpf(self.numeral) / self.unit) <= 0.5:
            return "rounded"
        towards_zero = MP.sign(signed) * MP.floor(abs(signed))
        return "cut off" if abs(towards_zero - mpf(self.numeral) / self.unit) < MP.mpf("1e-30") else ""

    @property
    def unit(self) -> Any:
        """One unit of the last printed digit."""
        mantissa, _, exponent = self.numeral.lower().partition("e")
        places = len(mantissa.partition(".")[2])
        return MP.mpf(10) ** (int(exponent or 0) - places)

    def row(self) -> Row:
        """Equal, reproduced, near enough for an "about", or a misprint."""
        value = self.value()
        how = self.fits(value)
        made = Row(self.id, self.place, self.printed, shown(value), "exact", remark=self.remark)
        if how == "equal":
            return made
        if how:
            remark = self.remark if how == "rounded" else _joined("cut off, not rounded", self.remark)
            return _changed(made, verdict="reproduced", remark=remark)
        if self.as_given is not None and self.fits(self.as_given()):
            given = f"from {self.given}: {shown(self.as_given(), 8)}"
            return _changed(made, verdict="reproduced", remark=_joined(given, self.remark))
        off = abs(mpf(self.numeral) - value)
        if self.about is not None and off <= mpf(LOOSE) * abs(self.about()):
            return _changed(made, verdict="approximation", error=f"{shown(off, 3)}, {shown(off / abs(value), 2)} of it")
        return _changed(made, verdict="misprint", correction=self.rounded(value))

    def rounded(self, value: Any) -> str:
        """The value in the shape of the print."""
        if self.decimals is None and "e" in self.numeral.lower():
            return shown(value, len(self.numeral.lower().partition("e")[0].replace(".", "").lstrip("-0")))
        decimals = self.decimals if self.decimals is not None else -int(MP.nint(MP.log10(self.unit)))
        return fixed_decimal(to_fraction(value), max(0, decimals))


@dataclass(frozen=True)
class Finding:
    """What a statement's computation found: does it hold, and the number it rests on."""

    holds: bool
    recomputed: str
    error: str = ""


@dataclass(frozen=True)
class Statement:
    """A sentence, and a computation that can refute it. `by_run`: it rests on a run and not on an identity."""

    id: str
    place: str
    printed: str
    test: Callable[[], Finding]
    correction: str = ""
    corrected: Callable[[], bool] | None = None
    by_run: bool = False
    remark: str = ""

    def row(self) -> Row:
        """Exact or reproduced, an approximation if it holds but for an error, or a misprint whose correction holds."""
        found = self.test()
        made = Row(self.id, self.place, self.printed, found.recomputed, "exact", remark=self.remark)
        if found.holds:
            if self.corrected is not None:
                raise UnexplainedError(self.id, "the sentence holds and a correction is declared")
            if found.error:
                return _changed(made, verdict="approximation", error=found.error)
            return _changed(made, verdict="reproduced") if self.by_run else made
        if self.corrected is None or not self.corrected():
            raise UnexplainedError(self.id, "the sentence does not hold and neither does a correction")
        return _changed(made, verdict="misprint", correction=self.correction)


def _joined(*texts: str) -> str:
    return "; ".join(text for text in texts if text)


def _changed(row: Row, **fields: Any) -> Row:
    return replace(row, **fields)
