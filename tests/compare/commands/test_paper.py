"""`foucault paper`, with the rows that the page was built from."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from compare import papers as paper
from compare.commands.paper import command
from compare.papers.checks import JudgedRow


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch, built: tuple[Path, list[JudgedRow]]) -> typer.Typer:
    monkeypatch.setattr(paper, "rows", lambda report=None: built[1])
    made = typer.Typer()
    made.command("paper")(command)
    made.command("other")(lambda: None)
    return made


def test_json_is_one_document_with_every_row(app: typer.Typer, built: tuple[Path, list[JudgedRow]]) -> None:
    outcome = CliRunner().invoke(app, ["paper", "--json"])
    assert outcome.exit_code == 0
    rows = json.loads(outcome.stdout)["rows"]
    assert [row["id"] for row in rows] == [row.id for row in built[1]]
    assert {row["verdict"] for row in rows} == {"exact", "reproduced", "approximation", "misprint"}


def test_text_names_every_place_and_counts_the_verdicts(app: typer.Typer, built: tuple[Path, list[JudgedRow]]) -> None:
    outcome = CliRunner().invoke(app, ["paper"])
    assert outcome.exit_code == 0
    assert all(row.place in outcome.stdout for row in built[1])
    assert f"misprint       {sum(row.verdict == 'misprint' for row in built[1])}" in outcome.stdout


def test_a_folder_that_is_not_ours_is_refused(
    app: typer.Typer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from compare.papers import figures
    from reference import InputError

    (tmp_path / "index.html").write_text("mine")
    monkeypatch.setattr(figures, "svg", lambda number: "<svg/>")
    outcome = CliRunner().invoke(app, ["paper", "--out", str(tmp_path)])
    assert isinstance(outcome.exception, InputError)
    assert outcome.exception.exit_status == 2
    assert [path.name for path in tmp_path.iterdir()] == ["index.html"]
    assert (tmp_path / "index.html").read_text() == "mine"
