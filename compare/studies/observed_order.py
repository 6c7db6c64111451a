"""The order that a method shows: the power with which its error falls as it takes more steps, over its settings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from reference.status import Status

from ..methods import METHODS
from ..observed.power_law import LEAST_POINTS, PowerLaw, power_law
from .row import Row

TOLD_APART = 0.25  # standard error up to which an order is told from its neighbours: twice that is half an order
ABOVE_LEAST = 10.0  # errors within this factor of a method's least are taken for rounding, or for the reference's bound


@dataclass(frozen=True)
class Order:
    """Declared and observed order of a method in a formulation.

    Attributes:
        method: its id.
        formulation: of the equations of motion.
        declared: by the method.
        observed: exponent of the error against the steps, or the evaluations where steps are not told; None where the
            runs do not tell it from its neighbours.
        standard_error: of the fit.
        settings: number of settings that were fitted.
    """

    method: str
    formulation: str
    declared: int
    observed: float | None = None
    standard_error: float | None = None
    settings: int = 0


def orders(rows: Sequence[Row], bound_m: float) -> list[Order]:
    """Return the orders of all methods that declare one, each in each of its formulations.

    Args:
        rows: of a study.
        bound_m: of the reference, in m.
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row.method in METHODS and METHODS[row.method].order is not None:
            groups.setdefault((row.method, row.formulation), []).append(row)
    return [_order(*key, group, bound_m) for key, group in groups.items()]


def _order(method: str, formulation: str, rows: Sequence[Row], bound_m: float) -> Order:
    declared = METHODS[method].order or 0
    laws = [law for law in _laws(rows, bound_m) if law.standard_error <= TOLD_APART]
    if not laws:
        return Order(method, formulation, declared)
    law = max(laws, key=lambda one: (one.points, -one.standard_error))
    return Order(method, formulation, declared, -law.exponent, law.standard_error, law.points)


def _laws(rows: Sequence[Row], bound_m: float) -> Iterator[PowerLaw]:
    """Yield the fit to each run of neighbouring settings over which the error falls and is no rounding."""
    points = sorted((count, row.error_m) for row in rows if row.status is Status.OK and row.error_m
                    if (count := row.steps or row.rhs_evaluations))  # fmt: skip
    least = max(bound_m, min((error for _, error in points), default=0.0))
    above = [point for point in points if point[1] > ABOVE_LEAST * least]
    for first in range(len(above)):
        for end in range(first + LEAST_POINTS, len(above) + 1):
            counts, errors = zip(*above[first:end], strict=True)
            if len(set(counts)) == len(counts) and list(errors) == sorted(errors, reverse=True):
                yield power_law(counts, errors)
