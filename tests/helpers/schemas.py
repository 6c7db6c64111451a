"""The JSON Schemas of manifest, vectors and scene, written anew from the code: python tests/helpers/schemas.py."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from places import ROOT
from pydantic import BaseModel

from reference.dataset.function import FunctionRecord
from reference.dataset.manifest import Manifest
from reference.dataset.render import Vectors
from reference.scenes.scene import Scene

SCHEMAS: dict[str, type[BaseModel]] = {
    "manifest.json": Manifest,
    "vectors.json": Vectors,
    "scene.json": Scene,
    "function.json": FunctionRecord,
}


def path_of(name: str) -> Path:
    """Return where the schema of a file of a dataset stands, or of a scene."""
    room = "scenes" if name == "scene.json" else "dataset/schema"
    return ROOT / "reference" / room / name.replace(".json", ".schema.json")


def schema_of(name: str) -> dict[str, Any]:
    """Return the schema that the code has for such a file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **SCHEMAS[name].model_json_schema(),
    }


if __name__ == "__main__":
    for name in SCHEMAS:
        path_of(name).write_text(json.dumps(schema_of(name), indent=1) + "\n", encoding="utf-8")
