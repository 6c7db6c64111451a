"""`certified.txt`: inputs, certified values and how to score, on a page for people in the manner of NIST StRD."""

from __future__ import annotations

from ..precision import outward
from ..scene import LEVELS
from ..solver.solution import Solution
from .manifest import Bounds
from .sheets import GRID_HEADER, Sheet, scene_inputs

_MEANING = dict(
    zip(
        LEVELS,
        (
            "One run; its error is estimated, not checked.",
            "Two runs at different precisions and tolerances agree to every printed digit.",
            "Two runs in different formulations, precisions and tolerances agree to every printed digit.",
            "A proof encloses every printed digit (interval arithmetic, rounding included).",
        ),
        strict=True,
    )
)


def certified_page(solution: Solution, grid: Sheet, transits: Sheet, bounds: Bounds, completeness: str) -> str:
    """Return the page: inputs, first and last state, bounds, number of transits, how to score."""
    accuracy = [*_accuracy(bounds, transits, completeness), *_undecided(solution)]
    return "\n".join([*_inputs(solution), *_states(grid), *accuracy, *_how_to(solution)])


def _inputs(solution: Solution) -> list[str]:
    scene = solution.scene
    rows = [
        f"  {section + '.' + key:26} {value}"
        for section, table in scene_inputs(scene).items()
        for key, value in table.items()
    ]
    return [
        f"Foucault pendulum reference: {scene.id}",
        scene.title,
        *([f"Source: {scene.source}"] if scene.source else []),
        "",
        f"Level: {solution.level}. {_MEANING[solution.level]}",
        f"Inputs are read as: {scene.inputs}",
        *([f"Why it is hard: {', '.join(scene.flags)}"] if scene.flags else []),
        "",
        "Inputs (SI units, angles in degrees)",
        *rows,
        "",
        "Model: full Lagrangian of the Foucault pendulum (Mathar), axes x east, y north, z up, origin at the",
        "suspension; gravity g points along the ellipsoid's normal, the centrifugal force is explicit.",
        "",
    ]


def _states(grid: Sheet) -> list[str]:
    first, last = grid.rows[0], grid.rows[-1]
    width = max(len(text) for row in (first, last) for text in row[1:])
    lines = []
    for title, row in ((f"State at t = {first[0]} s", first), (f"Certified state at t = {last[0]} s", last)):
        numbers = zip(GRID_HEADER[1:], row[1:], strict=True)
        lines += [title, *(f"  {name:3} {value:>{width}}" for name, value in numbers), ""]
    return lines


def _accuracy(bounds: Bounds, transits: Sheet, completeness: str) -> list[str]:
    lines = [
        f"Bound on every position {bounds.position_m} m, on every velocity {bounds.velocity_m_s} m/s",
        "",
        f"Transits (xdot = 0, t > 0): {len(transits.rows)} ({completeness})",
    ]
    if transits.rows:
        ends = (("first", transits.rows[0]), ("last", transits.rows[-1]))
        lines += [f"  {word:5} t = {row[1]} s, direction {row[2]}, bound {row[-1]} s" for word, row in ends]
        lines += [f"  largest bound on a time {bounds.transit_s} s"]
    return lines


def _undecided(solution: Solution) -> list[str]:
    return [
        f"  possible transit in [{outward(low, -1)}, {outward(high, 1)}] s ({parity} number of zeros): not decided"
        for low, high, parity in solution.possible
    ]


def _how_to(solution: Solution) -> list[str]:
    return [
        "",
        "How to score: compare your t, x, y, z with grid.csv; grid.binary64.csv holds the nearest doubles,",
        "also as hexfloats. A program that reads its inputs as doubles solves the problem whose inputs are",
        f"read as binary64; this dataset reads them as {solution.scene.inputs}.",
        "",
    ]
