"""Possible transits: an interval that a proof left undecided passes and is named; one that the motion refutes does not.

Of two releases that differ by 1e-22 m/s one has two zeros of xdot in a tenth of a nanosecond at 22.945 s, one has none.
"""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

import pytest
from forgery import forge, moved

import reference
from reference.dataset.files import read_files
from reference.dataset.verify import recompute, verify
from reference.dataset.write import write
from reference.numbers.precision import fixed_decimal

# m/s to the east, by the zeros in the dip
SPEEDS = {0: "-0.0077460679307865453684", 2: "-0.0077460679307865453685"}
BEND = Fraction("0.26")  # third derivative of x in the dip, in m/s³
SAID = "checked only by --recompute: the possible transits, the proof, the cross-checks"


# none is what a run finds first
@pytest.fixture(scope="module", params=[2, pytest.param(0, marks=pytest.mark.long)])
def undecided(request, tmp_path_factory):
    changes = [
        "run.t_end=24",
        "run.grid_step=2",
        "run.digits=10",
        f"release.vx={SPEEDS[request.param]}",
    ]
    scene = reference.load_scene("close_pair", changes)
    return write(
        reference.solve(scene), tmp_path_factory.mktemp(f"zeros_{request.param}") / "grazing"
    )


@pytest.fixture
def grazing(undecided, tmp_path):
    return Path(shutil.copytree(undecided, tmp_path / "grazing"))


def test_what_a_proof_leaves_undecided_passes_and_is_said(grazing):
    manifest = read_files(grazing).manifest
    (part,) = manifest.possible
    # xdot = BEND s²/2 is below the proof's radius for as long as sqrt(8 radius/BEND); what is halved there ends later
    width, radius = (
        Fraction(part.to_s) - Fraction(part.from_s),
        Fraction(manifest.enclosure.velocity_radius_m_s),
    )
    assert part.parity == "even" and width**2 < 16 * 8 * radius / BEND
    found = verify(grazing)
    assert (found.problems, found.undecided) == ([], [SAID])
    assert recompute(grazing) == ([], [])


def interval(document, **ends):
    document["possible"][0].update(ends)


def another(document, *ends):
    document["possible"].insert(
        0, dict(zip(("from_s", "to_s", "parity"), (*ends, "unknown"), strict=True))
    )
    document["counts"]["possible"] += 1


REFUTED = {
    "an odd number": lambda document: interval(document, parity="odd"),
    "the transit before": lambda document: interval(document, from_s="22.2", parity="unknown"),
    "the first transit": lambda document: another(document, "0", "0.5"),
    "a narrow one in the middle of a swing": lambda document: another(
        document, "0.4", "0.40000000001"
    ),
    "a wide one between two transits": lambda document: another(document, "0.48", "0.49"),
    "nearly all": lambda document: another(document, "0", "22.9"),
}


@pytest.mark.parametrize("name", REFUTED)
def test_an_interval_in_which_the_motion_is_decided_is_found(grazing, name):
    forge(grazing, manifest=REFUTED[name])
    found = verify(grazing)
    assert any(
        "the motion has" in problem and "that is decided" in problem for problem in found.problems
    )
    assert found.undecided == []


@pytest.mark.parametrize("places", [range(0, 40, 2), [0], [40]])
def test_a_transit_outside_the_intervals_must_be_listed(grazing, places):
    def drop(rows, header):
        rows[:] = [row for i, row in enumerate(rows) if i not in places]
        for k, row in enumerate(rows, 1):
            row[0] = str(k)

    forge(grazing, transits=drop)
    assert "are not the motion's" in verify(grazing).problems[-1]


@pytest.mark.parametrize("late", [Fraction(1, 1000), Fraction(1, 10**8)])
def test_a_transit_outside_the_intervals_is_where_the_motion_has_it(grazing, late):
    forge(
        grazing, transits=lambda rows, _: [row.__setitem__(1, moved(row[1], late)) for row in rows]
    )
    assert "t is off by" in verify(grazing).problems[0]


def test_all_directions_turned_are_found(grazing):
    def turn(rows, header):
        for row in rows:
            row[2] = "-1" if row[2] == "+1" else "+1"

    forge(grazing, transits=turn)
    assert "are not the motion's" in verify(grazing).problems[0]


def test_a_passage_that_is_possible_up_to_an_end_of_many_decimals_is_written(tmp_path):
    """The double nearest to 6.4 has 49 decimals, and a possible passage ends there."""
    changes = [
        "inputs=binary64",
        "run.t_end=6.4",
        "run.grid_step=6.4",
        "run.sections=highest",
        "run.digits=10",
    ]
    scene = reference.load_scene("inverted_rest", [*changes, "run.level=enclosed"])
    solution = reference.solve(scene, confirm="none", audit=False)
    (low, high, parity), *_ = solution.sections["highest"].possible
    assert (low, high, parity) == (0, Fraction(6.4), "unknown")
    folder = write(solution, tmp_path / "rest")
    part = read_files(folder).manifest.sections.possible["highest"][0]
    assert Fraction(part.to_s) == Fraction(6.4)


def test_a_transit_that_no_proof_can_tell_from_the_end_of_the_run_is_possible_and_passes(tmp_path):
    """A finer run decides that it comes before the end; the dataset says no more than that it may."""
    plain = reference.load_scene("close_pair", ["run.t_end=2", "run.grid_step=2", "run.digits=10"])
    fine = reference.solve(plain, digits=40, confirm="none", audit=False)
    end = -(-fine.transits.exact("t")[0] * 10**30 // 1)
    text = fixed_decimal(Fraction(end, 10**30), 30)
    scene = plain.with_values([f"run.t_end={text}", f"run.grid_step={text}"])
    folder = write(reference.solve(scene, confirm="none", audit=False), tmp_path / "end")
    (part,) = read_files(folder).manifest.possible
    assert part.to_s == text
    assert verify(folder).problems == []
    # a decided transit that is said to be possible is still found
    forge(folder, manifest=lambda document: document["possible"][0].update(from_s="0"))
    assert any("that is decided" in problem for problem in verify(folder).problems)


# drag lets so little remain of the swing that its last highest points are undecided up to the end of the run
OVERDAMPED = {
    "id": "overdamped",
    "inputs": "binary64",
    "pendulum": {"length": "0.11", "drag": "24"},
    "site": {"latitude": "50"},
    "release": {"x": "0.00001", "y": "0"},
    "run": {
        "t_end": "10.6",
        "grid_step": "1",
        "digits": 15,
        "level": "enclosed",
        "sections": ["highest"],
    },
}


def test_an_undecided_passage_ends_with_the_run_however_many_decimals_its_end_has(tmp_path):
    solution = reference.solve(reference.parse_scene(OVERDAMPED))
    manifest = read_files(write(solution, tmp_path / "overdamped")).manifest
    (part,) = manifest.sections.possible["highest"]
    assert Fraction(part.from_s) < Fraction(part.to_s) == Fraction(10.6)
