"""Shared parts of the commands: comma-separated options, folders of results, and how a command ends."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer

from reference import InputError
from reference.commands.terminal import emit


def listed(text: str | None, field: str) -> list[str] | None:
    """Split a comma-separated option into words."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words:
        raise InputError(field, text, "at least one word", "Separate several with commas.")
    return words


def numbers(text: str, field: str) -> list[float]:
    """Split a comma-separated option into positive numbers."""
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if not values or not all(0 < value < float("inf") for value in values):
        raise InputError(field, text, "positive numbers", "Separate several with commas.")
    return values


def inside(folder: Path | None, name: str) -> Path | None:
    """Return the path of a file in a folder of results; None if there is no folder."""
    return None if folder is None else folder / name


def resumes(folder: Path | None) -> str:
    """Return what becomes of a campaign that is stopped, whose results go into a folder (None: nowhere)."""
    if folder is None:
        return "nothing was kept; with --out, the same command would go on where it stopped"
    return "the same command with the same --out goes on where it stopped"


def announce(text: str) -> None:
    """Print a message on stderr before work that takes long."""
    typer.echo(text, err=True)


def finish(document: dict[str, Any], text: Callable[[dict[str, Any]], str], page: Path | None, as_json: bool) -> None:
    """Print a result as a JSON document, or as text with the path of the page that was written."""
    if as_json:
        emit(document)
        return
    typer.echo(text(document))
    if page is not None:
        typer.echo(f"{page}: the report")
