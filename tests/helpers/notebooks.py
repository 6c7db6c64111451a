"""The notebooks of docs/gallery, run without Jupyter; their outputs written anew: python tests/helpers/notebooks.py."""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from places import ROOT

GALLERY = ROOT / "docs/gallery"
NOTEBOOKS = sorted(GALLERY.glob("*.ipynb"))
DPI, WIDTH, COLOURS = 100, 720, 32  # of the pictures that are kept


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the cells of code."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def text_of(cell: dict[str, Any]) -> str:
    """Return the text that a cell has as its output: what it printed, then the value of its last line."""
    kept = (entry.get("text") or entry["data"].get("text/plain", []) for entry in cell["outputs"])
    return "".join("".join(lines) for lines in kept)


def run(path: Path) -> list[tuple[str, Any]]:
    """Run all cells of a notebook in its folder and in one namespace; return what each printed, and its last value."""
    names: dict[str, Any] = {"__name__": "__main__"}
    found = []
    before = Path.cwd()
    os.chdir(path.parent)
    try:
        for cell in code_cells(json.loads(path.read_text(encoding="utf-8"))):
            body = ast.parse("".join(cell["source"])).body
            last = body.pop() if isinstance(body[-1], ast.Expr) else None
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(ast.Module(body, []), path.name, "exec"), names)
                value = (
                    eval(compile(ast.Expression(last.value), path.name, "eval"), names)
                    if last
                    else None
                )
            found.append((printed.getvalue(), value))
    finally:
        os.chdir(before)
    return found


def outputs(printed: str, value: Any, *, with_pictures: bool = True) -> list[dict[str, Any]]:
    """Return what a notebook keeps of what a cell printed and of its last value: text, or a small picture."""
    kept: list[dict[str, Any]] = []
    if printed:
        kept.append(
            {"name": "stdout", "output_type": "stream", "text": printed.splitlines(keepends=True)}
        )
    if value is not None:
        data: dict[str, Any] = {"text/plain": str(repr(value)).splitlines(keepends=True)}
        if with_pictures and (picture := _png(value)):
            data["image/png"] = base64.b64encode(picture).decode()
        kept.append(
            {"data": data, "execution_count": None, "metadata": {}, "output_type": "execute_result"}
        )
    return kept


def _png(value: Any) -> bytes:
    """Return a picture of `compare.plot`, or a figure of matplotlib, as a small PNG; nothing for another value."""
    from PIL import Image

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "picture.png")
        if hasattr(value, "savefig"):
            value.savefig(path, dpi=DPI)
        elif hasattr(value, "save"):
            value.save(path)
        else:
            return b""
        small = io.BytesIO()
        picture = Image.open(path).convert("RGB")
        picture.thumbnail((WIDTH, WIDTH))
        picture.quantize(COLOURS).save(small, "png", optimize=True)
        return small.getvalue()


def fill(path: Path) -> None:
    """Run a notebook and write its outputs into it."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell, (printed, value) in zip(code_cells(notebook), run(path), strict=True):
        cell["outputs"] = outputs(printed, value)
    path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    for one in [path for path in NOTEBOOKS if not sys.argv[1:] or path.stem in sys.argv[1:]]:
        print(one.name, flush=True)
        fill(one)
