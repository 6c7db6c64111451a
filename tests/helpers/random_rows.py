"""Random scenes of many kinds, as exact inputs, and the same as columns for `row_constants`."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from reference.engines.batch_interface import Rows
from reference.numbers.double_double import DoubleDouble
from reference.scenes.inputs import Inputs
from reference.scenes.scene import load_scene
from reference.sweeps.row_constants import columns_of, row_constants

KINDS = ("small", "wide", "meridian", "planet", "over")
SPAN = Fraction(600)


def _decimal(generator: random.Random, low: float, high: float, places: int = 9) -> Fraction:
    return Fraction(round(generator.uniform(low, high) * 10**places), 10**places)


def random_inputs(kind: str, generator: random.Random, span: Fraction = SPAN) -> Inputs:
    """Return one scene of a kind.

    small: a swing below a hundredth of l; wide: thrown to half of l, with half the speed of a free fall from there;
    meridian: all but north-south, with close pairs; planet: turning with up to 0.1 rad/s; over: beyond the horizontal
    or over the top, given by angles.
    """
    length = _decimal(generator, 1, 100, 3)
    site = {
        "length": length,
        "latitude": _decimal(generator, -90, 90, 6),
        "altitude": _decimal(generator, 0, 5000, 1),
        "t_end": span,
        "grid_step": span,
    }
    share = {"small": 0.01, "wide": 0.5, "meridian": 0.05, "planet": 0.3, "over": 0}[kind]
    speed = float(length) ** 0.5 * 3.13 * share
    x, y, vx, vy = (
        _decimal(generator, -f, f) for f in (*[float(length) * share] * 2, *[speed] * 2)
    )
    if kind == "meridian":
        x, vx = _decimal(generator, -1e-4, 1e-4), _decimal(generator, -1e-4, 1e-4)
    if generator.random() < 0.3:
        vx = vy = Fraction(0)
    if kind == "planet":
        site["rotation_rate"] = _decimal(generator, -0.1, 0.1)
        site["equatorial_radius"] = _decimal(generator, 0, 300, 3)
        site |= {"gravity": _decimal(generator, 1, 12, 6), "altitude": Fraction(0)}
    if kind == "small" and generator.random() < 0.3:
        site["gravity_is"] = "effective"
    angles = None
    if kind == "over":
        rates = _decimal(generator, -200, 200, 3), _decimal(generator, -60, 60, 3)
        angles = (_decimal(generator, 60, 179, 3), _decimal(generator, -180, 180, 3), *rates)
        site["length"] = _decimal(generator, 1, 10, 3)
    return replace(
        load_scene("paris").exact,
        **site,
        position=None if angles else (x, y, vx, vy),
        angles=angles,
    )


def random_kinds(
    seed: int, count: int, span: Fraction = SPAN, kinds: tuple[str, ...] = KINDS
) -> Iterator[Inputs]:
    """Yield scenes of all kinds in turn."""
    generator = random.Random(seed)
    for i in range(count):
        yield random_inputs(kinds[i % len(kinds)], generator, span)


def columns_of_many(many: list[Inputs]) -> dict[str, DoubleDouble]:
    """Return scenes of one release form and one gravity as columns."""
    columns = [columns_of(inputs) for inputs in many]
    return {
        name: DoubleDouble.from_pairs(np.concatenate([each[name].pairs for each in columns]))
        for name in columns[0]
    }


def rows_of(many: list[Inputs], section: str = "") -> Rows:
    """Return scenes of any release form and gravity as rows, in order, with a section's form or that of xdot."""
    return Rows.joined(
        [row_constants(columns_of(inputs), inputs.gravity_is, 1, section) for inputs in many]
    )
