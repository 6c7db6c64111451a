"""Programs with an integrator whose error has no name: SciPy's solvers at loose tolerances, beside typed mistakes.

The equations are written here once more, in Cartesian coordinates; they share nothing with the project.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from reference import Scene, load_scene

METHODS = ("RK45", "RK45", "RK45", "LSODA", "DOP853", "RK23")
TOLERANCES = (1e-3, 1e-3, 1e-4, 1e-5, 1e-6)
LENGTHS_M = (67.0, 60.0, 20.0, 10.0, 2.0, 1.0)
LATITUDES = (48.85, 60.0, 45.0, 35.5, -33.0)
GRAVITIES = (9.81, 9.8, 9.80665)
RADIUS_M = 6378137.0
FLATTENING = 1 / 298.257223563


@dataclass
class Loose:
    """A program: its scene, the numbers and choices it uses, and the words that are true of it.

    `lift` is a factor of the vertical centrifugal force, `suspension` are factors of its parts to the north and upward
    at the suspension alone; `changes` is whether the force changes along the swing.
    """

    scene: Scene
    times: np.ndarray
    l: float  # noqa: E741
    g: float
    latitude: float
    rate: float
    start: tuple[float, float]
    method: str
    rtol: float
    model: str = "sphere"
    gravity: str = "ellipsoid"
    lift: float = 1.0
    suspension: tuple[float, float] = (1.0, 1.0)
    changes: bool = True
    coriolis: float = 1.0
    stars: float = 0.0
    drag: float = 0.0
    true: set[str] = field(default_factory=lambda: {"integrator_loose"})

    @property
    def name(self) -> str:
        """What it is, in a word."""
        return "-".join([self.method, f"{self.rtol:g}", self.model, *sorted(self.true)])

    def acceleration(self, r: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return all forces but the cord's, per mass."""
        phi = math.radians(self.latitude)
        omega = self.rate * np.array([0.0, math.cos(phi), math.sin(phi)])
        force = np.array([0.0, 0.0, -self.g]) - 2 * self.coriolis * np.cross(omega, v)
        force -= self.drag * v
        centrifugal = np.zeros(3)
        if self.gravity != "none" and self.changes:
            centrifugal -= np.cross(omega, np.cross(omega, r))
        if self.gravity == "ellipsoid":
            e2 = FLATTENING * (2 - FLATTENING)
            axis = RADIUS_M / math.sqrt(1 - e2 * math.sin(phi) ** 2) * math.cos(phi)
            by_north, by_up = self.suspension
            outward = np.array([0.0, -math.sin(phi) * by_north, math.cos(phi) * by_up])
            centrifugal += self.rate**2 * axis * outward
        return np.asarray(force + centrifugal * [1.0, 1.0, self.lift])

    def rates(self, _: float, state: np.ndarray) -> np.ndarray:
        """Return the derivative of a state."""
        if self.model == "linear":
            up = self.rate * math.sin(math.radians(self.latitude))
            x, y, vx, vy = state
            ax = -self.g / self.l * x + 2 * self.coriolis * up * vy - self.drag * vx
            ay = -self.g / self.l * y - 2 * self.coriolis * up * vx - self.drag * vy
            return np.array([vx, vy, ax, ay])
        r, v = state[:3], state[3:]
        force = self.acceleration(r, v)
        return np.concatenate([v, force - r * (v @ v + r @ force) / self.l**2])

    def rows(self) -> dict[str, np.ndarray]:
        """Return what it prints."""
        x, y = self.start
        turn = self.stars * self.coriolis * self.rate * math.sin(math.radians(self.latitude))
        vx, vy = turn * y, -turn * x
        state = [x, y, vx, vy]
        if self.model == "sphere":
            z = -math.sqrt(self.l**2 - x * x - y * y)
            state = [x, y, z, vx, vy, -(x * vx + y * vy) / z]
        solved: Any = solve_ivp(
            self.rates,
            (0.0, float(self.times[-1])),
            state,
            method=self.method,
            t_eval=self.times,
            rtol=self.rtol,
            atol=min(self.rtol, 1e-6),
        )
        return {"x": solved.y[0].copy(), "y": solved.y[1].copy()}


Change = Callable[[Loose], None]


def _mistake(word: str, **fields: Any) -> Change:
    def change(made: Loose) -> None:
        vars(made).update(fields)
        made.true.add(word)

    return change


def _hemisphere(made: Loose) -> None:
    made.latitude = -made.latitude
    made.true.add("hemisphere")


def _gravity(made: Loose) -> None:
    others = [g for g in (9.81, 9.8, 9.80665, 9.82) if g != made.g]
    made.g = others[int(made.l) % len(others)]
    made.true.add("site.gravity")


def _linear(made: Loose) -> None:
    made.model = "linear"
    made.gravity = "none"
    made.true |= {"linear_g", "no_centrifugal"}


MISTAKES: dict[str, tuple[Change, ...]] = {
    "gravity": (
        _linear, _linear, _mistake("no_centrifugal", gravity="none"),
        _mistake("effective_gravity", gravity="effective"),
    ),
    "rate": (_mistake("solar_day", rate=2 * math.pi / 86400), _mistake("rounded_rate", rate=7.29e-5)),
    "coriolis": (_mistake("coriolis_half", coriolis=0.5), _mistake("coriolis_sign", coriolis=-1.0), _hemisphere),
    "release": (_mistake("inertial_rest", stars=1.0),),
    "g": (_gravity,),
    "drag": (_mistake("pendulum.drag", drag=2e-4),),
}  # fmt: skip


def drawn_loose(draw: random.Random) -> Loose:
    """Return a program drawn at random: one with a typed mistake or two, sometimes with none."""
    length = draw.choice(LENGTHS_M)
    latitude = draw.choice(LATITUDES)
    g = draw.choice(GRAVITIES)
    reach = length * draw.choice((0.003, 0.01, 0.05, 0.2, 0.5))
    azimuth = draw.choice((0.0, 0.4, 0.9, math.pi / 2))
    x, y = round(reach * math.cos(azimuth), 4), round(reach * math.sin(azimuth), 4)
    period = 2 * math.pi * math.sqrt(length / g)
    out = float(f"{period / draw.choice((3.1, 8, 15, 30)):.2g}")
    rows = draw.randrange(250, 700)
    scene = load_scene("paris", [
        f"pendulum.length={length}", f"site.latitude={latitude}", f"site.gravity={g}", f"release.x={x}",
        f"release.y={y}", f"run.t_end={out * rows!r}", "run.transits=false", "inputs=binary64",
    ])  # fmt: skip
    times = out * np.arange(rows)
    made = Loose(
        scene,
        times,
        length,
        g,
        latitude,
        7.292115e-5,
        (x, y),
        draw.choice(METHODS),
        draw.choice(TOLERANCES),
    )
    count = draw.choice((0, 1, 1, 2, 2))
    for group in draw.sample(list(MISTAKES), count):
        draw.choice(MISTAKES[group])(made)
    return made
