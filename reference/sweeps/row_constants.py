"""The constants and releases of rows, by the model's own formulas: `Rows` for an engine.

They are computed in double-double arrays, within an ulp of the exact constants, at about two
microseconds a row. In mpmath a row would cost more than its integration.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..engines.batch_interface import XDOT, Rows
from ..model.algebra import add, cross, dot, scale, subtract
from ..model.constants import Constants, Vector, axis_distance, centrifugal_products, turn_and_pull
from ..model.force import acceleration, force, tension
from ..model.sections import form_along
from ..model.start import Angle, at_angles
from ..numbers.double_double import DoubleDouble, in_radians, sine_and_cosine, square_root
from ..numbers.precision import Array
from ..scenes.inputs import RELEASES, GravityIs, Inputs, azimuth_of
from ..scenes.scene import Scene
from .axes import AxisTable

Columns = Mapping[str, DoubleDouble]

_SITE = (
    "length",
    "drag",
    "latitude",
    "altitude",
    "gravity",
    "rotation_rate",
    "equatorial_radius",
    "flattening",
)
POSITION, ANGLES = RELEASES.values()
_AT_REST = (0, 0, 0)
_ZERO = DoubleDouble(np.zeros(1), np.zeros(1))
_SAME = 2.0**-94  # a sum below this share of its terms is zero
_NEWTON_STEPS = 8  # to a rest position
_CLOSE = 2.0**-94  # in rad: the last of these steps is at most as long
_EVEN = 0.5  # a share of |c|: if Ω² is below it, there is one rest position near the plumb line


@dataclass(frozen=True)
class _RowForm:
    """The form whose zeros are sought in rows.

    Attributes:
        numbers: a, b and d of the form, as in `Rows`.
        zeros_at_release: as in `Rows`.
        leaves: as in `Rows`.
    """

    numbers: Sequence[DoubleDouble]
    zeros_at_release: Any
    leaves: Any


def columns_of(inputs: Inputs) -> dict[str, DoubleDouble]:
    """Return a scene's numbers as columns of one row: site, release, pendulum and t_end."""
    values = {name: getattr(inputs, name) for name in (*_SITE, "t_end")}
    if inputs.position is not None:
        values |= dict(zip(POSITION, inputs.position, strict=True))
    if inputs.angles is not None:
        values |= dict(zip(ANGLES, inputs.angles, strict=True))
    return {name: DoubleDouble.of([value]) for name, value in values.items()}


def engine_rows(scene: Scene, table: AxisTable, numbers: Any, section: str = "") -> Rows:
    """Return the constants and releases of rows; not finite for invalid scenes.

    Args:
        scene: the scene that is varied.
        table: its values.
        numbers: of the rows.
        section: the section whose passages take the place of the transits, if any.
    """
    numbers = np.asarray(numbers, np.int64)
    words = table.words(numbers)
    combinations: Iterable[tuple[str, ...]] = zip(*words.values(), strict=True)
    if not words:
        combinations = [()] * len(numbers)
    places_of: dict[tuple[str, ...], list[int]] = {}
    for place, combination in enumerate(combinations):
        places_of.setdefault(combination, []).append(place)

    blocks = []
    for combination, places in places_of.items():
        values = [f"{key}={word}" for key, word in zip(words, combination, strict=True)]
        blocks.append(_of_words(scene.with_values(values), table, numbers[places], section))
    order = np.concatenate(list(places_of.values()))
    return Rows.joined(blocks)[np.argsort(order)]


def _of_words(scene: Scene, table: AxisTable, numbers: Any, section: str) -> Rows:
    """Return rows whose words are those of the scene."""
    columns = columns_of(scene.exact)
    with np.errstate(all="ignore"):
        for key, values in table.numbers(numbers, scene.inputs).items():
            if key == "site.inverse_flattening":
                is_sphere = np.isinf(values.high)
                columns["flattening"] = _ZERO.where(is_sphere, (_ZERO + 1) / values)
            else:
                columns[key.rpartition(".")[2]] = values
        return row_constants(columns, scene.site.gravity_is, len(numbers), section)


def row_constants(columns: Columns, gravity_is: GravityIs, count: int, section: str = "") -> Rows:
    """Return the constants and releases of rows.

    Args:
        columns: the numbers of the scenes by the names of `columns_of`, SI units and degrees; one
            for all or `count`.
        gravity_is: the meaning of gravity, as in `Inputs`.
        count: how many rows.
        section: as in `engine_rows`.
    """
    k = _constants(columns, gravity_is)
    n, v = _release(columns)
    form = _of_section(section, n, v, k) if section else _of_xdot(n, v, k)
    still = _is_still(n, v, k) & (section == "")
    return Rows(
        length=_stacked([columns["length"]], count)[:, 0],
        drag=_stacked([columns["drag"]], count)[:, 0],
        t_end=_stacked([columns["t_end"]], count)[:, 0],
        turn=_stacked([_ZERO, *k.turn[1:]], count),
        pull=_stacked([_ZERO, *k.pull[1:]], count),
        n=_stacked(n, count),
        V=_stacked(add(v, cross(k.turn, n)), count),
        form=_stacked(form.numbers, count),
        zeros_at_release=np.full(count, form.zeros_at_release),
        leaves=np.full(count, form.leaves),
        rising=np.full(count, _rising(v, k)),
        still=np.full(count, still),
    )


def _constants(columns: Columns, gravity_is: GravityIs) -> Constants:
    """Return the constants of the equations of motion."""
    rate = columns["rotation_rate"]
    sin, cos = sine_and_cosine(columns["latitude"])
    distance = _ZERO
    if gravity_is == "ellipsoid":
        ellipsoid = columns["equatorial_radius"], columns["flattening"]
        distance = axis_distance(*ellipsoid, columns["altitude"], sin, cos, square_root)
    north, up, pull_north, pull_up = turn_and_pull(
        columns["length"], columns["gravity"], rate, distance, sin, cos
    )
    return Constants(
        turn=(0, north, up),
        pull=(0, pull_north, pull_up),
        centrifugal=centrifugal_products(rate, north, up),
        drag=columns["drag"],
        rate=rate,
    )


def _release(columns: Columns) -> tuple[Vector, Vector]:
    """Return position and velocity over l."""
    if "angle" not in columns:
        length = columns["length"]
        x, y, vx, vy = (columns[name] / length for name in POSITION)
        z = -square_root((1 - x) * (1 + x) - y * y)
        return (x, y, z), (vx, vy, -(x * vx + y * vy) / z)
    angle, azimuth, angle_rate, azimuth_rate = (columns[name] for name in ANGLES)
    return at_angles(
        1,
        Angle(*sine_and_cosine(angle), in_radians(angle_rate)),
        Angle(*sine_and_cosine(azimuth), in_radians(azimuth_rate)),
    )


def _rising(v: Vector, k: Constants) -> Any:
    """Return the sign of u', the rate at which the bob rises along the plumb line: -1, 0 or 1."""
    north = k.pull[1] * v[1]
    up = k.pull[2] * v[2]
    fall = (north + up).high
    return np.where(_cancel(north, up), 0, -np.sign(fall)).astype(np.int64)


def _is_still(n: Vector, v: Vector, k: Constants) -> Any:
    """Return where xdot is zero at all times: see `model.start.xdot_vanishes`."""
    at_rest = v[0].vanishes & v[1].vanishes & v[2].vanishes
    across = cross(n, force(n, _AT_REST, k))
    is_balanced = across[0].vanishes & across[1].vanishes & across[2].vanishes
    stays_in_meridian = k.rate.vanishes & n[0].vanishes & v[0].vanishes
    return at_rest & is_balanced | stays_in_meridian


def _of_xdot(n: Vector, v: Vector, k: Constants) -> _RowForm:
    """Return the form of the transits."""
    return _RowForm([_ZERO + part for part in XDOT], _zeros_at_release(n, v, k), np.zeros(1))


def _zeros_at_release(n: Vector, v: Vector, k: Constants) -> Any:
    """Return the multiplicities of xdot's zeros at t = 0: see `model.start.zero_at_release`."""
    _, north, up = k.turn
    moves_east = ~v[0].vanishes
    moves = ~(v[1].vanishes & v[2].vanishes)
    in_meridian = n[0].vanishes
    along_axis = _cancel(north * v[2], -(up * v[1]))
    across_axis = _cancel(north * n[1], up * n[2])
    at_pole = k.turn[1].vanishes & k.pull[1].vanishes
    falls_straight = n[2].vanishes & (at_pole | n[1].vanishes)
    # the first condition that holds decides
    cases = (
        (moves_east, 0),
        (moves & in_meridian & along_axis, 2),
        (moves, 1),
        (in_meridian & across_axis, 4),
        (in_meridian, 2),
        (falls_straight, 3),
    )
    return np.select([where for where, _ in cases], [count for _, count in cases], default=1)


def _cancel(a: DoubleDouble, b: DoubleDouble) -> Any:
    """Return where the sum of two numbers is nothing but rounding."""
    return np.abs((a + b).high) <= _SAME * (np.abs(a.high) + np.abs(b.high))


def _of_section(word: str, n: Vector, v: Vector, k: Constants) -> _RowForm:
    """Return the form of a section.

    Its zero at t = 0 has as many as four derivatives that may vanish if it is a position's, and
    three if it is a velocity's. Where all of them vanish, the multiplicity is at least as large,
    and the sign after it is not known.
    """
    sin, cos = sine_and_cosine(DoubleDouble.of([azimuth_of(word)]))
    form = form_along(word, (cos, sin, 0), k.pull, lambda: _rest_position(k))
    numbers = [_ZERO + part for part in (*form.a, *form.b, form.d)]
    rate = acceleration(n, v, k)
    jerk = _jerk(n, v, rate, k)
    if word.startswith("gate"):
        weights = numbers[:3]
        derivatives = [n, v, rate, jerk]
    else:
        weights = numbers[3:6]
        derivatives = [v, rate, jerk]

    offset = numbers[6]
    vanish = np.ones(1, bool)
    multiplicity = np.zeros(1, np.int64)
    leaves = np.full(1, np.nan)
    for vector in derivatives:
        x, y, z = (weight * part for weight, part in zip(weights, vector, strict=True))
        value = (x + y + z - offset).high
        size = sum(np.abs(term.high) for term in (x, y, z, offset))
        is_zero = np.abs(value) <= _SAME * size
        leaves = np.where(vanish & ~is_zero, np.sign(value), leaves)
        vanish = vanish & is_zero
        multiplicity = multiplicity + vanish
        offset = _ZERO  # of the form alone, not of its derivatives
    return _RowForm(numbers, multiplicity, leaves)


def _jerk(n: Vector, v: Vector, rate: Vector, k: Constants) -> Vector:
    """Return the third derivative of n, from the second, `rate`."""
    force_rate = subtract(force(v, rate, k), k.pull)  # the force is linear but for c
    tension_rate = 2 * dot(v, rate) + dot(v, force(n, v, k)) + dot(n, force_rate)
    cord = add(scale(tension_rate, n), scale(tension(n, v, k), v))
    return subtract(force_rate, cord)


def _rest_position(k: Constants) -> Vector:
    """Return the rest position, as in `model.force`; NaN where there may be several."""
    size = square_root(dot(k.pull, k.pull))
    north, up = (part / size for part in k.pull[1:])
    for _ in range(_NEWTON_STEPS):
        n = (0, north, up)
        along = (0, -up, north)
        push = force(n, _AT_REST, k)
        push_rate = subtract(force(along, _AT_REST, k), k.pull)
        step = dot(push, along) / (dot(push, n) - dot(push_rate, along))
        north = north + step * along[1]
        up = up + step * along[2]
        size = square_root(north * north + up * up)
        north = north / size
        up = up / size
    pull_size = np.sqrt(k.pull[1].high ** 2 + k.pull[2].high ** 2)
    is_even = np.abs(k.centrifugal[0].high) < _EVEN * pull_size
    is_settled = is_even & (np.abs(step.high) <= _CLOSE)
    return 0, north + np.where(is_settled, 0.0, np.nan), up


def _stacked(parts: Sequence[DoubleDouble], count: int) -> Array:
    """Return numbers as an array of shape (count, parts, 2)."""
    return np.stack([np.broadcast_to(part.pairs, (count, 2)) for part in parts], axis=1)
