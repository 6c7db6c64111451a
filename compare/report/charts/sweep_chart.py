"""Picture of a sweep, as a file: curves over one field, heat maps over two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    "frequency_hz": "frequency of the transits in Hz",
    "swing_hz": "frequency of the swing in Hz",
    "precession_deg_per_h": "precession in °/h, east to north",
    "precession_ratio": "precession over −Ω sin(latitude)",
    "max_angle_deg": "largest angle in °",
    "position_error_m": "error of the position in m",
}
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
    check_target(path)
    shape = request.table.shape
    if request.table.typed is None or len(shape) > 2 or not _numeric(request):
        raise InputError(
            "--plot", str(path), "one or two fields varied by --over, both numbers", "Or draw the columns."
        )
    if not _drawn(request):
        raise InputError("--plot", str(path), "--want with frequency or precession")


def draw(swept: Swept, path: Path) -> None:
    """Draw frequency and precession of a sweep, those of them that were wanted, into a file."""
    request = swept.request
    keys = request.table.keys
    columns = swept.columns([*keys, *_drawn(request)])
    axes = []
    for place, key in enumerate(keys):
        grid = columns[key].reshape(request.table.shape)
        axes.append((key, np.moveaxis(grid, place, 0).reshape(grid.shape[place], -1)[:, 0]))
    title = f"{request.scene.id}, {float(request.scene.exact.t_end):g} s"
    sweep_picture(title, axes, {name: columns[name] for name in _drawn(request)}, path)


def _numeric(request: Request) -> bool:
    from reference.sweeps.axes import TEXTS

    return not set(request.table.keys) & set(TEXTS)


def _drawn(request: Request) -> list[str]:
    names = [column.name for column in request.columns]
    return [name for name in ("swing_hz", "precession_deg_per_h") if name in names]


def sweep_picture(title: str, axes: Sequence[tuple[str, Array]], quantities: Mapping[str, Array], path: Path) -> None:
    """Draw quantities over one or two varied fields.

    Args:
        title: of the picture.
        axes: one or two fields and their values, increasing or not.
        quantities: columns by name, each with one value a row, the last axis fastest; NaN where there is none.
        path: of the file, which ends in .svg, .png or .pdf.
    """
    draw = _curve if len(axes) == 1 else _map
    with sheet((8, 3.0 * len(quantities) + 0.4) if len(axes) == 1 else (8, 3.6 * len(quantities) + 0.4)) as figure:
        panels = np.atleast_1d(figure.subplots(len(quantities), 1, sharex=True))
        for panel, (name, values) in zip(panels, quantities.items(), strict=True):
            draw(figure, panel, axes, LABELS.get(name, name), np.asarray(values, float))
        panels[-1].set_xlabel(_label(axes[-1][0]))
        panels[0].set_title(title)
        content = picture(figure, path.suffix[1:].lower())
    write_file(path, content, "--plot")


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
