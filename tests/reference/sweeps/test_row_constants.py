"""Constants and releases of rows in double-double are those of the model, rounded."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from random_rows import KINDS, columns_of_many, random_inputs

from reference.model.algebra import add, cross
from reference.model.start import Start, xdot_vanishes, zero_at_release
from reference.sweeps.row_constants import columns_of, row_constants

BITS = 300


def exact_numbers(inputs):
    """The numbers of a row as fractions, by the model in 300 bits."""
    start = Start.of(inputs, BITS)
    k, n, v = start.k, start.n, start.v
    inertial = add(v, cross(k.turn, n))
    return {"length": (k.length,), "turn": k.turn, "pull": k.pull, "n": n, "V": inertial}, start


def assert_constants(many):
    rows = row_constants(columns_of_many(many), many[0].gravity_is, len(many))
    worst = 0.0
    for i, inputs in enumerate(many):
        exact, start = exact_numbers(inputs)
        for name, values in exact.items():
            got = getattr(rows, name)[i].reshape(-1, 2)
            scale = max(abs(float(v)) for v in values) or 1.0
            for (high, low), value in zip(got, values, strict=True):
                assert abs(high - value) <= np.spacing(abs(high)) + 2.0**-100 * scale, (
                    inputs,
                    name,
                )
                worst = max(worst, abs(float((high + start.ctx.mpf(low)) - value)) / scale)
        assert rows.zeros_at_release[i] == zero_at_release(start), inputs
        assert bool(rows.still[i]) == xdot_vanishes(start), inputs
    return worst


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gravity_is", ["ellipsoid", "effective"])
def test_constants_and_releases_are_within_an_ulp_of_the_model(kind, gravity_is, size, tally):
    generator = random.Random(f"{kind} {gravity_is}")
    many = [
        replace(random_inputs(kind, generator), gravity_is=gravity_is)
        for _ in range(size(15, 1000))
    ]
    worst = assert_constants(many)
    tally(
        f"constants, {kind}, {gravity_is}: {len(many)} rows, high + low within {worst:.1e} of the largest component"
    )
    assert worst < 2.0**-98


RELEASES = [
    {"position": (0, 0, 0, 0)},
    {"position": (0, 1, 0, 0)},
    {"position": (0, 1, 0, 2)},
    {"position": (1, 0, 0, 0)},
    {"position": (1, 1, 1, 0)},
    {"angles": (180, 0, 0, 0)},
    {"angles": (90, 90, 0, 0)},
    {"angles": (90, 180, 0, 0)},
    {"angles": (90, 33, 0, 0)},
    {"position": (0, 0, 0, 1)},
    {"angles": (30, -90, 0, 0)},
    {"angles": (30, -90, 5, 0)},
    {"angles": (30, 0, 0, 5)},
]
SPECIAL = [  # half of them are run always, so that any three of the four meet
    pytest.param(*values, marks=[pytest.mark.long] * (sum(places) % 2))
    for places, values in (
        zip(*case, strict=True)
        for case in product(
            enumerate([-90, -30, 0, 90]),
            enumerate(["0", "7.292115e-5"]),
            enumerate(RELEASES),
            enumerate(["ellipsoid", "effective"]),
        )
    )
]


@pytest.mark.parametrize(("latitude", "rate", "release", "gravity_is"), SPECIAL)
def test_exact_zeros_are_those_of_the_model(paris, latitude, rate, release, gravity_is):
    values = {name: tuple(map(Fraction, numbers)) for name, numbers in release.items()}
    assert_constants(
        [
            replace(
                paris.exact,
                latitude=Fraction(latitude),
                rotation_rate=Fraction(rate),
                gravity_is=gravity_is,
                **({"position": None, "angles": None} | values),
            )
        ]
    )


def test_columns_that_are_one_number_serve_all_rows(paris):
    columns = columns_of(paris.exact)
    rows = row_constants(columns, "ellipsoid", 5000)
    assert len(rows) == 5000
    assert (rows.n == rows.n[0]).all()
