"""The front door: one command `foucault`."""

from __future__ import annotations

import sys

from reference.cli import app
from reference.errors import FoucaultError


def main() -> None:
    """Run the command line; a user's mistake ends with a message and its exit status, not a traceback."""
    try:
        app(prog_name="foucault")
    except FoucaultError as error:
        print(f"foucault: {error}", file=sys.stderr)
        raise SystemExit(error.exit_status) from None


if __name__ == "__main__":
    main()
