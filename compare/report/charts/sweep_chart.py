"""Picture of a sweep, as a file: curves over one field, heat maps over two."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

from ..folder import write_file
from .drawing import BLUE, RULE, check_target, picture, sheet

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request

LABELS = {
    "swing_hz": "frequency of the swing in Hz",
    "precession_deg_per_h": "precession in °/h, east to north",
}  # of the columns that are drawn
UNITS = {
    "m": ("length", "altitude", "x", "y", "equatorial_radius"),
    "m/s": ("vx", "vy"),
    "°": ("latitude", "angle", "azimuth"),
    "°/s": ("angle_rate", "azimuth_rate"),
    "s": ("t_end",),
    "1/s": ("drag",),
    "m/s²": ("gravity",),
    "rad/s": ("rotation_rate",),
}  # and the fields that have them
_MARKED = 40  # values up to which a curve's points are marked


def check(request: Request, path: Path) -> None:
    """Refuse a picture that could not be drawn, before any work.

    Raises:
        InputError: a wrong path, other than one or two fields that are numbers, or neither quantity is wanted.
    """
    from reference.sweeps.axes import TEXTS

    check_target(path)
    table = request.table
    if table.typed is None or len(table.shape) > 2 or set(table.values) & set(TEXTS):
        raise InputError(
            "--plot", str(path), "one or two fields varied by --over, both numbers", "Or draw the columns."
        )
    if not _drawn(request):
        raise InputError("--plot", str(path), "--want with frequency or precession")


def draw(swept: Swept, path: Path) -> None:
    """Draw frequency and precession of a sweep, those of them that were wanted, into a file."""
    request = swept.request
    drawn = _drawn(request)
    columns = swept.columns(drawn)
    axes = [(key, np.array(texts, float)) for key, texts in request.table.values.items()]
    draw_panel, height = (_curve, 3.0) if len(axes) == 1 else (_map, 3.6)
    with sheet((8, height * len(drawn) + 0.4)) as figure:
        panels = np.atleast_1d(figure.subplots(len(drawn), 1, sharex=True))
        for panel, name in zip(panels, drawn, strict=True):
            draw_panel(figure, panel, axes, LABELS[name], columns[name])
        panels[-1].set_xlabel(_label(axes[-1][0]))
        panels[0].set_title(f"{request.scene.id}, {float(request.scene.exact.t_end):g} s")
        content = picture(figure, path.suffix[1:].lower())
    write_file(path, content, "--plot")


def _drawn(request: Request) -> list[str]:
    names = [column.name for column in request.columns]
    return [name for name in LABELS if name in names]


def _label(key: str) -> str:
    name = key.rpartition(".")[2]
    unit = next((unit for unit, names in UNITS.items() if name in names), "")
    return name.replace("_", " ") + (f" in {unit}" if unit else "")


def _curve(_: Any, panel: Any, axes: Sequence[tuple[str, Array]], label: str, values: Array) -> None:
    ((_, x),) = axes
    order = np.argsort(x)
    panel.plot(x[order], values[order], color=BLUE, marker="o" if len(x) <= _MARKED else None, markersize=3)
    panel.grid(color=RULE)
    panel.ticklabel_format(axis="y", useOffset=False)
    panel.set_ylabel(label)


def _map(figure: Any, panel: Any, axes: Sequence[tuple[str, Array]], label: str, values: Array) -> None:
    (key, y), (_, x) = axes
    grid = values.reshape(len(y), len(x))[np.ix_(np.argsort(y), np.argsort(x))]
    low, high = np.nanmin(grid, initial=np.inf), np.nanmax(grid, initial=-np.inf)
    signed = low < 0 < high
    most = max(-low, high)
    span = {"vmin": -most, "vmax": most} if signed else {}
    mesh = panel.pcolormesh(
        np.sort(x), np.sort(y), grid, cmap="RdBu_r" if signed else "cividis", **span, rasterized=True
    )
    panel.set_ylabel(_label(key))
    bar = figure.colorbar(mesh, ax=panel, label=label)
    bar.formatter.set_useOffset(False)
