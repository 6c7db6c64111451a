"""Proposals of the six columns for Theorem E: the linearised flow of a step, in double precision.

Untrusted. But the radii of a proof follow from them, and so do bytes of its dataset: only operations
are used that IEEE 754 rounds alike on every machine, one after another. No BLAS, no LAPACK, no libm.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from flint import arb, fmpz_poly

from ..numbers.taylor_step import TaylorStep
from .trusted.six_columns import FINE
from .trusted.system import SceneBalls

ORDER = 27  # of the columns' polynomials
ILL = 13  # condition number (Frobenius) above which the frame is made orthogonal


class Linearised(NamedTuple):
    """Coefficients of powers of s, along the first axis of each array; of the matrix, along the second."""

    field: Any  # the matrix of the linearised equations, shape (6, ORDER + 1, 6)
    p: Any  # shape (ORDER + 1, 3)
    K_less_omega: Any  # K - Ω, likewise


class ColumnSource:
    """Proposes six columns for each step: the linearised flow about (p, K), from a well-conditioned frame."""

    def __init__(self, balls: SceneBalls) -> None:
        """Read the constants as floats."""
        self.omega = np.array([float(x) for x in balls.omega_0])
        self.c = np.array([float(x) for x in balls.c])
        self.drag = float(balls.drag_0)
        self.w0 = float(balls.w0)
        self.end: Any = np.eye(6)

    def propose(self, step: TaylorStep, log_widths: Iterable[float]) -> list[list[list[int]]]:
        """Return integer polynomials over 2^FINE, column by column, from the logarithms of the z_j."""
        M = ORDER
        flow = self._flow(step)
        start = product(_powers(float(step.low), M)[None], flow).reshape(6, 6)
        end = product(_powers(float(step.high), M)[None], flow).reshape(6, 6)

        unit = np.array([1.0] * 3 + [float(step.h) * self.w0] * 3)
        combine = product(_inverse(start), unit[:, None] * self._frame(log_widths))
        columns = product(flow.reshape(-1, 6), combine).reshape(M + 1, 6, 6)
        self.end = product(end, combine) / unit[:, None]
        integers = np.rint(np.ldexp(columns, FINE))
        return [[[int(x) for x in integers[:, i, j]] for i in range(6)] for j in range(6)]

    def _flow(self, step: TaylorStep) -> Any:
        """Return coefficients of the flow from s = 0, shape (ORDER + 1, 36)."""
        M = ORDER
        field = self.linearised(step).field
        reversed_flow = np.zeros((M + 1, 6, 6))  # coefficient k is at M - k
        reversed_flow[M] = np.eye(6)
        for k in range(M):
            matrices = field[:, : k + 1].reshape(6, -1)
            before = reversed_flow[M - k :].reshape(-1, 6)
            reversed_flow[M - k - 1] = product(matrices, before) / (k + 1)
        return reversed_flow[::-1].reshape(M + 1, 36)

    def linearised(self, step: TaylorStep) -> Linearised:
        """Return the equations of section 5 about the step's polynomials, linearised."""
        h = float(step.h)
        M = ORDER
        omega = self.omega * h
        c = self.c * h * h
        drag = self.drag * h

        whole = _coefficients(step)
        p = whole[: M + 1]
        p_rate = whole[1:] * np.arange(1, M + 2)[:, None]
        V = p_rate + np.cross(omega, p)
        products = np.cross(p[:, None], V[None])
        K_less_omega = np.array(
            [products[range(k + 1), range(k, -1, -1)].sum(axis=0) for k in range(M + 1)]
        )
        K_less_omega[0] -= omega

        field = np.zeros((6, M + 1, 6))
        field[:3, :, :3] = hats(K_less_omega).transpose(1, 0, 2)
        field[:3, :, 3:] = -hats(p).transpose(1, 0, 2)
        field[3:, 0, :3] = -hats(c[None])[0]
        field[3:, 0, 3:] = -hats(omega[None])[0]
        if drag:
            along = product(p, omega[:, None])[:, 0]
            outer = p.T[:, :, None] * omega
            field[3:, :, :3] -= drag * (outer + np.eye(3)[:, None, :] * along[:, None])
            field[3:, 0, 3:] -= drag * np.eye(3)
        return Linearised(field, p, K_less_omega)

    def _frame(self, log_widths: Iterable[float]) -> Any:
        """Return unit columns at the step's start: where the last ones ended, or orthogonal ones."""
        lengths = np.sqrt((self.end * self.end).sum(axis=0))
        straight = self.end / lengths
        inverse = _inverse(straight)
        condition_squared = _sum_of_squares(straight) * _sum_of_squares(inverse)
        if condition_squared < ILL**2:
            return straight

        # the longest of the box first
        logs = [
            float(arb(length).log()) + log_width
            for length, log_width in zip(lengths, log_widths, strict=True)
        ]
        longest_first = sorted(range(6), key=lambda j: -logs[j])
        return _orthogonal(straight[:, longest_first])


def _coefficients(step: TaylorStep) -> Any:
    """Return the coefficients of p as floats, shape (ORDER + 2, 3)."""
    count = ORDER + 2
    one = 1 << step.bits
    columns = np.zeros((3, count))
    x, m, w, _ = step.coefficients
    for i, row in enumerate((x, m, w)):
        for k, x in enumerate(fmpz_poly(row).truncate(count).coeffs()):
            columns[i, k] = int(x) / one
    return columns.T


def product(a: Any, b: Any) -> Any:
    """Return the matrix product, each sum taken in order."""
    # along the first axis: one by one
    return np.multiply(a.T[:, :, None], b[:, None, :], order="C").sum(axis=0)


def _powers(x: float, order: int) -> Any:
    """Return 1, x, x², … up to an order."""
    return np.cumprod([1.0, *[x] * order])


def _sum_of_squares(matrix: Any) -> Any:
    """Return the sum of the squares of all entries, taken in order."""
    return (matrix * matrix).ravel().cumsum()[-1]


def _inverse(matrix: Any) -> Any:
    """Return the inverse, by elimination with row exchanges."""
    size = len(matrix)
    rows = np.hstack([matrix, np.eye(size)])
    for i in range(size):
        pivot = i + int(np.argmax(np.abs(rows[i:, i])))
        rows[[i, pivot]] = rows[[pivot, i]]
        rows[i] /= rows[i, i]
        not_i = np.arange(size) != i
        rows[not_i] -= rows[not_i, i : i + 1] * rows[i]
    return rows[:, size:]


def _orthogonal(matrix: Any) -> Any:
    """Return orthonormal columns, each from those up to it: Gram-Schmidt, twice for accuracy."""
    columns: list[Any] = []
    for column in matrix.T:
        remainder = column
        for done in columns * 2:
            remainder = remainder - (done * remainder).cumsum()[-1] * done
        columns.append(remainder / np.sqrt((remainder * remainder).cumsum()[-1]))
    return np.array(columns).T


def hats(rows: Any) -> Any:
    """Return the matrices a× of the rows a."""
    x, y, z = rows.T
    zero = np.zeros_like(x)
    matrix = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    return np.stack([np.stack(row, -1) for row in matrix], 1)
