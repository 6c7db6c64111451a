"""Plane pendulum without rotation (Ω = 0) in Jacobi's elliptic functions: the green curves of Mathar, figure 7."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import Scene
from reference.numbers.precision import Array

from .approximation import Motion
from .case import PaperCase, at_rest, lowest_point, under_gravity, without_drag

_SMALLEST = 1e-20  # terms of the series below this are lost in binary64 rounding


def sn_cn(u: Array, modulus: Any, ctx: Any) -> tuple[Array, Array]:
    """Return k sn(u) and k cn(u), k the modulus, by their Fourier series in the nome (DLMF 22.11.1, 22.11.2).

    With q the nome and v = π u/(2 K(k)), k sn = (2π/K) Σ q^(n+1/2)/(1 - q^(2n+1)) sin((2n+1) v);
    for k cn the sine is a cosine and the denominator has a plus sign. A swing of 170° needs
    fourteen terms.
    """
    quarter = ctx.ellipk(modulus**2)
    nome = ctx.qfrom(k=modulus)
    v = float(ctx.pi / (2 * quarter)) * u
    sn, cn = np.zeros_like(u), np.zeros_like(u)
    power, odd = ctx.sqrt(nome), 1
    while power > _SMALLEST:
        square = nome**odd
        sn += float(2 * ctx.pi / quarter * power / (1 - square)) * np.sin(odd * v)
        cn += float(2 * ctx.pi / quarter * power / (1 + square)) * np.cos(odd * v)
        power, odd = power * nome, odd + 2
    return sn, cn


def _path(case: PaperCase, times: Array) -> Array:
    """Return rows of sin(φ/2) = k sn(K + ω0 t), φ' = 2 k ω0 cn(K + ω0 t), k = sin(φ0/2), ω0² = g/l."""
    ctx, (x, y, z) = case.ctx, case.position
    aside = ctx.hypot(x, y)
    modulus = ctx.sin(ctx.atan2(aside, -z) / 2)
    omega = ctx.sqrt(case.gravity / case.length)
    u = float(ctx.ellipk(modulus**2)) + float(omega) * times
    half_sine, rate = sn_cn(u, modulus, ctx)
    rate = 2 * float(omega) * rate
    sine, cosine = 2 * half_sine * np.sqrt(1 - half_sine**2), 1 - 2 * half_sine**2
    length = float(case.length)
    toward = complex(x / aside, y / aside) if aside else 1
    place, speed = length * sine * toward, length * cosine * rate * toward
    return np.column_stack(
        (place.real, place.imag, -length * cosine, speed.real, speed.imag, length * sine * rate)
    )


def _not_upright(scene: Scene) -> str | None:
    upright = scene.exact.angles is not None and scene.exact.angles[0] == 180
    return "The bob is released upright: give release.angle below 180" if upright else None


APPROXIMATIONS = (
    Motion(
        id="planar",
        title="plane pendulum without the Foucault effect",
        where="Mathar section VII and figure 7 (Ω = 0): period 4 sqrt(l/g) K(sin(φ0/2))",
        drops="Ω",
        needs=(at_rest, _not_upright, without_drag, under_gravity),
        path=_path,
        rest=lowest_point,
    ),
)
