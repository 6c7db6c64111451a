"""Failures on extreme scenes, the reasons given for them, and the digits that methods are asked for."""

from __future__ import annotations

import json
import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
from here import measured_here

from compare.methods import METHODS
from compare.methods.rhs.problem import Problem, suited
from compare.report.stability_page import document_of, headlines, page_text, text_table
from compare.studies.campaign import Reports
from compare.studies.character import character
from compare.studies.long_runs import LongRun, laws
from compare.studies.stability import Cell, cut, default_scenes, digits_requested, stability
from reference import load_scene, trajectory
from reference.scenes.shipped import data_root
from reference.status import Status


def test_there_are_thirty_extreme_scenes_and_each_says_what_it_catches() -> None:
    names = default_scenes()
    assert len(names) >= 31
    for name in names:
        scene = load_scene(name)
        assert scene.title and scene.source
        assert float(cut(scene).exact.t_end) <= float(scene.exact.t_end)


def test_a_fixed_step_is_asked_for_as_many_digits_as_its_order_gives() -> None:
    assert digits_requested("rkng67", 1 / 200) == pytest.approx(9.0, abs=0.02)  # (2 pi / 200)^6
    assert digits_requested("rkng56", 1 / 200) == pytest.approx(7.5, abs=0.02)
    assert digits_requested("rk4", 1 / 200) == pytest.approx(6.0, abs=0.02)


def shortened(folder: Path, name: str, t_end: str, grid_step: str) -> str:
    """Write a scene that ships with another end and grid; return the path."""
    text = (data_root() / "scenes" / f"{name}.toml").read_text()
    text = re.sub('t_end = ".*"', f't_end = "{t_end}"', text)
    (folder / f"{name}.toml").write_text(
        re.sub('grid_step = ".*"', f'grid_step = "{grid_step}"', text)
    )
    return str(folder / f"{name}.toml")


@pytest.fixture(scope="module")
def cells(tmp_path_factory: pytest.TempPathFactory, pytestconfig: pytest.Config) -> list[Cell]:
    folder = tmp_path_factory.mktemp("stability")
    journal_path = folder / "cells.jsonl"
    # the first falls from the top and comes back there; a few swings of the others show as much as many
    scenes = (("near_inverted", "10", "0.125"), ("creeping", "1", "0.0125"), ("hard", "10", "1"))
    methods = ["heyoka_double", "scipy_dop853", "scipy_radau", "rkmk4"]
    if not pytestconfig.getoption("--long"):
        scenes, methods = scenes[:1], methods[:1]
    names = [shortened(folder, *scene) for scene in scenes]
    with pytest.MonkeyPatch.context() as patch:
        measured_here(patch)
        measured = stability(names, methods, limit_s=0.5, journal_path=journal_path)
    # from the journal
    assert stability(names, methods, limit_s=0.5, journal_path=journal_path) == measured
    return measured


def test_space_is_silently_wrong_above_the_horizontal_and_momentum_is_not(
    cells: list[Cell],
) -> None:
    by_key = {
        (Path(cell.scene).stem, cell.precision): cell
        for cell in cells
        if cell.method == "heyoka_double"
    }
    space = by_key["near_inverted", "double, space"]
    assert space.status == "silently_wrong"
    assert "the rod is pushed" in space.reason
    assert by_key["near_inverted", "double, momentum"].status == "ok"


def test_a_stiff_method_wins_where_it_is_stiff_and_loses_where_it_is_not() -> None:
    def evaluations(name: str, scene_id: str, t_end: str) -> int:
        scene, method = (
            load_scene(scene_id, ["inputs=binary64", f"run.t_end={t_end}"]),
            METHODS[name],
        )
        problem = Problem.of(scene, suited(scene, method.formulations), [0.0, float(t_end)])
        return int(method.prepare(problem, 1e-9)().rhs_evaluations)

    assert 100 * evaluations("scipy_radau", "creeping", "4") < evaluations(
        "scipy_dop853", "creeping", "4"
    )
    assert evaluations("scipy_radau", "hard", "5") > 3 * evaluations("scipy_dop853", "hard", "5")


RIGHT_TO_SO_MANY_DIGITS = """
import sys
folder, t_end, digits = sys.argv[1:]
print("t,x,y,z")
for line in open(f"{folder}/{t_end}.txt"):
    t, x, y, z, amplitude = map(float, line.split())
    print(t, x + amplitude * 10 ** -float(digits), y, z, sep=",")
"""
CALM = '[release]\nx = "0.3"\ny = "0.4"\n[run]\nt_end = "60"\ngrid_step = "10"\n'
FROM_THE_TOP = """
[pendulum]
length = "1"
[site]
rotation_rate = "0"
[release]
angle = "179.99"
azimuth = "20"
[run]
t_end = "4"
grid_step = "0.125"
"""


@pytest.mark.usefixtures("here")
def test_what_the_motion_magnifies_is_not_the_methods_fault(tmp_path: Path) -> None:
    """A program is asked for 6 digits and may lose 3; where the motion loses more by itself, as many as that."""
    lost = {}
    for word, text in (("calm", CALM), ("from_the_top", FROM_THE_TOP)):
        path = tmp_path / f"{word}.toml"
        path.write_text(text)
        scene = cut(load_scene(path))
        times = np.array([float(t) for t in scene.exact.grid])
        states = trajectory(scene, times)
        traits = character(scene, times, states)
        lost[str(path)] = traits.digits_lost
        amplitude_m = np.full(len(times), traits.amplitude * float(scene.exact.length))
        rows = np.column_stack([times, states[:, :3], amplitude_m])
        np.savetxt(tmp_path / f"{scene.run.t_end}.txt", rows, fmt="%.17g")
    calm, from_the_top = lost
    assert lost[calm] < 1
    assert 3.2 < lost[from_the_top] < 4.8

    program = tmp_path / "program.py"
    program.write_text(RIGHT_TO_SO_MANY_DIGITS)
    command = shlex.join([sys.executable, str(program), str(tmp_path)])
    programs = {digits: f"{command} {{t_end}} {digits}" for digits in ("3.1", "2.9", "0.9")}
    cells = {
        (cell.scene, cell.method): cell
        for cell in stability([*lost], ["heyoka_double"], programs=programs)
    }
    expected = {
        (calm, "3.1"): Status.OK,
        (calm, "2.9"): Status.SILENTLY_WRONG,
        (calm, "0.9"): Status.SILENTLY_WRONG,
        (from_the_top, "3.1"): Status.OK,
        (from_the_top, "2.9"): Status.ILL_CONDITIONED,
        (from_the_top, "0.9"): Status.SILENTLY_WRONG,
    }
    for scene in lost:
        for digits in programs:
            assert cells[scene, digits].status == expected[scene, digits]
    assert "magnifies an error at the release" in cells[from_the_top, "2.9"].reason
    assert "magnifies an error at the release" not in cells[calm, "2.9"].reason


def cell_of(status: Status, digits: float) -> Cell:
    """The cell of a run that was asked for 9 digits and kept so many."""
    names = ("paris", "scipy_dop853", "double, space")
    return Cell(
        *names, status, digits, 9.0, 0.02, "as measured", setting=1e-9, kind="tolerance", load=0.5
    )


def test_the_headline_counts_the_methods_own_failures_only() -> None:
    cells = [
        cell_of(Status.OK, 9.0),
        cell_of(Status.SILENTLY_WRONG, 5.0),
        cell_of(Status.ILL_CONDITIONED, 5.0),
        cell_of(Status.ILL_CONDITIONED, 1.0),
    ]
    first, _, *_ = lines = headlines(cells)
    assert first.startswith("1 of 4 runs are silently wrong")
    assert any(
        line.startswith("2 more are as far off because the motion itself magnifies")
        for line in lines
    )
    document = document_of(cells, [])
    assert (document["silently_wrong"], document["ill_conditioned"]) == (1, 2)
    text = text_table(document)
    assert (
        "scipy_dop853" in text
        and re.search(r"setting +asked", text)
        and re.search(r"1e-9 +9\.0", text)
    )
    assert (
        "1e-9"
        in page_text(document).partition("What each run was asked for")[2].partition("</table>")[0]
    )


@pytest.mark.usefixtures("here")
def test_a_method_that_is_asked_for_nothing_unusual_is_ill_conditioned_where_the_flow_is() -> None:
    (cell,) = stability(["separatrix"], ["rkmk4"])
    assert cell.status == "ill_conditioned", cell
    assert cell.digits is not None and cell.digits < cell.asked - 3


@pytest.mark.usefixtures("here")
def test_a_stiff_start_is_not_extrapolated_into_out_of_time(tmp_path: Path) -> None:
    """A start of 1e-5 s takes nearly all of the run's time, so 64 times the probe's is far beyond the limit."""
    (cell,) = stability(
        [shortened(tmp_path, "creeping_far", "0.01", "0.00005")], ["scipy_radau"], limit_s=1.0
    )
    assert cell.status == "ok", cell


def test_a_failure_says_what_the_numbers_point_to(cells: list[Cell]) -> None:
    for cell in cells:
        assert bool(cell.reason) == (cell.status != "ok"), cell
        if cell.status == "silently_wrong":
            assert cell.digits is not None and cell.digits < cell.asked - 3


@pytest.mark.usefixtures("here")
def test_a_scene_that_the_reference_cannot_solve_is_unreachable_and_the_others_are_measured(
    tmp_path: Path,
) -> None:
    own = tmp_path / "stiff.toml"
    own.write_text(
        'id = "stiff"\n[pendulum]\ndrag = "1e9"\n[release]\nx = "0.3"\ny = "0.4"\n[run]\nt_end = "600"\n'
    )
    solved: list[tuple[float, int]] = []
    hard = shortened(tmp_path, "hard", "10", "1")
    lost, measured = stability(
        [str(own), hard],
        ["rkmk4"],
        reports=Reports(solving=lambda done, total: solved.append((done, total))),
    )
    assert solved == sorted(solved) and (1, 2) in solved and solved[-1] == (2, 2)
    assert (lost.status, lost.digits, lost.cpu_s) == (Status.UNREACHABLE, None, None)
    assert lost.reason.startswith("The reference cannot solve it: ") and "Stiff" in lost.reason
    assert measured.status == Status.OK


def test_the_law_of_a_known_exponent_of_time_is_named() -> None:
    t = np.linspace(0, 100, 400)
    run = LongRun("m", "f", 1.0, Status.OK, "", t.tolist(), (1e-9 * t**1.5).tolist(), 1.0)
    assert run.exponent == pytest.approx(1.5, abs=0.02)
    assert run.law == "t^1.5"
    assert "grows like t^1.5" in next(laws([run]))


@pytest.mark.usefixtures("here")
def test_the_command_reports_rows_and_a_page(foucault, tmp_path: Path, size) -> None:
    scenes = ",".join(
        shortened(tmp_path, name, "10", "1") for name in size(["hard"], ["hard", "two_radians"])
    )
    words = ("stability", "--scenes", scenes, "--methods", "rkmk4,scipy_dop853", "--json")
    status, out, _ = foucault(*words, "--out", tmp_path / "out")
    assert status == 0
    rows = json.loads(out)["rows"]
    assert {"scene", "method", "precision", "status", "digits", "cpu_s", "reason"} <= rows[0].keys()
    page = (tmp_path / "out/index.html").read_text()
    assert "<svg" in page
    wrong = any(row["status"] == Status.SILENTLY_WRONG for row in rows)
    assert (
        "<p>None.</p>" in page.partition("<h2>Silently wrong</h2>")[2].partition("</section>")[0]
    ) is not wrong
