"""Run the page's integrator in Node.js: the motion of scenes, with its own estimate of the error."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable, Sequence
from typing import Any

from compare.report.atlas.form import fields, form_words, texts_of
from compare.report.atlas.parts import plain, vocabulary
from compare.report.atlas.scripts import WORKERS, source
from reference import Scene

_RUN = """
const asked = JSON.parse(require("fs").readFileSync(0, "utf8"));
const { fields, words } = asked;
const told = asked.cases.map(({ texts, times }) => {
  try {
    const begin = performance.now();
    const solved = solve(sceneOf(texts, fields), words);
    const seconds = (performance.now() - begin) / 1000;
    const transits = solved.truth.transits && [...solved.truth.transits.t];
    return { states: times.map(solved.at), errors: times.map(solved.error), facts: solved.facts, transits, seconds };
  } catch (error) {
    if (!(error instanceof Unsolvable)) throw error;
    return { refused: error.message };
  }
});
console.log(JSON.stringify(told));
"""


def code(*names: str) -> str:
    """Return the scripts of the page's worker as one program, and further ones."""
    return "\n".join(map(source, (*WORKERS["solving"], *names)))


def node(script: str, document: Any) -> Any:
    """Return what a script prints as JSON, given a document on its standard input."""
    done = subprocess.run(
        ["node", "-e", script],
        input=json.dumps(document, default=plain),
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def words() -> dict[str, Any]:
    """Return the words and limits that the page has."""
    return vocabulary() | form_words()


def motions(cases: Iterable[tuple[Scene, Sequence[float]]]) -> list[dict[str, Any]]:
    """Return for each scene its states at some times in s, their estimated errors in m, its facts and its transits."""
    document = {
        "fields": fields(),
        "words": words(),
        "cases": [{"texts": texts_of(scene), "times": [*times]} for scene, times in cases],
    }
    told: list[dict[str, Any]] = node(code() + _RUN, document)
    return told
