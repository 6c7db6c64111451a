"""Proposals of the six columns for Theorem E: the linearised flow of a step, in double precision. Untrusted.

The radii of a proof follow from them, and so do bytes of its dataset. So only operations are used that IEEE 754 rounds
alike on every machine, one after another: no BLAS, no LAPACK, no functions of libm.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from flint import arb, fmpz_poly

from ..numbers.taylor_step import TaylorStep
from .trusted.six_columns import FINE
from .trusted.system import SceneBalls

ORDER = 27  # of the columns' polynomials
ILL = 13  # condition number (Frobenius) above which the frame is made orthogonal


class ColumnSource:
    """Six columns a step: the linearised flow about (p, K), from a well-conditioned frame at the step's start."""

    def __init__(self, balls: SceneBalls) -> None:
        """Read the constants as floats."""
        self.w = np.array([float(x) for x in balls.omega_0])
        self.c = np.array([float(x) for x in balls.c])
        self.g, self.w0 = float(balls.drag_0), float(balls.w0)
        self.end: Any = np.eye(6)

    def propose(self, step: TaylorStep, widths: Iterable[float]) -> list[list[list[int]]]:
        """Return integer polynomials over 2^FINE, column by column; `widths` are the logarithms of the z_j."""
        h, M = float(step.h), ORDER
        field, _, _ = self.linearised(step)
        back = np.zeros((M + 1, 6, 6))  # coefficient k stands at M - k
        back[M] = np.eye(6)
        for k in range(M):
            back[M - k - 1] = product(
                field[:, : k + 1].reshape(6, -1), back[M - k :].reshape(-1, 6)
            ) / (k + 1)
        flow = back[::-1].reshape(M + 1, 36)
        unit = np.array([1.0] * 3 + [h * self.w0] * 3)
        start, end = (
            product(_powers(float(s), M)[None], flow).reshape(6, 6) for s in (step.low, step.high)
        )
        combine = product(_inverse(start), unit[:, None] * self._frame(widths))
        columns = product(flow.reshape(-1, 6), combine).reshape(M + 1, 6, 6)
        self.end = product(end, combine) / unit[:, None]
        integers = np.rint(np.ldexp(columns, FINE))
        return [[[int(x) for x in integers[:, i, j]] for i in range(6)] for j in range(6)]

    def linearised(self, step: TaylorStep) -> tuple[Any, Any, Any]:
        """Return coefficients of the matrix of the linearised equations on a step, of p, and of K - Ω."""
        h, M = float(step.h), ORDER
        w, c, g = self.w * h, self.c * h * h, self.g * h
        one = 1 << step.bits
        rows = [
            [int(x) / one for x in fmpz_poly(row).truncate(M + 2).coeffs()]
            for row in step.coefficients
        ]
        whole = np.array([row + [0.0] * (M + 2 - len(row)) for row in rows[:3]]).T
        n = whole[: M + 1]
        speed = whole[1:] * np.arange(1, M + 2)[:, None] + np.cross(w, n)
        products = np.cross(n[:, None], speed[None])
        turn = np.array(
            [products[range(k + 1), range(k, -1, -1)].sum(axis=0) for k in range(M + 1)]
        )
        turn[0] -= w
        field = np.zeros((6, M + 1, 6))
        field[:3, :, :3] = hats(turn).transpose(1, 0, 2)
        field[:3, :, 3:] = -hats(n).transpose(1, 0, 2)
        field[3:, 0, :3] = -hats(c[None])[0]
        field[3:, 0, 3:] = -hats(w[None])[0]
        if g:
            along = product(n, w[:, None])[:, 0]
            field[3:, :, :3] -= g * (n.T[:, :, None] * w + np.eye(3)[:, None, :] * along[:, None])
            field[3:, 0, 3:] -= g * np.eye(3)
        return field, n, turn

    def _frame(self, widths: Iterable[float]) -> Any:
        lengths = np.sqrt((self.end * self.end).sum(axis=0))
        straight = self.end / lengths
        inverse = _inverse(straight)
        if (straight * straight).ravel().cumsum()[-1] * (inverse * inverse).ravel().cumsum()[
            -1
        ] < ILL**2:
            return straight
        logs = [
            float(arb(length).log()) + width for length, width in zip(lengths, widths, strict=True)
        ]
        return _orthogonal(straight[:, sorted(range(6), key=lambda j: -logs[j])])


def product(a: Any, b: Any) -> Any:
    """Return the matrix product, each sum taken in order."""
    # along the first axis: one by one
    return np.multiply(a.T[:, :, None], b[:, None, :], order="C").sum(axis=0)


def _powers(x: float, order: int) -> Any:
    return np.cumprod([1.0, *[x] * order])


def _inverse(matrix: Any) -> Any:
    """Return the inverse, by elimination with row exchanges."""
    size = len(matrix)
    rows = np.hstack([matrix, np.eye(size)])
    for i in range(size):
        pivot = i + int(np.argmax(np.abs(rows[i:, i])))
        rows[[i, pivot]] = rows[[pivot, i]]
        rows[i] /= rows[i, i]
        others = np.arange(size) != i
        rows[others] -= rows[others, i : i + 1] * rows[i]
    return rows[:, size:]


def _orthogonal(matrix: Any) -> Any:
    """Return orthonormal columns, each from those up to it (Gram and Schmidt, twice, as once loses digits)."""
    columns: list[Any] = []
    for column in matrix.T:
        left = column
        for done in columns * 2:
            left = left - (done * left).cumsum()[-1] * done
        columns.append(left / np.sqrt((left * left).cumsum()[-1]))
    return np.array(columns).T


def hats(rows: Any) -> Any:
    """Return the matrices a× of the rows a."""
    x, y, z = rows.T
    zero = np.zeros_like(x)
    return np.stack([np.stack(r, -1) for r in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], 1)
