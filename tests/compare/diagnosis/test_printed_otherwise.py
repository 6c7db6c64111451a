"""Right motions that are printed otherwise: with few digits, in other units, with a z or a column that is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from compare.candidates.candidate import Candidate
from compare.score.judge import judge
from reference import Scene, load_scene, trajectory

Columns = dict[str, np.ndarray]
TIMES = np.linspace(0, 120, 241)
LENGTH = 20.0
ROUNDED = "The rounding of its numbers explains the error."


def hall(*settings: str) -> Scene:
    """A pendulum of 20 m, let go one metre from the vertical."""
    fields = [f"pendulum.length={LENGTH}", "release.x=0.8", "release.y=0.6"]
    return load_scene(
        "paris", [*fields, "run.t_end=200", "inputs=binary64", "run.transits=false", *settings]
    )


@pytest.fixture(scope="module")
def right() -> Columns:
    """What a right program prints of it."""
    return right_rows(hall(), TIMES)


def right_rows(scene: Scene, times: np.ndarray) -> Columns:
    return dict(zip("xyz", trajectory(scene, times).T[:3], strict=True))


def printed(form: str, column: np.ndarray) -> np.ndarray:
    return np.array([float(form % number) for number in column])


def explained(columns: Columns, scene: Scene | None = None, times: np.ndarray = TIMES) -> Any:
    found = judge(Candidate.of("mine", times, columns), scene or hall(), tolerance=1e-7)
    assert not found.agrees and found.explanation is not None
    return found.explanation


def ids(explanation: Any) -> list[str]:
    return [part.id for part in (*explanation.conventions, *explanation.causes)]


@pytest.mark.parametrize("form", ["%g", "%.4g", "%.3g", "%.4f", "%.6f"])
@pytest.mark.parametrize("names", ["xyz", "xy"])
def test_a_right_program_that_prints_few_digits_is_told_of_these_alone(
    right: Columns, form: str, names: str
) -> None:
    found = explained({name: printed(form, right[name]) for name in names})
    digits = "decimals" if form.endswith("f") else "digits"
    assert ids(found) == [digits]
    # more rows would not help
    assert [line for line in found.lines() if not line.startswith("  →")][1:] == [ROUNDED]


def test_a_fixed_number_of_decimals_is_no_number_of_digits(right: Columns) -> None:
    """A release of 1 m is the only number of its decade: that it ends in zeros says nothing."""
    scene = hall("release.x=1", "release.y=0")
    mistaken = scene.with_values(["site.gravity=9.8"])
    columns = right_rows(mistaken, TIMES)
    found = explained({name: printed("%.9f", columns[name]) for name in "xy"}, scene)
    assert ids(found) == ["decimals", "gravity_9.8"]
    assert found.conventions[0].text.startswith("prints 9 decimals")


def test_a_mistake_beside_few_digits_is_named_alone() -> None:
    columns = right_rows(hall("site.gravity=9.8"), TIMES)
    found = explained({name: printed("%g", columns[name]) for name in "xyz"})
    assert ids(found) == ["digits", "gravity_9.8"]


@pytest.mark.parametrize(
    "wrong",
    [
        lambda z: z + 1e-5 * np.sin(37 * TIMES),
        lambda z: 1.01 * z + 21,
        lambda z: np.interp(TIMES - 0.25, TIMES, z),
    ],
    ids=["noise", "scaled and moved", "half a row late"],
)
def test_a_wrong_z_beside_right_columns_is_told_as_that(
    right: Columns, wrong: Callable[[np.ndarray], np.ndarray]
) -> None:
    found = explained(right | {"z": wrong(right["z"])})
    assert ids(found) == ["z_wrong"]
    assert any(line.startswith("Without its z, the error is below") for line in found.lines())


def test_a_z_of_fewer_decimals_is_rounded(right: Columns) -> None:
    found = explained(right | {"z": printed("%.3f", right["z"])})
    assert ids(found) == ["decimals_of_z"]
    assert ROUNDED in found.lines()


def test_x_and_y_of_fewer_decimals_than_z_are_rounded(right: Columns) -> None:
    found = explained(
        {name: printed("%.3f", right[name]) for name in "xy"} | {"z": printed("%.9f", right["z"])}
    )
    assert ids(found) == ["decimals"] and found.conventions[0].text.startswith("prints 3 decimals")
    assert ROUNDED in found.lines()


def test_a_z_that_rounding_makes_a_constant_may_have_too_few_digits(right: Columns) -> None:
    found = explained(right | {"z": printed("%.1f", right["z"])})
    assert ids(found) == ["column_constant"]
    assert found.conventions[0].text == "prints z as a constant, -20, or with too few digits"


@pytest.mark.parametrize(
    ("per_metre", "text"),
    [
        (1000, "is in millimetres"),
        (1e-3, "is in kilometres"),
        (1 / LENGTH, "is in cord lengths (x/l)"),
    ],
)
def test_another_unit_of_all_columns_is_one_convention(
    right: Columns, per_metre: float, text: str
) -> None:
    found = explained({name: per_metre * column for name, column in right.items()})
    assert [part.text for part in found.conventions] == [text] and not found.causes


def test_heights_from_the_floor_are_found_in_another_unit_too(right: Columns) -> None:
    found = explained(
        {**{name: 1000 * right[name] for name in "xy"}, "z": 1000 * (right["z"] + 21)}
    )
    assert ids(found) == ["unit_of_length", "z_offset"]


@pytest.mark.parametrize("unit", ["radians", "degrees"])
def test_angles_are_no_cord_lengths_and_leave_z_right(right: Columns, unit: str) -> None:
    size = 180 / math.pi if unit == "degrees" else 1.0
    separate = {name: size * np.arcsin(right[name] / LENGTH) for name in "xy"}
    projected = {name: size * np.arctan2(right[name], -right["z"]) for name in "xy"}
    for columns in (
        separate,
        separate | {"z": right["z"]},
        projected,
        projected | {"z": right["z"]},
    ):
        found = explained(columns)
        assert found.corrected_m < 1e-9
        assert [part.text for part in found.conventions] == [
            f"gives x and y as angles of the cord in {unit}"
        ]


@pytest.mark.parametrize("length", ["2", "6.7"])
def test_a_wrong_length_is_no_other_count_of_z(length: str) -> None:
    columns = right_rows(hall(f"pendulum.length={length}"), TIMES)
    found = explained(columns)
    assert {part.id for part in found.conventions} == set()
    assert [cause.id for cause in found.known] in ([], ["pendulum.length"])


def test_another_length_is_told_beside_a_z_that_points_down(right: Columns) -> None:
    columns = right_rows(hall("pendulum.length=20.11"), TIMES)
    found = explained(columns | {"z": -columns["z"]})
    assert ids(found) == ["z_down", "pendulum.length"]


@pytest.mark.parametrize("clock", [1.002, 0.999])
@pytest.mark.parametrize(
    ("column", "text"),
    [("x", "prints x in its column of y"), ("0", "prints y as a constant, 0")],
)
def test_a_column_that_is_evidently_wrong_is_no_physics_beside_a_clock(
    right: Columns, clock: float, column: str, text: str
) -> None:
    y = right["x"] if column == "x" else 0 * right["y"]
    found = explained({"x": right["x"], "y": y}, times=clock * TIMES)
    assert [part.text for part in found.conventions] == [text] and not found.causes


def test_on_an_axis_a_mirrored_column_and_another_hemisphere_are_one_motion() -> None:
    """Beside a second mistake as well as alone."""
    scene = hall("release.y=0")
    columns = right_rows(scene, TIMES)
    for mistake in ("site.gravity=9.8", "site.gravity=9.80665"):
        columns = right_rows(scene.with_values([mistake]), TIMES)
        found = explained({"x": columns["x"], "y": -columns["y"]}, scene)
        (either,) = (cause for cause in found.causes if cause.stage == "either")
        assert {*either.id.split("|")} >= {"hemisphere", "column_mirrored"}
        assert "either either" not in either.text


def test_a_turned_plane_has_the_sense_in_which_it_turns(right: Columns) -> None:
    plane = (right["x"] + 1j * right["y"]) * np.exp(-1j * math.radians(1))
    found = explained({"x": plane.real, "y": plane.imag})
    assert [part.text for part in found.conventions] == ["prints x and y turned by 1°, clockwise"]
