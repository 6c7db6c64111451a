"""Taylor coefficients from the model's own equations, in mpmath: numbers that are polynomials in time."""

from __future__ import annotations

from reference.model.formulations import FORMULATIONS
from reference.model.start import Start


class Polynomial:
    def __init__(self, coefficients):
        self.coefficients = list(coefficients)

    def _like(self, other):
        if isinstance(other, Polynomial):
            return other.coefficients
        return [other, *([0] * (len(self.coefficients) - 1))]

    def __add__(self, other):
        return Polynomial(a + b for a, b in zip(self.coefficients, self._like(other), strict=True))

    __radd__ = __add__

    def __sub__(self, other):
        return Polynomial(a - b for a, b in zip(self.coefficients, self._like(other), strict=True))

    def __rsub__(self, other):
        return Polynomial(b - a for a, b in zip(self.coefficients, self._like(other), strict=True))

    def __neg__(self):
        return Polynomial(-a for a in self.coefficients)

    def __mul__(self, other):
        a, b = self.coefficients, self._like(other)
        return Polynomial(
            sum((a[i] * b[k - i] for i in range(k + 1)), start=0 * a[0]) for k in range(len(a))
        )

    __rmul__ = __mul__


def taylor(inputs, formulation, order, prec):
    """Return a context, the constants, and the Taylor coefficients of a formulation's variables at release, in rows."""
    start, model = Start.of(inputs, prec), FORMULATIONS[formulation]
    ctx, k = start.ctx, start.k
    rows = [[ctx.mpf(value)] for value in start.state(model)]
    for j in range(order):
        rates = model.derivatives([Polynomial(row) for row in rows], k, ctx)
        for row, rate in zip(rows, rates, strict=True):
            value = (
                rate.coefficients[j] if isinstance(rate, Polynomial) else (rate if j == 0 else 0)
            )
            row.append(ctx.mpf(value) / (j + 1))
    return ctx, k, rows
