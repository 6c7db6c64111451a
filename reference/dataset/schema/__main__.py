"""Write the JSON Schemas anew from `reference/dataset/`: python -m reference.dataset.schema."""

from __future__ import annotations

import json
from pathlib import Path

from reference.dataset import manifest, vectors

if __name__ == "__main__":
    for module in (manifest, vectors):
        target = Path(__file__).with_name(f"{module.__name__.rpartition('.')[2]}.schema.json")
        target.write_text(json.dumps(module.json_schema(), indent=1) + "\n", encoding="utf-8")
