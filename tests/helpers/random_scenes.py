"""Scenes drawn at random: every latitude, amplitude to 3.1 rad, fast and slow planets, a third of them damped."""

from __future__ import annotations

import math
from random import Random
from typing import Any


def random_scene(seed: int) -> dict[str, Any]:
    """Return a scene at the level enclosed: 5 to 120 swings, 15 to 30 digits."""
    rng = Random(seed)
    length = 10 ** rng.uniform(-3, 4)
    latitude = rng.choice(
        [rng.uniform(-90, 90)] * 6 + [0, 90, -90, rng.uniform(-1e-6, 1e-6), 89.999999]
    )
    g = rng.choice([9.80665] * 5 + [1.62, 0.01, 24.8])
    rotation = rng.choice(
        [
            7.292115e-5,
            7.292115e-5,
            0,
            -7.292115e-5,
            10 ** rng.uniform(-4, -0.31),
            -(10 ** rng.uniform(-4, -0.31)),
        ]
    )
    radius: float = 6378137
    if abs(rotation) > 1e-3:  # keep the centrifugal pull below a few g
        radius = rng.choice([0, rng.uniform(0, 3) * g / rotation**2])
    swing = math.sqrt(g / length)
    end = 2 * math.pi / swing * (rng.choice([5, 5, 8, 8, 12, 20, 30]) if seed % 20 else 120)
    drag = rng.choice([0, 0, 0, swing * 10 ** rng.uniform(-5, -0.5), swing * rng.uniform(0.5, 1.5)])
    digits = rng.randint(15, 30)
    document: dict[str, Any] = {
        "id": f"random_{seed}",
        "pendulum": {"length": f"{length:.12g}", "drag": f"{drag:.9g}"},
        "site": {
            "latitude": f"{latitude:.10g}",
            "gravity": f"{g}",
            "rotation_rate": f"{rotation:.9g}",
            "equatorial_radius": f"{radius:.10g}",
            "altitude": f"{rng.choice([0, 0, 1000, -50])}",
            "inverse_flattening": rng.choice(["inf", "298.257223564"]),
        },
        "run": {
            "t_end": f"{end:.9g}",
            "grid_step": f"{end / rng.choice([3, 7.3, 20, 50]):.6g}",
            "digits": digits,
            "level": "enclosed",
        },
    }
    kind = rng.randrange(4)
    angle = rng.choice([10 ** rng.uniform(-4, -0.2)] * 3 + [rng.uniform(0.3, 3.1)])
    if kind == 0 and angle < 1.5:
        azimuth, r = rng.uniform(0, 2 * math.pi), length * math.sin(angle)
        document["release"] = {
            "x": f"{r * math.cos(azimuth):.12g}",
            "y": f"{r * math.sin(azimuth):.12g}",
        }
        if rng.random() < 0.5:
            speed = 0.5 * angle * length * swing
            document["release"] |= {
                "vx": f"{rng.gauss(0, speed):.9g}",
                "vy": f"{rng.gauss(0, speed):.9g}",
            }
    else:
        azimuth = rng.choice([rng.uniform(-180, 180)] * 5 + [0, 90, -90, 180])
        document["release"] = {"angle": f"{math.degrees(angle):.12g}", "azimuth": f"{azimuth:.12g}"}
        if rng.random() < 0.6:
            rates = (
                math.degrees(rng.gauss(0, 0.5) * angle * swing),
                math.degrees(rng.gauss(0, 0.7) * swing),
            )
            document["release"] |= {
                "angle_rate": f"{rates[0]:.9g}",
                "azimuth_rate": f"{rates[1]:.9g}",
            }
    return document
