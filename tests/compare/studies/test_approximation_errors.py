"""Tables of errors and of limits agree with the motions themselves."""

from __future__ import annotations

import json

import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS, Motion, motions, quantities
from compare.studies.approximation_errors import TIMES, ReferenceMotion, error_table, quantity_table
from compare.studies.approximation_limits import LIMITS, limits, sweep, sweep_values, varied
from reference import InputError, load, load_scene, trajectory
from reference.model.force import rest_position
from reference.status import Status

PARIS = load_scene("paris")
FEW = ("linear_anharmonic", "gastebois_general", "conical")


def chosen(*words):
    return [APPROXIMATIONS[word] for word in words]


def test_a_row_for_every_approximation_and_time():
    rows = error_table(PARIS, chosen(*FEW), 20000.0)
    assert [(row.approximation, row.t) for row in rows] == [
        (word, t) for word in FEW for t in (20.0, 3600.0, 12000.0, 20000.0)
    ]
    assert error_table(PARIS, chosen(FEW[0]), 20.0)[-1].t == 20.0
    assert TIMES == (20.0, 3600.0, 12000.0, 86400.0)
    json.dumps([vars(row) for row in rows])


def test_errors_are_those_of_the_motions_and_never_shrink():
    rows = error_table(PARIS, chosen("linear_anharmonic"), 3600.0, times=(20.0, 1000.0))
    fine = np.linspace(0.0, 3600.0, 36001)
    gap = (
        APPROXIMATIONS["linear_anharmonic"].trajectory(PARIS, fine)[:, :3]
        - trajectory(PARIS, fine)[:, :3]
    )
    for row in rows:
        worst = np.max(np.linalg.norm(gap[fine <= row.t], axis=1))
        assert row.error_m == pytest.approx(worst, rel=0.02)
    assert rows[0].error_m <= rows[1].error_m <= rows[2].error_m
    assert rows[0].plane_error_arcsec <= rows[1].plane_error_arcsec <= rows[2].plane_error_arcsec


def test_the_uniform_field_is_the_best_of_all_after_a_day_and_good_to_a_fifth_of_a_millimetre():
    at_end = {
        row.approximation: row
        for row in error_table(PARIS, motions().values(), 86400.0)
        if row.t == 86400.0
    }
    assert set(at_end) == set(motions())
    best = min(
        (row for row in at_end.values() if row.error_m is not None), key=lambda row: row.error_m
    )
    assert best.approximation == "gastebois_general"
    assert 1e-4 < best.error_m < 2e-4
    # The slow-down is what the recentred harmonic pendulum lacks for a day.
    assert at_end["linear_anharmonic"].error_m < 0.05 * at_end["linear_recentred"].error_m
    # Both have the right gravity and the right centre, so that only the amplitude costs: ω t A³/(16 l²).
    for word in ("linear_recentred", "gastebois_6_1", "linear_3d"):
        assert at_end[word].error_m == pytest.approx(
            0.38229 * 86400 * 0.5963**3 / (16 * 67**2), rel=0.02
        )
    assert at_end["linear_apparent"].error_m < 0.25 < 1 < at_end["linear_g"].error_m
    # λ_a and the tilt are what it lacks for the plane: 1444" against 27".
    assert (
        at_end["gastebois_6_1"].plane_error_arcsec
        < 0.02 * at_end["linear_recentred"].plane_error_arcsec
    )


def test_the_run_that_approximations_are_held_against_is_the_golden_dataset():
    golden = load("paris")
    times = [float(t) for t in golden.exact("t")]
    rows = trajectory(PARIS, times)
    for i, name in enumerate("xyz"):
        gap = np.abs(rows[:, i] - np.array([float(v) for v in golden.exact(name)]))
        assert np.max(gap) < 1e-9


def test_what_does_not_apply_says_why_and_gives_no_numbers():
    rows = error_table(PARIS, chosen("conical"), 20.0)
    assert all(row.error_m is None and row.plane_error_arcsec is None for row in rows)
    assert rows[0].status == Status.REFUSED
    assert "circle" in rows[0].reason


def test_a_scene_without_a_swing_still_has_errors_of_position():
    drifting = PARIS.with_values(["site.gravity=0", "site.rotation_rate=0", "release.vx=0.1"])
    row = error_table(drifting, chosen("mathar_item_4"), 20.0)[-1]
    assert row.error_m < 1e-12
    assert row.plane_error_arcsec is None


def test_numbers_stand_beside_the_reference():
    rows = {row.approximation: row for row in quantity_table(PARIS)}
    assert set(rows) == set(quantities())
    assert rows["rest_equation"].relative_error < 1e-50
    assert rows["frequency_apparent"].value == "0.0608439352207779"
    assert rows["rest_series_1"].relative_error == pytest.approx(1.5e-3, rel=0.01)
    refused = {row.approximation: row for row in quantity_table(load_scene("equator"))}
    assert refused["precession_sine"].value is None
    assert "turn" in refused["precession_sine"].reason


# Limits --------------------------------------------------------------------------------------------------------------
def test_limits_over_time_are_where_the_error_passes_them():
    ids = ["linear_3d", "gastebois_6_1", "mathar_item_4"]
    rows = limits(PARIS, chosen(*ids), "time", 7200.0)
    assert [(row.approximation, row.limit) for row in rows] == [
        (word, name) for word in ids for name, _, _ in LIMITS
    ]
    truth = ReferenceMotion(PARIS, 7200.0)
    for row in rows:
        _, quantity, limit = next(entry for entry in LIMITS if entry[0] == row.limit)
        start, end = row.good[0]
        at_end, later = truth.largest(
            APPROXIMATIONS[row.approximation], [end, min(end + 17.0, 7200.0)]
        )
        assert start == 0.0
        assert getattr(at_end, quantity) <= limit
        if end < 7200.0:
            assert getattr(later, quantity) > limit * 0.999


def good_to_a_millimetre(over, size_m):
    """Return where an approximation is good to 1 mm that is the truth moved east by a size in m, scene by scene."""

    class Moved(Motion):
        def trajectory(self, scene, times):
            rows = trajectory(scene, times)
            rows[:, 0] += size_m(float(scene.exact.length), float(scene.exact.latitude))
            return rows

    moved = Moved(id="moved", title="", where="", drops="", path=lambda *_: None)
    (row,) = (row for row in limits(PARIS, [moved], over, 1.0) if row.limit == "1 mm")
    return [tuple(pytest.approx(end, rel=0.01) for end in interval) for interval in row.good]


def test_lengths_end_where_the_logarithm_of_the_error_meets_the_limit():
    def only_at_2_m(length_m, _):
        if length_m != 2:
            raise InputError("scene", "another length", "2 m")
        return 1e-5

    # 1e-6 l² is 1 mm at sqrt(1000) = 31.6 m, and 1 / l² at 31.6 m, too
    assert good_to_a_millimetre("length", lambda length_m, _: 1e-6 * length_m**2) == [(1.0, 31.6)]
    assert good_to_a_millimetre("length", lambda length_m, _: 1 / length_m**2) == [(31.6, 200.0)]
    assert good_to_a_millimetre("length", lambda *_: 0.01) == []
    assert good_to_a_millimetre("length", lambda *_: 1e-4) == [(1.0, 200.0)]
    assert good_to_a_millimetre("length", only_at_2_m) == [(2.0, 2.0)]


def test_latitudes_may_be_good_in_several_intervals():
    # 10^-2 m at the equator, and a tenth of that every 22.5 degrees
    assert good_to_a_millimetre(
        "latitude", lambda _, latitude: 10 ** (-2 - abs(latitude) / 22.5)
    ) == [
        (-90.0, -22.5),
        (22.5, 90.0),
    ]


def test_the_amplitude_at_which_the_harmonic_swing_loses_a_millimetre_in_an_hour():
    # ω t A³/(16 l²) = 1 mm at 3600 s.
    (good,) = (
        row.good
        for row in limits(PARIS, chosen("linear_3d"), "amplitude", 3600.0)
        if row.limit == "1 mm"
    )
    expected = (1e-3 * 16 * 67**2 / (0.3826 * 3600)) ** (1 / 3)
    assert good[0][1] == pytest.approx(expected, rel=0.05)


def test_without_rotation_of_the_plane_the_vertical_approximations_are_good_at_the_pole_and_not_between():
    rows = {row.value: row for row in sweep(PARIS, chosen("mathar_item_1"), "latitude", 600.0)}
    assert rows[45.0].error_m > 0.1
    assert rows[90.0].error_m < 1e-5
    assert (rows[45.0].over, rows[45.0].t) == ("latitude", 600.0)


def test_limits_of_what_does_not_apply_say_why():
    for over in ("time", "length"):
        rows = limits(PARIS, chosen("conical"), over, 20.0)
        assert len(rows) == len(LIMITS)
        assert all(row.good == () and "circle" in row.reason for row in rows)


# Varied scenes -------------------------------------------------------------------------------------------------------
def test_amplitude_is_the_distance_from_the_rest_position_in_the_same_direction():
    from compare.approximations.case import PaperCase

    for scene in (PARIS, PARIS.with_values(["release.vx=0.1"]), load_scene("hard")):
        before, after = (
            PaperCase.of_scene(scene),
            PaperCase.of_scene(varied(scene, "amplitude", 0.25)),
        )
        rest = rest_position(after.k, after.ctx)
        away = [
            case.ctx.mpc(case.position[0], case.position[1] - rest[1] * case.length)
            for case in (before, after)
        ]
        assert abs(abs(away[1]) - 0.25) < 1e-30
        assert abs((away[1] / away[0]).imag) < 1e-30
        ratio = abs(away[1] / away[0])
        assert abs(after.velocity[0] - ratio * before.velocity[0]) < 1e-30


def test_a_longer_cord_keeps_the_angle():
    longer = varied(PARIS, "length", 134.0)
    assert longer.exact.length == 134
    assert [float(v) for v in longer.exact.position] == [0.6, 0.8, 0.0, 0.0]
    assert (
        varied(load_scene("two_radians"), "length", 3.0).release
        == load_scene("two_radians").release
    )


def test_a_latitude_changes_nothing_else():
    assert varied(PARIS, "latitude", 0.5) == PARIS.with_values(["site.latitude=0.5"])


@pytest.mark.parametrize(
    ("over", "value"), [("latitude", 91.0), ("length", -1.0), ("amplitude", 70.0)]
)
def test_impossible_variations_are_refused(over, value):
    with pytest.raises(InputError):
        varied(PARIS, over, value)


def test_a_bob_at_rest_has_no_direction_to_vary():
    with pytest.raises(InputError, match="rest position"):
        varied(
            PARIS.with_values(["site.rotation_rate=0", "release.x=0", "release.y=0"]),
            "amplitude",
            1.0,
        )


def test_a_sweep_chooses_its_values():
    assert sweep_values(PARIS, "latitude")[0] == -90.0
    assert sweep_values(PARIS, "amplitude")[-1] == pytest.approx(6.7)
    assert sweep_values(PARIS, "length")[-1] == 200.0
