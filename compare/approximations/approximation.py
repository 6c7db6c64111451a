"""Declaration of an approximation: its source, dropped terms and formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import InputError, Scene, UnreachableError
from reference.errors import Described
from reference.numbers.precision import Array

from .case import PaperCase


@dataclass(frozen=True, kw_only=True, repr=False)
class Approximation:
    """An analytic or truncated model from the source papers.

    Attributes:
        id: its name on the command line, in files and in tests.
        title: its description in one line.
        where: source paper and equation numbers.
        drops: terms and effects that it leaves out.
        needs: what its domain needs: each gives the reason why a scene is outside of it, or None.
    """

    id: str
    title: str
    where: str
    drops: str
    needs: tuple[Callable[[Scene], str | None], ...] = ()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.id}: {self.title})"

    def refuses(self, scene: Scene) -> str | None:
        """Return the first reason why a scene is outside its domain, or None."""
        return next(filter(None, (need(scene) for need in self.needs)), None)

    def check(self, scene: Scene) -> None:
        """Raise InputError if the scene is outside the domain in which the formulas have a meaning."""
        reason = self.refuses(scene)
        if reason is not None:
            raise InputError("scene", scene.id, f"a scene that {self.id} applies to", f"{reason}.")


@dataclass(frozen=True, kw_only=True, repr=False)
class Motion(Approximation):
    """An approximation of the whole motion.

    Attributes:
        path: `path(case, times)`, the motion without checks of scene and times; see `trajectory`.
        rest: `rest(scene)`, the point (x, y, z) in m about which it swings; None: the full model's
            rest position.
    """

    path: Callable[[PaperCase, Array], Array]
    rest: Callable[[Scene], Any] | None = None

    def trajectory(self, scene: Scene, times: npt.ArrayLike) -> Array:
        """Return the approximate motion at the times.

        Args:
            scene: the scene to approximate.
            times: increasing, not negative, in s.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6); z is always on the sphere.

        Raises:
            InputError: the scene is outside the domain, or the times are negative or do not
                increase.
            UnreachableError: the motion leaves the sphere or is not finite.
        """
        self.check(scene)
        grid = np.asarray(times, dtype=np.float64)
        if grid.ndim != 1 or not len(grid) or grid[0] < 0 or not np.all(np.diff(grid) > 0):
            raise InputError(
                "times",
                Described(f"an array of shape {grid.shape}"),
                "increasing times in s, the first 0 or later",
            )
        try:
            case = PaperCase.of_scene(scene)
            rows = (
                self.path(case, grid)
                if grid[0] == 0
                else self.path(case, np.insert(grid, 0, 0.0))[1:]
            )
        except OverflowError:
            rows = np.array([np.inf])
        if not np.isfinite(rows).all():
            raise UnreachableError(f"{self.id} gives no finite motion for {scene.id}.")
        return rows


@dataclass(frozen=True, kw_only=True, repr=False)
class Quantity(Approximation):
    """An approximation of one number.

    Attributes:
        formula: `formula(case)`, an mpf, without checks of the scene; see `value`.
        truth: `truth(scene)`, the number in the full model, from the reference.
        unit: unit of both.
    """

    formula: Callable[[PaperCase], Any]
    truth: Callable[[Scene], Any]
    unit: str

    def value(self, scene: Scene) -> Any:
        """Return the approximate number as an mpf in `unit`.

        Raises:
            InputError: the scene is outside the domain.
        """
        self.check(scene)
        return self.formula(PaperCase.of_scene(scene))
