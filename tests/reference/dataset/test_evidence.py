"""What manifest, vectors and page say beside the numbers is compared with the solution and with the tables."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

import reference
from reference.dataset import render as rendering
from reference.dataset.evidence import check_evidence
from reference.errors import DatasetError


@pytest.fixture(scope="module")
def solution():
    return reference.solve("paris", t_end="60", digits=12, level="confirmed")


@pytest.fixture(scope="module")
def proved():
    pytest.importorskip("flint")
    return reference.solve("paris", t_end="20", digits=12, level="enclosed", confirm="none", audit=False)


def moved(solution, **changes):
    """The solution with other facts of its first check."""
    return replace(solution, checks=(replace(solution.checks[0], **changes), *solution.checks[1:]))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (lambda solution: moved(solution, position_m=solution.checks[0].position_m * 2), "position_m"),
        (lambda solution: moved(solution, position_m=solution.checks[0].position_m / 2), "position_m"),
        (lambda solution: moved(solution, steps=3), "cross_checks.*steps"),
        (lambda solution: replace(solution, run=replace(solution.run, order=3)), "run.order"),
        (lambda solution: replace(solution, checks=()), "the number of cross_checks"),
        (lambda solution: replace(solution, scene=solution.scene.with_values(["title=Another"])), "title"),
    ],
)
def test_a_manifest_of_other_runs_or_another_title_is_refused(change, place, solution):
    """The same files pass beside their own solution."""
    contents = rendering.render(solution)
    check_evidence(contents, solution)
    with pytest.raises(DatasetError, match=place):
        check_evidence(contents, change(solution))


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"audited": True}, "the audit of command"),
        ({"confirmed": "whole"}, "the confirmation of command"),
        ({"transit_radius": Fraction(1, 10)}, "transit_radius_s"),
        ({"agreement_bits": 3}, "agreement_bits"),
    ],
)
def test_a_manifest_of_another_proof_is_refused(changes, place, proved):
    contents = rendering.render(proved)
    check_evidence(contents, proved)
    with pytest.raises(DatasetError, match=place):
        check_evidence(contents, replace(proved, proof=replace(proved.proof, **changes)))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (lambda said: said["states"][-1]["values"]["x"].update(decimal="0.1"), r"states\[1\].values.x.decimal"),
        (lambda said: said["transits"][0]["values"]["t"].update(bound="1e-40"), r"transits\[0\].values.t.bound"),
        (lambda said: said["transits"][-1]["values"]["ax"].update(hexfloat="0x1.0p+0"), "values.ax.hexfloat"),
        (lambda said: said["states"][0].update(row=2), r"states\[0\].row"),
        (lambda said: said["transits"].pop(), "transits"),
        (lambda said: said["columns"].update(t="min"), "columns.t = min"),
        (lambda said: said["notes"].pop("end"), "notes"),
    ],
)
def test_write_refuses_wrong_vectors_that_it_would_make_again(change, place, solution, tmp_path, monkeypatch):
    honest = rendering.vectors

    def wrong(*words):
        made = honest(*words)
        said = made.model_dump()
        change(said)
        return type(made).model_validate(said)

    monkeypatch.setattr(rendering, "vectors", wrong)
    with pytest.raises(DatasetError, match=f"vectors.json: .*{place}"):
        reference.write(solution, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Level: confirmed.", "Level: enclosed."),
        ("Two runs in different formulations", "Two runs"),
        ("read as: decimal", "read as: binary64"),
    ],
)
def test_write_refuses_a_page_of_another_level_that_it_would_make_again(old, new, solution, tmp_path, monkeypatch):
    honest = rendering.certified_page
    monkeypatch.setattr(rendering, "certified_page", lambda *words: honest(*words).replace(old, new))
    with pytest.raises(DatasetError, match=r"certified.txt: its head does not say"):
        reference.write(solution, tmp_path / "out")
