"""A JSON-lines file to which a study appends each result, so that an interrupted study resumes where it stopped."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reference import InputError


@dataclass(frozen=True)
class Journal:
    """A file of JSON lines, each a result with the recipe it was measured by.

    Attributes:
        path: the file; None if nothing is to be stored.
        recipe: must be equal for a stored result to be used again.
    """

    path: Path | None
    recipe: str

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """Yield the results of the same recipe, in order; a line cut short by an interrupt is skipped."""
        if self.path is None or not self.path.exists():
            return
        for line in self.path.read_text().splitlines():
            try:
                record = json.loads(line)
                if record["recipe"] == self.recipe:
                    yield dict(record["result"])
            except (ValueError, KeyError, TypeError):
                continue

    def add(self, result: dict[str, Any]) -> None:
        """Append one result.

        Raises:
            InputError: the file cannot be written.
        """
        if self.path is None:
            return
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a") as stream:
                stream.write(json.dumps({"recipe": self.recipe, "result": result}) + "\n")
        except OSError as error:
            raise InputError("--out", str(self.path), "a folder that can be written to", f"{error.strerror}.") from None
