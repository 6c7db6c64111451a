"""CITATION.cff, written anew from pyproject.toml and the changelog: python tests/helpers/citation.py."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any

from places import ROOT

PAGE, CHANGELOG = ROOT / "CITATION.cff", ROOT / "CHANGELOG.md"
PAPER = """references:
  - type: article
    title: "The Foucault Pendulum: Trajectories of the Full Lagrangian"
    authors:
      - family-names: Mathar
        given-names: Richard J.
    year: 2023
"""


def project() -> dict[str, Any]:
    """Return the table [project] of pyproject.toml."""
    return dict(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"])


def text() -> str:
    """Return CITATION.cff: version, authors, URL and words from pyproject.toml, the day from the changelog."""
    return "\n".join(lines(project())) + "\n" + PAPER


def lines(told: dict[str, Any]) -> Iterator[str]:
    """Yield its lines, but for the paper."""
    version = told["version"]
    found = re.search(
        rf"^## {re.escape(version)} \((\d{{4}}-\d\d-\d\d)\)$",
        CHANGELOG.read_text(encoding="utf-8"),
        re.M,
    )
    if found is None:
        raise SystemExit(
            f"CHANGELOG.md: got no section for {version}, expected '## {version} (YEAR-MONTH-DAY)'. Add it."
        )
    yield "cff-version: 1.2.0"
    yield "title: Reference solver for the Foucault pendulum"
    yield "message: If you use a golden dataset, please cite this software and the version of the data in its manifest."
    yield f"abstract: {told['description'].replace(': ', ', ')}."
    yield "type: software"
    yield f"version: {version}"
    yield f"date-released: {found[1]}"
    yield f"license: {told['license']}"
    yield f"keywords: [{', '.join(told['keywords'])}]"
    for name, key in (("Repository", "repository-code"), ("Documentation", "url")):
        if name in told.get("urls", {}):
            yield f"{key}: {told['urls'][name]}"
    yield "authors:"
    for author in told["authors"]:
        given, _, family = author["name"].rpartition(" ")
        person = "email" in author  # a group has a name alone
        yield (
            f"  - family-names: {family}\n    given-names: {given}"
            if person
            else f"  - name: {author['name']}"
        )


if __name__ == "__main__":
    PAGE.write_text(text(), encoding="utf-8")
