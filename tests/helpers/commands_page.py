"""The help of all commands in docs/commands.md, written anew from the code: python tests/helpers/commands_page.py."""

from __future__ import annotations

import re

import typer
from places import ROOT
from typer.cli import get_docs_for_click

from foucault import commands

PAGE, BEFORE = ROOT / "docs/commands.md", "because few people need them, are here as well.\n"


def page() -> str:
    """Return the page as it should be: what is written by hand, then what each command prints as its help."""
    command = typer.main.get_command(commands())
    context = typer.Context(command)
    for name in command.list_commands(context):
        for option in command.get_command(context, name).params:
            option.hidden = False  # the page has what the help leaves out
    text = get_docs_for_click(obj=command, ctx=context, name="foucault").partition("\n")[2].strip()
    for name in command.list_commands(context):
        first = str(command.get_command(context, name).help).partition("\n")[0]
        # it is cut there
        text = re.sub(rf"^\* `{name}`: .*$", f"* `{name}`: {first}", text, flags=re.M)
    text = text.replace("\n## `", "\n### `").replace("```console\n", "```text\n")
    return f"{PAGE.read_text(encoding='utf-8').partition(BEFORE)[0]}{BEFORE}\n{text}\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
