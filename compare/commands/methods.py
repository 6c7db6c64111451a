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
                    {"id": method.id, "title": method.title, "setting": method.setting, "missing": available(method)}
                    for method in METHODS.values()
                ],
                "approximations": [
                    {"id": approximation.id, "title": approximation.title} for approximation in APPROXIMATIONS.values()
                ],
            }
        )
        return
    width = max(map(len, (*METHODS, *APPROXIMATIONS)))
    typer.echo("Methods (study, stability):")
    for method in METHODS.values():
        missing = available(method)
        typer.echo(f"  {method.id:{width}}  {method.title}{f'  [{missing}]' if missing else ''}")
    typer.echo("Approximations (score --approximation, study --approximations):")
    for approximation in APPROXIMATIONS.values():
        typer.echo(f"  {approximation.id:{width}}  {approximation.title}")
