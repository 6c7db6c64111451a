"""Proposals for derivatives with respect to inputs, from their linear equations in double precision. Untrusted."""

from __future__ import annotations

from fractions import Fraction
from math import frexp
from typing import Any

import numpy as np

from ..numbers.taylor_step import TaylorStep
from .frames import ORDER, ColumnSource, hats
from .trusted.box import BoxBalls
from .trusted.derivatives import InputSensitivity

FINE = 50  # bits of a coefficient beyond the largest


def scales_of(balls: BoxBalls, names: list[str]) -> dict[str, int]:
    """Return, by input, powers of two that scale the derivatives to about 1."""
    w0 = float(balls.w0)
    scales = {}
    for name in names:
        sensitivity = InputSensitivity(balls, name, Fraction(0), 0)
        lengths = sensitivity.end.rho
        rates = [*sensitivity.end.chi, *sensitivity.omega_q, sensitivity.drag_q]
        sizes = [abs(float(x.mid())) for x in (*lengths, *(x / w0 for x in rates))]
        _, exponent = frexp(max(sizes) or 1.0)
        scales[name] = 1 - exponent
    return scales


class TangentSource:
    """Proposes six polynomials a step for each input: the linearised flow, with the input's forces."""

    def __init__(self, balls: BoxBalls, sensitivities: list[InputSensitivity]) -> None:
        """Read Ω_q, γ_q and the derivatives at the release as floats."""
        self.columns = ColumnSource(balls)
        self.drag = float(balls.drag_0)
        self.omega_q = [np.array([*map(float, x.omega_q)]) for x in sensitivities]
        self.drag_q = [float(x.drag_q) for x in sensitivities]
        # the matrices of r ↦ r × Ω_q
        self.crosses = hats(np.array(self.omega_q)).transpose(0, 2, 1)
        self.ends = [np.array([*map(float, [*x.end.rho, *x.end.chi])]) for x in sensitivities]

    def propose(self, step: TaylorStep) -> list[Any]:
        """Return for each input integer polynomials and the bits of their unit."""
        h = float(step.h)
        unit = np.array([1.0] * 3 + [h] * 3)
        flow = self._flow(step)
        start = _value(flow, step.low)
        end = _value(flow, step.high)

        # the part of the free flow that makes each solution begin where the step before ended
        begins = np.array([unit * x for x in self.ends]).T - start[:, 6:]
        proposals = []
        for j, y in enumerate(np.linalg.solve(start[:, :6], begins).T):
            rows = flow[:, :, :6] @ y + flow[:, :, 6 + j]
            self.ends[j] = (end[:, :6] @ y + end[:, 6 + j]) / unit
            proposals.append(_integers(rows))
        return proposals

    def _flow(self, step: TaylorStep) -> Any:
        """Return coefficients of six free solutions, and of one driven by each input, from 0."""
        M = ORDER
        count = len(self.ends)
        field, forces = self._equations(step)
        flow = np.zeros((M + 1, 6, 6 + count))
        flow[0, :, :6] = np.eye(6)
        matrices = field.transpose(1, 0, 2)
        for k in range(M):
            products = np.einsum("kij,kjl->il", matrices[: k + 1], flow[k::-1])
            flow[k + 1] = (products + forces[k]) / (k + 1)
        return flow

    def _equations(self, step: TaylorStep) -> tuple[Any, Any]:
        """Return coefficients of the linearised equations' matrix, and of their forces (12.1)."""
        h = float(step.h)
        M = ORDER
        count = len(self.ends)
        linearised = self.columns.linearised(step)
        p = linearised.p
        K_less_omega = linearised.K_less_omega
        omega = self.columns.omega * h
        K = K_less_omega.copy()
        K[0] += omega
        forces = np.zeros((M + 1, 6, 6 + count))
        for j in range(count):
            omega_q = self.omega_q[j] * h
            drag_q = self.drag_q[j] * h
            forces[:, :3, 6 + j] = -p @ self.crosses[j] * h
            forces[:, 3:, 6 + j] = -K @ self.crosses[j] * h
            if self.drag:
                forces[:, 3:, 6 + j] -= h * self.drag * _along(omega_q, p)
                forces[0, 3:, 6 + j] += h * self.drag * omega_q
            if drag_q:
                forces[:, 3:, 6 + j] -= drag_q * (K_less_omega + _along(omega, p))
        return linearised.field, forces


def _value(flow: Any, s: Fraction) -> Any:
    """Return polynomials at `s`."""
    return np.tensordot(float(s) ** np.arange(ORDER + 1), flow, 1)


def _integers(rows: Any) -> tuple[list[list[int]], int]:
    """Return polynomials in integers, and the bits of their unit."""
    _, exponent = frexp(np.abs(rows).max() or 1.0)
    bits = FINE - exponent
    return np.rint(np.ldexp(rows.T, bits)).astype(np.int64).tolist(), max(bits, 0)


def _along(a: Any, p: Any) -> Any:
    """Return the coefficients of (a·p) p."""
    return np.array([np.convolve(p @ a, column)[: len(p)] for column in p.T]).T
