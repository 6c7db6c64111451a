"""The two pictures of README, in docs/, written anew: python tests/helpers/pictures.py (make studies does it too)."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path

from places import ROOT

TURNING, CHART, STUDY = "docs/turning.svg", "docs/error_time.svg", "docs/studies/paris.json"
HOURS, SIDEREAL, LATITUDE = 6, 15.0410671786, 48.846111  # °/h, degrees
SHOWN = {  # method and formulation in the study, and the name in the chart
    ("rk4", "plane"): "RK4",
    ("scipy_dop853", "space"): "SciPy DOP853",
    ("cvode_c_adams", "momentum"): "CVODE Adams",
    ("gsl_rk8pd", "space"): "GSL rk8pd",
    ("rkng67", "plane"): "RKN-G 6(7)",
    ("heyoka_double", "space"): "heyoka",
}
STYLE = """<style>
text { font: 16px sans-serif; fill: #222 } .small { font-size: 14px } .axis { stroke: #888; fill: none }
.grid { stroke: #8883; fill: none } .right { stroke: #0a66c2; fill: none; stroke-width: 2 }
.wrong { stroke: #c2410c; fill: none; stroke-width: 2 } text.right { fill: #0a66c2; stroke: none }
text.wrong { fill: #c2410c; stroke: none } .dot { fill: #0a66c2; stroke: none }
@media (prefers-color-scheme: dark) { text { fill: #ddd } .right { stroke: #6cb2ff } .wrong { stroke: #ff9d6c }
text.right, .dot { fill: #6cb2ff } text.wrong { fill: #ff9d6c } }
</style>"""


def turning() -> str:
    """Return the swing plane hour by hour: of the reference, and of a program that gives degrees to its sine."""
    right = -SIDEREAL * math.sin(math.radians(LATITUDE))
    wrong = -SIDEREAL * math.sin(LATITUDE)
    parts = [
        _plane(150, "right", "in Paris", right),
        _plane(450, "wrong", "a program: sin(48.8), in radians", wrong),
    ]
    return _svg(
        600,
        310,
        "The swing plane from above, hour by hour: in Paris, and by a program that turns it wrongly",
        parts,
    )


def _plane(x: float, kind: str, title: str, rate: float) -> str:
    """Return the plane at each full hour about (x, 160), released to the east, north up; paler with time."""
    lines = [f'<text class="{kind}" x="{x}" y="24" text-anchor="middle">{title}</text>']
    for hour in range(HOURS + 1):
        angle = math.radians(rate * hour)
        dx, dy = 110 * math.cos(angle), -110 * math.sin(angle)
        shade = f'opacity="{1 - 0.11 * hour:.2f}"'
        ends = (
            f'x1="{x - dx:.1f}" y1="{160 - dy:.1f}" x2="{x + dx:.1f}" y2="{160 - dy + 2 * dy:.1f}"'
        )
        lines.append(f'<line class="{kind}" {shade} {ends}/>')
        place = f'x="{x + 1.12 * dx:.1f}" y="{164 + 1.12 * dy:.1f}"'
        lines.append(f'<text class="small" {place} text-anchor="middle">{hour} h</text>')
    sense = "clockwise" if rate < 0 else "anticlockwise"
    lines.append(
        f'<text x="{x}" y="300" text-anchor="middle">{abs(rate):.1f}° an hour, {sense}</text>'
    )
    return "\n".join(lines)


def chart(rows: Iterable[Mapping[str, object]]) -> str:
    """Return error against CPU time of some methods of the study of Paris, on logarithmic axes."""
    times, errors, left, top, width, height = (-3.0, 1.0), (-13.0, 0.0), 70, 20, 400, 300

    def place(cpu: float, error: float) -> tuple[float, float]:
        across = (math.log10(cpu) - times[0]) / (times[1] - times[0])
        return left + width * across, top + height * (errors[1] - math.log10(error)) / (
            errors[1] - errors[0]
        )

    parts = []
    for power in range(int(errors[0]), int(errors[1]) + 1, 3):
        y = place(1, 10.0**power)[1]
        parts.append(f'<path class="grid" d="M{left} {y:.1f}h{width}"/>')
        parts.append(
            f'<text class="small" x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">1e{power} m</text>'
        )
    for power in range(int(times[0]), int(times[1]) + 1):
        x = place(10.0**power, 1)[0]
        parts.append(f'<path class="grid" d="M{x:.1f} {top}v{height}"/>')
        parts.append(
            f'<text class="small" x="{x:.1f}" y="{top + height + 22}" text-anchor="middle">1e{power} s</text>'
        )
    parts.append(f'<path class="axis" d="M{left} {top}v{height}h{width}"/>')
    parts.append(
        f'<text x="{left + width / 2}" y="{top + height + 44}" text-anchor="middle">CPU time</text>'
    )
    found = list(rows)
    for (method, formulation), name in SHOWN.items():
        mine = [
            row for row in found if (row["method"], row["formulation"]) == (method, formulation)
        ]
        points = sorted(
            place(row["cpu_s"], row["error_m"]) for row in mine if row["status"] == "ok"
        )  # type: ignore[arg-type]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        parts.append(f'<polyline class="right" points="{line}"/>')
        parts += [f'<circle class="dot" cx="{x:.1f}" cy="{y:.1f}" r="2.5"/>' for x, y in points]
        x, y = points[-1]
        parts.append(f'<text class="small" x="{x + 7:.1f}" y="{y + 4:.1f}">{name}</text>')
    return _svg(
        600,
        376,
        "Position error against CPU time of six integrators, a day of the Paris pendulum",
        parts,
    )


def _svg(width: int, height: int, title: str, parts: Iterable[str]) -> str:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    return "\n".join([f'{head} role="img" aria-label="{title}">', STYLE, *parts, "</svg>\n"])


def pictures() -> dict[str, str]:
    """Return each picture's path in the project, and its text."""
    study = json.loads((ROOT / STUDY).read_text(encoding="utf-8"))
    return {TURNING: turning(), CHART: chart(study["rows"])}


def write() -> None:
    """Write the pictures."""
    for name, text in pictures().items():
        Path(ROOT / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
