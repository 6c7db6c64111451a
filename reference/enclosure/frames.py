"""Proposals of the six columns for Theorem E: the linearised flow of a step, in double precision. Untrusted."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from flint import fmpz_poly

from ..taylor_step import TaylorStep
from .bound import World
from .columns import FINE

ORDER = 27  # of the columns' polynomials
ILL = 10  # condition number above which the frame is made orthogonal


class ColumnSource:
    """Six columns a step: the linearised flow about (p, K), from a well-conditioned frame at the step's start."""

    def __init__(self, world: World) -> None:
        """Read the constants as floats."""
        self.w = np.array([float(x) for x in world.omega])
        self.c = np.array([float(x) for x in world.c])
        self.g, self.w0 = float(world.drag), float(world.w0)
        self.end: Any = np.eye(6)

    def propose(self, step: TaylorStep, widths: Iterable[float]) -> list[list[list[int]]]:
        """Return integer polynomials over 2^FINE, column by column; `widths` are the logarithms of the z_j."""
        h, M = float(step.h), ORDER
        w, c, g = self.w * h, self.c * h * h, self.g * h
        one = 1 << step.bits
        rows = [[int(x) / one for x in fmpz_poly(row).truncate(M + 2).coeffs()] for row in step.coefficients]
        whole = np.array([row + [0.0] * (M + 2 - len(row)) for row in rows[:3]]).T
        n = whole[: M + 1]
        speed = whole[1:] * np.arange(1, M + 2)[:, None] + np.cross(w, n)
        turn = np.array([np.cross(n[: k + 1], speed[k::-1]).sum(axis=0) for k in range(M + 1)])
        turn[0] -= w
        field = np.zeros((6, M + 1, 6))
        field[:3, :, :3] = hats(turn).transpose(1, 0, 2)
        field[:3, :, 3:] = -hats(n).transpose(1, 0, 2)
        field[3:, 0, :3] = -hats(c[None])[0]
        field[3:, 0, 3:] = -hats(w[None])[0]
        if g:
            along = n @ w
            field[3:, :, :3] -= g * (n.T[:, :, None] * w + np.eye(3)[:, None, :] * along[:, None])
            field[3:, 0, 3:] -= g * np.eye(3)
        back = np.zeros((M + 1, 6, 6))  # coefficient k stands at M - k
        back[M] = np.eye(6)
        for k in range(M):
            back[M - k - 1] = field[:, : k + 1].reshape(6, -1) @ back[M - k :].reshape(-1, 6) / (k + 1)
        flow = back[::-1]
        a, b = float(step.low), float(step.high)
        unit = np.array([1.0] * 3 + [h * self.w0] * 3)
        powers = np.arange(M + 1)
        start, end = (np.tensordot(s**powers, flow, 1) for s in (a, b))
        combine = np.linalg.solve(start, unit[:, None] * self._frame(np.fromiter(widths, float)))
        columns = flow @ combine
        self.end = (end @ combine) / unit[:, None]
        integers = np.rint(np.ldexp(columns, FINE))
        return [[[int(x) for x in integers[:, i, j]] for i in range(6)] for j in range(6)]

    def _frame(self, widths: Any) -> Any:
        lengths = np.linalg.norm(self.end, axis=0)
        straight = self.end / lengths
        if np.linalg.cond(straight) < ILL:
            return straight
        order = np.argsort(-(np.log(lengths) + widths))
        return np.linalg.qr(straight[:, order])[0]


def hats(rows: Any) -> Any:
    """Return the matrices a× of the rows a."""
    x, y, z = rows.T
    zero = np.zeros_like(x)
    return np.stack([np.stack(r, -1) for r in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], 1)
