"""Commands that use the datasets: score, study, stability, sweep, plot, atlas, methods, pend, paper."""

from __future__ import annotations

import typer

from reference.commands.options import as_command

from . import papers, pictures, score, studies, sweep

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None)
app.command("score")(score.command)
app.command("study")(as_command(studies.StudyOptions, studies.study))
app.command("stability")(as_command(studies.StabilityOptions, studies.stability))
app.command("sweep")(as_command(sweep.SweepOptions, sweep.sweep))
app.command("plot")(pictures.plot)
app.command("atlas")(pictures.atlas)
app.command("methods")(studies.methods)
app.command("pend")(papers.pend)
app.command("paper")(papers.paper)
