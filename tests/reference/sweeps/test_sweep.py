"""Sweeps in memory: numbers against the solver, errors above the truth, rows that fail by themselves."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from interruption import interrupted
from swept_here import swept_here

from reference import InputError, load_scene, solve, sweep
from reference.sweeps import driver
from reference.sweeps.part import solve_part
from reference.sweeps.promote import Promoted, audited, promoted
from reference.sweeps.request import Settings, request
from reference.sweeps.sweep import checked_request
from reference.system.channel import ACTIVITY

MILLION = ["site.altitude=1:1000:1", "release.x=0.0001:0.1:0.0001"]
LATITUDES = "site.latitude=-90,-30,0,48.846111,90"


@pytest.fixture(scope="module", params=["heyoka", "octet"])
def engine(request):
    return request.param


@pytest.fixture(scope="module")
def swept(engine):
    return sweep(
        load_scene("paris", ["run.t_end=300"]),
        [LATITUDES],
        engine=engine,
        want=("all", "transit-times"),
    )


@pytest.fixture(scope="module")
def truths():
    """What the solver gives for each row, whatever the engine."""
    asked = request(load_scene("paris", ["run.t_end=300"]), [LATITUDES])
    return [
        solve(asked.scene_of(number), level="computed", digits=20)
        for number in range(asked.table.count)
    ]


def test_every_row_is_what_the_solver_gives_within_its_errors(swept, truths):
    for number, (row, truth) in enumerate(zip(swept.rows(), truths, strict=True)):
        assert row["status"] == "ok"
        position = np.array([row[f"{name}_m"] - truth.grid[name][-1] for name in "xyz"])
        velocity = np.array(
            [row[f"{name}_m_s"] - truth.grid[name][-1] for name in ("vx", "vy", "vz")]
        )
        assert np.linalg.norm(position) <= row["position_error_m"] < 1e-11
        assert np.linalg.norm(velocity) <= row["velocity_error_m_s"] < 1e-11
        t = truth.transits["t"].astype(float)
        assert row["transits"] == len(t)
        assert abs(row["t_last_s"] - t[-1]) <= row["transit_error_s"]
        assert (
            abs(row["frequency_hz"] - (len(t) - 1) / (2 * (t[-1] - t[0])))
            <= row["frequency_error_hz"]
            < 1e-12
        )
        listed = swept.transits()
        own = listed["row"] == number
        assert np.allclose(listed["t_s"][own], t, rtol=0, atol=row["transit_error_s"])
        assert listed["direction"][own].tolist() == list(truth.directions)


def test_the_plane_turns_as_foucault_says_and_the_angle_is_that_of_the_release(swept):
    ratio = swept["precession_ratio"]
    # the plumb line lies up to 0.1° off the normal, 3e-3 of the sine of 30°
    assert np.abs(ratio[[0, 1, 3, 4]] - 1).max() < 3e-3
    assert np.isnan(ratio[2])
    assert abs(swept["precession_deg_per_h"][2]) < 1e-4
    # at a pole the plumb line is the normal, and 0.5 m of 67 the largest angle
    assert swept["max_angle_deg"][[0, 4]] == pytest.approx(
        np.degrees(np.arcsin(0.5 / 67)), abs=1e-9
    )
    assert swept["swing_hz"] == pytest.approx(swept["frequency_hz"], abs=1e-6)


def test_a_row_is_the_same_alone_and_in_company(swept, engine):
    alone = sweep(load_scene("paris", ["run.t_end=300"]), ["site.latitude=0"], engine=engine)
    row, same = next(alone.rows()), list(swept.rows())[2]
    assert {name: value for name, value in row.items() if name != "row"} == {
        name: value for name, value in same.items() if name != "row"
    }


def test_a_wrong_combination_fails_alone_with_its_reason(paris):
    swept = sweep(
        paris.with_values(["run.t_end=60"]),
        ["pendulum.length=0.5,67", "release.x=0.1,0.3"],
        engine="heyoka",
    )
    assert swept["status"].tolist() == ["ok", "invalid", "ok", "ok"]
    assert "x² + y² less than length²" in swept["reason"][1]
    assert np.isnan(swept["frequency_hz"][1])
    assert swept.counts == {"invalid": 1, "ok": 3}
    assert swept.first_bad == 1


def test_what_no_double_holds_is_unreachable_by_itself(paris):
    swept = sweep(
        paris.with_values(["run.t_end=60"]), ["pendulum.length=67,1e390"], engine="heyoka"
    )
    assert swept["status"].tolist() == ["ok", "unreachable"]
    assert "beyond the range of binary64" in swept["reason"][1]


def test_words_are_varied_too(paris):
    swept = sweep(
        paris.with_values(["run.t_end=60"]),
        ["site.gravity_is=ellipsoid,effective", "inputs=decimal,binary64"],
        engine="heyoka",
    )
    assert swept["site.gravity_is"].tolist() == ["ellipsoid"] * 2 + ["effective"] * 2
    assert len(set(swept["x_m"].tolist())) == 4 or np.abs(np.diff(swept["x_m"])).max() > 1e-9
    alone = sweep(
        paris.with_values(["run.t_end=60", "site.gravity_is=effective"]),
        ["site.latitude=48.846111"],
        engine="heyoka",
    )
    assert alone["x_m"][0] == swept["x_m"][2]


def test_rows_of_a_file_fail_by_themselves(paris, tmp_path):
    (tmp_path / "rows.csv").write_text(
        "site.latitude,site.inverse_flattening\n10,inf\n91,300\n20,x\n30,300\n"
    )
    swept = sweep(paris.with_values(["run.t_end=60"]), rows=tmp_path / "rows.csv", engine="heyoka")
    assert swept["status"].tolist() == ["ok", "invalid", "invalid", "ok"]
    assert "at least -90" in swept["reason"][1]
    assert "decimal number" in swept["reason"][2]
    assert swept["site.latitude"].tolist() == [10, 91, 20, 30]


def test_spans_and_drag_differ_by_row(paris, engine):
    swept = sweep(
        paris.with_values(["run.t_end=60"]),
        ["run.t_end=20,100", "pendulum.drag=0,0.01"],
        engine=engine,
    )
    assert swept["status"].tolist() == ["ok"] * 4
    assert swept["engine"].tolist() == [engine, "heyoka"] * 2
    assert swept["transits"].tolist() == [2, 2, 12, 12]
    truth = solve(swept.request.scene_of(3), level="computed", digits=15)
    assert abs(truth.grid["x"][-1] - swept["x_m"][3]) <= swept["position_error_m"][3]


def test_more_digits_go_through_the_solver(paris):
    swept = sweep(
        paris.with_values(["run.t_end=20"]),
        ["site.latitude=0,10"],
        digits=18,
        level="self_consistent",
        workers=2,
    )
    assert swept["level"].tolist() == ["self_consistent"] * 2
    assert swept["digits"].tolist() == [18] * 2
    # the rounding of z
    assert swept["position_error_m"] == pytest.approx(np.spacing(np.abs(swept["z_m"])), rel=1e-3)
    assert np.isfinite(swept["precession_deg_per_h"]).all()


def test_a_tolerance_promotes_the_rows_above_it(paris):
    swept = sweep(
        paris.with_values(["run.t_end=20"]), ["site.latitude=0"], tolerance=1e-16, engine="heyoka"
    )
    assert swept["level"][0] == "self_consistent"
    assert swept["position_error_m"][0] < 2e-14  # an ulp of 67 m


def test_a_transit_at_the_end_is_left_to_more_digits(paris):
    t = solve(paris, t_end="20", level="computed", digits=20).transits.exact("t")[0]
    swept = swept_here(
        paris.with_values([f"run.t_end={float(t)!r}"]), ["site.latitude=48.846111"], engine="heyoka"
    )
    assert swept["level"][0] == "self_consistent"
    assert swept["status"][0] == "ok"


SPOILT = {
    **dict.fromkeys(
        ("x_m", "vz_m_s", "t_last_s", "frequency_hz", "swing_hz", "max_angle_deg"), 1e-9
    ),
    **dict.fromkeys(("precession_deg_per_h", "precession_ratio"), 1e-3),
    **dict.fromkeys(("transits", "close_pairs"), 1),
}


def test_an_audit_finds_what_is_wrong_in_any_column(paris):
    """One number of each row but the first is spoilt, in another column each time."""
    count = 1 + len(SPOILT)
    swept = swept_here(
        paris.with_values(["run.t_end=30"]),
        [f"site.latitude=5:{4 + count}:1"],
        engine="heyoka",
        audit=count,
    )
    columns = swept.columns()
    for row, (name, amount) in enumerate(SPOILT.items(), 1):
        columns[name][row] += amount
    found = audited(swept.request, lambda _: columns)
    assert (found.rows, found.wrong) == (count, tuple(range(1, count)))


def test_an_audit_reports_every_row_and_is_not_named_by_what_the_solver_does(paris):
    swept = swept_here(
        paris.with_values(["run.t_end=30"]),
        ["site.latitude=5:7:1"],
        engine="heyoka",
        audit=3,
    )
    columns = swept.columns()
    told: list[int] = []
    words: list[str] = []
    with ACTIVITY.heard_by(words.append):
        audited(swept.request, lambda _: columns, told.append)
    assert (told[0], told[-1]) == (0, 3)
    assert words == []


def test_a_row_of_an_audit_takes_as_long_as_many_rows_of_the_sweep(paris):
    """What the remaining time of a sweep counts for its audit: a row by the solver takes as long as any other."""
    over = ["site.latitude=5:7:1"]
    by_heyoka = request(paris, over, settings=Settings(engine="heyoka", audit=3))
    by_solver = request(paris, over, settings=Settings(digits=25, audit=3))
    assert by_heyoka.rows_per_audited > 10
    assert by_solver.rows_per_audited == 1


def test_a_row_that_the_solver_refuses_is_no_wrong_one():
    """1e-170 m: its square, which event detection needs, is below what 28 digits hold."""
    swept = sweep(
        load_scene("paris", ["run.t_end=60"]),
        ["release.x=1e-170,0.1"],
        engine="heyoka",
        audit_rows=2,
    )
    found = swept.audit
    assert (found.rows, found.wrong, found.refused) == (1, (), (0,))
    assert 0 < found.worst_ratio < 1
    assert swept.audit_s > 0


def test_highest_points_near_the_plumb_line_are_counted_by_the_solver():
    """Released on the plumb line, off its rest position: 73 highest points by an independent solver in 160 bits."""
    scene, asked = (
        load_scene("paris_measured", ["release.x=1e-12", "release.y=0", "run.t_end=600"]),
        [],
    )

    def once(request, row, *, doubtful):  # for both engines
        assert doubtful
        asked.append(asked[0] if asked else promoted(request, row, doubtful=doubtful))
        return asked[-1]

    for engine in ("heyoka", "octet"):
        swept = swept_here(scene, ["pendulum.length=67"], once, engine=engine)
        assert swept["level"][0] == "self_consistent"
        assert abs(swept["swing_hz"][0] - 0.0608896) < 1e-7
        assert abs(swept["precession_deg_per_h"][0] - 39451) < 1
    assert len(asked) == 2


@pytest.mark.parametrize(
    ("over", "options", "field"),
    [
        ([], {}, "--over"),
        (["site.latitude=1"], {"want": ("speed",)}, "--want"),
        (["site.latitude=1"], {"level": "good"}, "--level"),
        (["site.latitude=1"], {"engine": "euler"}, "--engine"),
        (["release.angle=1"], {}, "--over"),
        (MILLION, {}, "--out"),
    ],
)
def test_wrong_options_are_refused_before_any_work(paris, over, options, field, tmp_path):
    with pytest.raises(InputError) as error:
        sweep(paris, over, **options)
    assert error.value.field == field
    if field == "--out":
        assert checked_request(paris, over, None, tmp_path, Settings(audit=None)).audit == 1000


def test_parts_depend_on_the_scene_and_not_on_a_clock(paris):
    short, long = (
        request(paris.with_values([f"run.t_end={t}"]), MILLION, settings=Settings(engine="heyoka"))
        for t in (60, 86400)
    )
    assert short.rows_per_part > 8 * long.rows_per_part
    assert long.rows_per_part & (long.rows_per_part - 1) == 0


def test_a_grid_has_the_shape_of_its_axes(paris):
    swept = sweep(
        paris.with_values(["run.t_end=30"]),
        ["site.latitude=0:20:10", "release.x=0.1,0.2"],
        engine="heyoka",
    )
    grid = swept.grid("x_m")
    assert grid.shape == (3, 2)
    assert np.asarray(grid).ravel().tolist() == swept["x_m"].tolist()
    with pytest.raises(InputError, match="a column of this sweep"):
        swept["speed"]
    with pytest.raises(InputError, match="transit-times"):
        swept.transits()


def test_rows_that_another_process_solves_cost_what_they_cost_there(paris):
    asked = request(
        paris.with_values(["run.t_end=30"]),
        ["site.latitude=10,20"],
        settings=Settings(engine="heyoka", tolerance=1e-30),
    )
    part = solve_part(asked, range(2), lambda *_, **__: Promoted({}, ([], []), cpu_s=100.0))
    assert 200.0 < part.tally.cpu_s < 300.0
    assert driver.compute_alone(asked.text, 0, True).cpu_s > 0


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads CPU seconds in /proc")
def test_a_sweep_that_is_interrupted_does_not_wait_for_rows_that_take_long(tmp_path):
    out, begun = tmp_path / "out", []

    def at_work(pid, _):
        """Return whether it has worked for a second since its plan was written."""
        if (out / "plan.json").exists():
            begun.append(sum(map(int, Path(f"/proc/{pid}/stat").read_text().split()[13:15])))
        return bool(begun) and begun[-1] - begun[0] > os.sysconf("SC_CLK_TCK")

    minutes = [
        "sweep",
        "paris",
        "--over",
        "latitude=0",
        "--t-end",
        "1.2e8",
        "--engine",
        "heyoka",
        "--audit",
        "0",
    ]
    status, err, _ = interrupted([*minutes, "--out", str(out)], at_work)
    assert status == 130
    assert err.decode().splitlines()[-1].endswith(f"`foucault sweep --out {out}` resumes")
