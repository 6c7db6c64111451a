"""How far a program in double precision can follow a scene, at best.

Such a program rounds each number that it starts from. Even if it rounds nothing afterwards, its
motion is that of neighbouring inputs, and the distance grows: in proportion to time, since its
period is a little wrong, or much faster where the motion magnifies every error, as near the top of
a pole. No method and no step size gets that back. What its own steps add comes on top, so that this
is an upper limit of what a program in doubles can reach, not what it will reach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..engines.trajectory import trajectory
from ..numbers.precision import DOUBLE_BITS, Array
from ..scenes.scene import AnyScene, as_scene
from .sensitivity import Sensitivity

# Default tolerance of `foucault score`, as a part of the amplitude.
TOLERANCE = 1e-6

_ROUNDING = 2.0**-DOUBLE_BITS  # largest relative error of a rounded number
_TIMES = 577  # moments, evenly spaced, at which the motions are compared


@dataclass(frozen=True)
class DoubleReach:
    """How far a program in double precision can follow a scene, at best: estimates, to first order.

    Attributes:
        end_s: end of the run in s.
        amplitude_m: largest horizontal distance from the suspension's vertical over the run.
        moved_m: how far one rounding of every input moves the bob horizontally up to the end.
        until_s: when that first exceeds `TOLERANCE` of the amplitude; None if it does not.
        costly: the inputs whose rounding costs most: "release" or "constants" (length, gravity, …).
    """

    end_s: float
    amplitude_m: float
    moved_m: float
    until_s: float | None
    costly: str

    @property
    def digits(self) -> float | None:
        """Decimal digits of the amplitude that are kept to the end; None if the tolerance is exceeded before."""
        if self.until_s is not None:
            return None
        most = DOUBLE_BITS * math.log10(2)
        if not self.moved_m:
            return most
        return min(most, math.log10(self.amplitude_m / self.moved_m))

    @property
    def in_words(self) -> str:
        """How far doubles go, in words that fit into a table."""
        if self.until_s == 0:
            return "not at all"
        if self.digits is None:
            return f"6 digits up to {self.until_s:.2g} s, then fewer"
        return f"about {self.digits:.0f} digits up to {self.end_s:g} s"


def double_reach(scene: AnyScene) -> DoubleReach:
    """Return how far a program in double precision can follow a scene, at best.

    Raises:
        UnreachableError: the scene cannot be solved in double precision.
    """
    scene = as_scene(scene)
    end_s = float(scene.exact.t_end)
    times = np.linspace(0.0, end_s, _TIMES)
    response = Sensitivity(scene, times)
    by_release = _moved_m(response, release=True)
    by_constants = _moved_m(response, release=False)
    moved_m = by_release + by_constants

    amplitude_m = float(np.hypot(*trajectory(scene, times)[:, :2].T).max())
    beyond = np.flatnonzero(moved_m > TOLERANCE * amplitude_m)
    last = beyond[0] if len(beyond) else -1
    return DoubleReach(
        end_s=end_s,
        amplitude_m=amplitude_m,
        moved_m=float(moved_m[-1]),
        until_s=float(times[beyond[0]]) if len(beyond) else None,
        costly="release" if by_release[last] > by_constants[last] else "constants",
    )


def _moved_m(response: Sensitivity, *, release: bool) -> Array:
    """Return the largest horizontal distance so far, by one rounding of all numbers of a kind."""
    moved = _ROUNDING * response.relative(release=release)
    return np.asarray(np.maximum.accumulate(np.hypot(moved[:, 0], moved[:, 1])))
