"""The zeros that heyoka finds in a batch, guarded: what they say of a row's transits and highest points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.algebra import cross, subtract
from ...model.constants import Constants
from ...model.force import acceleration
from ...numbers.precision import Array
from ..batch_interface import CLOSE_PAIR, DOUBTFUL, LEAST_BEND, Outcomes, Rows, Wanted

TRANSIT, TURNING = 0, 1  # kinds of zeros: xdot = 0; zdot along the plumb line from + to -
QUIET = 1e-4  # of a small swing's period after the release: zeros there are those of the release itself


@dataclass(frozen=True)
class Zeros:
    """Times of the zeros of one row, increasing; `directions` are those of xdot; `times` are all, each once."""

    transits: Array
    directions: Array
    turnings: Array
    times: Array


def by_lane(zeros: Mapping[int, list[list[float]]], rows: Rows) -> list[Zeros]:
    """Return the zeros of each lane, without those of the release.

    heyoka reports the zeros at the release as t = 1e-17 or so. Where it has none by the exact inputs, all count.

    Args:
        zeros: of each kind and each lane time, direction, time, direction, …
        rows: the scenes in the lanes.
    """
    lanes = []
    for lane, (end, rate) in enumerate(zip(rows.t_end[:, 0], rows.rate, strict=True)):
        quiet = QUIET * 2 * np.pi / rate
        none = quiet if rows.zeros_at_release[lane] else 0.0
        t, directions = _within(zeros, TRANSIT, lane, np.inf if rows.still[lane] else none, end)
        turnings, _ = _within(zeros, TURNING, lane, quiet, end)
        lanes.append(Zeros(t, directions, turnings, np.unique(np.concatenate([t, turnings]))))
    return lanes


def _within(
    zeros: Mapping[int, list[list[float]]], kind: int, lane: int, after: float, end: float
) -> tuple[Array, Array]:
    """Return times, in order, and directions of the zeros of one kind in a lane that lie in a span."""
    if kind not in zeros:
        return np.zeros(0), np.zeros(0)
    t, directions = np.array(zeros[kind][lane], dtype=np.float64).reshape(-1, 2).T
    kept = np.flatnonzero((t > after) & (t <= end))
    kept = kept[np.argsort(t[kept], kind="stable")]
    return t[kept], directions[kept]


def describe(
    outcomes: Outcomes, row: int, scene: Rows, wanted: Wanted, zeros: Zeros, n: Any, v: Any
) -> tuple[Array, Array]:
    """Fill in what the zeros of a row say of it; return times and directions of its transits.

    Args:
        outcomes: where to fill it in; state and fate are there.
        row: the row's place there.
        scene: the row by itself.
        wanted: what is wanted.
        zeros: its zeros.
        n: position over l at `zeros.times`, shape (3, times).
        v: n' there.
    """
    k = Constants.of({name: value[0] for name, value in scene.k.entries().items()})
    if wanted.transits or wanted.times:
        at = np.searchsorted(zeros.times, zeros.transits)
        _transits(outcomes, row, scene, zeros, acceleration(n[:, at], v[:, at], k)[0] * k.length)
    if wanted.apsides:
        at = np.searchsorted(zeros.times, zeros.turnings)
        _turnings(outcomes, row, scene, k, zeros.turnings, n[:, at], v[:, at])
    return zeros.transits, zeros.directions


def _transits(outcomes: Outcomes, row: int, scene: Rows, zeros: Zeros, ax: Array) -> None:
    t, directions = zeros.transits, zeros.directions
    if scene.still[0]:
        return
    signs = np.concatenate([[_sign_after_release(scene)], directions, [np.sign(outcomes.state[row, 3])]])
    if (directions * signs[: len(t)] >= 0).any() or signs[-1] != signs[-2] or (np.sign(ax) != directions).any():
        outcomes.fate[row] = DOUBTFUL
    outcomes.transits[row] = len(t)
    if len(t):
        outcomes.t_first[row], outcomes.t_last[row] = t[0], t[-1]
        outcomes.least_ax[row] = np.abs(ax).min()
        outcomes.close_pairs[row] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / scene.rate[0])


def _sign_after_release(scene: Rows) -> float:
    """Return the sign of xdot just after the release: that of its first derivative which is not exactly zero."""
    n, V, turn = (tuple(array[0, :, 0]) for array in (scene.n, scene.V, scene.turn))
    k = Constants.of({name: value[0] for name, value in scene.k.entries().items()})
    v = subtract(V, cross(turn, n))
    zeros = scene.zeros_at_release[0]
    if zeros == 0:
        return float(np.sign(v[0]))
    a: Any = acceleration(n, (0, *v[1:]), k)
    return float(np.sign(a[0] if zeros == 1 else -2 * cross(turn, a)[0]))


def _turnings(outcomes: Outcomes, row: int, scene: Rows, k: Constants, t: Array, n: Any, v: Any) -> None:
    pull = scene.pull[0, :, 0]
    up = -pull / scene.rate[0] ** 2
    release = np.arctan2(np.linalg.norm(np.cross(scene.n[0, :, 0], up)), -scene.n[0, :, 0] @ up)
    outcomes.largest_angle[row] = release
    if not len(t):
        return
    height = up @ n
    bend = -(up @ np.array(acceleration(n, v, k))) / (scene.rate[0] ** 2 * (1 - height**2))
    if bend.min() < LEAST_BEND:
        return
    north = np.cross(up, [1.0, 0.0, 0.0])
    azimuth = np.arctan2(north @ n, n[0])
    change = np.diff(azimuth)
    outcomes.apsides[row], outcomes.least_bend[row] = len(t), bend.min()
    outcomes.apsis_first[row], outcomes.apsis_last[row] = t[0], t[-1]
    outcomes.turn[row] = np.sum(change - np.pi * np.round(change / np.pi))
    outcomes.largest_angle[row] = max(release, np.max(np.arctan2(np.hypot(north @ n, n[0]), -height)))
