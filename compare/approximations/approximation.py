"""What an approximation declares: where it stands, what it drops, how its error must grow, and how it is computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from reference import InputError, Scene, UnreachableError

Array = npt.NDArray[np.float64]
Against = Literal["amplitude", "rotation_rate", "length"]


@dataclass(frozen=True)
class Order:
    """A statement of theory that `order.measure` puts to the test: error proportional to `against` ** `power`.

    Attributes:
        against: what is varied: the displacement from the point of rest in m, Ω in rad/s, or the length in m.
        power: the exponent; None where the approximation is exact, so that only rounding is left.
        values: the sizes at which the error is measured.
        setting: `section.key=value` replacements that leave this error as the largest.
        amplitude: displacement from the point of rest in m that is kept, released at rest; None: as the scene says.
    """

    against: Against
    power: int | None
    values: tuple[float, ...]
    setting: tuple[str, ...] = ()
    amplitude: float | None = None


@dataclass(frozen=True)
class Printed:
    """How a document prints it, where that differs from the right form.

    Attributes:
        text: as printed.
        right: as it must be.
        compute: the printed form evaluated, with the signature of the right one; None if it has no meaning.
    """

    text: str
    right: str
    compute: Callable[..., Any] | None = None


@dataclass(frozen=True, kw_only=True)
class Approximation:
    """One analytic or truncated model of the seeds.

    Attributes:
        id: its word, the same everywhere.
        title: one line for people.
        where: document and equation numbers.
        domain: amplitude, latitude and time that it is meant for.
        drops: what it leaves out.
        orders: how its error grows.
        refuses: a reason why a scene is outside its domain, or None.
        printed: the form in print, where it is wrong.
    """

    id: str
    title: str
    where: str
    domain: str
    drops: str
    orders: tuple[Order, ...]
    refuses: Callable[[Scene], str | None] = lambda scene: None
    printed: Printed | None = None

    def check(self, scene: Scene) -> None:
        """Raise InputError if the scene is outside the domain in which the formulas have a meaning."""
        reason = self.refuses(scene)
        if reason is not None:
            raise InputError("scene", scene.id, f"a scene that {self.id} applies to", f"{reason}.")


@dataclass(frozen=True, kw_only=True)
class Motion(Approximation):
    """An approximation of the whole motion.

    Attributes:
        path: `path(scene, times)` without checks; see `trajectory`.
        rest: its own point of rest (x, y, z) in m, about which it swings; None for that of the full model.
    """

    path: Callable[[Scene, Array], Array]
    rest: Callable[[Scene], Any] | None = None

    def trajectory(self, scene: Scene, times: npt.ArrayLike) -> Array:
        """The approximate motion.

        Args:
            scene: what to approximate.
            times: increasing, not negative, in s.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6); z is always that of the sphere.

        Raises:
            InputError: the scene is outside the domain, or the times are not increasing from 0 or later.
            UnreachableError: the motion leaves the sphere or the numbers.
        """
        self.check(scene)
        grid = np.asarray(times, dtype=np.float64)
        if grid.ndim != 1 or not len(grid) or grid[0] < 0 or not np.all(np.diff(grid) > 0):
            raise InputError("times", f"{grid.shape} numbers", "increasing times in s, the first not negative")
        rows = self.path(scene, grid) if grid[0] == 0 else self.path(scene, np.insert(grid, 0, 0.0))[1:]
        if not np.isfinite(rows).all():
            raise UnreachableError(f"{self.id} gives no finite motion for {scene.id}.")
        return rows


@dataclass(frozen=True, kw_only=True)
class Quantity(Approximation):
    """An approximation of one number.

    Attributes:
        formula: `formula(scene)`, an mpf, without checks; see `value`.
        truth: what the number is in the full model, from the reference.
        unit: of both.
        relative: whether `orders` speak of the relative error, or of the error in `unit`.
    """

    formula: Callable[[Scene], Any]
    truth: Callable[[Scene], Any]
    unit: str
    relative: bool = True

    def value(self, scene: Scene) -> Any:
        """The approximate number as an mpf in `unit`.

        Raises:
            InputError: the scene is outside the domain.
        """
        self.check(scene)
        return self.formula(scene)
