"""How far a number may be changed before `verify` refuses it: as far as the bounds allow, and hardly further."""

from __future__ import annotations

import json
import math
import shutil
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from forgery import forge, moved, seal

import reference
from reference.dataset.checks.scene_check import largest_jerk
from reference.dataset.files import read_files
from reference.dataset.manifest import MANIFEST
from reference.dataset.record import bounds_of
from reference.dataset.verify import problems_of, verify
from reference.dataset.write import write
from reference.model.force import acceleration
from reference.model.start import Start
from reference.numbers.columns import POSITION, VELOCITY

LENGTH_M, GRAVITY_M_S2 = 10.0, 9.8
WIDER = 10**8  # bounds so wide that rounding, of which they consist, is nothing beside them


@pytest.fixture(scope="module")
def wide(passing, tmp_path_factory):
    """The same motion with wide bounds on transits and passages, which a dataset without a proof may have."""

    def widened(bounds):
        return {
            name: bound if name == "t" else f"{float(bound) * WIDER:.1e}"
            for name, bound in bounds.items()
        }

    def widen(document):
        bounds = document["bounds"]
        document["bounds"] = bounds_of(bounds["grid"], widened(bounds["transits"])).model_dump()
        document["sections"]["bounds"] = widened(document["sections"]["bounds"])

    folder = Path(shutil.copytree(passing, tmp_path_factory.mktemp("wide") / passing.name))
    forge(folder, manifest=widen)
    assert verify(folder).problems == []
    return folder


@pytest.fixture
def swing(wide, tmp_path) -> Path:
    return Path(shutil.copytree(wide, tmp_path / wide.name))


# ------------------------------------------------------------------------------- closed forms of a spherical pendulum


def depth_m(x, y):
    return -math.sqrt(LENGTH_M**2 - x**2 - y**2)


def energy(x, y, vx, vy):
    z = depth_m(x, y)
    vz = -(x * vx + y * vy) / z
    return (vx**2 + vy**2 + vz**2) / 2 + GRAVITY_M_S2 * z


def energy_at_transit(x, y, vy):
    return energy(x, y, 0.0, vy)


def acceleration_at_transit(x, y, vy):
    """The force of the cord pulls along -r, so hard that r·a = -v²."""
    z = depth_m(x, y)
    vz = -y * vy / z
    return -x * (vy**2 + vz**2 - GRAVITY_M_S2 * z) / LENGTH_M**2


def distance_squared(x, y, z):
    return x**2 + y**2 + z**2


def across_the_sphere(x, y, z, vx, vy, vz):
    return x * vx + y * vy + z * vz


def corner_of_the_box(quantity, numbers, bounds):
    """Return by how much a quantity may be off in the box of the bounds: the most of its corners."""
    middle = quantity(*numbers)
    corners = product(*((q - b, q + b) for q, b in zip(numbers, bounds, strict=True)))
    return max(abs(quantity(*corner) - middle) for corner in corners)


LAWS = [  # table, law, of which numbers it is, which one is changed, what verify says
    ("sections", distance_squared, POSITION, "z", "the bob is not at the distance"),
    ("transits", distance_squared, POSITION, "z", "the bob is not at the distance"),
    (
        "sections",
        across_the_sphere,
        (*POSITION, *VELOCITY),
        "vz",
        "the velocity is not along the sphere",
    ),
    ("sections", energy, ("x", "y", "vx", "vy"), "x", "the invariant h differs"),
    ("transits", energy_at_transit, ("x", "y", "vy"), "x", "the invariant h differs"),
    ("transits", acceleration_at_transit, ("x", "y", "vy"), "ax", "the equations of motion give"),
]


@pytest.mark.parametrize(("part", "found"), [(0.97, False), (1.08, True)])
@pytest.mark.parametrize(("kind", "law", "columns", "changed", "said"), LAWS)
def test_a_row_may_break_a_law_by_what_its_bounds_allow_and_not_by_a_tenth_more(
    swing, kind, law, columns, changed, said, part, found
):
    files = read_files(swing)
    sheet = files.tables[f"{kind}.csv"]
    row = dict(zip(sheet.header, sheet.rows[1], strict=True))
    numbers = [float(row[name]) for name in columns]
    bounds = [float(files.manifest.bound(kind, name)) for name in columns]
    allowed = corner_of_the_box(law, numbers, bounds)
    if changed == "ax":
        by = allowed + float(files.manifest.bound(kind, "ax"))
    else:
        ahead = [
            number + 1e-6 * (name == changed) for name, number in zip(columns, numbers, strict=True)
        ]
        slope = (law(*ahead) - law(*numbers)) / 1e-6
        by = allowed / slope

    change_a_row(swing, kind, {changed: moved(row[changed], Fraction(part * by))})
    assert any(said in sentence for sentence in problems_of(swing)) is found


@pytest.mark.parametrize("scene", ["near_inverted", "over_top"])
def test_a_bob_above_the_pivot_obeys_the_laws_too(tmp_path, scene):
    solution = reference.solve(scene, t_end="2", digits=10, level="computed")
    assert max(solution.grid.exact("z")) > solution.scene.exact.length / 4
    assert problems_of(write(solution, tmp_path / scene)) == []


def change_a_row(folder, kind, cells, place=1, **more):
    """Put other texts into a row of a table, the second if no other is asked for."""

    def change(rows, header):
        for name, text in cells.items():
            rows[place][header.index(name)] = text

    forge(folder, **{kind: change}, **more)


# ---------------------------------------------------------------------------------------------- bounds on times, digits


@pytest.mark.parametrize(
    ("bound", "found"), [("2.0e-06", False), ("2.2e-06", False), ("2.3e-06", True)]
)
def test_the_bound_of_a_time_may_be_twice_what_the_runs_are_apart_rounded_up(swing, bound, found):
    def a_microsecond_apart(document):
        document["cross_checks"][0]["transit_s"] = "1.0e-06"

    change_a_row(swing, "transits", {"bound": bound}, manifest=a_microsecond_apart)
    assert ("more than the runs leave open" in "".join(problems_of(swing))) is found


@pytest.mark.parametrize(
    ("digits", "bound", "found"),
    [(10, "1.3e-07", False), (10, "1.4e-07", True), (6, "1.0e-02", False)],
)
def test_the_bound_of_a_time_may_be_the_error_of_xdot_over_xddot_unless_xdot_may_graze_zero(
    tmp_path, digits, bound, found
):
    """Two zeros of xdot follow close on each other, with xddot = ±8.8e-5 m/s².

    Of ten digits xdot has 5.1e-12 m/s, so a time may be unknown by twice that over xddot, 1.2e-7 s, and what rounding
    adds. Of six digits it has 5.1e-8 m/s, and the swing may have no zero there at all.
    """
    changes = ["run.t_end=24", "run.grid_step=2", f"run.digits={digits}", "release.vx=-0.00774607"]
    solution = reference.solve(reference.load_scene("close_pair", changes), level="computed")
    folder = write(solution, tmp_path / "close_pair")
    slopes = [abs(ax) for (ax,) in read_files(folder).tables["transits.csv"].numbers(("ax",))]
    change_a_row(folder, "transits", {"bound": bound}, slopes.index(min(slopes)))
    assert ("more than the runs leave open" in "".join(problems_of(folder))) is found


@pytest.mark.parametrize(("part", "found"), [("5.0", False), ("4.9", True)])
def test_the_bound_of_a_time_is_at_least_half_a_unit_of_its_last_digit(swing, part, found):
    decimals = read_files(swing).manifest.decimals["transits"]["t"]
    change_a_row(swing, "transits", {"bound": f"{part}e-{decimals + 1}"})
    assert ("less than half a unit of the last digit" in "".join(problems_of(swing))) is found


@pytest.mark.parametrize("kind, column", [("grid", "x"), ("transits", "t"), ("transits", "x")])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_double_is_that_of_some_number_within_the_bound_of_the_decimal(
    passing, tmp_path, kind, column, side
):
    folder = Path(shutil.copytree(passing, tmp_path / passing.name))
    files = read_files(folder)
    plain, name = files.tables[f"{kind}.csv"], f"{kind}.binary64.csv"
    cell = plain.header.index(column)
    row = plain.rows[1]
    bound = Fraction(row[-1]) if column == "t" else files.manifest.bound(kind, column)
    last = float(Fraction(row[cell]) + side * bound)
    lines = [line.split(",") for line in files.texts[name].splitlines()]
    for double, found in ((last, False), (math.nextafter(last, side * math.inf), True)):
        lines[2][cell] = f"{double:.16e}"
        lines[2][lines[0].index(f"{column}_hex")] = double.hex()
        text = "".join(",".join(line) + "\n" for line in lines)
        seal(folder, json.loads((folder / MANIFEST).read_text()), files.texts | {name: text})
        assert ("is not the double nearest to" in "".join(problems_of(folder))) is found


@pytest.mark.parametrize("column", ["x", "vy"])
def test_a_column_with_a_digit_less_than_asked_for_is_found(passing, tmp_path, column):
    folder = Path(shutil.copytree(passing, tmp_path / passing.name))

    def cut(rows, header):
        for row in rows:
            row[header.index(column)] = row[header.index(column)][:-1]

    def say_so(document):
        document["decimals"]["grid"][column] -= 1
        wider = {column: f"{10 * float(document['bounds']['grid'][column]):.1e}"}
        document["bounds"] = bounds_of(
            document["bounds"]["grid"] | wider, document["bounds"]["transits"]
        ).model_dump()

    forge(folder, grid=cut, manifest=say_so)
    assert problems_of(folder) == [
        f"manifest.json: decimals: {column} of grid has fewer than 15 digits"
    ]


# ------------------------------------------------------------------------------------------------------- proven limits


@pytest.mark.parametrize(
    "name", ["over_top", "conical", "damped", "fast_pole", "weightless", "overdamped", "hard"]
)
def test_no_rate_of_xddot_exceeds_its_bound(name):
    golden = reference.load(name)
    k = Start.of(golden.scene.exact, 53).k.converted(float)
    n, v = (tuple(golden.grid[name] / k.length for name in names) for names in (POSITION, VELOCITY))
    jerks = np.abs(np.diff(acceleration(n, v, k)[0] * k.length)) / np.diff(golden.t)
    assert jerks.max() <= float(largest_jerk(read_files(golden.path)))
