"""The command `foucault`: the commands of `reference` (compute datasets) and `compare` (judge results) in one."""

from __future__ import annotations

import os
import signal
import sys
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    import typer

INTERRUPTED = 130


def commands() -> typer.Typer:
    """Return the command line; all imports are here, so that an interruption finds `main` at work."""
    import typer

    from compare.commands import app as comparing
    from reference.commands import app as computing

    app = typer.Typer(
        help="Reference solutions of the Foucault pendulum, and programs judged by them.",
        add_completion=False,
        no_args_is_help=True,
        rich_markup_mode=None,
    )
    app.add_typer(computing)
    app.add_typer(comparing)
    return app


def main() -> None:
    """Run the command line; a mistake, a full disk or an interruption ends with a message and its exit status."""
    try:
        _run()
    except KeyboardInterrupt:
        _end(INTERRUPTED)


def _run() -> None:
    from reference.errors import FoucaultError
    from reference.process import terminable

    try:
        with terminable():
            try:
                commands()(prog_name="foucault")
            finally:
                sys.stdout.flush()
    except SystemExit as end:
        _end(end.code)
    except FoucaultError as error:
        _end(error.exit_status, str(error))
    except BrokenPipeError:
        _forget_output()
        _end(1)
    except OSError as error:
        _forget_output()
        _end(2, f"{error.filename or 'output'}: {error.strerror or error}")


def _end(status: str | int | None, message: str = "") -> NoReturn:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # from here on Ctrl-C would only show the innards of Python's own end
    if message:
        print(f"foucault: {message}", file=sys.stderr)
    raise SystemExit(status) from None


def _forget_output() -> None:
    """Drop what could not be written to stdout, which Python would try again when it ends."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


if __name__ == "__main__":
    main()
