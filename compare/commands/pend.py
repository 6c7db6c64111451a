"""`foucault pend`: run the paper's program foucPend, with the same switches."""

from __future__ import annotations

import sys
from inspect import Parameter, Signature
from typing import Annotated

import typer

from ..papers.foucpend.options import SWITCHES, Switch

ALSO = {"O": "-0", "l": "-1"}  # the letters may be read as digits where they are printed


def command(*, exact: bool = False, **typed: str | None) -> None:
    """Run the paper's program foucPend.

    It integrates at a fixed step and prints snapshots and transits.
    """
    from ..papers.foucpend import Options, lines

    options = Options.parse({letter: text for letter, text in typed.items() if text is not None}, exact)
    output = lines(options)
    while block := [line for _, line in zip(range(4096), output, strict=False)]:
        sys.stdout.write("\n".join(block) + "\n")


def _parameter(letter: str, switch: Switch) -> Parameter:
    """Return the parameter of `command` for a switch."""
    names = [f"-{letter}", *([ALSO[letter]] if letter in ALSO else [])]
    option = typer.Option(*names, metavar=switch.unit, help=f"{switch.help} [{switch.default}].")
    return Parameter(letter, Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option])


_EXACT = Annotated[bool, typer.Option("--exact", help="Print the same lines from the reference.")]

# what typer reads: one keyword for each switch of the table, then --exact
command.__signature__ = Signature([  # type: ignore[attr-defined]
    *(_parameter(letter, switch) for letter, switch in SWITCHES.items()),
    Parameter("exact", Parameter.KEYWORD_ONLY, default=False, annotation=_EXACT),
])  # fmt: skip
