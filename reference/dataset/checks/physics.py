"""Check each row by itself: position on the sphere, velocity tangent to it, invariant, acceleration at a transit.

How far a checked quantity may be off follows from the bounds of the columns, by differences of the
quantity itself.
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
from ..files import DatasetFiles
from ..manifest import Kind
from ..record import INVARIANT_BITS
from ..sheets import Sheet

# where |z| is below l/4, z does not follow well enough from x and y
_STEEP = 4
# a nudge of z is at most its size over this; where the bound of z is more, what is divided by z
# means little
_NEAR = 64
_NUDGE = 1e-5  # of a column's size: differences over it are right to four digits, which is plenty
_SLACK = Fraction(21, 20)

_Quantity = Callable[[Vector, Vector, Constants], Any]  # of position and velocity, over the length

# what messages call a row of each table, and how many of its cells name it
_ROW_WORDS: dict[Kind, tuple[str, int]] = {
    "grid": ("t =", 1),
    "transits": ("transit", 1),
    "sections": ("passage", 2),
}


def problems(files: DatasetFiles) -> Iterator[str]:
    """Yield a sentence for every row that breaks a law of the motion."""
    kinds: tuple[Kind, ...] = ("grid", "sections", "transits")
    tables = []
    for kind in kinds:
        sheet = files.tables.get(f"{kind}.csv")
        if sheet is not None and sheet.rows:
            tables.append(_moments(files, kind, sheet))

    for moments in tables:
        yield from moments.off_the_sphere()
        if moments.transits is None:
            yield from moments.not_along_the_sphere()
        if files.scene.exact.drag == 0:
            yield from moments.with_another_invariant(tables[0].first())
        if moments.transits is not None:
            yield from moments.with_another_acceleration(moments.transits)


def _moments(files: DatasetFiles, kind: Kind, sheet: Sheet) -> _Moments:
    """Return the states of a table, over a unit that holds the bounds and the length as well.

    At a transit the velocity is (0, vy, -y vy / z).
    """
    printed = ("x", "y", "z", "vy") if kind == "transits" else STATE
    columns, unit = sheet.scaled_integers(printed)
    bounds = [files.manifest.bound(kind, name) for name in printed]
    if kind == "transits":
        # xdot is zero by definition, and zdot follows
        zero = integers([0] * len(sheet.rows))
        exact = Fraction(0)
        columns = [*columns[:3], zero, columns[3], zero]
        bounds = [*bounds[:3], exact, bounds[3], exact]

    length = files.scene.exact.length * unit
    scaled_bounds = [bound * unit for bound in bounds]
    finer = math.lcm(length.denominator, *(bound.denominator for bound in scaled_bounds))
    word, count = _ROW_WORDS[kind]
    return _Moments(
        files=files,
        names=[f"{kind}.csv: {word} {' '.join(row[:count])}" for row in sheet.rows],
        columns=[column * finer for column in columns],
        unit=unit * finer,
        bounds=[int(bound * finer) for bound in scaled_bounds],
        length=int(length * finer),
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

    files: DatasetFiles
    names: list[str]
    columns: list[Integers]
    unit: int
    bounds: list[int]
    length: int
    transits: Sheet | None

    def off_the_sphere(self) -> Iterator[str]:
        """Check |r| = l."""
        gap = 0
        allowed = 0
        for q, bound in zip(self.columns[:3], self.bounds[:3], strict=True):
            gap = gap + q * q
            allowed = allowed + 2 * abs(q) * bound + bound * bound
        gap = abs(gap - self.length**2)
        for i in np.flatnonzero(gap > allowed):
            length = float(self.files.scene.exact.length)
            yield f"{self.names[i]}: the bob is not at the distance {length:g} m from the pivot"

    def not_along_the_sphere(self) -> Iterator[str]:
        """Check r·v = 0."""
        gap = 0
        allowed = 0
        for j in range(3):
            q = self.columns[j]
            v = self.columns[3 + j]
            q_bound = self.bounds[j]
            v_bound = self.bounds[3 + j]
            gap = gap + q * v
            allowed = allowed + abs(q) * v_bound + abs(v) * q_bound + q_bound * v_bound
        for i in np.flatnonzero(abs(gap) > allowed):
            yield f"{self.names[i]}: the velocity is not along the sphere"

    def first(self) -> _Moments:
        """Return the first of the states alone."""
        return replace(self, names=self.names[:1], columns=[column[:1] for column in self.columns])

    def with_another_invariant(self, release: _Moments) -> Iterator[str]:
        """Check that h is that of the release."""
        (first,) = release.values(invariant)
        (allowed_first,) = release.allowed(energy)
        values = self.values(invariant)
        rows = zip(self.names, values, self.allowed(energy), self._known, strict=True)
        for name, h, allowed, known in rows:
            if known and abs(h - first) > allowed + allowed_first:
                yield f"{name}: the invariant h differs by {float(h - first):.2g} m²/s² from that of the first row"

    def with_another_acceleration(self, transits: Sheet) -> Iterator[str]:
        """Check xddot, as the table of transits prints it."""
        (printed,), unit = transits.scaled_integers(("ax",))
        bound = self.files.manifest.bound("transits", "ax")
        values = self.values(_xddot)
        rows = zip(self.names, values, self.allowed(_xddot), printed, self._known, strict=True)
        for name, value, allowed, ax, known in rows:
            if known and abs(value - Fraction(ax, unit)) > allowed + bound:
                yield f"{name}: ax = {ax / unit:.17g}, the equations of motion give {float(value):.17g}"

    def values(self, quantity: _Quantity) -> list[Fraction]:
        """Return a quantity of each state."""
        bits = 2 * bits_of(self.files.manifest.digits) + INVARIANT_BITS
        exact = constants(self.files.scene.exact, context(bits))
        k = exact.converted(lambda number: FixedPoint.of(number, bits))
        columns = [FixedPoint.column(column, self.unit, bits) for column in self.columns]

        deep = self._deep
        side = np.where(self.columns[2][deep] > 0, 1, -1)
        x = columns[0][deep]
        y = columns[1][deep]
        columns[2].values[deep] = _depth(x, y, k.length, side, FixedPoint.sqrt).values

        # beyond the sphere, z comes out 0
        follows = self._follows & np.asarray(columns[2].values != 0, dtype=bool)
        x, y, z, vx, vy = (column[follows] for column in columns[:5])
        columns[5].values[follows] = _vertical_velocity(x, y, z, vx, vy).values
        return list(quantity(*_over_length(columns, k), k).fractions())

    @np.errstate(all="ignore")
    def allowed(self, quantity: _Quantity) -> list[Fraction]:
        """Return how far a quantity of each state may be off by its bounds, to first order.

        Raises:
            OverflowError: no double is as large.
        """
        # many names, as each is a quantity of one formula
        k = constants(self.files.scene.exact, context(GUARD_BITS)).converted(float)
        columns = [(column / self.unit).astype(np.float64) for column in self.columns]
        bounds = [Fraction(bound, self.unit) for bound in self.bounds]
        largest = max(bounds)
        fastest = max(float(np.max(np.abs(column))) for column in columns[3:])
        speed = fastest or k.length
        sizes = [k.length, k.length, k.length, speed, speed, speed]

        value = self._in_doubles(quantity, columns, k)
        total = np.zeros(len(self.names))
        for j, bound in enumerate(bounds):
            if not bound:
                continue
            step = np.full(len(value), _NUDGE * sizes[j])
            if j == 2:  # what follows by dividing by z bends within |z|
                step = np.where(columns[2], np.minimum(step, np.abs(columns[2]) / _NEAR), step)
            step = np.maximum(step, float(bound))

            changes = []
            for side in (1, -1):
                nudged = [*columns[:j], columns[j] + side * step, *columns[j + 1 :]]
                changes.append(np.abs(self._in_doubles(quantity, nudged, k) - value))
            slopes = np.max(changes, axis=0) / step
            if not np.isfinite(slopes).all():
                raise OverflowError
            total += slopes * float(bound / largest)
        return [Fraction(part) * largest * _SLACK for part in total]

    def _in_doubles(self, quantity: _Quantity, columns: list[Array], k: Constants) -> Array:
        """Return a quantity of states in doubles, with z and vz from the other columns.

        Where these do not determine them well (`_deep`, `_follows`), they are as given.
        """
        x, y, z, vx, vy, vz = columns
        depth = _depth(x, y, k.length, np.sign(z), lambda q: np.sqrt(np.maximum(q, 0.0)))
        z = np.where(self._deep, depth, z)
        vertical = _vertical_velocity(x, y, np.where(z, z, 1.0), vx, vy)
        vz = np.where(self._follows, vertical, vz)
        # the last term gives a constant quantity the shape of the columns
        return np.asarray(quantity(*_over_length([x, y, z, vx, vy, vz], k), k) + 0.0 * z)

    @property
    def _deep(self) -> Array:
        """Whether z follows well from x and y, for each state."""
        return np.asarray(abs(self.columns[2]) * _STEEP > self.length, dtype=bool)

    @property
    def _known(self) -> Array:
        """Whether all of each state is known: at a transit with a nearly level cord, vz is not.

        There the rounding of y, vy and z multiplies, and differences of one at a time do not bound
        what it does.
        """
        if self.transits is None:
            return np.ones(len(self.names), dtype=bool)
        return np.asarray(abs(self.columns[2]) > _NEAR * self.bounds[2], dtype=bool)

    @property
    def _follows(self) -> Array:
        """Whether vz is taken as it follows from the others."""
        if self.transits is None:
            return self._deep
        return np.asarray(self.columns[2] != 0, dtype=bool)


def _depth(x: Any, y: Any, length: Any, side: Any, sqrt: Callable[[Any], Any]) -> Any:
    """Return z, above (side 1) or below (-1) the pivot."""
    return sqrt(length * length - x * x - y * y) * side


def _vertical_velocity(x: Any, y: Any, z: Any, vx: Any, vy: Any) -> Any:
    """Return vz, which keeps the velocity along the sphere."""
    return -(x * vx + y * vy) / z


def _xddot(n: Vector, v: Vector, k: Constants) -> Any:
    return acceleration(n, v, k)[0] * k.length


def _over_length(columns: list[Any], k: Constants) -> tuple[Vector, Vector]:
    x, y, z, vx, vy, vz = (column / k.length for column in columns)
    return (x, y, z), (vx, vy, vz)
