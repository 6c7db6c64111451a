"""From the values of rows to their constants and releases, by the model's own formulas: `Rows` for an engine.

They are computed in double-double arrays, within an ulp of the exact constants, at about two microseconds a row; in
mpmath a row would cost more than its integration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..engines.batch_interface import XDOT, Rows
from ..model.algebra import add, cross, dot, scale, subtract
from ..model.constants import Constants, Vector, axis_distance, turn_and_pull
from ..model.force import acceleration, force, tension
from ..model.sections import form_along
from ..model.start import at_angles
from ..numbers.double_double import DoubleDouble, in_radians, sine_and_cosine, square_root
from ..numbers.precision import Array
from ..scenes.inputs import RELEASES, GravityIs, Inputs, azimuth_of
from ..scenes.scene import Scene
from .axes import AxisTable

Columns = Mapping[str, DoubleDouble]

SITE = (
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
_SAME = 2.0**-94  # of the parts of a sum: if it is less, it is zero
_NEWTON_STEPS, _CLOSE = 8, 2.0**-94  # to a rest position, in rad: the last step is at most as long
_ZERO = DoubleDouble(np.zeros(1), np.zeros(1))
_EVEN = 0.5  # of |c|: where Ω² is less, there is one rest position near the plumb line


def columns_of(inputs: Inputs) -> dict[str, DoubleDouble]:
    """Return a scene's numbers as columns of one row, by the names of `SITE`, `POSITION` or `ANGLES`, and t_end."""
    named = {name: getattr(inputs, name) for name in (*SITE, "t_end")}
    named |= (
        dict(zip(POSITION, inputs.position, strict=True)) if inputs.position is not None else {}
    )
    named |= dict(zip(ANGLES, inputs.angles, strict=True)) if inputs.angles is not None else {}
    return {name: DoubleDouble.of([value]) for name, value in named.items()}


def engine_rows(scene: Scene, table: AxisTable, numbers: Any, section: str = "") -> Rows:
    """Return the constants and releases of rows; not finite where something is wrong with the scene.

    Args:
        scene: the scene that is varied.
        table: its values.
        numbers: of the rows.
        section: whose passages take the place of the transits, if any.
    """
    numbers = np.asarray(numbers, np.int64)
    words = table.words(numbers)
    kinds = list(zip(*words.values(), strict=True)) or [()] * len(numbers)
    order, blocks = [], []
    for kind in sorted(set(kinds)):
        places = np.flatnonzero([other == kind for other in kinds])
        worded = scene.with_values(f"{key}={word}" for key, word in zip(words, kind, strict=True))
        order.append(places)
        blocks.append(_of_kind(worded, table, numbers[places], section))
    return Rows.joined(blocks)[np.argsort(np.concatenate(order))]


def _of_kind(scene: Scene, table: AxisTable, numbers: Any, section: str) -> Rows:
    """Return rows whose words are those of the scene."""
    columns = columns_of(scene.exact)
    with np.errstate(all="ignore"):
        for key, values in table.numbers(numbers, scene.inputs).items():
            if key == "site.inverse_flattening":
                columns["flattening"] = _ZERO.where(np.isinf(values.high), (_ZERO + 1) / values)
            else:
                columns[key.rpartition(".")[2]] = values
        return row_constants(columns, scene.site.gravity_is, len(numbers), section)


def row_constants(columns: Columns, gravity_is: GravityIs, count: int, section: str = "") -> Rows:
    """Return the constants and releases of rows.

    Args:
        columns: the numbers of the scenes by the names of `columns_of`, SI units and degrees; one for all or `count`.
        gravity_is: what gravity means, as in `Inputs`.
        count: how many rows.
        section: as in `engine_rows`.
    """
    length, rate = columns["length"], columns["rotation_rate"]
    sin, cos = sine_and_cosine(columns["latitude"])
    distance = _ZERO
    if gravity_is == "ellipsoid":
        earth = columns["equatorial_radius"], columns["flattening"], columns["altitude"]
        distance = axis_distance(*earth, sin, cos, square_root)
    north, up, pull_north, pull_up = turn_and_pull(
        length, columns["gravity"], rate, distance, sin, cos
    )
    n, v = _release(columns)
    k = Constants(
        turn=(0, north, up),
        pull=(0, pull_north, pull_up),
        centrifugal=(rate * rate, up * up, -(north * up), north * north),
        drag=columns["drag"],
    )
    at_rest = v[0].vanishes & v[1].vanishes & v[2].vanishes
    falls = pull_north * v[1], pull_up * v[2]  # along c
    fall, size = (falls[0] + falls[1]).high, abs(falls[0].high) + abs(falls[1].high)
    still = at_rest & _balanced(n, k) | rate.vanishes & n[0].vanishes & v[0].vanishes
    form, multiplicity, leaves = (
        [_ZERO + part for part in XDOT],
        _zeros_at_release(n, v, k),
        np.zeros(1),
    )
    if section:
        form, multiplicity, leaves = _of_section(section, n, v, k)
    return Rows(
        length=_stacked((length,), count)[:, 0],
        drag=_stacked((columns["drag"],), count)[:, 0],
        t_end=_stacked((columns["t_end"],), count)[:, 0],
        turn=_stacked((_ZERO, north, up), count),
        pull=_stacked((_ZERO, pull_north, pull_up), count),
        n=_stacked(n, count),
        V=_stacked(add(v, cross(k.turn, n)), count),
        form=_stacked(form, count),
        zeros_at_release=np.full(count, multiplicity),
        leaves=np.full(count, leaves),
        rising=np.full(
            count, np.where(np.abs(fall) <= _SAME * size, 0, -np.sign(fall)).astype(np.int64)
        ),
        still=np.full(count, still & (section == "")),
    )


def _release(columns: Columns) -> tuple[Vector, Vector]:
    """Return position and velocity over l."""
    if "angle" not in columns:
        length = columns["length"]
        x, y, vx, vy = (columns[name] / length for name in POSITION)
        z = -square_root((1 - x) * (1 + x) - y * y)
        return (x, y, z), (vx, vy, -(x * vx + y * vy) / z)
    (sa, ca), (sl, cl) = (sine_and_cosine(columns[name]) for name in ANGLES[:2])
    return at_angles(1, sa, ca, sl, cl, *(in_radians(columns[name]) for name in ANGLES[2:]))


def _zeros_at_release(n: Vector, v: Vector, k: Constants) -> Any:
    """Return the multiplicities of xdot's zeros at t = 0: see `model.start.zero_at_release`."""
    at_pole, in_meridian, (_, north, up) = (
        k.turn[1].vanishes & k.pull[1].vanishes,
        n[0].vanishes,
        k.turn,
    )
    falls = n[2].vanishes & (at_pole | n[1].vanishes)
    square = np.where(_cancel(north * n[1], up * n[2]), 4, 2)
    at_rest = np.where(in_meridian, square, np.where(falls, 3, 1))
    moving = np.where(in_meridian & _cancel(north * v[2], -(up * v[1])), 2, 1)
    return np.where(v[0].vanishes, np.where(v[1].vanishes & v[2].vanishes, at_rest, moving), 0)


def _cancel(a: DoubleDouble, b: DoubleDouble) -> Any:
    """Return where two numbers have no sum but their rounding."""
    return np.abs((a + b).high) <= _SAME * (np.abs(a.high) + np.abs(b.high))


def _of_section(
    word: str, n: Vector, v: Vector, k: Constants
) -> tuple[list[DoubleDouble], Any, Any]:
    """Return a section's form, the multiplicity of its zero at t = 0, and its sign just after.

    Of a velocity three derivatives are looked at, of a position four. Where all vanish, the multiplicity is as many at
    least, and the sign is not known.
    """
    sin, cos = sine_and_cosine(DoubleDouble.of([azimuth_of(word)]))
    form = form_along(word, (cos, sin, 0), k.pull, lambda: _rest_position(k))
    numbers = [_ZERO + part for part in (*form.a, *form.b, form.d)]
    rate = acceleration(n, v, k)
    driven = subtract(force(v, rate, k), k.pull)  # rate of the force, which is linear
    tighter = 2 * dot(v, rate) + dot(v, force(n, v, k)) + dot(n, driven)
    jerk = subtract(driven, add(scale(tighter, n), scale(tension(n, v, k), v)))
    is_gate, d, vanish = word.startswith("gate"), numbers[6], np.ones(1, bool)
    multiplicity, leaves = np.zeros(1, np.int64), np.full(1, np.nan)
    for vector in (n, v, rate, jerk) if is_gate else (v, rate, jerk):
        parts = [
            p * q for p, q in zip(numbers[:3] if is_gate else numbers[3:6], vector, strict=True)
        ]
        value, size = (
            (parts[0] + parts[1] + parts[2] - d).high,
            sum(np.abs(part.high) for part in (*parts, d)),
        )
        is_none = np.abs(value) <= _SAME * size
        leaves = np.where(vanish & ~is_none, np.sign(value), leaves)
        vanish, d = vanish & is_none, _ZERO
        multiplicity = multiplicity + vanish
    return numbers, multiplicity, leaves


def _rest_position(k: Constants) -> Vector:
    """Return what `model.force.rest_position` does; NaN where there may be another one near the plumb line."""
    size = square_root(dot(k.pull, k.pull))
    north, up = (part / size for part in k.pull[1:])
    for _ in range(_NEWTON_STEPS):
        n, along = (0, north, up), (0, -up, north)
        push, bent = force(n, (0, 0, 0), k), subtract(force(along, (0, 0, 0), k), k.pull)
        step = dot(push, along) / (dot(push, n) - dot(bent, along))
        north, up = north + step * along[1], up + step * along[2]
        size = square_root(north * north + up * up)
        north, up = north / size, up / size
    even = np.abs(k.centrifugal[0].high) < _EVEN * np.sqrt(
        k.pull[1].high ** 2 + k.pull[2].high ** 2
    )
    settled = even & (np.abs(step.high) <= _CLOSE)
    return 0, north + np.where(settled, 0.0, np.nan), up


def _balanced(n: Vector, k: Constants) -> Any:
    """Return where the force on the bob at rest has no component along the sphere: see `model.start.xdot_vanishes`."""
    across = cross(n, force(n, (0, 0, 0), k))
    return across[0].vanishes & across[1].vanishes & across[2].vanishes


def _stacked(parts: Sequence[DoubleDouble], count: int) -> Array:
    """Return numbers as an array of shape (count, parts, 2)."""
    return np.stack([np.broadcast_to(part.pairs, (count, 2)) for part in parts], axis=1)
