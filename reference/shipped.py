"""The data that come with the project: where they are, the ids of the scenes, the meaning of their flags."""

from __future__ import annotations

import tomllib
from pathlib import Path


def data_root() -> Path:
    """Return the folder that holds `scenes` and `golden`: in the installed package, or beside it in a checkout."""
    package = Path(__file__).resolve().parent
    return package / "data" if (package / "data").is_dir() else package.parent / "data"


def in_checkout() -> bool:
    """Return whether scenes and golden datasets are those of a source checkout, which `generate` may replace."""
    return data_root().parent != Path(__file__).resolve().parent


def scene_ids() -> list[str]:
    """Return the ids of the scenes that come with the project, sorted."""
    return sorted(path.stem for path in (data_root() / "scenes").glob("*.toml"))


def flag_meanings() -> dict[str, str]:
    """Return why a scene with a flag is difficult: a sentence for each flag, from `data/flags.toml`."""
    return {flag: str(text) for flag, text in tomllib.loads((data_root() / "flags.toml").read_text("utf-8")).items()}
