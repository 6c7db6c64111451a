"""Bernstein's form of a polynomial on [0, 1]: it changes sign as often as it has zeros, or 2, 4, ... times more."""

from __future__ import annotations

from functools import cache
from math import comb
from typing import Any

import numpy as np

from ..numbers.precision import Array

ROUNDING = 2.0**-46  # of Bernstein's form in double, against the sum of the coefficients' sizes
MOST_TERMS = 40  # of a polynomial whose zeros are counted; those beyond, e**-80 of the first, count as rounding


def signs_of(form: Array, left: Any, right: Any) -> Array:
    """Return the signs of Bernstein forms, at the ends as given; where rounding decides 0, which makes two changes."""
    signs = np.sign(np.trunc(form))
    signs[..., 0], signs[..., -1] = left, right
    return signs


@cache
def bernstein(terms: int) -> tuple[Array, Array]:
    """Return the matrices from coefficients to Bernstein's form, and from that to the form on the first half."""
    n = range(terms)
    form = np.array([[comb(j, i) / comb(terms - 1, i) for i in n] for j in n])
    return form, np.array([[comb(j, i) / 2**j for i in n] for j in n])
