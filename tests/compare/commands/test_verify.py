"""`foucault verify` of sweeps and reports: whatever was changed, lost or added since they were written is told."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from here import measured_here
from lines import unwrapped

STUDY = (
    "study",
    "paris",
    "--t-end",
    "20",
    "--methods",
    "heyoka_double",
    "--limit",
    "0.05",
    "--no-formulations",
)
SWEEP = (
    "sweep",
    "paris",
    "--over",
    "latitude=0:80:20",
    "--t-end",
    "20",
    "--engine",
    "heyoka",
    "--audit",
    "1",
)


@pytest.fixture
def swept(foucault, tmp_path):
    pytest.importorskip("pyarrow")
    assert foucault(*SWEEP, "--out", tmp_path / "swept")[0] == 0
    return tmp_path / "swept"


@pytest.fixture
def studied(foucault, tmp_path, monkeypatch):
    measured_here(monkeypatch)
    assert foucault(*STUDY, "--out", tmp_path / "studied")[0] == 0
    return tmp_path / "studied"


def change_a_digit(path: Path) -> None:
    """Raise the last digit before the end of a number with a fraction; the text stays as long, and of the same form."""
    text = path.read_text()
    found = [*re.finditer(r"\.\d*([0-8])\d?\b", text)] or [*re.finditer(r"\b([0-8])\b", text)]
    at = found[-1].start(1)
    path.write_text(text[:at] + str(int(text[at]) + 1) + text[at + 1 :])


def test_what_is_whole_is_ok(foucault, swept, studied):
    status, out, _ = foucault("verify", swept, studied)
    assert (status, out) == (0, f"{swept}: ok\n{studied}: ok\n")


@pytest.mark.parametrize("name", ["summary.json", "plan.json"])
def test_a_digit_of_a_sweeps_documents_is_found(foucault, swept, name):
    change_a_digit(swept / name)
    status, out, err = foucault("verify", swept)
    assert status in (1, 2) and name in out + err


def test_a_sweep_without_its_summary_is_not_whole(foucault, swept):
    (swept / "summary.json").unlink()
    status, out, _ = foucault("verify", swept)
    assert status == 1 and "summary.json is missing" in unwrapped(out)


def test_a_damaged_part_and_one_that_does_not_belong_are_told(foucault, swept):
    part = swept / "rows/part-00000000.parquet"
    shutil.copy(part, swept / "rows/part-00000001.parquet")
    status, out, _ = foucault("verify", swept, "--json")
    (row,) = json.loads(out)["rows"]
    (problem,) = row["problems"]
    assert status == 1 and problem.startswith(
        "rows/part-00000001.parquet is not a part of this sweep: remove it"
    )
    data = bytearray(part.read_bytes())
    data[len(data) // 2] ^= 1
    part.write_bytes(data)
    status, out, _ = foucault("verify", swept)
    assert status == 1 and "1 of 1 parts are missing or damaged" in unwrapped(out)


def test_a_summary_that_is_not_of_these_rows_is_told(foucault, swept, tmp_path):
    assert foucault(*SWEEP, "--out", tmp_path / "other", "--over", "altitude=0,1")[0] == 0
    for name in ("summary.json", "SHA256SUMS"):
        shutil.copy(tmp_path / "other" / name, swept / name)
    status, out, _ = foucault("verify", swept)
    assert status == 1 and "plan.json is not as it was written" in unwrapped(out)


def test_of_a_sweep_that_an_earlier_version_wrote_the_summary_is_not_decided(foucault, swept):
    (swept / "SHA256SUMS").unlink()
    status, out, _ = foucault("verify", swept)
    assert status == 0 and "ok summary.json" in unwrapped(out)
    summary = json.loads((swept / "summary.json").read_text())
    (swept / "summary.json").write_text(json.dumps(summary | {"rows": 6}))
    status, out, _ = foucault("verify", swept)
    assert status == 1 and "but the parts contain" in unwrapped(out)


@pytest.mark.parametrize("name", ["study.json", "rows.csv", "index.html", "rows.jsonl"])
def test_a_digit_of_a_study_is_found(foucault, studied, name):
    change_a_digit(studied / name)
    status, out, _ = foucault("verify", studied)
    assert status == 1 and name in out and "not as it was written" in unwrapped(out)


def test_a_result_that_was_changed_is_measured_again_and_one_of_an_earlier_version_is_not(
    foucault, studied
):
    journal = studied / "rows.jsonl"
    *lines, last = journal.read_text().splitlines()
    unsealed = [
        json.dumps({key: value for key, value in json.loads(line).items() if key != "seal"})
        for line in lines
    ]
    journal.write_text("\n".join([*unsealed, last, ""]))
    assert "of an earlier version" in foucault("verify", studied)[1]
    change_a_digit(journal)
    written = len(journal.read_text().splitlines())
    assert foucault(*STUDY, "--out", studied)[0] == 0
    assert len(journal.read_text().splitlines()) == written + 1


def test_a_line_that_can_no_longer_be_read_is_told(foucault, studied):
    journal = studied / "rows.jsonl"
    journal.write_text(journal.read_text().replace('"item"', '"item', 1))
    status, out, _ = foucault("verify", studied)
    assert status == 1 and "rows.jsonl: line 1 is not as it was written" in unwrapped(out)


def test_a_line_that_was_cut_short_is_told_and_is_no_damage(foucault, studied):
    with (studied / "rows.jsonl").open("a") as journal:
        journal.write('{"recipe": "0')
    status, out, _ = foucault("verify", studied)
    assert status == 0 and "rows.jsonl: lines that were cut short" in unwrapped(out)


def test_recomputing_is_for_datasets(foucault, studied):
    status, _, err = foucault("verify", studied, "--recompute")
    assert status == 2 and "--recompute" in err
