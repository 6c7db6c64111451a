"""Sphinx: the site of all pages of the checkout and of the public docstrings; `make docs` builds it."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

project = "Reference solver for the Foucault pendulum"
author = ", ".join(
    one["name"]
    for one in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["authors"]
)
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]

# The source is the checkout: pages stay where a forge shows them, and their links lead to the same places.
root_doc = "docs/index"
include_patterns = [
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs/**.md",
    "docs/gallery/*.ipynb",
    "reference/enclosure/THEOREM.md",
]
exclude_patterns = [".*", "build", "compare", "data", "dist", "golden", "atlas", "tests"]
myst_heading_anchors = 4
highlight_language = "text"
smartquotes = False  # r' is a derivative

nitpicky = True  # what a docstring refers to has to exist
default_role = "code"
autodoc_class_signature = "separated"  # and api.md leaves it out: nobody makes these by hand
autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # the docstrings say it with shapes and units
autodoc_preserve_defaults = True
napoleon_attr_annotations = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = "Foucault reference"
html_copy_source = False
html_show_copyright = False
html_static_path, html_css_files = ["site/style.css"], ["style.css"]
html_extra_path = ["site/index.html"]  # leads to the start page


class Notebook(MystParser):
    """Reads a notebook as the page that it is: text, code, and the output that it keeps."""

    supported = ("ipynb",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        """Read the text of a notebook."""
        super().parse(
            "\n\n".join(part for cell in json.loads(inputstring)["cells"] for part in _parts(cell)),
            document,
        )


def _parts(cell: dict) -> Iterator[str]:
    """Yield a cell of a notebook in Markdown."""
    source = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        yield source
        return
    yield f"```python\n{source}\n```"
    for output in cell["outputs"]:
        data = output.get("data", {"text/plain": output.get("text", [])})
        if "image/png" in data:
            yield f'<img class="kept" alt="what this cell draws" src="data:image/png;base64,{data["image/png"]}">'
        else:
            yield f"```text\n{''.join(data['text/plain']).rstrip()}\n```"


class WholeNumbers(SphinxPostTransform):
    """Keeps a number such as 1e-10 on one line, which a browser would break behind the hyphen."""

    default_priority = 900
    formats = ("html",)
    with_exponent = re.compile(r"(\d[\d.]*e-\d+)")

    def run(self, **_: object) -> None:
        """Give each such number of a text an element of its own, which style.css does not break."""
        for old in list(self.document.findall(nodes.Text)):
            parts = self.with_exponent.split(old)
            if len(parts) == 1 or isinstance(old.parent, nodes.FixedTextElement | nodes.raw):
                continue
            # the parts take turns: text, number, text, …
            new: list[nodes.Node] = [nodes.Text(part) for part in parts]
            for place in range(1, len(parts), 2):
                new[place] = nodes.inline("", "", new[place], classes=["number"])
            old.parent.replace(old, new)


def setup(app: Sphinx) -> None:
    """Have Sphinx read notebooks, and keep numbers whole."""
    app.add_source_suffix(".ipynb", "ipynb")
    app.add_source_parser(Notebook)
    app.add_post_transform(WholeNumbers)
