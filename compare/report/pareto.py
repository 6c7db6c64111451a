"""Cost and error of a study's rows: Pareto front, cost of reaching an error, and their summary.

An error below the bound of the reference counts as equal to that bound.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from operator import itemgetter
from typing import Any

from pydantic import TypeAdapter

from ..observed.least_squares import LEAST_POINTS, PowerLaw, power_law
from ..studies.row import Row, grouped

# errors for which costs are tabulated and the cheapest method is named
TARGETS_M = (1e-3, 1e-6, 1e-9, 1e-12)
_PAPER_METHOD = "rk4"
_PAPER_NAME = "the paper's RK4"
_SMALL = 1.5e-3  # numbers below this are written with an exponent
_ALIKE = 1.05  # costs closer than this factor count as equal: repeated runs spread by as much


@dataclass(frozen=True)
class Curve:
    """The ladder of a method: its rows in one formulation, over all settings.

    Attributes:
        method: id of the method.
        formulation: of the equations of motion.
        usual: whether this is the method's usual formulation, the first that it is run with.
        rows: from the loosest setting to the tightest, failed ones included.
    """

    method: str
    formulation: str
    usual: bool
    rows: tuple[Row, ...]

    @property
    def label(self) -> str:
        """The method's id, with the formulation in brackets where it is not the method's usual one."""
        return self.method if self.usual else f"{self.method} ({self.formulation})"

    @property
    def kind(self) -> str:
        """The quantity that is varied: "step", "tolerance" or "precision"."""
        return self.rows[0].kind

    @property
    def measured(self) -> tuple[Row, ...]:
        """Rows with a cost and an error."""
        return tuple(row for row in self.rows if row.measured)


Cost = tuple[Curve, float]  # a method, and the CPU seconds at which it reaches an error


def rows_of(document: dict[str, Any]) -> list[Row]:
    """Return the rows of a study's document."""
    return TypeAdapter(list[Row]).validate_python(document["rows"])


def curves(rows: Sequence[Row]) -> list[Curve]:
    """Group rows by method and formulation, in order of appearance.

    A method's first formulation is its usual one.
    """
    usual = {row.method: row.formulation for row in reversed(rows)}
    result = []
    by_curve = grouped(rows, lambda row: (row.method, row.formulation))
    for (method, formulation), group in by_curve.items():
        ladder = sorted(group, key=_tightness)
        result.append(Curve(method, formulation, usual[method] == formulation, tuple(ladder)))
    return result


def _tightness(row: Row) -> float:
    """Return a number that grows as the setting becomes tighter: bits grow, steps and tolerances shrink."""
    return row.setting if row.kind == "precision" else -row.setting


def error_of(row: Row, bound_m: float) -> float:
    """Return the row's largest position error in m, at least the bound of the reference.

    Infinity if it has none.
    """
    return math.inf if row.error_m is None else max(row.error_m, bound_m)


def cost_of(row: Row) -> float:
    """Return the row's CPU seconds; infinity if it has none."""
    return math.inf if row.cpu_s is None else row.cpu_s


def front(rows: Sequence[Row], bound_m: float = 0.0) -> list[Row]:
    """Return the Pareto front: the measured rows with no other that is more accurate at no greater cost.

    Args:
        rows: any rows; those that were not run over the whole span are never on the front.
        bound_m: bound of the reference in m; errors below it count as equal.

    Returns:
        Rows of increasing cost and decreasing error; the first of equal rows.
    """
    smallest_error_m = math.inf
    rows_on_front = []
    for row in sorted(_measured(rows), key=lambda row: (cost_of(row), error_of(row, bound_m))):
        error_m = error_of(row, bound_m)
        if error_m < smallest_error_m:
            smallest_error_m = error_m
            rows_on_front.append(row)
    return rows_on_front


def cost_at(curve: Curve, error_m: float, bound_m: float = 0.0) -> float | None:
    """Return the least CPU seconds at which a method reaches an error.

    None if it does not reach it.

    The cost is interpolated in logarithms between neighbouring settings on both sides of the error,
    never across a failed setting and never beyond the ladder: if the loosest setting is already
    more accurate, its cost is returned.
    """
    if error_m < bound_m:
        return None
    costs_s = [
        *_costs_of_settings(curve, error_m, bound_m),
        *_costs_between(curve, error_m, bound_m),
    ]
    return min(costs_s, default=None)


def _costs_of_settings(curve: Curve, error_m: float, bound_m: float) -> Iterator[float]:
    """Yield the CPU seconds of each setting that reaches the error."""
    for row in curve.measured:
        if row.cpu_s and error_of(row, bound_m) <= error_m:
            yield row.cpu_s


def _costs_between(curve: Curve, error_m: float, bound_m: float) -> Iterator[float]:
    """Yield the interpolated CPU seconds between neighbouring settings on both sides of the error."""
    for a, b in pairwise(curve.rows):
        if not (a.measured and b.measured and a.cpu_s and b.cpu_s):
            continue
        error_a = error_of(a, bound_m)
        error_b = error_of(b, bound_m)
        if 0 < min(error_a, error_b) < error_m < max(error_a, error_b):
            fraction = math.log(error_m / error_a) / math.log(error_b / error_a)
            yield a.cpu_s * (b.cpu_s / a.cpu_s) ** fraction


def costs_at(rows: Sequence[Row], error_m: float, bound_m: float = 0.0) -> list[Cost]:
    """Return the cost of an error with every method that reaches it, the cheapest first."""
    costs = []
    for curve in curves(rows):
        cost_s = cost_at(curve, error_m, bound_m)
        if cost_s is not None:
            costs.append((curve, cost_s))
    return sorted(costs, key=itemgetter(1))


def sentences(document: dict[str, Any]) -> list[str]:
    """Return the main results: the cheapest method at each error reached, and the cost of digits.

    Each program or file of the user's has a sentence of its own.

    A study of precisions has only the cost of digits: what was measured, the price of a further
    digit, and the power law.
    """
    rows = rows_of(document)
    bound_m = float(document["reference"]["bound_m"])
    t_end = document["t_end"]
    if of_digits(rows, bound_m):
        prices = [_prices(curve, bound_m, t_end) for curve in curves(rows)]
    else:
        own = [*document.get("programs", ()), *document.get("candidates", ())]
        prices = [*_cheapest(rows, bound_m), *_of_the_users(own, rows, bound_m)]
    laws = costs_of_digits(rows, bound_m)
    fits = [cost_sentence(label, law, t_end) for label, law in laws.items()]
    return [sentence for sentence in (*prices, *fits) if sentence]


def of_digits(rows: Sequence[Row], bound_m: float) -> bool:
    """Return whether a study is one of precisions: no ladder of steps or tolerances has large errors."""
    measured_precisions = False
    for curve in curves(rows):
        if curve.kind == "precision":
            measured_precisions |= bool(curve.measured)
        elif len(curve.rows) > 1:
            errors_m = [error_of(row, bound_m) for row in _measured(curve.rows)]
            if max(errors_m, default=0.0) > TARGETS_M[-1]:
                return False
    return measured_precisions


def _prices(curve: Curve, bound_m: float, t_end: float) -> str:
    """Return what each number of digits costs with a method, and what a further digit costs."""
    measured = [row for row in _measured(curve.rows) if error_of(row, 0.0) < 1 and row.cpu_s]
    costs = sorted((digits_of(row, bound_m), cost_of(row)) for row in measured)
    if not costs:
        return ""
    (least, cost), *finer = costs
    text = f"{curve.label}: {least:.0f} digits over {t_end:g} s cost {seconds(cost)}"
    text += "".join(f", {digits:.0f} digits {seconds(cpu_s)}" for digits, cpu_s in finer)
    if finer:
        (fewer, less), (more, dearer) = costs[-2:]
        if more - fewer > 1:
            further = seconds((dearer - less) / (more - fewer))
            text += f"; from {fewer:.0f} to {more:.0f} a further digit costs {further}"
    return f"{text}."


def _cheapest(rows: Sequence[Row], bound_m: float) -> Iterator[str]:
    """Yield the cheapest method at each error that is reached; equal results share a sentence."""
    costs_by_error = {error_m: costs_at(rows, error_m, bound_m) for error_m in TARGETS_M}
    reached = [(error_m, costs) for error_m, costs in costs_by_error.items() if costs]
    for costs, group in groupby(reached, key=itemgetter(1)):
        errors_m = [tidy(error_m) for error_m, _ in group]
        where = f"At {errors_m[0]} m"
        if len(errors_m) > 1:
            where = f"From {errors_m[0]} m to {errors_m[-1]} m"
        yield _sentence(rows, where, costs, bound_m)


def _sentence(rows: Sequence[Row], where: str, costs: Sequence[Cost], bound_m: float) -> str:
    """Return the cheapest method, compared with the paper's, or with the next if it is the paper's."""
    cheapest, least_s = costs[0]
    head = f"{where} the cheapest method is {cheapest.label}, with {seconds(least_s)} of CPU time"
    if cheapest.method == _PAPER_METHOD:
        if len(costs) == 1:
            return f"{head}."
        second, cpu_s = costs[1]
        return f"{head}: {_times(cpu_s / least_s)} the next, {second.label}."
    for curve, cpu_s in costs:
        if curve.method == _PAPER_METHOD:
            return f"{head}: {_times(cpu_s / least_s)} {_PAPER_NAME}."
    paper_rows = [row for row in _measured(rows) if row.method == _PAPER_METHOD]
    if not paper_rows:
        return f"{head}."
    best_m = min(error_of(row, bound_m) for row in paper_rows)
    return f"{head}; {_PAPER_NAME} does not reach it ({best_m:.1e} m at best)."


def _of_the_users(names: Sequence[str], rows: Sequence[Row], bound_m: float) -> Iterator[str]:
    """Yield for each program or file of the user's what it costs at each error, compared with the cheapest."""
    for curve in curves(rows):
        if curve.method not in names:
            continue
        costs = []
        for error_m in TARGETS_M:
            cost_s = cost_at(curve, error_m, bound_m)
            if cost_s is not None:
                cheapest, least_s = costs_at(rows, error_m, bound_m)[0]
                compared = _compared(cost_s / least_s, cheapest)
                costs.append(f"{seconds(cost_s)} at {tidy(error_m)} m, {compared}")
        errors_m = [error_of(row, bound_m) for row in _with_errors(curve.rows)]
        if costs:
            yield f"Your {curve.method}: {'; '.join(costs)}."
        elif errors_m:
            yield f"Your {curve.method}: {min(errors_m):.1e} m at best."


def _compared(ratio: float, cheapest: Curve) -> str:
    """Return how a cost compares with that of the cheapest method."""
    if ratio == 1:
        return "the cheapest"
    if ratio < _ALIKE:
        return f"as cheap as {cheapest.label}"
    return f"{float(f'{ratio:.2g}'):.15g} times {cheapest.label}"


def _with_errors(rows: Sequence[Row]) -> list[Row]:
    """Return rows with a finite error over the whole span, also those without a cost."""
    return [row for row in rows if row.measured and math.isfinite(error_of(row, 0.0))]


def _times(ratio: float) -> str:
    if ratio < _ALIKE:
        return "as cheap as"
    two_digits = float(f"{ratio:.2g}")
    return f"{two_digits:.15g} times cheaper than"


def digits_of(row: Row, bound_m: float) -> float:
    """Return the correct decimals of the position in m: -log10 of the largest error."""
    return -math.log10(error_of(row, bound_m))


def costs_of_digits(rows: Sequence[Row], bound_m: float = 0.0) -> dict[str, PowerLaw]:
    """Fit the CPU seconds of each method whose setting is the precision as a power of the digits achieved.

    Rows at or below the bound of the reference are left out, because their true error is unknown. A
    method with too few rows has no law.

    Returns:
        The power laws by the labels of their curves.
    """
    laws = {}
    for curve in curves(rows):
        if curve.kind != "precision":
            continue
        fitted = [
            row
            for row in _measured(curve.rows)
            if row.error_m and bound_m < row.error_m < 1 and row.cpu_s
        ]
        if len({row.error_m for row in fitted}) >= LEAST_POINTS:
            digits = [digits_of(row, bound_m) for row in fitted]
            laws[curve.label] = power_law(digits, map(cost_of, fitted))
    return laws


def cost_sentence(label: str, law: PowerLaw, t_end: float) -> str:
    """Return the fitted cost of digits over a span of `t_end` s as a sentence."""
    return (
        f"The cost of {label} over {t_end:g} s is about {law.factor:.2g} s · digits^{law.exponent:.1f}: {law.points} "
        f"settings of {law.low:.0f} to {law.high:.0f} digits lie within a factor of {law.within:.2f} of it (digits = "
        "−log10 of the largest error in m)."
    )


def seconds(cpu_s: float) -> str:
    """Return a CPU time with its unit, to three digits."""
    if cpu_s < 1e-3:
        return f"{cpu_s * 1e6:.3g} µs"
    if cpu_s < 0.1:
        return f"{cpu_s * 1e3:.3g} ms"
    if cpu_s < 1000:
        return f"{cpu_s:.3g} s"
    return f"{cpu_s:.0f} s"


def tidy(value: float) -> str:
    """Return a number with three digits, small ones with an exponent: 1e-4, 2.22e-16, 0.05, 113."""
    if not 0 < abs(value) < _SMALL:
        return f"{value:.3g}"
    digits, _, exponent = f"{value:.2e}".partition("e")
    return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"


def _measured(rows: Sequence[Row]) -> list[Row]:
    """Return rows with a finite cost and error: a NaN would slip through comparisons."""
    measured = [row for row in rows if row.measured]
    return [row for row in measured if math.isfinite(error_of(row, 0.0) + cost_of(row))]
