"""`foucault methods`: list the integrators and the approximations that are compared."""

from __future__ import annotations

import typer

from reference.commands.terminal import AsJson, emit


def command(as_json: AsJson = False) -> None:
    """List the integrators and approximations that are compared."""
    from ..approximations import APPROXIMATIONS
    from ..methods import METHODS, available

    if as_json:
        emit(
            {
                "methods": [
                    {"id": one.id, "title": one.title, "setting": one.setting, "missing": available(one)}
                    for one in METHODS.values()
                ],
                "approximations": [{"id": one.id, "title": one.title} for one in APPROXIMATIONS.values()],
            }
        )
        return
    width = max(map(len, (*METHODS, *APPROXIMATIONS)))
    typer.echo("Methods (study, stability):")
    for one in METHODS.values():
        missing = available(one)
        typer.echo(f"  {one.id:{width}}  {one.title}{f'  [{missing}]' if missing else ''}")
    typer.echo("Approximations (score --approximation, study --approximations):")
    for approximation in APPROXIMATIONS.values():
        typer.echo(f"  {approximation.id:{width}}  {approximation.title}")
