"""Commands that compute datasets: scenes, show, generate, verify; progress goes to stderr."""

from __future__ import annotations

import typer

from . import generate, scenes, show, verify

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)
app.command("scenes")(scenes.scenes)
app.command("show")(show.command)
app.command("generate")(generate.command)
app.command("verify")(verify.command)
