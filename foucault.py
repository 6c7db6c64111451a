"""The command `foucault`: the commands of `reference` (compute datasets) and `compare` (judge results) in one."""

from __future__ import annotations

import atexit
import gc
import os
import re
import signal
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    import typer

# a fault of this program, EX_SOFTWARE of sysexits.h; 1 would be a verdict, 2 the user's mistake
UNFORESEEN = 70
INTERRUPTED = 130
STOPPED = "stopped"  # of a command that says no more of what became of its work
UNREAD = 141  # the reader of the output is gone, as after SIGPIPE
GROUPS = {
    "Solve and judge": ("scenes", "show", "generate", "verify", "score", "plot", "atlas"),
    "Compare many": ("methods", "study", "stability", "sweep"),
    "The source papers": ("paper", "pend"),
}
SELDOM = 100_000  # objects made between two searches for garbage: imports make many, and leave none


def commands() -> typer.Typer:
    """Return the command line; all imports are here, so that an interruption finds `main` at work."""
    import typer
    from typer.core import TyperGroup

    from compare.commands import app as comparing
    from reference.commands import app as computing

    class Grouped(TyperGroup):
        """The commands, listed in groups of one purpose each."""

        def format_commands(self, ctx: Any, formatter: Any) -> None:
            """Write a list of commands for each group, with the first line of their help."""
            for heading, names in GROUPS.items():
                with formatter.section(heading):
                    helps = {name: self.commands[name].help or "" for name in names}
                    formatter.write_dl(
                        [(name, text.partition("\n")[0]) for name, text in helps.items()]
                    )

        def invoke(self, ctx: Any) -> Any:
            """Run a command; a number that is none is told in plain words."""
            try:
                return super().invoke(ctx)
            except typer.BadParameter as error:
                told = re.match("Input should be a valid (number|integer)", error.message)
                if told:
                    error.message = (
                        f"expected a {'whole ' * (told[1] == 'integer')}number, without a unit"
                    )
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
    """Run the command line; a mistake, a full disk or an interruption ends with a message and its exit status.

    So does an error that nobody foresaw.
    """
    gc.set_threshold(SELDOM)
    _open_closed_streams()
    # numpy's matrices are small here: more threads only wait
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        ended = _run()
    except KeyboardInterrupt:
        ended = INTERRUPTED, STOPPED, True
    except Exception as error:
        ended = UNFORESEEN, _report(error), False
    # here no exception is left, which would keep what a signal has interrupted from being cleared away
    if ended:
        _end(*ended)


def _open_closed_streams() -> None:
    """Have what is written to a stream that a shell has closed, as by 2>&-, go nowhere; Python leaves it None."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))


def _run() -> tuple[str | int | None, str, bool] | None:
    """Run a command; return how it ended, as `_end` takes it, or None where it simply did."""
    from reference.errors import FoucaultError, Stopped
    from reference.plain_text import plain_lines, plain_output
    from reference.system.interruption import terminable

    signals: list[int] = []
    try:
        with plain_output(), terminable() as signals:
            try:
                commands()(prog_name="foucault")
            finally:
                sys.stdout.flush()
    except SystemExit as end:
        unread = isinstance(end.__context__, BrokenPipeError)
        status = UNREAD if unread else end.code
        stopped = signals or status == INTERRUPTED
        return status, STOPPED if stopped else "", bool(signals)
    except Stopped as stopped:
        return stopped.exit_status, str(stopped), bool(signals)
    except Exception as error:
        if signals:  # what followed from the interruption is no mistake of the user's
            return 128 + signals[0], STOPPED, True
        if isinstance(error, FoucaultError):
            return error.exit_status, str(error), False
        if not isinstance(error, OSError):
            raise
        _flush_output()
        if isinstance(error, BrokenPipeError):
            return UNREAD, "", False
        return 2, plain_lines(f"{error.filename or 'output'}: {error.strerror or error}"), False
    return None


def _report(error: Exception) -> str:
    """Return what a user is to do about an error that nobody foresaw, and what a maintainer needs, its traceback."""
    import traceback

    from reference.plain_text import plain_lines

    asked = "Please report the command, what `foucault --version` prints, and all that follows."
    lines = "".join(traceback.format_exception(error)).rstrip()
    return plain_lines(f"This is a fault of foucault, not yours. {asked}\n{lines}")


def _end(status: str | int | None, message: str, interrupted: bool) -> NoReturn:
    """End with a message and an exit status; an interrupted run waits for no thread that is still at work."""
    # from here on Ctrl-C would only show the innards of Python's own end
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if message:
        with suppress(OSError):  # nobody reads it; the exit status stays
            print(f"foucault: {message}", file=sys.stderr)
    if interrupted and isinstance(status, int):
        _flush_output()
        atexit._run_exitfuncs()
        os._exit(status)
    raise SystemExit(status) from None


def _flush_output() -> None:
    """Write out what waits for stdout; drop what cannot be written, which Python would try again when it ends."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


if __name__ == "__main__":
    main()
