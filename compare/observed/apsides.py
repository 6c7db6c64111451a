"""The apsides of a motion, its largest distances from the rest position; its frequency and precession from them."""

from __future__ import annotations

import numpy as np

from reference import Scene, UnreachableError, trajectory
from reference.numbers.precision import Array

from .swing_plane import Gauge

PER_SWING = 64  # samples in a period: the interpolation of an apsis between them is accurate to 1e-12
_NODES = 12  # samples that the interpolation of an apsis uses


def apsides(gauge: Gauge, times: Array, rows: Array) -> tuple[Array, Array]:
    """Return times in s and azimuths in rad (unwrapped modulo π) of the largest distances from the rest position.

    Args:
        gauge: of the rest position.
        times: evenly spaced in s, about PER_SWING in a period.
        rows: states x, y, z, vx, vy, vz at the times.
    """
    place, rate = gauge.displacement(rows)
    height = rows[:, :3] @ np.array(gauge.rest)  # along the plumb line
    radial = (place.conj() * rate).real if np.min(height) > 0 else -rows[:, 3:] @ np.array(gauge.rest)
    before = np.flatnonzero((radial[:-1] > 0) & (radial[1:] <= 0))
    half = _NODES // 2
    before = before[(before >= half - 1) & (before + half < len(times))]
    nodes = np.arange(1 - half, half + 1)
    inverse = np.linalg.inv(np.vander(nodes, _NODES, increasing=True))  # the nodes are small: condition 1e7
    at = before[:, None] + nodes
    distance = inverse @ radial[at].T
    east, north = inverse @ place.real[at].T, inverse @ place.imag[at].T
    step = radial[before] / (radial[before] - radial[before + 1])
    powers, slopes = np.arange(_NODES)[:, None], np.arange(1, _NODES)[:, None]
    for _ in range(4):  # Newton, from a secant: the function is nearly linear between two samples
        value = np.sum(distance * step**powers, axis=0)
        step = step - value / np.sum(slopes * distance[1:] * step ** (slopes - 1), axis=0)
    z = np.sum(east * step**powers, axis=0) + 1j * np.sum(north * step**powers, axis=0)
    azimuth = np.unwrap(2 * np.angle(z)) / 2
    return times[before] + step * (times[1] - times[0]), azimuth


def _apsides_of(scene: Scene, gauge: Gauge, duration: float) -> tuple[Array, Array]:
    """Return the apsides of the full model's motion within a duration in s."""
    step = gauge.period / PER_SWING
    times: Array = np.arange(int(duration / step) + _NODES + 1) * np.float64(step)
    return apsides(gauge, times, trajectory(scene, times))


def frequency(scene: Scene, swings: int = 50) -> float:
    """Return the frequency in Hz of the full model over about `swings` periods, from its apsides.

    Raises:
        UnreachableError: the bob does not swing.
    """
    gauge = Gauge.of(scene)
    times, _ = _apsides_of(scene, gauge, (swings + 1) * gauge.period)
    if len(times) < 3:
        raise UnreachableError("the bob does not swing: it has no largest distances from its rest position.")
    return float((len(times) - 1) / (2 * (times[-1] - times[0])))


def precession_period(scene: Scene, longest: float = 1e6) -> float:
    """Return the time in s in which the swing plane of the full model turns by 360°: twice that of its first half turn.

    Raises:
        UnreachableError: it does not turn by 180° within `longest` seconds.
    """
    gauge = Gauge.of(scene)
    guess = np.pi / abs(gauge.turn) if gauge.turn else np.inf
    for stretch in (1.1, 2.0, 4.0):
        if not guess * stretch < longest:
            break
        times, azimuths = _apsides_of(scene, gauge, guess * stretch + 2 * gauge.period)
        turned = np.abs(azimuths - azimuths[0])
        if turned[-1] >= np.pi:
            last = int(np.argmax(turned >= np.pi))
            share = (np.pi - turned[last - 1]) / (turned[last] - turned[last - 1])
            return float(2 * (times[last - 1] + share * (times[last] - times[last - 1]) - times[0]))
    raise UnreachableError(f"the swing plane does not turn by 180° within {longest:g} s.")
