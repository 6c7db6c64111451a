"""Figures 1 and 3 to 9 of Mathar's paper, drawn again from runs of the reference (matplotlib, extra `plot`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reference import load_scene
from reference.precision import Array

from ..approximations import APPROXIMATIONS, Motion
from ..observed.swing_plane import rest_in_metres
from ..position_error import difference, distance
from ..report.charts.drawing import COLOURS, FAINT, picture, sheet
from .digits import degrees, mpf
from .figure_runs import estimate_at, frequencies, orders_at
from .first_principles import rest_angle
from .points import paris
from .runs import paris_path, paris_swing_plane, window

BLUE, RED, GREEN, PINK, *_, BLACK = COLOURS
DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
WINDOWS = (0, 7000, 12000)  # s
WIDE, HIGH = 7.6, 4.0  # inches


def figure_1(figure: Any) -> None:
    """Draw the rest position's angle against latitude, l = 1, 10, 100 m."""
    axes = figure.subplots()
    latitudes = np.linspace(-90, 90, 73)
    for length, colour, dashes in zip((1, 10, 100), (BLUE, RED, GREEN), DASHES, strict=False):
        p = paris().but(length=mpf(length))
        angles = [abs(float(degrees(rest_angle(p.but(latitude=mpf(float(d))))))) for d in latitudes]
        axes.plot(latitudes, angles, color=colour, linestyle=dashes, label=f"l = {length} m")
    axes.set(xlabel="geodetic latitude in °", ylabel="deviation from the vertical in °", xlim=(-90, 90), ylim=(0, None))
    axes.set_xticks(range(-90, 91, 30))
    axes.legend(loc="upper center")


def figure_3(figure: Any) -> None:
    """Draw x and y over 20 s, three times."""
    panels = figure.subplots(1, 3, sharey=True)
    for begin, axes in zip(WINDOWS, panels, strict=True):
        times, states = window(begin, 20)
        axes.plot(times, states[:, 0], color=BLUE, linestyle=DASHES[0], label="x, east")
        axes.plot(times, states[:, 1], color=RED, linestyle=DASHES[1], label="y, north")
        axes.axhline(0, color=FAINT, linewidth=0.5)
        axes.set(xlabel="t in s", xlim=(begin, begin + 20))
        axes.set_xticks([begin + 5, begin + 15])
    panels[0].set_ylabel("position in m")
    _legend_above(figure, panels[0])


def figure_4(figure: Any) -> None:
    """Draw three swings in space and from above."""
    space, above = figure.add_subplot(1, 2, 1, projection="3d"), figure.add_subplot(1, 2, 2)
    rest = rest_in_metres(load_scene("paris"))
    for begin, colour, dashes in zip(WINDOWS, (BLUE, RED, GREEN), DASHES, strict=False):
        _, states = window(begin, 17)
        space.plot(states[:, 0], states[:, 1], 1000 * (states[:, 2] + 67), color=colour, linestyle=dashes)
        above.plot(states[:, 0], states[:, 1], color=colour, linestyle=dashes, label=f"from {begin} s")
    above.plot(rest[0], rest[1], "+", color=BLACK, markersize=10)
    above.set(xlabel="x (east) in m", ylabel="y (north) in m", aspect="equal", xlim=(-0.62, 0.62), ylim=(-0.8, 0.62))
    above.legend(loc="upper left")
    space.set(xlabel="x in m", ylabel="y in m")
    space.text2D(0.98, 0.93, "z + 67 m, in mm", transform=space.transAxes, ha="right")
    space.tick_params(labelsize=8, pad=1)
    space.locator_params(nbins=5)
    space.view_init(elev=22, azim=-65)


def _snapshots() -> tuple[Array, Array]:
    """Return hours and states every 30 s."""
    times, states = paris_path()
    return times / 3600, states


def _day(axes: Any) -> None:
    axes.set(xlabel="t in h", xlim=(0, 24))
    axes.set_xticks(range(0, 25, 3))


def figure_5(figure: Any) -> None:
    """Draw z over a day."""
    axes = figure.subplots()
    hours, states = _snapshots()
    axes.plot(hours, states[:, 2], ".", color=BLUE, markersize=2)
    axes.axhline(states[0, 2], color=RED, linewidth=1, linestyle=DASHES[1])
    axes.annotate(
        f"release, z = {states[0, 2]:.4f} m",
        (13.5, states[0, 2]),
        (13.5, -66.9972),
        color=RED,
        arrowprops={"arrowstyle": "-", "color": RED, "linewidth": 0.6},
        backgroundcolor="white",
    )
    axes.set(ylabel="z in m")
    axes.ticklabel_format(axis="y", useOffset=False)
    _day(axes)


def figure_6(figure: Any) -> None:
    """Draw the azimuth over a day."""
    axes = figure.subplots()
    hours, states = _snapshots()
    axes.plot(hours, np.degrees(np.arctan2(states[:, 1], states[:, 0])), ".", color=BLUE, markersize=2)
    plane = paris_swing_plane()
    for turn in (-1, 0, 1, 2):
        line = np.degrees(plane) + 180 * turn
        axes.plot(hours, np.where(np.abs(line) <= 180, line, np.nan), color=RED, linewidth=1)
    axes.set(ylabel="azimuth λ in ° (east to north)", ylim=(-180, 180))
    axes.set_yticks(range(-180, 181, 60))
    _day(axes)


def figure_7(figure: Any) -> None:
    """Draw x and y after 12000 s: full, without rotation, without the off-diagonal elements, without Ω²."""
    figure.set_figheight(1.35 * HIGH)
    panels = figure.subplots(2, 1, sharex=True)
    times, full = window(12000, 20)
    no_rotation = load_scene("paris", ["site.rotation_rate=0"])
    output_times = np.concatenate(([0.0], times))
    others = (
        ("Ω = 0", GREEN, DASHES[3], window(12000, 20, no_rotation)[1]),
        ("without -yx (item 2)", BLUE, DASHES[1], _path("mathar_item_2", output_times)),
        ("without Ω² (item 1)", RED, DASHES[2], _path("mathar_item_1", output_times)),
    )
    for i, axes in enumerate(panels):
        axes.plot(times, full[:, i], color=PINK, linewidth=2.2, label="full theory")
        for label, colour, dashes, states in others:
            axes.plot(times, states[:, i], color=colour, linestyle=dashes, label=label)
        axes.axhline(0, color=FAINT, linewidth=0.5)
        axes.set(ylabel=f"{'xy'[i]} in m", xlim=(12000, 12020))
    panels[1].set_xlabel("t in s")
    panels[1].set_xticks(range(12000, 12021, 5))
    _legend_above(figure, panels[0])


def _path(name: str, times: Array) -> Array:
    motion = APPROXIMATIONS[name]
    assert isinstance(motion, Motion)
    return motion.trajectory(load_scene("paris"), times)[1:]


def figure_8(figure: Any) -> None:
    """Draw the frequency against latitude."""
    axes = figure.subplots()
    latitudes = np.linspace(-90, 90, 91)
    axes.plot(latitudes, [estimate_at(float(d)) for d in latitudes], color=RED, linewidth=1)
    measured = frequencies()
    axes.plot(list(measured), list(measured.values()), "o", color=BLUE, markersize=4, fillstyle="none")
    axes.annotate(
        "Paris, 0.0608436 Hz",
        (48.846111, estimate_at(48.846111)),
        (12, 0.060868),
        arrowprops={"arrowstyle": "-", "color": FAINT, "linewidth": 0.7},
    )
    axes.set(xlabel="geodetic latitude in °", ylabel="frequency in Hz", xlim=(-93, 93))
    axes.set_xticks(range(-90, 91, 30))
    axes.ticklabel_format(axis="y", useOffset=False)


def figure_9(figure: Any) -> None:
    """Draw three fixed-step methods at steps of 0.5 s after 12000 s."""
    figure.set_figheight(1.35 * HIGH)
    panels = figure.subplots(2, 1, sharex=True)
    times, truth = window(12000, 20, step=0.5)
    smooth, path = window(12000, 20)
    panels[0].plot(smooth, path[:, 0], color=FAINT, linewidth=1, label="reference")
    labels = {"rk4": "-R 4", "rkng56": "-R 5", "rkng67": "-R 6"}
    for (name, states), colour, mark in zip(orders_at(12000, 20, 0.5).items(), (RED, BLUE, GREEN), "osx", strict=True):
        panels[0].plot(times, states[:, 0], mark, color=colour, fillstyle="none", markersize=5, label=labels[name])
        gap = distance(map(difference, states.T[:3], truth.T[:3]))
        panels[1].plot(times, gap, color=colour, marker=mark, fillstyle="none", markersize=5, linewidth=0.7)
    panels[0].set(ylabel="x in m", xlim=(12000, 12020))
    panels[1].set(ylabel="error in m", xlabel="t in s", yscale="log")
    panels[1].set_xticks(range(12000, 12021, 5))
    _legend_above(figure, panels[0])


def _legend_above(figure: Any, axes: Any) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))


FIGURES: dict[int, Callable[[Any], None]] = {
    1: figure_1,
    3: figure_3,
    4: figure_4,
    5: figure_5,
    6: figure_6,
    7: figure_7,
    8: figure_8,
    9: figure_9,
}


def svg(number: int) -> str:
    """Draw a figure as SVG.

    Raises:
        InputError: matplotlib is not installed.
    """
    with sheet((WIDE, HIGH)) as figure:
        FIGURES[number](figure)
        return picture(figure).decode()
