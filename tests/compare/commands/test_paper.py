"""`foucault paper`, with a row of each verdict."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from compare import papers as paper
from compare.commands.papers import paper as command
from compare.papers.checks import JudgedRow

ROWS = [
    JudgedRow("mathar_1", "Mathar II (1)", "x = y", "0", "exact"),
    JudgedRow("mathar_2", "Mathar II (2)", "1.5", "1.5", "reproduced"),
    JudgedRow("gastebois_3", "Gastebois 5", "z = 0", "1.2e-3", "approximation", error="1.2e-3 m"),
    JudgedRow("methods_4", "Methods 2", "-m", "+m", "misprint", correction="+m"),
    JudgedRow("methods_5", "Methods 3", "sin", "cos", "misprint", correction="cos"),
]


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch) -> typer.Typer:
    monkeypatch.setattr(paper, "rows", lambda report=None: ROWS)
    made = typer.Typer()
    made.command("paper")(command)
    made.command("other")(lambda: None)
    return made


def test_json_is_one_document_with_every_row(app: typer.Typer) -> None:
    outcome = CliRunner().invoke(app, ["paper", "--json"])
    assert outcome.exit_code == 0
    rows = json.loads(outcome.stdout)["rows"]
    assert [row["id"] for row in rows] == [row.id for row in ROWS]
    assert {row["verdict"] for row in rows} == {"exact", "reproduced", "approximation", "misprint"}


def test_text_names_every_place_and_counts_the_verdicts(app: typer.Typer) -> None:
    outcome = CliRunner().invoke(app, ["paper"])
    assert outcome.exit_code == 0
    assert all(row.place in outcome.stdout for row in ROWS)
    assert f"misprint       {sum(row.verdict == 'misprint' for row in ROWS)}" in outcome.stdout


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
