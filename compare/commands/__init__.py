"""Commands that use the datasets: score, study, stability, sweep, plot, atlas, methods, pend, paper."""

from __future__ import annotations

import typer

from . import atlas, methods, paper, pend, plot, score, stability, study, sweep

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)
app.command("score")(score.command)
app.command("study")(study.command)
app.command("stability")(stability.command)
app.command("sweep")(sweep.command)
app.command("plot")(plot.command)
app.command("atlas")(atlas.command)
app.command("methods")(methods.command)
app.command("pend")(pend.command)
app.command("paper")(paper.command)
