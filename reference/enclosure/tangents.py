"""Proposals for derivatives to inputs: the equations that they obey, in double precision. Untrusted."""

from __future__ import annotations

from fractions import Fraction
from math import frexp
from typing import Any

import numpy as np

from ..numbers.taylor_step import TaylorStep
from .frames import ORDER, ColumnSource, hats
from .trusted.box import BoxBalls
from .trusted.derivatives import Way

FINE = 50  # bits of a coefficient beyond the largest


def scales_of(balls: BoxBalls, names: list[str]) -> dict[str, int]:
    """Return powers of two by which derivatives become about 1, by input."""
    found = {}
    for name in names:
        way, w = Way(balls, name, Fraction(0), 0), float(balls.w0)
        parts = [*way.last[:3], *(x / w for x in (*way.last[3:], *way.turn, way.slow))]
        found[name] = 1 - frexp(max(abs(float(x.mid())) for x in parts) or 1.0)[1]
    return found


class TangentSource:
    """Proposes six polynomials a step for each input: the linearised flow, driven by what the input changes."""

    def __init__(self, balls: BoxBalls, ways: list[Way]) -> None:
        """Read the ways as floats."""
        self.columns, self.w0, self.drag = ColumnSource(balls), float(balls.w0), float(balls.drag_0)
        self.turns, self.slows = (
            [np.array([*map(float, way.turn)]) for way in ways],
            [float(way.slow) for way in ways],
        )
        self.crosses = hats(np.array(self.turns)).transpose(0, 2, 1)
        self.ends = [np.array([*map(float, way.last)]) for way in ways]

    def propose(self, step: TaylorStep) -> list[Any]:
        """Return for each input integer polynomials and the bits of their unit."""
        h, M = float(step.h), ORDER
        field, n, lean = self.columns.linearised(step)
        w, unit, count = self.columns.w * h, np.array([1.0] * 3 + [h] * 3), len(self.ends)
        K = lean.copy()
        K[0] += w
        forces = np.zeros((M + 1, 6, 6 + count))
        for j in range(count):
            turn, slow = self.turns[j] * h, self.slows[j] * h
            forces[:, :3, 6 + j] = -n @ self.crosses[j] * h
            forces[:, 3:, 6 + j] = -K @ self.crosses[j] * h
            if self.drag:
                forces[:, 3:, 6 + j] -= h * self.drag * _along(turn, n)
                forces[0, 3:, 6 + j] += h * self.drag * turn
            if slow:
                forces[:, 3:, 6 + j] -= slow * (lean + _along(w, n))
        flow = np.zeros((M + 1, 6, 6 + count))
        flow[0, :, :6] = np.eye(6)
        matrices = field.transpose(1, 0, 2)
        for k in range(M):
            flow[k + 1] = (np.einsum("kij,kjl->il", matrices[: k + 1], flow[k::-1]) + forces[k]) / (
                k + 1
            )
        start, end = (
            np.tensordot(float(s) ** np.arange(M + 1), flow, 1) for s in (step.low, step.high)
        )
        proposals, begins = [], np.array([unit * x for x in self.ends]).T - start[:, 6:]
        for j, y in enumerate(np.linalg.solve(start[:, :6], begins).T):
            rows = flow[:, :, :6] @ y + flow[:, :, 6 + j]
            self.ends[j] = (end[:, :6] @ y + end[:, 6 + j]) / unit
            bits = FINE - frexp(np.abs(rows).max() or 1.0)[1]
            proposals.append(
                (np.rint(np.ldexp(rows.T, bits)).astype(np.int64).tolist(), max(bits, 0))
            )
        return proposals


def _along(a: Any, n: Any) -> Any:
    """Return the coefficients of (a·n) n."""
    return np.array([np.convolve(n @ a, column)[: len(n)] for column in n.T]).T
