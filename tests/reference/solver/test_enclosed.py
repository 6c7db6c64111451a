"""The level enclosed: what is printed is what the balls prove, and heyoka's runs are held against them."""

from __future__ import annotations

import os
import signal
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from time import process_time

import pytest
from interruption import children
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.dataset.golden import load
from reference.dataset.sheets import grid_sheet, transits_sheet
from reference.dataset.verify import problems_of, verify
from reference.dataset.write import write
from reference.enclosure import enclose
from reference.enclosure.trusted.course import FINISHED
from reference.engines.plan import Plan
from reference.engines.registry import engines, run
from reference.errors import InputError, IntegrationError, UnreachableError
from reference.numbers.precision import fixed_decimal, real
from reference.solver.guard import guarded
from reference.solver.pilot import run_pilot
from reference.solver.proof_steps import Feed
from reference.solver.proving import ProofTask, first_radius, proved

SHORT = {"t_end": "120", "digits": 30, "level": "enclosed"}


@pytest.fixture(scope="module")
def enclosed():
    return reference.solve(
        reference.load_scene("paris"), t_end="120", level="enclosed", engine="limbs"
    )


def finer(scene, prec=300):
    """A run far finer than the balls, in a formulation that the proof does not use."""
    return run(Plan(scene.exact, "spin", real(prec), tuple(scene.exact.grid), scene.run.zeros))


def test_an_enclosed_file_is_digit_for_digit_the_confirmed_one(enclosed):
    confirmed = reference.solve(reference.load_scene("paris"), t_end="120", level="confirmed")
    assert grid_sheet(enclosed) == grid_sheet(confirmed)
    ours, theirs = transits_sheet(enclosed), transits_sheet(confirmed)
    assert [row[:-1] for row in ours.rows] == [row[:-1] for row in theirs.rows]


# of the last digit
TIES = ["release.x=0.30000000005", "release.vy=-0.000123456785", "run.t_end=60", "run.digits=10"]


@pytest.mark.parametrize("level", ["computed", "confirmed", "enclosed"])
def test_a_release_between_two_decimals_is_rounded_as_it_is_given_and_proved(level, tmp_path):
    solution = reference.solve(reference.load_scene("paris", TIES), level=level)
    first = grid_sheet(solution).rows[0]
    assert (first[1], first[5]) == ("0.3000000000", "-0.0001234568")  # ties to even
    assert verify(reference.write(solution, tmp_path / "tie")).problems == []


def test_every_ball_contains_a_much_finer_run(enclosed):
    truth = finer(enclosed.scene)
    for table, other in ((enclosed.grid, truth.grid), (enclosed.transits, truth.transits)):
        assert len(table) == len(other)
        misses = table.distance(other)
        for name in table.columns:
            for miss, error in zip(misses.exact(name), table.bound(name), strict=True):
                assert miss <= error + Fraction(1, 2**250)


def test_the_manifest_carries_the_proof(enclosed, tmp_path):
    path = write(enclosed, tmp_path / "paris")
    assert problems_of(path) == []
    manifest = load(path).manifest
    assert manifest.level == "enclosed"
    record = manifest.enclosure
    assert record is not None
    assert record.method == "radius"
    assert Fraction(record.position_radius_m) < Fraction(1, 10**45)
    assert record.agreement_bits > 160
    assert [check.formulation for check in manifest.cross_checks] == ["inertial"]
    assert enclosed.guard.formulation == "momentum" and enclosed.guard.transit_s < Fraction(
        1, 10**6
    )


SCENES = {
    "drag": {"pendulum": {"drag": "0.01"}},
    "pole": {"site": {"latitude": "90"}},
    "south": {"site": {"latitude": "-33.9"}},
    "fast Earth": {"site": {"rotation_rate": "0.001"}},
    "no rotation": {"site": {"rotation_rate": "0"}},
    "equator": {"site": {"latitude": "0"}},
    "meridian": {"release": {"x": "0", "y": "0.5"}},
    "moving": {"release": {"x": "0.3", "y": "0.4", "vx": "0.067", "vy": "-0.2"}},
    "3.1 rad": {
        "pendulum": {"length": "1"},
        "release": {"angle": "177.61691649055521", "azimuth": "53"},
    },
    "2 rad": {
        "pendulum": {"length": "1"},
        "release": {"angle": "114.59155902616464", "azimuth": "53"},
    },
    "binary64": {"inputs": "binary64"},
}


@pytest.mark.parametrize("sections", one_in(8, SCENES.values()), ids=SCENES.keys())
def test_every_kind_of_scene_is_proved_and_every_digit_is_right(sections, size):
    scene = make_scene(**sections, run={**SHORT, "t_end": size("5", "60")})
    solution = reference.solve(scene)
    sheet, truth = grid_sheet(solution), finer(scene, 256)
    for name, text in zip(sheet.header[1:], sheet.rows[-1][1:], strict=True):
        assert abs(Fraction(text) - truth.grid.exact(name)[-1]) <= Fraction(
            1, 2 * 10 ** sheet.decimals[name]
        )
    assert solution.possible == ()
    times = truth.transits.exact("t")
    assert len(times) == len(solution.directions)
    for row, t in zip(transits_sheet(solution).rows, times, strict=True):
        assert abs(Fraction(row[1]) - t) <= Fraction(row[-1])


HARD = {
    "nearly linear, in heyoka's long steps": ("conical", "heyoka"),
    "a flow that blurs what nine digits show": ("separatrix", "auto"),
    "an unstable rest": ("inverted_rest", "auto"),
    "no gravity to measure by": ("weightless", "auto"),
}


@pytest.mark.parametrize(("name", "engine"), one_in(4, HARD.values()), ids=HARD.keys())
def test_scenes_that_bounds_find_hard_are_proved(name, engine, size):
    scene = reference.load_scene(name)
    solution = reference.solve(
        scene, t_end=size("20", scene.run.t_end), level="enclosed", engine=engine
    )
    assert solution.level == "enclosed"
    assert solution.possible == ()


def cpu_s():
    """Return the CPU seconds of this process and of those that it waited for."""
    return process_time() + sum(os.times()[2:4])


@pytest.mark.parametrize(
    ("name", "t_end", "digits"),
    [("paris", "60", 15), ("pantheon", "60", 40), ("damped", "600", 20)],
)
def test_a_proof_about_heyokas_run_succeeds_at_once_and_no_second_is_counted_twice(
    name, t_end, digits
):
    before = cpu_s()
    solution = reference.solve(name, t_end=t_end, digits=digits, level="enclosed", engine="heyoka")
    assert solution.run.cpu_s > 0 and solution.proof.enclosure.cpu_s > 0
    assert solution.discarded_s == 0
    assert solution.run.cpu_s + solution.proof.enclosure.cpu_s < solution.cpu_s < cpu_s() - before


def test_the_cpu_seconds_of_an_audit_are_told():
    plain, audited = (
        reference.solve("paris", t_end="60", level="enclosed", engine="limbs", audit=audit)
        for audit in (False, True)
    )
    assert (plain.proof.audit_s, plain.check_s) < (audited.proof.audit_s, audited.check_s)
    assert audited.check_s >= audited.proof.enclosure.cpu_s + audited.proof.audit_s


def test_xdot_identically_zero_has_no_transits_to_enclose():
    planar = make_scene(site={"rotation_rate": "0"}, release={"x": "0", "y": "0.4"}, run=SHORT)
    assert reference.solve(planar).zeros == {}


def test_transits_can_be_left_out():
    assert reference.solve(make_scene(run=SHORT), transits=False, engine="limbs").zeros == {}


def solved_with(change, scene, engine="limbs"):
    """Return what becomes of a scene whose proof says something else than trusted code has proved."""

    def lying(*words, **options):
        honest = enclose(*words, **options)
        said = change(honest.proved)
        FINISHED.add(said)
        return replace(honest, proved=said)

    problem = ProofTask(scene, engine, run_pilot(scene.exact, tuple(scene.exact.grid)))
    return guarded(proved(problem, lying), problem.pilot)


def with_transits(proved, transits):
    return replace(proved, zeros=proved.zeros | {"xdot": tuple(transits)})


def test_what_cannot_be_decided_is_said_and_its_row_left_out(tmp_path):
    def doubt(proved):
        transits = list(proved.zeros["xdot"])
        transits[3] = replace(transits[3], parity="odd", direction=0)
        return with_transits(proved, transits)

    path = write(solved_with(doubt, make_scene(run=SHORT)), tmp_path / "doubt")
    manifest = load(path).manifest
    assert manifest.transits == "undecided intervals"
    (possible,) = manifest.possible
    assert possible.parity == "odd"
    truth = finer(make_scene(run=SHORT | {"t_end": "60"}), 160)
    assert Fraction(possible.from_s) < truth.transits.exact("t")[3] < Fraction(possible.to_s)
    assert Fraction(possible.to_s) - Fraction(possible.from_s) < Fraction(1, 10**19)
    assert manifest.counts.transits == 13
    assert "possible transit in [" in (path / "certified.txt").read_text()
    assert problems_of(path) == []


def at_a_transit(places=60):
    """A scene that ends less than 10^-places s after its second transit, of fewer digits than would show it."""
    far = reference.solve(
        make_scene(run=SHORT | {"t_end": "20", "digits": places + 2}), engine="limbs"
    )
    late = -(-far.transits.exact("t")[1] * 10**places // 1)
    return make_scene(
        run=SHORT | {"t_end": fixed_decimal(Fraction(late, 10**places), places), "digits": 24}
    )


def test_a_run_that_ends_at_a_transit_is_written_with_what_is_possible_up_to_its_end(tmp_path):
    """F7 of the audit: the interval's end was rounded up beyond that of the run, and the proof lost."""
    scene = at_a_transit()
    manifest = load(write(reference.solve(scene, engine="limbs"), tmp_path / "end")).manifest
    (possible,) = manifest.possible
    assert (manifest.transits, manifest.counts.transits) == ("undecided intervals", 1)
    assert Fraction(possible.to_s) == scene.exact.t_end


def test_a_possible_transit_is_reported_within_the_run():
    def doubt(proved):
        first, *others, last = proved.zeros["xdot"]
        early = replace(first, parity="odd", t=replace(first.t, low=Fraction(-1, 10**14)))
        late = replace(
            last, parity="odd", t=replace(last.t, high=proved.times[-1] + Fraction(1, 10**14))
        )
        return with_transits(proved, [early, *others, late])

    early, late = solved_with(doubt, make_scene(run=SHORT)).possible
    assert (early[0], late[1]) == (0, 120)


@pytest.mark.parametrize(
    ("engine", "shift"), [("heyoka", Fraction(1, 10**35)), ("limbs", Fraction(1, 10**29))]
)
def test_a_state_outside_its_ball_names_time_and_component(engine, shift):
    def move(proved):
        row = list(proved.states[1])
        row[2] = replace(row[2], low=row[2].low + shift, high=row[2].high + shift)
        return replace(proved, states=[proved.states[0], tuple(row), *proved.states[2:]])

    with pytest.raises(IntegrationError, match=r"outside the enclosure at t = 60\.0 s in z"):
        solved_with(move, make_scene(run=SHORT), engine)


def test_a_transit_that_heyoka_does_not_see_is_named():
    with pytest.raises(IntegrationError, match="heyoka finds 14 transits, but the proof finds 13"):
        solved_with(
            lambda proved: with_transits(proved, proved.zeros["xdot"][:-1]), make_scene(run=SHORT)
        )


def test_a_transit_that_heyoka_sees_elsewhere_is_named():
    def shift(proved):
        transits = list(proved.zeros["xdot"])
        t = transits[4].t
        transits[4] = replace(transits[4], t=replace(t, low=t.low + 1, high=t.high + 1))
        return with_transits(proved, transits)

    with pytest.raises(
        IntegrationError, match="did not find transit 5, which the proof has at t = "
    ):
        solved_with(shift, make_scene(run=SHORT))


def test_a_number_exactly_between_two_decimals_is_refused_with_advice():
    """z = -0.35 m, which follows from the length, has no nearest number of one digit."""
    run = {"t_end": "1", "digits": 1, "level": "enclosed"}
    scene = make_scene(
        pendulum={"length": "0.35"}, release={"x": "0", "y": "0", "vx": "0.01"}, run=run
    )
    with pytest.raises(UnreachableError, match="ask for one digit more"):
        reference.solve(scene)


def test_balls_that_cannot_be_had_end_with_the_widths_reached():
    scene = make_scene(
        pendulum={"length": "1"},
        release={"angle": "177", "azimuth": "53"},
        run={"t_end": "60", "digits": 900, "level": "enclosed"},
    )
    with pytest.raises(UnreachableError, match="more than"):
        reference.solve(scene)


def test_without_flint_the_level_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(InputError, match=r"foucault-reference\[enclose\]"):
        reference.solve(make_scene(run=SHORT))


def test_the_feed_joins_step_to_step_without_a_gap(paris):
    steps = list(
        engines()["heyoka"].taylor_steps(paris.exact, (Fraction(0), Fraction(60)), 128, 148)
    )
    assert steps[0].centre == 0
    assert all(a.centre + a.h == b.centre for a, b in pairwise(steps))
    assert steps[-1].centre + steps[-1].h > 60
    assert len({step.h for step in steps}) < len(steps)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes in /proc")
def test_a_feed_that_dies_is_an_error_and_leaves_no_process(paris):
    others = children()
    feed = Feed(paris.exact, (Fraction(0), Fraction(86400)), "heyoka")
    steps = feed(180)
    next(steps)
    (process,) = children() - others
    os.kill(process, signal.SIGKILL)
    with pytest.raises(IntegrationError, match="ended before it returned"):
        feed.finished()
    feed.stop()
    assert children() <= others


def test_an_error_in_the_feeds_process_arrives(paris):
    lost = make_scene(pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"})
    feed = Feed(lost.exact, (Fraction(0), Fraction(10**6)), "heyoka")
    with pytest.raises(IntegrationError):
        list(feed(84))
    feed.stop()


def test_a_proof_that_another_engine_has_to_make_is_the_one_that_this_engine_makes():
    """At rest at the top, limbs have too few bits for the second try: heyoka begins again with the first."""
    begun_by_limbs, by_heyoka = (
        reference.solve("inverted_rest", engine=engine) for engine in ("limbs", "heyoka")
    )
    assert begun_by_limbs.level == "enclosed"
    assert begun_by_limbs.possible == ()
    for name in ("engine", "number", "order", "steps"):
        assert getattr(begun_by_limbs.run, name) == getattr(by_heyoka.run, name), name
    assert begun_by_limbs.run.engine == "heyoka"
    assert begun_by_limbs.proof.enclosure.bits == by_heyoka.proof.enclosure.bits
    # what was tried is told, and counts
    assert begun_by_limbs.discarded_s > by_heyoka.discarded_s > 0
    for solution in (begun_by_limbs, by_heyoka):
        assert (
            solution.cpu_s
            == solution.pilot_s + solution.run.cpu_s + solution.check_s + solution.discarded_s
        )


def test_an_audit_changes_no_digit_and_finds_spoilt_sums(monkeypatch):
    digits = pytest.importorskip("reference.enclosure.trusted.digits")
    scene = make_scene(run={**SHORT, "t_end": "30", "digits": 20})
    audited = reference.solve(scene, engine="limbs", audit=True)
    plain = reference.solve(scene, engine="limbs")
    assert (audited.proof.audited, plain.proof.audited) == (True, False)
    assert grid_sheet(audited) == grid_sheet(plain)
    honest = digits.sums

    def without_the_defect(*words):
        absolute, of_all = honest(*words)
        absolute[:3] = 0
        return absolute, of_all

    monkeypatch.setattr(digits, "sums", without_the_defect)
    # the proof succeeds, and is none: only the audit can tell
    reference.solve(scene, engine="limbs")
    with pytest.raises(IntegrationError, match="audit: compiled sums of digits are wrong"):
        reference.solve(scene, engine="limbs", audit=True)


@pytest.mark.parametrize("words", [("xdot",), ("gate 30",), ()], ids=", ".join)
def test_flint_alone_proves_the_same_digits_as_an_audited_proof(words):
    """As certified.txt says: from the same polynomials, without any compiled sum."""
    asked = {"transits": "xdot" in words, "sections": [word for word in words if word != "xdot"]}
    scene = make_scene(run={**SHORT, "t_end": "30", "digits": 20, **asked})
    solution = reference.solve(scene, engine="limbs", audit=True)
    assert solution.proof.audited
    grid = tuple(scene.exact.grid)
    feed = Feed(scene.exact, grid, "limbs")

    def integers(bits):
        for step in feed(bits):
            yield step._replace(rows=tuple(step.rows))

    by_flint = enclose(
        scene.exact,
        grid,
        radius=first_radius(scene, run_pilot(scene.exact, grid)),
        zeros=scene.run.zeros,
        approximant=integers,
        lost=feed.lost,
    )
    own = solution.proof.enclosure
    assert by_flint.bits == own.bits
    for state, wider in zip(by_flint.proved.states, own.proved.states, strict=True):
        for interval, around in zip(state, wider, strict=True):
            assert around.low <= interval.low <= interval.high <= around.high
    for word, zeros in own.proved.zeros.items():
        for zero, wider in zip(by_flint.proved.zeros[word], zeros, strict=True):
            assert wider.t.low <= zero.t.high and zero.t.low <= wider.t.high
            assert zero.parity == wider.parity


def test_an_audit_without_a_proof_is_refused():
    with pytest.raises(InputError, match="audit"):
        reference.solve(make_scene(run={**SHORT, "level": "computed"}), audit=True)
