"""The unrolled sums equal the sums of products that they stand for, exactly."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pytest.importorskip("numba")

import numba

from reference.engines.limbs.lanes import LANES
from reference.engines.limbs.series import MOST_ORDER, MOST_ROWS, PLANES, WIDTH, add_convolved, empty_series
from reference.engines.limbs.size import LIMB_BITS

LARGEST = 2 ** (LIMB_BITS - 1)


def random_limbs(shape, seed):
    limbs = np.random.default_rng(seed).integers(-LARGEST, LARGEST + 1, size=shape)
    limbs.flat[::7] = LARGEST
    return limbs


@cache
def compiled_with(fastmath):
    @numba.njit(fastmath=fastmath, error_model="numpy")
    def run(rows, planes, factors, sums):
        add_convolved(rows, planes, 0, factors, 0, sums, 3)

    return run


@pytest.mark.parametrize("fastmath", [False, True])
@pytest.mark.parametrize("rows", range(MOST_ROWS + 1))
def test_convolved_rows_are_exact_sums_of_all_pairs_of_limbs(rows, fastmath):
    planes, sums = random_limbs((MOST_ROWS, PLANES, WIDTH), 1), random_limbs((MOST_ROWS, PLANES, WIDTH), 2)
    factors = np.repeat(2 * random_limbs((MOST_ROWS, PLANES, 1), 3), LANES, axis=2)
    expected, order = sums.copy(), slice(3, 3 + LANES)
    for r in range(rows):
        for p in range(r + 1):
            for lane in range(3):
                expected[r, lane, order] += factors[p, 3] * planes[r - p, lane, :LANES]
                expected[r, lane, order] += factors[p, lane] * planes[r - p, 3, :LANES]
    got = sums.astype(float)
    compiled_with(fastmath)(rows, planes.astype(float).ravel(), factors.astype(float).ravel(), got.reshape(-1))
    assert (got == expected).all()


def test_a_series_of_too_high_an_order_is_refused():
    with pytest.raises(ValueError, match="order"):
        empty_series(MOST_ORDER + 1, 3)
