"""Gastebois, sections 6.2 and 6.3: the Pantheon's numbers."""

from __future__ import annotations

from ..checks import Check, PrintedNumber
from ..digits import mpf, pi, radians, shown, sin, sqrt
from .numbers import GRAVITY, PANTHEON_LATITUDE, PANTHEON_LENGTH, PANTHEON_RELEASE, RATE, SIDEREAL_DAY, G

OWN_LAMBDA = mpf("48.97")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    up = RATE * sin(radians(PANTHEON_LATITUDE))
    w = sqrt(GRAVITY / PANTHEON_LENGTH)
    spread = 1 + mpf("0.375") * (PANTHEON_RELEASE / PANTHEON_LENGTH) ** 2
    own, rising = sin(radians(OWN_LAMBDA)), sin(radians(PANTHEON_LATITUDE))
    return [
        PrintedNumber(
            "gastebois_6_2_mm", f"{G} 6.2", "v_y0 = -0,357 mm/s", "-0.357", lambda: -PANTHEON_RELEASE * up * 1000
        ),
        PrintedNumber(
            "gastebois_6_2_mh", f"{G} 6.2", "= -1,285 m/hour", "-1.285", lambda: -PANTHEON_RELEASE * up * 3600
        ),
        PrintedNumber(
            "gastebois_6_2_tiny",
            f"{G} 6.2",
            "a relative difference of 10⁻⁸",
            "1e-8",
            lambda: up**2 / (2 * w**2),
        ),
        PrintedNumber(
            "gastebois_6_3_t", f"{G} 6.3", "T = 16,43 s", "16.43", lambda: 2 * pi / w, remark="with g = 9,8 m/s² of 4.1"
        ),
        PrintedNumber("gastebois_6_3_w", f"{G} 6.3", "ω = 0,382 rd/s", "0.382", lambda: w),
        PrintedNumber(
            "gastebois_6_3_up", f"{G} 6.3", "Ω_z = 5,49 · 10⁻⁵ rd/s", "5.49e-5", lambda: up, remark="at 48.87°"
        ),
        PrintedNumber(
            "gastebois_6_3_h",
            f"{G} 6.3",
            "T_f = 31,77 h",
            "31.77",
            lambda: SIDEREAL_DAY / sin(radians(PANTHEON_LATITUDE)),
            from_inputs=lambda: mpf("23.93") / sin(radians(PANTHEON_LATITUDE)),
            inputs="T_p = 23,93 h",
        ),
        PrintedNumber(
            "gastebois_6_3_small",
            f"{G} 6.3",
            "0,93 mm at the middle",
            "0.93",
            lambda: 1000 * PANTHEON_RELEASE * up / w,
        ),
        PrintedNumber(
            "gastebois_6_3_step",
            f"{G} 6.3",
            "5,88 mm after one swing",
            "5.88",
            lambda: 2000 * pi * PANTHEON_RELEASE * up / w,
            from_inputs=lambda: 2000 * pi * PANTHEON_RELEASE * mpf("7.297e-5") * rising / mpf("0.382"),
            inputs="Ω = 7,297 · 10⁻⁵ and ω = 0,382",
        ),
        PrintedNumber(
            "gastebois_6_3_apparent",
            f"{G} 6.3",
            "with the centrifugal force T_f = 31,74 h",
            "31.74",
            lambda: SIDEREAL_DAY / own,
            from_inputs=lambda: mpf("23.92") / own,
            inputs="T_p = 23,92 h",
            remark="at λ_a = 48,97°; T_p = 23,92 h gives "
            f"{shown(mpf('23.92') / own, 6)}, 23,93 h {shown(mpf('23.93') / own, 6)}",
        ),
        PrintedNumber(
            "gastebois_6_3_precession",
            f"{G} 6.3",
            "31,74 (1 + 3/8 r0²/L0²) = 31,85 h",
            "31.85",
            lambda: SIDEREAL_DAY / own * spread,
            from_inputs=lambda: mpf("31.74") * spread,
            inputs="31,74 h",
        ),
        PrintedNumber(
            "gastebois_6_3_rounded",
            f"{G} 6.3",
            "one may take 31,8 h",
            "31.8",
            lambda: SIDEREAL_DAY / own * spread,
        ),
    ]
