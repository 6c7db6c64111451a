"""A command's options are the fields of a class, and a table says which exclude each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from reference.commands.options import Conflict, as_command, refuse_conflicts, values_by_word
from reference.commands.terminal import option, scene_argument
from reference.errors import InputError


@dataclass(frozen=True)
class Options:
    scene: Annotated[str | None, scene_argument()] = None
    run: Annotated[str | None, option("--run", "Run a program.", "COMMAND")] = None
    timeout: Annotated[float | None, option("--timeout", "Stop it.", "S")] = None
    audit: Annotated[bool | None, option("--audit/--no-audit", "Prove it again.")] = None
    reading: Annotated[str, option("--reading", "Read it so.", "WORD")] = "auto"


CONFLICTS = [
    Conflict("--timeout --no-audit --reading", "without --run", lambda chosen: chosen.run is None)
]


def run(options: Options) -> None:
    """Print what was chosen."""
    typer.echo(options)


def test_a_command_takes_the_fields_of_a_class_and_its_help_has_their_words():
    app = typer.Typer()
    app.command("try")(as_command(Options, run))
    runner = CliRunner()
    result = runner.invoke(app, ["paris", "--timeout", "3", "--no-audit"])
    assert result.output.strip() == str(Options("paris", None, 3.0, False))
    help_text = runner.invoke(app, ["--help"]).output
    assert "Print what was chosen." in help_text and "--no-audit" in help_text


def test_values_are_named_as_a_user_types_them():
    values = values_by_word(Options("paris", audit=False))
    assert values == {
        "SCENE": "paris",
        "--run": None,
        "--timeout": None,
        "--audit": None,
        "--no-audit": True,
        "--reading": None,
    }


def test_an_option_without_effect_is_refused_by_its_word_and_the_case():
    refuse_conflicts(Options("paris", "a.out", 3.0), CONFLICTS)
    with pytest.raises(InputError, match=r"--timeout: has no effect without --run"):
        refuse_conflicts(Options("paris", None, 3.0), CONFLICTS)
    with pytest.raises(InputError, match=r"--no-audit"):
        refuse_conflicts(Options("paris", audit=False), CONFLICTS)


@dataclass(frozen=True)
class OfOneScene:
    scene: Annotated[str, scene_argument()]


def test_a_field_without_a_default_is_required():
    app = typer.Typer()
    app.command("try")(as_command(OfOneScene, run))
    runner = CliRunner()
    missing = runner.invoke(app, [])
    assert missing.exit_code == 2 and "Missing argument" in missing.output
    assert runner.invoke(app, ["paris"]).output.strip() == str(OfOneScene("paris"))


def test_an_option_at_its_default_changes_nothing_and_is_not_refused():
    refuse_conflicts(Options("paris", reading="auto"), CONFLICTS)
    with pytest.raises(InputError, match=r"--reading: has no effect without --run"):
        refuse_conflicts(Options("paris", reading="binary64"), CONFLICTS)
