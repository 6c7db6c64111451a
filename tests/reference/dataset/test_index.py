"""The index inside the package: a dataset that ships, or a copy of it, has the seal that stands there."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from forgery import forge
from own_project import foucault_of, own_project

import reference
from reference.dataset.files import read_files

SEAL = "is not that of the dataset that ships"


@pytest.fixture
def project(tmp_path):
    return own_project(tmp_path / "own", ["paris"])


def ship(project, dataset) -> Path:
    """Have a dataset of Paris come with a project, under its seal."""
    golden = project / "data/golden"
    entry = {"seal": read_files(dataset).manifest.seal, "options": "--engine heyoka"}
    (golden / "index.json").write_text(json.dumps({"paris": entry}))
    return Path(shutil.copytree(dataset, golden / "paris"))


def copied(dataset, folder, change=None) -> Path:
    """Copy a dataset, and change the copy's manifest by a function."""
    copy = Path(shutil.copytree(dataset, folder / "paris"))
    if change is not None:
        forge(copy, manifest=change)
    return copy


def retitle(document):
    document.update(title="another")


def verified(project, *folders):
    """Return what `verify` in a project has against each of some folders, as one text."""
    said = json.loads(foucault_of(project, "verify", *folders, "--json", numba=False).stdout)
    return ["\n".join(row["problems"]) for row in said["rows"]]


def test_in_its_place_or_copied_from_there_a_dataset_has_the_seal_of_the_index(
    project, original, tmp_path
):
    ships = ship(project, original)
    copy = copied(ships, tmp_path / "copy")
    forged = copied(ships, tmp_path / "forged", retitle)
    others = [
        copied(ships, tmp_path / "span", lambda m: m["scene"]["run"].update(t_end="60")),
        copied(
            ships, tmp_path / "command", lambda m: m.update(command=m["command"] + " --no-confirm")
        ),
    ]
    in_place, of_copy, of_forged, *of_others = verified(project, ships, copy, forged, *others)
    assert (in_place, of_copy) == ("", "")
    ours, theirs = (read_files(folder).manifest.seal[:12] for folder in (forged, ships))
    assert of_forged == f"manifest.json: its seal {ours}… {SEAL}, {theirs}… (index.json)"
    # another scene or command is another dataset
    assert not any(SEAL in said for said in of_others)

    forge(ships, manifest=retitle)
    assert SEAL in verified(project, ships)[0]
    shutil.rmtree(ships)
    assert verified(project, forged) == [""]  # there is nothing that it could be a copy of


def test_a_copy_that_was_made_here_with_other_versions_need_not_have_it(
    project, original, tmp_path
):
    ships = ship(project, original)
    made_here = copied(ships, tmp_path / "here", retitle)
    made_nowhere = copied(ships, tmp_path / "nowhere", lambda m: m["generator"].update(heyoka="1"))
    forge(ships, manifest=lambda m: m["generator"].update(heyoka="0"))
    here, nowhere = verified(project, made_here, made_nowhere)
    assert here == ""
    assert SEAL in nowhere


@pytest.mark.parametrize("audit", [True, False])
def test_a_proof_in_its_place_says_that_it_was_audited(project, tmp_path, audit):
    pytest.importorskip("flint")
    solution = reference.solve(
        "paris", t_end="20", digits=12, level="enclosed", confirm="none", audit=audit
    )
    elsewhere = reference.write(solution, tmp_path / "paris")
    in_place, of_copy = verified(project, ship(project, elsewhere), elsewhere)
    assert of_copy == ""
    said = "manifest.json: a proof that ships must be audited: make it again with --audit"
    assert in_place == ("" if audit else said)


def test_no_proof_is_written_there_unaudited(project):
    """Paris, at the level of what ships."""
    pytest.importorskip("flint")
    words = (
        "generate",
        "paris",
        "--t-end",
        "20",
        "--digits",
        "12",
        "--no-audit",
        "--no-confirm",
        "--engine",
        "heyoka",
    )
    done = foucault_of(project, *words, "--out", "data/golden/paris", numba=False)
    assert (done.returncode, "expected an audited proof" in done.stderr) == (2, True)
    assert not (project / "data/golden/paris").exists()
