"""The data that come with the project: their folders, the scenes' ids, the datasets' seals, the flags' meaning."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

INDEX = "index.json"
DATA_VERSION = "1.0"  # of what datasets hold, apart from the code's: docs/format.md says when it is raised


def data_root() -> Path:
    """Return the folder that holds `scenes` and `golden`: in the installed package, or beside it in a checkout."""
    package = Path(__file__).resolve().parent
    return package / "data" if (package / "data").is_dir() else package.parent / "data"


def golden_root() -> Path:
    """Return the folder of the golden datasets that come with the project."""
    return data_root() / "golden"


def in_checkout() -> bool:
    """Return whether scenes and golden datasets are those of a source checkout, which `generate` may replace."""
    return data_root().parent != Path(__file__).resolve().parent


def scene_ids() -> list[str]:
    """Return the ids of the scenes that come with the project, sorted."""
    return sorted(path.stem for path in (data_root() / "scenes").glob("*.toml"))


def seals() -> dict[str, str]:
    """Return the seal of each golden dataset that comes with the project, by id, from `golden/index.json`."""
    try:
        text = (golden_root() / INDEX).read_text("utf-8")
    except FileNotFoundError:
        return {}
    return {name: str(seal) for name, seal in json.loads(text).items()}


def keep_seal(name: str, seal: str) -> None:
    """Write the seal of a dataset that ships into `golden/index.json`, whole or not at all."""
    text = json.dumps(dict(sorted({**seals(), name: seal}.items())), indent=1) + "\n"
    draft = golden_root() / f".{INDEX}.draft"
    draft.write_text(text, "utf-8")
    draft.replace(golden_root() / INDEX)


def flag_meanings() -> dict[str, str]:
    """Return why a scene with a flag is difficult: a sentence for each flag, from `data/flags.toml`."""
    return {flag: str(text) for flag, text in tomllib.loads((data_root() / "flags.toml").read_text("utf-8")).items()}
