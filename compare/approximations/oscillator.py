"""Closed form of the small-angle pendulum on a turntable, Z = x + i y, shared by several models: Gastebois 6.1.

Z'' = -ω0² Z - 2 i Ω_z Z' has the solution Z = C1 exp(-i (ω + Ω_z) t) + C2 exp(i (ω - Ω_z) t), ω² = ω0² + Ω_z².
"""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import UnreachableError

from .approximation import Array
from .case import Case, hung


def turntable_frequency(case: Case, gravity: Any, turn: Any) -> Any:
    """Return ω = (gravity/l + Ω_z²)^(1/2) in rad/s.

    Raises:
        UnreachableError: ω is zero.
    """
    omega = case.ctx.sqrt(gravity / case.length + turn**2)
    if not omega:
        raise UnreachableError("nothing pulls the bob back: gravity and centrifugal force cancel.")
    return omega


def oscillation(place: tuple[Any, Any], speed: tuple[Any, Any], omega: Any, turn: Any, times: Array) -> Any:
    """Return Z in m and Z' in m/s at the times, two complex arrays.

    Args:
        place: x, y in m at t = 0, mpf.
        speed: vx, vy in m/s at t = 0, mpf.
        omega: ω in rad/s, mpf, not zero.
        turn: Ω_z in rad/s, mpf.
        times: in s.
    """
    (x, y), (vx, vy) = place, speed
    first = complex(((omega - turn) * x - vy) / (2 * omega), ((omega - turn) * y + vx) / (2 * omega))
    second = complex(((omega + turn) * x + vy) / (2 * omega), ((omega + turn) * y - vx) / (2 * omega))
    fast, slow = float(omega + turn), float(omega - turn)
    one, two = first * np.exp(-1j * fast * times), second * np.exp(1j * slow * times)
    return one + two, 1j * (slow * two - fast * one)


def swung(case: Case, gravity: Any, centre: Any, times: Array, slowed: Any = 1) -> Array:
    """Return rows of Mathar (51)-(52): ω0² = gravity/l about (0, centre), Ω_z = Ω sin φ, and ω divided by `slowed`."""
    turn = case.rate * case.sin
    omega = turntable_frequency(case, gravity, turn) / slowed
    place = (case.position[0], case.position[1] - centre)
    z, rate = oscillation(place, case.velocity[:2], omega, turn, times)
    return hung(z.real, z.imag + float(centre), rate.real, rate.imag, case.length)
