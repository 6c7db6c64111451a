"""Write `manifest.schema.json` anew from `reference/dataset/manifest.py`: python -m reference.dataset.schema."""

from __future__ import annotations

import json
from pathlib import Path

from reference.dataset.manifest import json_schema

if __name__ == "__main__":
    target = Path(__file__).with_name("manifest.schema.json")
    target.write_text(json.dumps(json_schema(), indent=1) + "\n", encoding="utf-8")
