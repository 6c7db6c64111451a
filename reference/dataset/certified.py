"""`certified.txt`: inputs, values, bounds and how to score, on a page for people in the manner of NIST StRD."""

from __future__ import annotations

from ..scenes.scene import LEVELS
from .manifest import Manifest
from .sheets import GRID_HEADER, Sheet

MEANING = dict(
    zip(
        LEVELS,
        (
            "One run; its error is estimated, not checked.",
            "Two runs with different precisions, tolerances and steps agree to every printed digit.",
            "Two runs in different formulations, precisions and tolerances agree to every printed digit.",
            "A proof encloses every printed digit (interval arithmetic, rounding included).",
        ),
        strict=True,
    )
)
_GRAVITY = {
    "ellipsoid": "gravity g points along the ellipsoid's normal, the centrifugal force is explicit.",
    "effective": "gravity g is effective: it points along the plumb line and contains the centrifugal force there.",
}


def certified_page(manifest: Manifest, grid: Sheet, transits: Sheet | None) -> str:
    """Return the page that belongs to a manifest and its tables; values are called certified if they are proven."""
    return "\n".join([*_inputs(manifest), *_states(manifest, grid), *_accuracy(manifest, transits), *_how_to(manifest)])


def _inputs(manifest: Manifest) -> list[str]:
    rows = [
        f"  {section + '.' + key:26} {value}"
        for section, table in manifest.scene.items()
        for key, value in table.items()
    ]
    return [
        f"Foucault pendulum reference: {manifest.id}",
        manifest.title,
        *([f"Source: {manifest.source}"] if manifest.source else []),
        "",
        f"Level: {manifest.level}. {MEANING[manifest.level]}",
        f"Inputs are read as: {manifest.inputs}",
        *(["Why it is hard:"] if manifest.flags else []),
        *(f"  {flag}: {manifest.notes[flag]}" for flag in manifest.flags),
        "",
        "Inputs (SI units, angles in degrees)",
        *rows,
        "",
        "Model: full Lagrangian of the Foucault pendulum (Mathar), axes x east, y north, z up, origin at the",
        f"suspension; {_GRAVITY[manifest.scene['site']['gravity_is']]}",
        "",
    ]


def _states(manifest: Manifest, grid: Sheet) -> list[str]:
    first, last = grid.rows[0], grid.rows[-1]
    width = max(len(text) for row in (first, last) for text in row[1:])
    word = "Certified state" if manifest.level == "enclosed" else "State"
    lines = []
    for title, row in ((f"State at t = {first[0]} s", first), (f"{word} at t = {last[0]} s", last)):
        numbers = zip(GRID_HEADER[1:], row[1:], strict=True)
        lines += [title, *(f"  {name:3} {value:>{width}}" for name, value in numbers), ""]
    return lines


def _accuracy(manifest: Manifest, transits: Sheet | None) -> list[str]:
    bounds, count = manifest.bounds, manifest.counts.transits
    lines = [
        f"Bound on every position {bounds.position_m} m, on every velocity {bounds.velocity_m_s} m/s",
        "  by column: " + ", ".join(f"{name} {bound}" for name, bound in bounds.grid.items()),
        "",
        f"Transits (xdot = 0, t > 0): {count} ({manifest.transits})",
    ]
    if transits is not None and transits.rows:
        ends = (("first", transits.rows[0]), ("last", transits.rows[-1]))
        lines += [f"  {word:5} t = {row[1]} s, direction {row[2]}, bound {row[-1]} s" for word, row in ends]
    if count:
        lines += [f"  largest bound on a time {bounds.transit_s} s"]
    if count and all(check.transit_s is None for check in manifest.cross_checks):
        lines += ["  the proof alone confirms them"]
    return lines + [
        f"  possible transit in [{one.from_s}, {one.to_s}] s ({one.parity} number of zeros): not decided"
        for one in manifest.possible
    ]


def _how_to(manifest: Manifest) -> list[str]:
    return [
        "",
        "How to score: compare your t, x, y, z with grid.csv; grid.binary64.csv holds the nearest doubles,",
        "also as hexfloats. A program that reads its inputs as doubles solves the problem whose inputs are",
        f"read as binary64; this dataset reads them as {manifest.inputs}.",
        "",
    ]
