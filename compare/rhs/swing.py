"""How far and how fast a bob can get, by its energy: scales for tolerances, and which formulations hold."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reference import Scene
from reference.errors import BeyondDoublesError
from reference.model.start import Start
from reference.numbers.precision import DOUBLE_BITS, GUARD_BITS

Array = npt.NDArray[np.float64]

SMALLEST_SIZE = 1e-12  # least swing of a variable, so that tolerances for a bob at rest are not zero


@dataclass(frozen=True)
class Swing:
    """How far and how fast the bob can get, from its energy about the rest position.

    Without the small gradient of the centrifugal force v²/2 - n·c is constant, so that the angle from the rest
    position c/|c| never exceeds the one where v would vanish, nor the speed its value at the bottom.

    Attributes:
        cosine: of that largest angle; at most 1, -1 or less where the bob can go over the top.
        fastest: speed over l, in 1/s.
        aside: distance of the rest position from the vertical, as a part of l.
        spread: largest energy that the centrifugal gradient may add, as a part of the pull.
    """

    cosine: float
    fastest: float
    aside: float
    spread: float

    @classmethod
    def of(cls, start: Start) -> Swing:
        """Return the swing that follows from the release.

        Raises:
            UnreachableError: a number of the scene is too large for binary64.
        """
        n, v, pull = (np.array(part, dtype=float) for part in (start.n, start.v, start.k.pull))
        rate = float(start.k.rate)
        if not (np.isfinite((n, v, pull)).all() and math.isfinite(rate * rate)):
            raise BeyondDoublesError
        strength = float(np.linalg.norm(pull))
        if strength == 0:
            return cls(-1.0, float(np.linalg.norm(v)), 1.0, 1.0)
        energy = float(v @ v / 2 - n @ pull)
        fastest = math.sqrt(max(2 * (energy + strength), 0.0))
        return cls(
            min(-energy / strength, 1.0),
            fastest,
            float(np.hypot(*pull[:2])) / strength,
            rate * rate / strength,
        )

    @property
    def below(self) -> bool:
        """True if the bob stays below the horizontal, where the cord always pulls."""
        return self.cosine > self.aside + self.spread

    def sizes(self, variables: int) -> Array:
        """Return bounds on positions (radians, or n) and rates (1/s), in the order of a state's variables."""
        reach = math.sqrt(1 - self.cosine**2) if self.cosine > 0 else 1.0
        half = variables // 2
        sizes: Array = np.array([min(reach + self.aside, 1.0)] * half + [self.fastest] * half)
        return np.maximum(sizes, SMALLEST_SIZE)


def suited(scene: Scene, formulations: Sequence[str]) -> str:
    """Return the first of some formulations that can describe the scene's whole motion.

    `plane` holds below the horizontal only, and `space` leaves the sphere where a rod is pushed; for a bob whose energy
    may take it there any other formulation is better, `space` is second best, and `plane` fails.
    """
    if Swing.of(Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)).below:
        return formulations[0]
    return min(formulations, key=lambda word: {"space": 1, "plane": 2}.get(word, 0))
