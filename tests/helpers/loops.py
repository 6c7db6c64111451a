"""Loops as people write them: a linear pendulum in Python, JavaScript, C and Perl, with the order of their statements."""

# ruff: noqa: E501

from __future__ import annotations

import math
import random
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reference import Scene, load_scene

LANGUAGES = ("Python", "JavaScript", "C", "Perl")
NAMES = [
    "x",
    "y",
    "vx",
    "vy",
    "ax",
    "ay",
    "bx",
    "by",
    "ux",
    "uy",
    "px",
    "py",
    "nx",
    "ny",
    "h",
    "q",
    "f",
    "d",
    "c",
    "kx",
    "ky",
    "lx",
    "ly",
    "mx",
    "my",
    "ox",
    "oy",
]
BOTH = ["ax = -q*x + f*vy - d*vx", "ay = -q*y - f*vx - d*vy"]
KICK, DRIFT = ["vx = vx + h*ax", "vy = vy + h*ay"], ["x = x + h*vx", "y = y + h*vy"]
X_FIRST = ["vx = vx + h*(-q*x + f*vy - d*vx)"]
Y_NEXT = ["vy = vy + h*(-q*y - f*vx - d*vy)"]
SLOPES = [
    "kx = vx", "ky = vy", "lx = -q*x + f*vy - d*vx", "ly = -q*y - f*vx - d*vy",
]  # fmt: skip
# statements of one step, and the word that is true of them
LOOPS: dict[str, tuple[list[str], str]] = {
    "kick_drift": ([*BOTH, *KICK, *DRIFT], "semi_implicit_euler"),
    "drift_kick": ([*DRIFT, *BOTH, *KICK], "semi_implicit_euler_drift"),
    "in_turn": ([*X_FIRST, *Y_NEXT, *DRIFT], "in_turn"),
    "in_turn_y_first": ([*Y_NEXT, *X_FIRST, *DRIFT], "in_turn"),
    "drift_in_turn": ([*DRIFT, *X_FIRST, *Y_NEXT], "in_turn_drift"),
    "axis_by_axis": ([*X_FIRST, "x = x + h*vx", *Y_NEXT, "y = y + h*vy"], "in_turn"),
    "explicit": (["ux = vx", "uy = vy", *BOTH, *KICK, "x = x + h*ux", "y = y + h*uy"], "explicit_euler"),
    "leapfrog": ([*BOTH, "vx = vx + h/2*ax", "vy = vy + h/2*ay", *DRIFT, *BOTH, "vx = vx + h/2*ax", "vy = vy + h/2*ay"], "leapfrog"),
    "verlet": (
        [*BOTH, "x = x + h*vx + h*h/2*ax", "y = y + h*vy + h*h/2*ay", "bx = -q*x + f*vy - d*vx", "by = -q*y - f*vx - d*vy",
         "vx = vx + h/2*(ax + bx)", "vy = vy + h/2*(ay + by)"],
        "leapfrog",
    ),
    "midpoint": (
        [*SLOPES, "mx = vx + h/2*lx", "my = vy + h/2*ly", "px = x + h/2*kx", "py = y + h/2*ky",
         "nx = -q*px + f*my - d*mx", "ny = -q*py - f*mx - d*my", "x = x + h*mx", "y = y + h*my", "vx = vx + h*nx", "vy = vy + h*ny"],
        "rk2",
    ),
}  # fmt: skip
FINE = {"explicit": (3000, 6000), "midpoint": (80, 400)}


@dataclass(frozen=True)
class Loop:
    """A program: its name, language and source, its scene, and what is true of it."""

    name: str
    language: str
    source: str
    scene: Scene
    true: set[str]
    needed: set[str]

    def rows(self, folder: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Return times and columns that it prints."""
        path = (
            folder
            / {"Python": "a.py", "JavaScript": "a.js", "C": "a.c", "Perl": "a.pl"}[self.language]
        )
        path.write_text(self.source)
        command = [
            sys.executable
            if self.language == "Python"
            else shutil.which({"JavaScript": "node", "Perl": "perl"}.get(self.language, "")) or "",
            str(path),
        ]
        if self.language == "C":
            binary = folder / "a.out"
            subprocess.run(
                [shutil.which("cc") or "cc", "-O1", "-o", str(binary), str(path), "-lm"], check=True
            )
            command = [str(binary)]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        table = np.loadtxt(text.splitlines(), delimiter=",", skiprows=1)
        return table[:, 0], {"x": table[:, 1].copy(), "y": table[:, 2].copy()}


def drawn_loop(draw: random.Random, language: str) -> Loop:
    """Return a loop drawn at random."""
    name = draw.choice(list(LOOPS))
    body, word = LOOPS[name]
    length = draw.choice((67.0, 20.0, 10.0, 2.5, 1.0))
    latitude = draw.choice((48.85, 50.0, 35.7, -33.9, 60.0, 45.0))
    rate = draw.choice((7.292115e-5, 7.292115e-5, 7.292115e-5, 0.01))
    x0, y0 = draw.choice(((0.01, 0.0), (0.005, 0.004), (0.006, -0.003)))
    x0, y0 = round(x0 * length, 4), round(y0 * length, 4)
    g = draw.choice((9.81, 9.80665, 9.8))
    period = 2 * math.pi * math.sqrt(length / g)
    out = float(f"{period / draw.uniform(6, 40):.2g}")
    low, high = FINE.get(name, (100, 1500))
    every = max(1, round(out / (period / draw.uniform(low, high))))
    rows = draw.randrange(200, 600)
    true = {"linear_g", "no_centrifugal", f"integrator_{word}"}
    damping = 1.0
    if draw.random() < 0.15:
        damping = draw.choice((0.9999, 0.99999, 0.999999))
        body = [*body, "vx = vx*c", "vy = vy*c"]
        true |= {"pendulum.drag", "damped_steps"}
    used_rate = rate
    if draw.random() < 0.25:
        used_rate = 2 * math.pi / 86400 if rate < 1e-3 else rate
        if used_rate != rate:
            true.add("solar_day")
    scene = load_scene("paris", [
        f"pendulum.length={length}", f"site.latitude={latitude}", f"site.rotation_rate={rate}", f"site.gravity={g}",
        "site.gravity_is=effective", f"release.x={x0}", f"release.y={y0}", f"run.t_end={out * rows!r}", "run.transits=false",
        "inputs=binary64",
    ])  # fmt: skip
    f = 2 * used_rate * math.sin(math.radians(latitude))
    values = {
        "x": x0,
        "y": y0,
        "vx": 0.0,
        "vy": 0.0,
        "h": out / every,
        "q": g / length,
        "f": f,
        "d": 0.0,
        "c": damping,
    }
    source = source_of(language, body, values, out, every, rows)
    needed = true - {"solar_day", "damped_steps"}
    return Loop(name, language, source, scene, true, {f"integrator_{word}"} & needed)


def source_of(
    language: str, body: list[str], values: dict[str, float], out: float, every: int, rows: int
) -> str:
    start = [f"{name} = {value!r}" for name, value in values.items()]
    if language == "Python":
        inner = "\n".join(f"        {line}" for line in body)
        first = "\n".join(start)
        return f"{first}\nprint('t,x,y')\nfor i in range({rows + 1}):\n    print(repr(i*{out!r}), repr(x), repr(y), sep=',')\n    for j in range({every}):\n{inner}\n"
    names = ", ".join(name for name in NAMES if name not in values)
    if language == "JavaScript":
        first = "; ".join(f"let {line}" for line in start)
        return f"let {names};\n{first};\nconsole.log('t,x,y');\nfor (let i = 0; i <= {rows}; i++) {{\nconsole.log(`${{i*{out!r}}},${{x}},${{y}}`);\nfor (let j = 0; j < {every}; j++) {{\n{'; '.join(body)};\n}}\n}}\n"
    if language == "C":
        first = "; ".join(f"double {line}" for line in start)
        return f'#include <stdio.h>\nint main(void) {{\ndouble {names};\n{first};\nprintf("t,x,y\\n");\nfor (int i = 0; i <= {rows}; i++) {{\nprintf("%.17g,%.17g,%.17g\\n", i*{out!r}, x, y);\nfor (int j = 0; j < {every}; j++) {{\n{"; ".join(body)};\n}}\n}}\nreturn 0; }}\n'

    def perl(line: str) -> str:
        return re.sub(r"\b([a-z]{1,2})\b", r"$\1", line)

    first = ";\n".join(f"${line}" for line in start)
    inner = ";\n".join(perl(line) for line in body)
    return f'{first};\nprint "t,x,y\\n";\nfor (my $i = 0; $i <= {rows}; $i++) {{\nprintf("%.17g,%.17g,%.17g\\n", $i*{out!r}, $x, $y);\nfor (my $j = 0; $j < {every}; $j++) {{\n{inner};\n}}\n}}\n'
