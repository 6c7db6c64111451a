"""The commands that judge. Results on stdout, progress on stderr."""

from __future__ import annotations

import typer

from .commands import score, stability, study
from .paper import command as paper
from .pend import command as pend

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)
for one in (score, study, stability, pend, paper):
    one.register(app)
