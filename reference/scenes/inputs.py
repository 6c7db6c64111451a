"""The exact numbers of a scene, as the model, the engines and the solver take them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

GravityIs = Literal["ellipsoid", "effective"]

SAME_TIME = Fraction(1, 1 << 30)  # of a grid step: times nearer than this differ only by the rounding of the inputs


@dataclass(frozen=True)
class Inputs:
    """The exact numbers of a scene: SI units, angles in degrees; `flattening` is 0 for a sphere.

    Exactly one of `position` (x, y, vx, vy) and `angles` (angle, azimuth, angle_rate, azimuth_rate)
    is set, the one that the scene contains. `gravity_is` tells the pull along the ellipsoid's normal, to which the
    centrifugal force comes, from the effective one along the plumb line, which contains that at the pivot.
    """

    length: Fraction
    drag: Fraction
    latitude: Fraction
    altitude: Fraction
    gravity: Fraction
    rotation_rate: Fraction
    equatorial_radius: Fraction
    flattening: Fraction
    position: tuple[Fraction, Fraction, Fraction, Fraction] | None
    angles: tuple[Fraction, Fraction, Fraction, Fraction] | None
    t_end: Fraction
    grid_step: Fraction
    gravity_is: GravityIs = "ellipsoid"

    @property
    def grid(self) -> list[Fraction]:
        """Output times in s: 0, grid_step, 2 grid_step, …, and t_end as the last.

        Read as binary64, the last step may miss t_end by rounding alone: then t_end takes its place.
        """
        whole = int(self.t_end / self.grid_step)
        times = [k * self.grid_step for k in range(whole + 1)]
        if whole and self.t_end - times[-1] < self.grid_step * SAME_TIME:
            times.pop()
        return [*times, self.t_end]

    @property
    def at_rest(self) -> bool:
        """True if the bob is released without any velocity."""
        moving = self.position[2:] if self.position else (self.angles or ())[2:]
        return not any(moving)
