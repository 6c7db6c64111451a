"""Check each row by itself: on the sphere, velocity along it, the invariant h, and the acceleration at a transit.

How far a checked quantity may be off follows from the bounds of the columns, by differences of the quantity itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ...model.constants import Constants, Vector, constants
from ...model.force import acceleration, energy, invariant
from ...numbers.columns import STATE
from ...numbers.precision import GUARD_BITS, Array, bits_of, context
from ...numbers.table import FixedPoint, Integers, integers
from ..files import Files
from ..manifest import Kind
from ..record import INVARIANT_BITS
from ..sheets import Sheet

STEEP = 4  # where |z| is below l/4, z does not follow well enough from x and y
# a nudge of z is at most its size over this; where the bound of z is more, what is divided by z means little
NEAR = 64
NUDGE = 1e-5  # of a column's size: differences over it are right to four digits, which is plenty
SLACK = Fraction(21, 20)

Quantity = Callable[[Vector, Vector, Constants], Any]  # of position and velocity, over the length


def problems(files: Files) -> Iterator[str]:
    """Yield every row that breaks a law which holds at each moment."""
    kinds: tuple[Kind, ...] = ("grid", "sections", "transits")
    tables = [
        _moments(files, kind)
        for kind in kinds
        if (sheet := files.tables.get(f"{kind}.csv")) and sheet.rows
    ]
    for moments in tables:
        yield from moments.off_the_sphere()
        if moments.transits is None:
            yield from moments.not_along_the_sphere()
        if files.scene.exact.drag == 0:
            yield from moments.with_another_invariant(tables[0].first())
        if moments.transits is not None:
            yield from moments.with_another_acceleration()


def _moments(files: Files, kind: Kind) -> _Moments:
    """Return the states of a table, over a unit that holds the bounds and the length as well.

    At a transit the velocity is (0, vy, -y vy / z).
    """
    sheet = files.tables[f"{kind}.csv"]
    printed = ("x", "y", "z", "vy") if kind == "transits" else STATE
    columns, unit = sheet.integers(printed)
    bounds = [files.manifest.bound(kind, name) for name in printed]
    if kind == "transits":  # xdot is zero by definition, and zdot follows
        zero, exact = integers([0] * len(sheet.rows)), Fraction(0)
        columns, bounds = (
            [*columns[:3], zero, columns[3], zero],
            [*bounds[:3], exact, bounds[3], exact],
        )
    numbers = [number * unit for number in (files.scene.exact.length, *bounds)]
    finer = math.lcm(*(number.denominator for number in numbers))
    length, *whole = (int(number * finer) for number in numbers)
    word, count = {"grid": ("t =", 1), "transits": ("transit", 1), "sections": ("passage", 2)}[kind]
    return _Moments(
        files=files,
        names=[f"{kind}.csv: {word} {' '.join(row[:count])}" for row in sheet.rows],
        columns=[column * finer for column in columns],
        unit=unit * finer,
        bounds=whole,
        length=length,
        transits=sheet if kind == "transits" else None,
    )


@dataclass(frozen=True)
class _Moments:
    """States of a dataset. All integers are in m and m/s over a common unit, and exact.

    Attributes:
        files: the dataset.
        names: what messages call each state.
        columns: x, y, z, vx, vy, vz.
        unit: what the integers are to be divided by.
        bounds: of the six columns.
        length: of the cord.
        transits: the printed table if these are transits, where vz is not given but follows.
    """

    files: Files
    names: list[str]
    columns: list[Integers]
    unit: int
    bounds: list[int]
    length: int
    transits: Sheet | None

    def off_the_sphere(self) -> Iterator[str]:
        """Check |r| = l."""
        position = list(zip(self.columns[:3], self.bounds[:3], strict=True))
        off = abs(sum(q * q for q, _ in position) - self.length**2)
        for i in np.flatnonzero(off > sum(2 * abs(q) * b + b * b for q, b in position)):
            length = float(self.files.scene.exact.length)
            yield f"{self.names[i]}: the bob is not at the distance {length:g} m from the pivot"

    def not_along_the_sphere(self) -> Iterator[str]:
        """Check r·v = 0."""
        pairs = list(
            zip(self.columns[:3], self.columns[3:], self.bounds[:3], self.bounds[3:], strict=True)
        )
        off = abs(sum(q * v for q, v, _, _ in pairs))
        for i in np.flatnonzero(off > sum(abs(q) * e + abs(v) * d + d * e for q, v, d, e in pairs)):
            yield f"{self.names[i]}: the velocity is not along the sphere"

    def first(self) -> _Moments:
        """Return the first of the states alone."""
        return replace(self, names=self.names[:1], columns=[column[:1] for column in self.columns])

    def with_another_invariant(self, release: _Moments) -> Iterator[str]:
        """Check that h is that of the release."""
        (first,), (allowed_first,) = release.values(invariant), release.allowed(energy)
        rows = zip(
            self.names, self.values(invariant), self.allowed(energy), self._whole, strict=True
        )
        for name, h, allowed, whole in rows:
            if whole and abs(h - first) > allowed + allowed_first:
                yield f"{name}: the invariant h differs by {float(h - first):.2g} m²/s² from that of the first row"

    def with_another_acceleration(self) -> Iterator[str]:
        """Check xddot."""
        assert self.transits is not None
        (printed,), unit = self.transits.integers(("ax",))
        bound = self.files.manifest.bound("transits", "ax")
        rows = zip(
            self.names, self.values(_xddot), self.allowed(_xddot), printed, self._whole, strict=True
        )
        for name, value, allowed, ax, whole in rows:
            if whole and abs(value - Fraction(ax, unit)) > allowed + bound:
                yield f"{name}: ax = {ax / unit:.17g}, the equations of motion give {float(value):.17g}"

    def values(self, quantity: Quantity) -> list[Fraction]:
        """Return a quantity of each state."""
        bits = 2 * bits_of(self.files.manifest.digits) + INVARIANT_BITS
        k = constants(self.files.scene.exact, context(bits)).converted(
            lambda number: FixedPoint.of(number, bits)
        )
        columns = [FixedPoint.column(column, self.unit, bits) for column in self.columns]
        deep = self._deep
        side = np.where(self.columns[2][deep] > 0, 1, -1)
        x, y = (column[deep] for column in columns[:2])
        columns[2].values[deep] = _depth(x, y, k.length, side, FixedPoint.sqrt).values
        # beyond the sphere, z comes out 0
        follows = self._follows & np.asarray(columns[2].values != 0, dtype=bool)
        x, y, z, vx, vy = (column[follows] for column in columns[:5])
        columns[5].values[follows] = _vertical_velocity(x, y, z, vx, vy).values
        return list(quantity(*_over_length(columns, k), k).fractions())

    @np.errstate(all="ignore")
    def allowed(self, quantity: Quantity) -> list[Fraction]:
        """Return how far a quantity of each state may be off by the bounds on the state.

        Raises:
            OverflowError: no double is as large.
        """
        k = constants(self.files.scene.exact, context(GUARD_BITS)).converted(float)
        columns = [(column / self.unit).astype(np.float64) for column in self.columns]
        bounds = [Fraction(bound, self.unit) for bound in self.bounds]

        def of(changed: list[Array]) -> Array:
            x, y, z, vx, vy, vz = changed
            z = np.where(
                self._deep,
                _depth(x, y, k.length, np.sign(z), lambda q: np.sqrt(np.maximum(q, 0.0))),
                z,
            )
            vz = np.where(self._follows, _vertical_velocity(x, y, np.where(z, z, 1.0), vx, vy), vz)
            return np.asarray(quantity(*_over_length([x, y, z, vx, vy, vz], k), k) + 0.0 * z)

        value, total, largest = of(columns), np.zeros(len(self.names)), max(bounds)
        fastest = max(float(np.max(np.abs(column))) for column in columns[3:])
        for j, bound in enumerate(bounds):
            if not bound:
                continue
            step = np.full(len(value), NUDGE * (k.length if j < 3 else fastest or k.length))
            if j == 2:  # what follows by dividing by z bends within |z|
                step = np.where(columns[2], np.minimum(step, np.abs(columns[2]) / NEAR), step)
            step = np.maximum(step, float(bound))
            ends = (
                of([*columns[:j], columns[j] + side * step, *columns[j + 1 :]]) for side in (1, -1)
            )
            slopes = np.max([np.abs(end - value) for end in ends], axis=0) / step
            if not np.isfinite(slopes).all():
                raise OverflowError
            total += slopes * float(bound / largest)
        return [Fraction(part) * largest * SLACK for part in total]

    @property
    def _deep(self) -> Array:
        """Whether z follows well from x and y, for each state."""
        return np.asarray(abs(self.columns[2]) * STEEP > self.length, dtype=bool)

    @property
    def _whole(self) -> Array:
        """Whether all of each state is known: at a transit with a nearly level cord vz = -y vy/z tells nothing.

        There the rounding of y, vy and z multiplies, and differences of one at a time do not bound what it does.
        """
        level = abs(self.columns[2]) <= NEAR * self.bounds[2]
        return ~np.asarray(level & (self.transits is not None), dtype=bool)

    @property
    def _follows(self) -> Array:
        """Whether vz is taken as it follows from the others."""
        return (
            np.asarray(self.columns[2] != 0, dtype=bool)
            if self.transits is not None
            else self._deep
        )


def _depth(x: Any, y: Any, length: Any, side: Any, sqrt: Callable[[Any], Any]) -> Any:
    """Return z on the side of the pivot, -1 or 1, where it is."""
    return sqrt(length * length - x * x - y * y) * side


def _vertical_velocity(x: Any, y: Any, z: Any, vx: Any, vy: Any) -> Any:
    """Return vz, which keeps the velocity along the sphere."""
    return -(x * vx + y * vy) / z


def _xddot(n: Vector, v: Vector, k: Constants) -> Any:
    return acceleration(n, v, k)[0] * k.length


def _over_length(columns: list[Any], k: Constants) -> tuple[Vector, Vector]:
    x, y, z, vx, vy, vz = (column / k.length for column in columns)
    return (x, y, z), (vx, vy, vz)
