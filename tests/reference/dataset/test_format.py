"""docs/format.md: every file, column, key and exit status in it is the code's, and none is missing."""

from __future__ import annotations

import json
import re
from dataclasses import fields

import pytest
from places import ROOT
from pydantic import BaseModel

from compare.papers.checks import JudgedRow
from compare.studies.row import Row
from compare.studies.stability import Cell
from foucault import UNFORESEEN, UNREAD
from reference import errors
from reference.dataset import function, manifest, render
from reference.dataset.sheets import GRID_HEADER, NUMBERS, SECTIONS_HEADER, TRANSITS_HEADER
from reference.scenes.fields import LEVELS
from reference.scenes.shipped import DATA_VERSION

PAGE = (ROOT / "docs/format.md").read_text("utf-8")


def section(title: str) -> str:
    """Return what stands below a heading, up to the next."""
    (text,) = re.findall(rf"^##+ {re.escape(title)}\n(.*?)(?=^##|\Z)", PAGE, re.M | re.S)
    return text


def table(title: str) -> list[str]:
    """Return the first words of a section's table."""
    return re.findall(r"^\| `([\w.]+)` \|", section(title), re.M)


def own(model: type[BaseModel], base: type[BaseModel] | None = None) -> list[str]:
    return [name for name in model.model_fields if base is None or name not in base.model_fields]


PARTS = {
    "manifest.json": own(manifest.Manifest),
    "bounds": own(manifest.Bounds),
    "counts": own(manifest.Counts),
    "possible": own(manifest.Possible),
    "sections": own(manifest.SectionsRecord),
    "invariant": own(manifest.Invariant),
    "equations": own(manifest.Equations),
    "run": own(manifest.RunRecord),
    "cross_checks": own(manifest.CrossCheckRecord, manifest.RunRecord),
    "enclosure": own(manifest.EnclosureRecord),
    "files": own(manifest.FileRecord),
    "vectors.json": own(render.Vectors),
    "states": own(render.StateVector),
    "transits": own(render.TransitVector),
    "values": own(render.Value),
    "function.json": own(function.FunctionRecord),
    "grid.csv": list(GRID_HEADER),
    "transits.csv": list(TRANSITS_HEADER),
    "sections.csv": list(SECTIONS_HEADER),
}


@pytest.mark.parametrize("title", PARTS)
def test_a_table_of_the_page_names_what_the_code_writes_in_its_order(title):
    assert table(title) == PARTS[title]


def test_every_part_of_the_two_documents_has_its_table():
    parts = {
        one
        for module in (manifest, render, function)
        for one in vars(module).values()
        if isinstance(one, type)
    }
    written = [
        one
        for one in parts
        if issubclass(one, manifest.ManifestPart) and one is not manifest.ManifestPart
    ]
    described = [set(names) for names in PARTS.values()]
    extended = set(own(manifest.CrossCheckRecord))  # its table continues that of a run
    assert all(set(own(one)) in [*described, extended] for one in written)


def test_the_files_are_those_of_the_code_and_say_which_are_optional():
    rows = re.findall(r"^\| `([\w.]+)` \| (always|optional) \|", section("Files"), re.M)
    assert {name for name, when in rows if when == "always"} == {
        manifest.MANIFEST,
        *manifest.ALWAYS,
    }
    assert [name for name, when in rows if when == "optional"] == list(manifest.OPTIONAL)


def test_words_and_numbers_are_those_of_the_code():
    assert f"| `schema_version` | the format, {manifest.FORMAT} |" in PAGE
    assert PAGE.startswith(f"# The format of golden datasets\n\nFormat {manifest.FORMAT},")
    assert all(f"`{level}`" in section("manifest.json") for level in LEVELS)
    assert all(
        f"`{name}_hex`" in section("grid.binary64.csv and transits.binary64.csv")
        for name in NUMBERS["transits"]
    )
    assert f"At most {render.MOST} states and {render.MOST} transits" in PAGE
    assert all(f"`{flag}`" in section("vectors.json") for flag in render.NOTES)
    for word in manifest.Manifest.model_fields["transits"].annotation.__args__:
        assert f"`{word}`" in section("manifest.json")


def test_the_changelog_says_what_the_version_of_the_data_holds():
    data = (ROOT / "CHANGELOG.md").read_text("utf-8").partition("\n## Data\n")[2]
    assert f"- **{DATA_VERSION}**:" in data


PROMISES = section("Versions, and what is promised from 1.0 on")


def promised(command: str) -> set[str]:
    """Return the keys that a command's JSON document keeps."""
    (row,) = re.findall(rf"^\| `{command}` \| (.+) \|$", PROMISES, re.M)
    return set(re.findall(r"`(\w+)`", row))


def test_promised_keys_of_studies_and_scores_are_there():
    study = {"scene", "t_end", "reference", "rows"}
    assert promised("study") - study <= {one.name for one in fields(Row)}
    assert promised("stability") - {"rows"} <= {one.name for one in fields(Cell)}
    assert promised("paper") - {"rows"} <= {one.name for one in fields(JudgedRow)}
    schema = json.loads((ROOT / "compare/report/score.schema.json").read_text("utf-8"))
    assert promised("score") <= set(schema["$defs"]["score"]["required"])


def test_promised_keys_are_printed(foucault, tmp_path):
    words = ("--t-end", "60", "--digits", "9", "--level", "computed", "--json")
    status, out, _ = foucault("generate", "laboratory", *words, "--out", tmp_path / "laboratory")
    assert (status, promised("generate") - json.loads(out).keys()) == (0, set())
    status, out, _ = foucault("verify", tmp_path / "laboratory", "--json")
    document = json.loads(out)
    assert (status, promised("verify") - document.keys() - document["rows"][0].keys()) == (0, set())
    status, out, _ = foucault(
        "sweep", "laboratory", "--over", "site.latitude=40,45", "--t-end", "60", "--json"
    )
    document = json.loads(out)
    assert (status, promised("sweep") - document.keys() - document["rows"][0].keys()) == (0, set())


def test_every_exit_status_stands_there():
    listed = set(map(int, re.findall(r"^\| (\d+) \|", PROMISES, re.M)))
    kinds = [
        one
        for one in vars(errors).values()
        if isinstance(one, type) and issubclass(one, errors.FoucaultError)
    ]
    assert listed == {0, UNFORESEEN, UNREAD, *(one.exit_status for one in kinds)}
