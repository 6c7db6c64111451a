"""The command `foucault`: the commands of `reference` (compute datasets) and `compare` (judge results) in one."""

from __future__ import annotations

import sys

import typer

from compare.commands import app as comparing
from reference.commands import app as computing
from reference.errors import FoucaultError
from reference.plain_text import plain_output

app = typer.Typer(
    help="Reference solutions of the Foucault pendulum, and programs judged by them.",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.add_typer(computing)
app.add_typer(comparing)


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
