"""The index inside the package: a dataset that ships, or a copy of it, has the seal that stands there."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from forgery import forge

from reference.dataset import verify
from reference.dataset.files import read_files
from reference.errors import InputError


@pytest.fixture
def shipped(dataset, tmp_path, monkeypatch):
    """The dataset as if it came with the project."""
    monkeypatch.setattr(verify, "golden_root", lambda: tmp_path)
    seal = read_files(dataset).manifest.seal
    monkeypatch.setattr(verify, "seals", lambda: {"paris": seal})
    return dataset


def seals_of(folder):
    return list(verify.seal_problems(read_files(folder)))


def test_in_its_place_or_copied_from_there_a_dataset_has_the_seal_of_the_index(shipped, tmp_path):
    copied = Path(shutil.copytree(shipped, tmp_path / "elsewhere" / "paris"))
    assert seals_of(shipped) == seals_of(copied) == []
    forge(copied, manifest=lambda m: m.update(title="another"))
    (said,) = seals_of(copied)
    own, ships = (read_files(folder).manifest.seal[:12] for folder in (copied, shipped))
    assert said == f"manifest.json: its seal {own}… is not that of the dataset that ships, {ships}… (index.json)"
    aside = shipped.rename(tmp_path / "aside")
    with pytest.raises(InputError):
        read_files(shipped)
    assert seals_of(copied) == []  # there is nothing that it could be a copy of
    forge(aside, manifest=lambda m: m.update(title="another"))
    assert len(seals_of(aside.rename(shipped))) == 1


def test_another_scene_or_command_and_other_versions_of_here_need_not_have_it(shipped, tmp_path):
    for name, change in (
        ("scene", lambda m: m["scene"]["run"].update(t_end="60")),
        ("command", lambda m: m.update(command=m["command"] + " --no-confirm")),
        ("versions", lambda m: m.update(title="another")),
    ):
        copied = Path(shutil.copytree(shipped, tmp_path / name / "paris"))
        forge(copied, manifest=change)
        if name == "versions":
            forge(shipped, manifest=lambda m: m["generator"].update(heyoka="0"))
        assert seals_of(copied) == []
    forge(copied, manifest=lambda m: m["generator"].update(heyoka="1"))  # made neither there nor here
    assert len(seals_of(copied)) == 1


def test_a_proof_in_its_place_says_that_it_was_audited(shipped, tmp_path):
    files = read_files(shipped)
    aside = read_files(Path(shutil.copytree(shipped, tmp_path / "elsewhere" / "paris")))

    def said(files, **changes):
        return list(verify.seal_problems(replace(files, manifest=files.manifest.model_copy(update=changes))))

    command = files.manifest.command
    assert said(files, level="enclosed") == [
        "manifest.json: a proof that ships must be audited: make it again with --audit"
    ]
    assert said(files, level="enclosed", command=f"{command} --audit") == said(aside, level="enclosed") == []
