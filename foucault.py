"""The command `foucault`: those of `reference` (compute) and `compare` (judge) in one."""

from __future__ import annotations

import atexit
import gc
import os
import re
import signal
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

if TYPE_CHECKING:
    import typer

# a fault of this program, EX_SOFTWARE of sysexits.h; 1 would be a verdict, 2 the user's mistake
UNFORESEEN = 70
_INTERRUPTED = 130
_STOPPED = "stopped"  # of a command that does not say what became of its work
UNREAD = 141  # the reader of the output is gone, as after SIGPIPE
GROUPS = {
    "Solve and judge": ("scenes", "show", "generate", "verify", "score", "plot", "atlas"),
    "Compare many": ("methods", "study", "stability", "sweep"),
    "The source papers": ("paper", "pend"),
}
# objects made between two searches for garbage: imports make many, and leave none
SELDOM = 100_000


def commands() -> typer.Typer:
    """Return the command line; all imports are here, so that Ctrl-C finds `main` at work."""
    import typer
    from typer.core import TyperGroup

    from compare.commands import app as comparing
    from reference.commands import app as computing

    class Grouped(TyperGroup):
        """The commands, listed in groups of one purpose each."""

        def format_commands(self, ctx: Any, formatter: Any) -> None:
            """Write a list of commands for each group, with the first line of their help."""
            for heading, names in GROUPS.items():
                rows = []
                for name in names:
                    first_line, _, _ = (self.commands[name].help or "").partition("\n")
                    rows.append((name, first_line))
                with formatter.section(heading):
                    formatter.write_dl(rows)

        def invoke(self, ctx: Any) -> Any:
            """Run a command; the message on a malformed number is in plain words."""
            try:
                return super().invoke(ctx)
            except typer.BadParameter as error:
                malformed = re.match("Input should be a valid (number|integer)", error.message)
                if malformed:
                    number = "whole number" if malformed[1] == "integer" else "number"
                    error.message = f"expected a {number}, without a unit"
                raise
            except EOFError as error:  # typer takes it for a user's Ctrl-D: "Aborted!", status 1
                raise RuntimeError("a file or a pipe ended too early") from error

    app = typer.Typer(
        cls=Grouped,
        no_args_is_help=True,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["--help", "-h"], "max_content_width": 110},
    )
    for part in (computing, comparing):
        app.add_typer(part)

    version_option = typer.Option(
        False,
        "--version",
        callback=_version,
        is_eager=True,
        help="Print the versions of code and data and exit.",
    )

    def front(_: bool = version_option) -> None:
        """Compute reference solutions of the Foucault pendulum, and judge other programs by them.

        A scene is a pendulum, its site and its release. `foucault scenes` lists those that come with the project;
        `foucault generate paris --out paris` solves one, `foucault score paris mine.csv` judges what your program
        printed for it. `foucault COMMAND --help` explains a command.
        """

    app.callback()(front)
    return app


def _version(wanted: bool) -> None:
    """Print the versions of the code and of the data, if asked for them, and end."""
    import typer

    if wanted:
        from importlib.metadata import PackageNotFoundError, version

        from reference.scenes.shipped import DATA_VERSION

        try:
            code = f"foucault {version('foucault-reference')}"
        except PackageNotFoundError:
            code = "foucault, not installed"
        typer.echo(f"{code}, data {DATA_VERSION}")
        raise typer.Exit


def main() -> None:
    """Run the command line; every error ends with a message and its exit status."""
    gc.set_threshold(SELDOM)
    _open_closed_streams()
    # numpy's matrices are small here: more threads only wait
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        end = _run()
    except KeyboardInterrupt:
        end = _End(_INTERRUPTED, _STOPPED, interrupted=True)
    except Exception as error:
        end = _End(UNFORESEEN, _report(error))
    # here no exception is left: it would keep alive what a signal has interrupted
    if end:
        _exit(end)


class _End(NamedTuple):
    """How a command ended: its exit status, a message, and whether it was interrupted."""

    status: str | int | None
    message: str = ""
    interrupted: bool = False


def _open_closed_streams() -> None:
    """Discard what is written to a stream that a shell has closed, as by 2>&-.

    Python leaves such a stream None.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))


def _run() -> _End | None:
    """Run a command; return how it ended, None if it ended without an exit status of its own."""
    from reference.errors import Stopped
    from reference.plain_text import plain_output
    from reference.system.interruption import terminable

    signals: list[int] = []
    try:
        with plain_output(), terminable() as signals:
            try:
                commands()(prog_name="foucault")
            finally:
                sys.stdout.flush()
    except SystemExit as end:
        status = end.code
        if isinstance(end.__context__, BrokenPipeError):
            status = UNREAD
        stopped = signals or status == _INTERRUPTED
        return _End(status, _STOPPED if stopped else "", interrupted=bool(signals))
    except Stopped as stopped:
        return _End(stopped.exit_status, str(stopped), interrupted=bool(signals))
    except Exception as error:
        if signals:  # what followed from the interruption is no mistake of the user's
            return _End(128 + signals[0], _STOPPED, interrupted=True)
        return _end_of(error)
    return None


def _end_of(error: Exception) -> _End:
    """Return how a command ends by an error that is foreseen; raise any other again."""
    from reference.errors import FoucaultError
    from reference.plain_text import plain_lines

    if isinstance(error, FoucaultError):
        return _End(error.exit_status, str(error))
    if not isinstance(error, OSError):
        raise error
    _flush_output()
    if isinstance(error, BrokenPipeError):
        return _End(UNREAD)
    place = error.filename or "output"
    return _End(2, plain_lines(f"{place}: {error.strerror or error}"))


def _report(error: Exception) -> str:
    """Return what a user should do about an unforeseen error, and its traceback."""
    import traceback

    from reference.plain_text import plain_lines

    asked = "Please report the command, what `foucault --version` prints, and all that follows."
    lines = "".join(traceback.format_exception(error)).rstrip()
    return plain_lines(f"This is a fault of foucault, not yours. {asked}\n{lines}")


def _exit(end: _End) -> NoReturn:
    """End with a message and an exit status; an interrupted run waits for no thread."""
    # from here on Ctrl-C would only show the innards of Python's own end
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if end.message:
        with suppress(OSError):  # nobody reads it; the exit status stays
            print(f"foucault: {end.message}", file=sys.stderr)
    if end.interrupted and isinstance(end.status, int):
        _flush_output()
        atexit._run_exitfuncs()
        os._exit(end.status)
    raise SystemExit(end.status) from None


def _flush_output() -> None:
    """Flush stdout; drop what cannot be written, which Python would try again at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


if __name__ == "__main__":
    main()
