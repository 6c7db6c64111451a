"""What manifest, vectors and page say beside the numbers is compared with the solution and with the tables."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from forgery import seal

import reference
from reference.dataset.checks import read_back
from reference.dataset.evidence import check_evidence
from reference.dataset.files import read_files
from reference.dataset.manifest import MANIFEST
from reference.dataset.render import render
from reference.dataset.verify import problems_of
from reference.errors import DatasetError


@pytest.fixture(scope="module")
def solution():
    return reference.solve("paris", t_end="60", digits=12, level="confirmed")


@pytest.fixture(scope="module")
def proved():
    pytest.importorskip("flint")
    return reference.solve(
        "paris", t_end="20", digits=12, level="enclosed", confirm="none", audit=False
    )


@pytest.fixture(scope="module")
def written(solution, tmp_path_factory):
    return reference.write(solution, tmp_path_factory.mktemp("evidence") / "paris")


def sealed(folder):
    """Have hashes and seal fit the page and the vectors that stand there."""
    texts = {name: (folder / name).read_text() for name in ("vectors.json", "certified.txt")}
    seal(folder, json.loads((folder / MANIFEST).read_text()), texts)


def moved(solution, **changes):
    """The solution with other facts of its first check."""
    return replace(solution, checks=(replace(solution.checks[0], **changes), *solution.checks[1:]))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (
            lambda solution: moved(solution, position_m=solution.checks[0].position_m * 2),
            "position_m",
        ),
        (
            lambda solution: moved(solution, position_m=solution.checks[0].position_m / 2),
            "position_m",
        ),
        (lambda solution: moved(solution, steps=3), "cross_checks.*steps"),
        (lambda solution: replace(solution, run=replace(solution.run, order=3)), "run.order"),
        (lambda solution: replace(solution, checks=()), "the number of cross_checks"),
        (
            lambda solution: replace(solution, scene=solution.scene.with_values(["title=Another"])),
            "title",
        ),
    ],
)
def test_a_manifest_of_other_runs_or_another_title_is_refused(change, place, solution):
    """The same files pass beside their own solution."""
    contents = render(solution)
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
    contents = render(proved)
    check_evidence(contents, proved)
    with pytest.raises(DatasetError, match=place):
        check_evidence(contents, replace(proved, proof=replace(proved.proof, **changes)))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (
            lambda said: said["states"][-1]["values"]["x"].update(decimal="0.1"),
            r"states\[1\].values.x.decimal",
        ),
        (
            lambda said: said["transits"][0]["values"]["t"].update(bound="1e-40"),
            r"transits\[0\].values.t.bound",
        ),
        (
            lambda said: said["transits"][-1]["values"]["ax"].update(hexfloat="0x1.0p+0"),
            "values.ax.hexfloat",
        ),
        (lambda said: said["states"][0].update(row=2), r"states\[0\].row"),
        (lambda said: said["transits"].pop(), "transits"),
        (lambda said: said["columns"].update(t="min"), "columns.t = min"),
        (lambda said: said["notes"].pop("end"), "notes"),
    ],
)
def test_wrong_vectors_are_found_by_reading_them_back(change, place, written, tmp_path):
    """What reads them has nothing in common with what writes them, and so finds what that would write wrongly again."""
    folder = Path(shutil.copytree(written, tmp_path / "paris"))
    said = json.loads((folder / "vectors.json").read_text())
    change(said)
    (folder / "vectors.json").write_text(json.dumps(said))
    sealed(folder)
    assert re.search(f"vectors.json: .*{place}", "\n".join(read_back.problems(read_files(folder))))
    assert problems_of(folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Level: confirmed.", "Level: enclosed."),
        ("Two runs in different formulations", "Two runs"),
        ("read as: decimal", "read as: binary64"),
    ],
)
def test_a_page_of_another_level_is_found_by_reading_it_back(old, new, written, tmp_path):
    folder = Path(shutil.copytree(written, tmp_path / "paris"))
    page = (folder / "certified.txt").read_text()
    assert old in page
    (folder / "certified.txt").write_text(page.replace(old, new))
    sealed(folder)
    assert "certified.txt: its head does not say" in "\n".join(
        read_back.problems(read_files(folder))
    )
    assert problems_of(folder)
