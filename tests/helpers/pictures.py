"""The pictures in docs/ that are drawn from numbers: python tests/helpers/pictures.py (make studies does it too)."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from places import ROOT

TURNING, CHART, AZIMUTH = "docs/turning.svg", "docs/error_time.svg", "docs/azimuth.svg"
STUDY = "docs/studies/paris.json"
HOURS, SIDEREAL, LATITUDE = 6, 15.0410671786, 48.846111  # °/h, degrees
SHOWN = {  # method and formulation in the study, and the name in the chart
    ("rk4", "plane"): "RK4",
    ("scipy_dop853", "space"): "SciPy DOP853",
    ("cvode_c_adams", "momentum"): "CVODE Adams",
    ("gsl_rk8pd", "space"): "GSL rk8pd",
    ("rkng67", "plane"): "RKN-G 6(7)",
    ("heyoka_double", "momentum"): "heyoka",
}
# on a light and on a dark page
COLOURS = {
    "blue": ("#0a66c2", "#6cb2ff"),
    "orange": ("#c2410c", "#ff9d6c"),
    "green": ("#00785a", "#3fd0a4"),
    "purple": ("#9b3a78", "#eb9fce"),
    "brown": ("#8a6100", "#e8c14a"),
    "grey": ("#4a4a4a", "#c8c8c8"),
}
ROOM = 11  # pixels from a grid line to the middle of a name that does not touch it


def _style() -> str:
    light = "\n".join(_coloured(name, colours[0]) for name, colours in COLOURS.items())
    dark = "\n".join(_coloured(name, colours[1]) for name, colours in COLOURS.items())
    return f"""<style>
text {{ font: 16px sans-serif; fill: #222 }} .small {{ font-size: 14px }}
.axis {{ stroke: #888; fill: none }} .grid {{ stroke: #888; stroke-opacity: 0.3; fill: none }}
.line {{ fill: none; stroke-width: 2 }} .faint {{ fill: #5c5c5c }} .worse {{ stroke-dasharray: 2 4 }}
.ink {{ fill: #222; stroke: #222 }} .dashed {{ stroke-dasharray: 5 4 }}
{light}
@media (prefers-color-scheme: dark) {{
text {{ fill: #ddd }} .faint {{ fill: #a4a4a4 }} .ink {{ fill: #ddd; stroke: #ddd }}
{dark}
}}
</style>"""


def _coloured(name: str, colour: str) -> str:
    return f".{name} {{ stroke: {colour} }} text.{name}, .dot.{name} {{ fill: {colour}; stroke: none }}"


def turning() -> str:
    """Return the swing plane hour by hour: of the reference, and of a program that gives degrees to its sine."""
    right = -SIDEREAL * math.sin(math.radians(LATITUDE))
    wrong = -SIDEREAL * math.sin(LATITUDE)
    parts = [
        *_plane(150, "blue", "in Paris", right, f"sin {LATITUDE}°"),
        *_plane(490, "orange", "a wrong program", wrong, f"sin({LATITUDE}), in radians"),
        *_compass(322, 110),
    ]
    title = (
        "The swing plane seen from above, hour by hour: in Paris, and by a program that turns it "
        "the other way"
    )
    return _svg(640, 348, title, parts)


def _plane(x: float, colour: str, title: str, rate: float, sine: str) -> Iterable[str]:
    """Yield the plane at each full hour about (x, 170), released to the east, north up; stronger with time."""
    yield f'<text class="{colour}" x="{x}" y="24" text-anchor="middle">{title}</text>'
    for hour in range(HOURS + 1):
        angle = math.radians(rate * hour)
        dx = 110 * math.cos(angle)
        dy = -110 * math.sin(angle)
        opacity = 0.3 + 0.7 * hour / HOURS
        start = f"M{x - dx:.1f} {170 - dy:.1f}"
        yield (
            f'<path class="line {colour}" stroke-opacity="{opacity:.2f}" '
            f'd="{start}L{x + dx:.1f} {170 + dy:.1f}"/>'
        )
        place = f'x="{x + 1.13 * dx:.1f}" y="{175 + 1.13 * dy:.1f}"'
        yield f'<text class="small" {place} text-anchor="middle">{hour} h</text>'
    sense = "clockwise" if rate < 0 else "anticlockwise"
    speed = f"{abs(rate):.1f}° an hour, {sense}"
    yield f'<text x="{x}" y="314" text-anchor="middle">{speed}</text>'
    yield f'<text class="small faint" x="{x}" y="336" text-anchor="middle">{sine}</text>'


def _compass(x: float, y: float) -> Iterable[str]:
    """Yield two arrows from (x, y), to the north and to the east."""
    yield f'<path class="axis" d="M{x} {y}v-40m-4 8l4 -8l4 8M{x} {y}h26m-8 -4l8 4l-8 4"/>'
    yield f'<text class="small" x="{x}" y="{y - 46}" text-anchor="middle">N</text>'
    yield f'<text class="small" x="{x + 31}" y="{y + 5}">E</text>'
    yield f'<text class="small faint" x="{x + 4}" y="{y + 26}" text-anchor="middle">from above</text>'


@dataclass(frozen=True)
class LogarithmicAxis:
    """A logarithmic axis: powers of ten at its ends, pixels at its ends, and its ticks with their names."""

    powers: tuple[float, float]
    pixels: tuple[float, float]
    ticks: Mapping[float, str]

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        first, last = self.powers
        part = (math.log10(value) - first) / (last - first)
        return self.pixels[0] + part * (self.pixels[1] - self.pixels[0])


TIMES = LogarithmicAxis(
    (-2.5, 2.0), (86, 610), {0.01: "10 ms", 0.1: "100 ms", 1: "1 s", 10: "10 s", 100: "100 s"}
)
ERRORS = LogarithmicAxis(
    (-13, 0), (364, 44), {1: "1 m", 1e-3: "1 mm", 1e-6: "1 µm", 1e-9: "1 nm", 1e-12: "1 pm"}
)


def chart(rows: Iterable[Mapping[str, Any]]) -> str:
    """Return error against CPU time of some methods of the study of Paris, on logarithmic axes."""
    measured = [row for row in rows if row["status"] == "ok"]
    parts = list(_axes())
    for colour, (shown, name) in zip(COLOURS, SHOWN.items(), strict=True):
        # in the order of the settings, as the study has them, each finer than the one before
        ladder = [row for row in measured if (row["method"], row["formulation"]) == shown]
        parts += _ladder(ladder, colour, name)
    title = "Position error against CPU time of six integrators, a day of the Paris pendulum"
    return _svg(640, 430, title, parts)


def _axes() -> Iterable[str]:
    left, right = TIMES.pixels
    bottom, top = ERRORS.pixels
    yield f'<text x="{left}" y="24">24 h of the Paris pendulum, in double precision</text>'
    for error, name in ERRORS.ticks.items():
        y = ERRORS(error)
        yield f'<path class="grid" d="M{left} {y:.1f}H{right}"/>'
        yield f'<text class="small" x="{left - 8}" y="{y + 5:.1f}" text-anchor="end">{name}</text>'
    for time, name in TIMES.ticks.items():
        x = TIMES(time)
        yield f'<path class="axis" d="M{x:.1f} {bottom}v6"/>'
        yield f'<text class="small" x="{x:.1f}" y="{bottom + 22}" text-anchor="middle">{name}</text>'
    yield f'<path class="axis" d="M{left} {top}V{bottom}H{right}"/>'
    across = (left + right) / 2
    up = (top + bottom) / 2
    yield f'<text x="{across:.0f}" y="{bottom + 50}" text-anchor="middle">CPU time</text>'
    yield (
        f'<text transform="translate(20 {up:.0f}) rotate(-90)" text-anchor="middle">'
        "largest position error</text>"
    )
    y = (ERRORS(1) + ERRORS(1e-3)) / 2
    note = "a finer tolerance, a larger error"
    start = right - 8 * len(note) - 40
    yield f'<path class="line grey worse" d="M{start} {y:.1f}h32"/>'
    yield f'<text class="small faint" x="{start + 40}" y="{y + 5:.1f}">{note}</text>'


def _ladder(rows: Sequence[Mapping[str, Any]], colour: str, name: str) -> Iterable[str]:
    """Yield a method's points, its line, and its name at the end; dotted where a finer setting is worse."""
    for coarse, fine in itertools.pairwise(rows):
        worse = " worse" if fine["error_m"] > coarse["error_m"] else ""
        yield f'<path class="line {colour}{worse}" d="M{_place(coarse)}L{_place(fine)}"/>'
    for row in rows:
        x, y = _place(row).split()
        yield f'<circle class="dot {colour}" cx="{x}" cy="{y}" r="3"/>'
    x = TIMES(rows[-1]["cpu_s"]) + 8
    y = _off_the_grid(ERRORS(rows[-1]["error_m"])) + 5
    yield f'<text class="small {colour}" x="{x:.1f}" y="{y:.1f}">{name}</text>'


def _place(row: Mapping[str, Any]) -> str:
    return f"{TIMES(row['cpu_s']):.1f} {ERRORS(row['error_m']):.1f}"


def _off_the_grid(y: float) -> float:
    """Return y, or the y above the grid line that a name at y would touch."""
    for error in ERRORS.ticks:
        line = ERRORS(error)
        if abs(y - line) < ROOM:
            return line - ROOM
    return y


def azimuth(degrees: float = 55.0) -> str:
    """Return a bob from above, pulled to this azimuth, with its azimuth and its compass bearing."""
    x, y = 150.0, 160.0
    bob_x, bob_y = _on_circle(x, y, 100, degrees)
    parts = [
        f'<path class="axis" d="M40 {y}H266m-8 -5l8 5l-8 5M{x} 205V40m-5 8l5 -8l5 8"/>',
        f'<text class="small" x="272" y="{y + 5}">east, x</text>',
        f'<text class="small" x="{x}" y="30" text-anchor="middle">north, y</text>',
        f'<path class="line ink" d="M{x} {y}L{bob_x:.1f} {bob_y:.1f}"/>',
        f'<circle class="ink" cx="{bob_x:.1f}" cy="{bob_y:.1f}" r="8"/>',
        *_arc(x, y, 48, "blue", 0, degrees),
        *_arc(x, y, 70, "orange dashed", 90, degrees),
        '<text class="small blue" x="202" y="140">azimuth</text>',
        '<text class="small orange" x="142" y="84" text-anchor="end">bearing</text>',
        '<text x="370" y="60">seen from above</text>',
        '<text class="blue" x="370" y="94">azimuth</text><text x="450" y="94">east to north</text>',
        '<text class="orange" x="370" y="120">bearing</text><text x="450" y="120">north to east</text>',
        '<text x="370" y="164">azimuth = 90° − bearing</text>',
    ]
    title = "Seen from above, the azimuth counts from east to north, a compass bearing from north to east."
    return _svg(600, 220, title, parts)


def _arc(
    x: float, y: float, radius: float, classes: str, start: float, end: float
) -> Iterable[str]:
    """Yield an arc about (x, y) between azimuths, with an arrow head that ends short of the second."""
    short = math.degrees(4 / radius)
    turn = math.copysign(1, end - start)
    tip = end - turn * short
    neck = tip - turn * math.degrees(8 / radius)
    first_x, first_y = _on_circle(x, y, radius, start)
    neck_x, neck_y = _on_circle(x, y, radius, neck)
    sweep = 0 if turn > 0 else 1
    yield (
        f'<path class="line {classes}" d="M{first_x:.1f} {first_y:.1f}'
        f'A{radius} {radius} 0 0 {sweep} {neck_x:.1f} {neck_y:.1f}"/>'
    )
    corners = [
        _on_circle(x, y, radius, tip),
        _on_circle(x, y, radius - 5, neck),
        _on_circle(x, y, radius + 5, neck),
    ]
    points = " ".join(f"{across:.1f},{down:.1f}" for across, down in corners)
    yield f'<polygon class="dot {classes.split()[0]}" points="{points}"/>'


def _on_circle(x: float, y: float, radius: float, degrees: float) -> tuple[float, float]:
    """Return the point of a circle about (x, y) at an azimuth, north up."""
    angle = math.radians(degrees)
    return x + radius * math.cos(angle), y - radius * math.sin(angle)


def _svg(width: int, height: int, title: str, parts: Iterable[str]) -> str:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    return "\n".join([f'{head} role="img" aria-label="{title}">', _style(), *parts, "</svg>\n"])


def pictures() -> dict[str, str]:
    """Return each picture's path in the project, and its text."""
    study = json.loads((ROOT / STUDY).read_text(encoding="utf-8"))
    return {TURNING: turning(), CHART: chart(study["rows"]), AZIMUTH: azimuth()}


def write() -> None:
    """Write the pictures."""
    for name, text in pictures().items():
        Path(ROOT / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
