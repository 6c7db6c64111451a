"""The command `foucault`: the commands of `reference` (compute datasets) and `compare` (judge results) in one."""

from __future__ import annotations

import sys
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated

import typer

from compare.commands import app as comparing
from reference.commands import app as computing
from reference.errors import FoucaultError
from reference.plain_text import plain_output

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["--help", "-h"]},
)
app.add_typer(computing)
app.add_typer(comparing)


def _version(asked: bool) -> None:
    if asked:
        try:
            typer.echo(f"foucault {version('foucault-reference')}")
        except PackageNotFoundError:
            typer.echo("foucault, not installed")
        raise typer.Exit


@app.callback()
def front(
    _: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Compute reference solutions of the Foucault pendulum, and judge other programs by them.

    A scene is a pendulum, its site and its release. `foucault scenes` lists those that come with the project;
    `foucault generate paris --out paris` solves one, `foucault score paris mine.csv` judges what your program printed
    for it. `foucault COMMAND --help` explains a command.
    """


def main() -> None:
    """Run the command line; a user's mistake ends with a message and its exit status, not a traceback."""
    with plain_output():
        try:
            app(prog_name="foucault")
        except FoucaultError as error:
            print(f"foucault: {error}", file=sys.stderr)
            raise SystemExit(error.exit_status) from None


if __name__ == "__main__":
    main()
