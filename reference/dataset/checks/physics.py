"""Check each row by itself: on the sphere, velocity along it, the invariant h, and the acceleration at a transit.

How far a checked quantity may be off follows from the bounds of the columns, by differences of the quantity itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from ...columns import GRID
from ...model.constants import Constants, constants
from ...model.force import acceleration, invariant
from ...precision import GUARD_BITS, Array, bits_of, context, to_fraction, to_mpf
from ..files import Files
from ..invariant import INVARIANT_BITS

NUDGE = 1e-5  # of a column's size: differences over it are right to four digits, which is plenty
SLACK = Fraction(21, 20)
STEEP = 4  # where |z| is below l/4, z does not follow well enough from x and y

Quantity = Callable[[list[Any], Constants], Any]


def problems(files: Files) -> Iterator[str]:
    """Yield every row that breaks a law which holds at each moment."""
    manifest, sheet = files.manifest, files.tables["grid.csv"]
    grid = _Moments(
        files,
        [f"grid.csv: t = {row[0]}" for row in sheet.rows],
        list(sheet.numbers(GRID)),
        [manifest.bound("grid", name) for name in GRID],
    )
    yield from grid.off_the_sphere()
    yield from grid.not_along_the_sphere()
    constant = files.scene.exact.drag == 0
    if constant:
        yield from grid.with_another_invariant(grid.first())
    if manifest.counts.transits and "transits.csv" in files.tables:
        transits, ax = _transits(files)
        yield from transits.off_the_sphere()
        if constant:
            yield from transits.with_another_invariant(grid.first())
        yield from transits.with_another_acceleration(ax, manifest.bound("transits", "ax"))


def _transits(files: Files) -> tuple[_Moments, list[Fraction]]:
    """Return the states at the transits, where the velocity is (0, vy, -y vy / z), and xddot."""
    sheet, bound = files.tables["transits.csv"], files.manifest.bound
    names, rows, ax = [], [], []
    for (x, y, z, vy, second), row in zip(sheet.numbers(("x", "y", "z", "vy", "ax")), sheet.rows, strict=True):
        names.append(f"transits.csv: transit {row[0]}")
        rows.append([x, y, z, Fraction(0), vy, Fraction(0)])
        ax.append(second)
    exact = Fraction(0)  # xdot is zero by definition, and zdot follows
    bounds = [*(bound("transits", name) for name in ("x", "y", "z")), exact, bound("transits", "vy"), exact]
    return _Moments(files, names, rows, bounds, at_transits=True), ax


@dataclass(frozen=True)
class _Moments:
    """States of a dataset.

    Attributes:
        files: the dataset.
        names: what messages call each.
        rows: x, y, z, vx, vy, vz of each.
        bounds: of the six columns.
        at_transits: whether vz is not given, but follows from the others and vx = 0.
    """

    files: Files
    names: list[str]
    rows: list[list[Fraction]]
    bounds: list[Fraction]
    at_transits: bool = False

    def off_the_sphere(self) -> Iterator[str]:
        """Check |r| = l."""
        length = self.files.scene.exact.length
        for name, row in zip(self.names, self.rows, strict=True):
            allowed = sum((2 * abs(q) * b + b * b for q, b in zip(row[:3], self.bounds[:3], strict=True)), Fraction(0))
            if abs(sum((q * q for q in row[:3]), Fraction(0)) - length**2) > allowed:
                yield f"{name}: the bob is not at the distance {float(length):g} m from the pivot"

    def not_along_the_sphere(self) -> Iterator[str]:
        """Check r·v = 0."""
        b, c = self.bounds[:3], self.bounds[3:]
        for name, row in zip(self.names, self.rows, strict=True):
            pairs = list(zip(row[:3], row[3:], b, c, strict=True))
            allowed = sum((abs(q) * e + abs(v) * d + d * e for q, v, d, e in pairs), Fraction(0))
            if abs(sum((q * v for q, v, _, _ in pairs), Fraction(0))) > allowed:
                yield f"{name}: the velocity is not along the sphere"

    def first(self) -> _Moments:
        """Return the first of the states alone."""
        return replace(self, names=self.names[:1], rows=self.rows[:1])

    def with_another_invariant(self, release: _Moments) -> Iterator[str]:
        """Check that h is that of the release."""
        first, allowed_first = release.values(_invariant)[0], release.allowed(_invariant)[0]
        for name, h, allowed in zip(self.names, self.values(_invariant), self.allowed(_invariant), strict=True):
            if abs(h - first) > allowed + allowed_first:
                yield f"{name}: the invariant h differs by {float(h - first):.2g} m²/s² from that of the first row"

    def with_another_acceleration(self, ax: list[Fraction], bound: Fraction) -> Iterator[str]:
        """Check xddot."""
        rows = zip(self.names, self.values(_xddot), self.allowed(_xddot), ax, strict=True)
        for name, value, allowed, printed in rows:
            if abs(value - printed) > allowed + bound:
                yield f"{name}: ax = {float(printed):.17g}, the equations of motion give {float(value):.17g}"

    def values(self, quantity: Quantity) -> list[Fraction]:
        """Return a quantity of each state."""
        ctx = context(bits_of(self.files.manifest.digits) + INVARIANT_BITS)
        k = constants(self.files.scene.exact, ctx)
        found = []
        for row, deep in zip(self.rows, self._deep, strict=True):
            x, y, z, vx, vy, vz = (to_mpf(q, ctx) for q in row)
            if deep:
                z = ctx.sqrt(max(ctx.zero, k.length * k.length - x * x - y * y)) * (1 if z > 0 else -1)
            if z and (self.at_transits or deep):
                vz = -(x * vx + y * vy) / z
            found.append(to_fraction(quantity([x, y, z, vx, vy, vz], k) + ctx.zero))
        return found

    @np.errstate(all="ignore")
    def allowed(self, quantity: Quantity) -> list[Fraction]:
        """Return how far a quantity of each state may be off by the bounds on the state.

        Raises:
            OverflowError: no double is as large.
        """
        k = constants(self.files.scene.exact, context(GUARD_BITS)).converted(float)
        columns = [np.array([float(row[j]) for row in self.rows]) for j in range(6)]
        deep = np.array(self._deep)

        def of(changed: list[Array]) -> Array:
            x, y, z, vx, vy, vz = changed
            z = np.where(deep, np.sqrt(np.maximum(k.length**2 - x * x - y * y, 0.0)) * np.sign(z), z)
            follows = (deep | self.at_transits) & (z != 0)
            vz = np.where(follows, -(x * vx + y * vy) / np.where(follows, z, 1.0), vz)
            return np.asarray(quantity([x, y, z, vx, vy, vz], k) + 0.0 * z)

        value, total, largest = of(columns), np.zeros(len(self.rows)), max(self.bounds)
        fastest = max(float(np.max(np.abs(column))) for column in columns[3:])
        for j, bound in enumerate(self.bounds):
            if not bound:
                continue
            step = max(NUDGE * (k.length if j < 3 else fastest or k.length), float(bound))
            ends = (of([*columns[:j], columns[j] + side * step, *columns[j + 1 :]]) for side in (1, -1))
            slopes = np.max([np.abs(end - value) for end in ends], axis=0) / step
            if not np.isfinite(slopes).all():
                raise OverflowError
            total += slopes * float(bound / largest)
        return [Fraction(part) * largest * SLACK for part in total]

    @cached_property
    def _deep(self) -> list[bool]:
        """Whether z follows well from x and y, for each state."""
        length = self.files.scene.exact.length
        return [abs(row[2]) * STEEP > length for row in self.rows]


def _invariant(columns: list[Any], k: Constants) -> Any:
    return invariant(*_over_length(columns, k), k)


def _xddot(columns: list[Any], k: Constants) -> Any:
    return acceleration(*_over_length(columns, k), k)[0] * k.length


def _over_length(columns: list[Any], k: Constants) -> tuple[Any, Any]:
    x, y, z, vx, vy, vz = (column / k.length for column in columns)
    return (x, y, z), (vx, vy, vz)
