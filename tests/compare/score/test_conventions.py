"""What is said of a file's conventions, of right and wrong files alike."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from scipy.special import ellipj, ellipk

from compare.diagnosis.case import Rows
from compare.diagnosis.conventions import unit_of_time


def test_no_wide_swing_counts_time_in_another_unit(size):
    """100 exact pendulums of 30° to 85° in a plane (Jacobi's elliptic functions), rows 0.02 s to 1 s apart.

    In every run each third of them.
    """
    length, rate = 67.0, math.sqrt(9.81 / 67.0)
    swings = product(
        (30, 40, 50, 55, 60, 65, 70, 75, 80, 85), (0.02, 0.033333, 0.05, 0.1, 0.14, 0.2, 0.25, 0.3, 0.5, 1.0)
    )
    for degrees, step in list(swings)[:: size(3, 1)]:
        modulus = math.sin(math.radians(degrees) / 2)
        span = 20 * 4 * ellipk(modulus**2) / rate
        times = np.arange(0, min(span, 60) if step < 0.3 else span, step)
        _, cosine, delta, _ = ellipj(rate * times, modulus**2)
        half = modulus * cosine / delta  # sin(θ/2), greatest at t = 0
        x = 2 * length * half * np.sqrt(1 - half**2)
        rows = Rows(times, np.column_stack([x, 0 * x]), 1e-15)
        assert unit_of_time(rows, rate, length).conventions == (), (degrees, step)
