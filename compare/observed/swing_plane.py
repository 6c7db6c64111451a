"""The swing plane of sampled states: highest points, frequency, precession. Of a solved scene: solver/swing.py.

A linear oscillator on a turntable, seen in axes that do not turn, moves on an ellipse about its
rest position. Let Z = X + iY be the displacement in the plane at right angles to the plumb line (X
east, Y north), Z' its rate on the ground, Ω_n the component of Ω along the plumb line, and ω the
frequency. In axes that do not turn, position and velocity over ω are Z and S = (Z' + i Ω_n Z)/ω,
and the major axis of the ellipse has the direction
    ψ = arg(Z² + S²)/2.
For Z = C1 exp(-iωt) + C2 exp(iωt) this is arg(4 C1 C2)/2 at every t. The axes on the ground and
those that do not turn coincide at the moment in question, so ψ is the azimuth (from east to north)
on the ground. It is counted modulo 180°, and it has no meaning on a circle (C1 or C2 zero).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from reference import Scene, UnreachableError, trajectory
from reference.model.constants import Vector
from reference.model.force import tension
from reference.model.start import Start, scaled
from reference.numbers.precision import Array

_PREC = 200  # bits in which a rest position is computed before it becomes doubles
# an ellipse with |Z² + S²| below this part of |Z|² + |S|² is nearly a circle and has no direction
_ROUND = 1e-6
# samples in a period: the interpolation of an apsis between them is accurate to 1e-12
PER_SWING = 64
_NODES = 12  # samples that the interpolation of an apsis uses


@dataclass(frozen=True)
class Gauge:
    """A rest position and the linear oscillator about it, by which the swing plane and the apsides are measured.

    Attributes:
        rest: unit vector from the suspension to the rest position.
        omega: ω in rad/s.
        turn: Ω_n in rad/s.
    """

    rest: tuple[float, float, float]
    omega: float
    turn: float

    @classmethod
    def of(cls, scene: Scene, rest: Vector | None = None) -> Gauge:
        """Return the gauge of a scene about `rest` in m, or about the scene's own rest position.

        ω follows from the tension of the cord at the scene's rest position.

        Raises:
            UnreachableError: there is no rest position, or nothing pulls the bob back to it.
        """
        start = Start.of(scene.exact, _PREC)
        hanging = start.rest
        turn = (
            -start.ctx.mpf(start.k.turn[1]) * hanging[1]
            - start.ctx.mpf(start.k.turn[2]) * hanging[2]
        )
        square = tension(hanging, (0, 0, 0), start.k) + turn**2
        if not square > 0:
            raise UnreachableError(
                "no force pulls the bob back to its rest position, so there is no swing to measure."
            )
        east, north, up = hanging if rest is None else scaled(rest, start.k.length)
        return cls(
            (float(east), float(north), float(up)), float(start.ctx.sqrt(square)), float(turn)
        )

    @cached_property
    def period(self) -> float:
        """Period 2π/ω in s."""
        return float(2 * np.pi / self.omega)

    def displacement(self, rows: Array) -> tuple[Any, Any]:
        """Return Z in m and Z' in m/s of rows x, y, z, vx, vy, vz."""
        _, y, z = self.rest
        return rows[:, 0] + 1j * (rows[:, 2] * y - rows[:, 1] * z), rows[:, 3] + 1j * (
            rows[:, 5] * y - rows[:, 4] * z
        )

    def swing_plane(self, rows: Array) -> Array:
        """Return ψ in rad, in (-π/2, π/2]; NaN where the ellipse is a circle."""
        place, rate = self.displacement(rows)
        speed = (rate + 1j * self.turn * place) / self.omega
        square = place**2 + speed**2
        size = np.abs(place) ** 2 + np.abs(speed) ** 2
        return np.where(np.abs(square) > _ROUND * size, np.angle(square) / 2, np.nan)


def gauge_of(scene: Scene, rest: Vector | None = None) -> Gauge | None:
    """Return the gauge of a scene's swing plane, as `Gauge.of`.

    None where nothing swings: there is no plane.
    """
    try:
        return Gauge.of(scene, rest)
    except UnreachableError:
        return None


def rest_in_metres(scene: Scene) -> Array:
    """Return the rest position in m, shape (3,).

    Raises:
        UnreachableError: there is no single rest position.
    """
    start = Start.of(scene.exact, _PREC)
    return np.array([float(part * start.k.length) for part in start.rest])


def apsides(gauge: Gauge, times: Array, rows: Array) -> tuple[Array, Array]:
    """Return times in s and azimuths in rad (unwrapped modulo π) of the apsides, the maxima of the distance from rest.

    Args:
        gauge: of the rest position.
        times: evenly spaced in s, about PER_SWING in a period.
        rows: states x, y, z, vx, vy, vz at the times.
    """
    from numpy.polynomial.polynomial import polyder, polyval

    place, rate = gauge.displacement(rows)
    height = rows[:, :3] @ np.array(gauge.rest)  # along the plumb line
    radial = (
        (place.conj() * rate).real if np.min(height) > 0 else -rows[:, 3:] @ np.array(gauge.rest)
    )
    before = np.flatnonzero((radial[:-1] > 0) & (radial[1:] <= 0))
    half = _NODES // 2
    before = before[(before >= half - 1) & (before + half < len(times))]
    nodes = np.arange(1 - half, half + 1)
    # the nodes are small: condition 1e7
    inverse = np.linalg.inv(np.vander(nodes, _NODES, increasing=True))
    at = before[:, None] + nodes
    distance = inverse @ radial[at].T
    step = radial[before] / (radial[before] - radial[before + 1])
    for _ in range(4):  # Newton, from a secant: the function is nearly linear between two samples
        step = step - polyval(step, distance, tensor=False) / polyval(
            step, polyder(distance), tensor=False
        )
    azimuth = np.unwrap(2 * np.angle(polyval(step, inverse @ place[at].T, tensor=False))) / 2
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
        raise UnreachableError(
            "the bob does not swing: its distance from the rest position has no maximum."
        )
    return float((len(times) - 1) / (2 * (times[-1] - times[0])))


def precession_period(scene: Scene, longest: float = 1e6) -> float:
    """Return the time in s in which the full model's swing plane turns by 360°: twice that of its first half turn.

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
            return float(
                2
                * (
                    np.interp(np.pi, turned[last - 1 : last + 1], times[last - 1 : last + 1])
                    - times[0]
                )
            )
    raise UnreachableError(f"the swing plane does not turn by 180° within {longest:g} s.")
