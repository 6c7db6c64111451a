"""Harmonic pendulum of the third source paper, ẍ + (g/L) x = 2 ω sin α ẏ and its counterpart in y, solved three ways.

All three give one motion, that of `linear_g`. Each is computed by its own method, so that they
check each other.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from .approximation import Motion
from .case import SWINGING, PaperCase, hung, lowest_point


def _rates(case: PaperCase) -> tuple[float, float]:
    """Return ω̃ = (g/L + ω_p²)^(1/2) and ω sin α."""
    return float(case.ctx.sqrt(case.gravity / case.length + case.turn**2)), float(case.turn)


def _rotating_frame(case: PaperCase, times: Array) -> Array:
    """Method 1: x' = x cos ω_p t - y sin ω_p t, y' = x sin ω_p t + y cos ω_p t; x, y oscillate, ω_p = -ω sin α.

    The primed coordinates are those of the ground: the paper substitutes into their equations of
    motion.
    """
    w, turn = _rates(case)
    (x0, y0, _), (vx0, vy0, _) = (tuple(map(float, v)) for v in (case.position, case.velocity))
    p = -turn
    cos, sin, c, s = np.cos(w * times), np.sin(w * times), np.cos(p * times), np.sin(p * times)
    x, vx = x0 * cos + (vx0 + p * y0) / w * sin, (vx0 + p * y0) * cos - x0 * w * sin
    y, vy = y0 * cos + (vy0 - p * x0) / w * sin, (vy0 - p * x0) * cos - y0 * w * sin
    across, along = vx - p * y, vy + p * x
    return hung(
        x * c - y * s, x * s + y * c, across * c - along * s, across * s + along * c, case.length
    )


def _coriolis_theorem(case: PaperCase, times: Array) -> Array:
    """Method 2: the vector x in a frame turning at ω_p = -ω sin α k, where ẋ = ẋ' + ω_p × x'."""
    w, turn = _rates(case)
    rotate = np.array([[0.0, turn], [-turn, 0.0]])  # ω_p ×
    start = np.array([float(part) for part in case.position[:2]])
    speed = np.array([float(part) for part in case.velocity[:2]]) - rotate @ start
    place = np.outer(start, np.cos(w * times)) + np.outer(speed / w, np.sin(w * times))
    rate = (
        np.outer(speed, np.cos(w * times)) - np.outer(start * w, np.sin(w * times)) + rotate @ place
    )
    cos, sin = np.cos(turn * times), np.sin(turn * times)

    def ground(v: Any) -> Any:
        return cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]

    (x, y), (vx, vy) = ground(place), ground(rate)
    return hung(x, y, vx, vy, case.length)


def _complex_variable(case: PaperCase, times: Array) -> Array:
    """Method 3: z = w exp(-i ω_P t), w = A sin ω̃t + B cos ω̃t, ω_P = ω sin α."""
    w, p = _rates(case)
    b = complex(case.position[0], case.position[1])
    a = (complex(case.velocity[0], case.velocity[1]) + 1j * p * b) / w
    wave, rate = (
        a * np.sin(w * times) + b * np.cos(w * times),
        w * (a * np.cos(w * times) - b * np.sin(w * times)),
    )
    back = np.exp(-1j * p * times)
    z, speed = back * wave, back * (rate - 1j * p * wave)
    return hung(z.real, z.imag, speed.real, speed.imag, case.length)


_motion = partial(
    Motion,
    drops="the centrifugal force, the vertical motion, all powers of x/L beyond the first",
    needs=SWINGING,
    rest=lowest_point,
)

APPROXIMATIONS = (
    _motion(
        id="method_1",
        title="harmonic pendulum by an explicit rotating frame",
        where="third source paper, method 1",
        path=_rotating_frame,
    ),
    _motion(
        id="method_2",
        title="harmonic pendulum by the Coriolis theorem",
        where="third source paper, method 2",
        path=_coriolis_theorem,
    ),
    _motion(
        id="method_3",
        title="harmonic pendulum by a complex variable",
        where="third source paper, method 3",
        path=_complex_variable,
    ),
)
