"""A wide swing released at rest on turning ground: its period and precession in closed form (elliptic integrals)."""

from __future__ import annotations

from typing import Any

from ..digits import MP, mpf, pi, sin, sqrt
from .numbers import GRAVITY, PANTHEON_LENGTH, PANTHEON_RELEASE, RATE


def swing_period(length: Any, r0: Any, gravity: Any, rate: Any) -> tuple[Any, Any]:
    """Return period in s, and turn in rad a period, of a spherical pendulum let go at rest on ground that turns.

    Closed form, in axes that do not turn: l² z'² = 2g (z - z1)(z - z2)(z - z3), z = z1 + (z2 - z1) sn², and the azimuth
    is the elliptic integral of the third kind; z2 is the height of the release.
    """
    high = -sqrt(length**2 - r0**2)
    speed = r0 * rate
    energy, momentum = speed**2 / 2 + gravity * high, r0 * speed
    half = (energy / gravity - high) / 2  # z1 and z3 are the roots of z² - 2 half z + product
    product = (momentum**2 / 2 - energy * length**2) / gravity / high
    spread = sqrt(half**2 - product)
    low, outer = half - spread, half + spread
    w = sqrt(gravity * (outer - low) / 2) / length
    span, m = high - low, (high - low) / (outer - low)
    pieces = MP.ellippi(span / (length - low), m) / (length - low) + MP.ellippi(-span / (length + low), m) / (
        length + low
    )
    return 4 * MP.ellipk(m) / w, 2 * (momentum / (length * w) * pieces - pi)


def plane_period(length: Any, r0: Any, gravity: Any, rate: Any) -> Any:
    """Return T_f of a release at rest, as seen from the ground, in s."""
    period, turn = swing_period(length, r0, gravity, rate)
    return 2 * pi / (rate - turn / period)


def wide_swing(s: Any) -> tuple[Any, Any]:
    """Return T_f / T_p (1 + 3/8 r0²/L0²) and the closed form, at s times the Pantheon's amplitude."""
    r0, rate = PANTHEON_RELEASE * s, mpf("7.292115e-5")
    true = plane_period(PANTHEON_LENGTH, r0, GRAVITY, rate) * rate / (2 * pi)
    return 1 + mpf("0.375") * (r0 / PANTHEON_LENGTH) ** 2, true


def narrow_swing(s: Any) -> tuple[Any, Any]:
    """Return T_f / T_p = 1 and the closed form."""
    return MP.one, wide_swing(s)[1]


def precession_ratio(angle: Any) -> Any:
    """Return the rotation of the plane over the precession of the ellipse, for a release at rest at the pole."""
    period, turn = swing_period(PANTHEON_LENGTH, PANTHEON_LENGTH * sin(angle), GRAVITY, RATE)
    return RATE * period / turn
