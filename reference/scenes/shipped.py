"""The data that come with the project: their folders, the scenes' ids, the datasets' seals, the flags' meaning."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable
from pathlib import Path

from ..system.documents import json_document
from ..system.workspace import replace_file

_INDEX = "index.json"
# MB that the golden function in doubles would take, of scenes that ship without it: the others fill
# the 12 MB there are
WITHOUT_FUNCTION = {
    "creeping": 27,
    "creeping_far": 14,
    "creeping_rotation": 1.4,
    "meridian_plane": 0.9,
    "paris_30d": 114,
}
_PACKAGE = Path(__file__).resolve().parents[1]
# of what datasets hold, apart from the code's: docs/format.md says when it is raised
DATA_VERSION = "1.1"


def data_root() -> Path:
    """Return the folder that holds `scenes` and `golden`: in the installed package, or beside it in a checkout."""
    return _PACKAGE / "data" if (_PACKAGE / "data").is_dir() else _PACKAGE.parent / "data"


def golden_root() -> Path:
    """Return the folder of the golden datasets that come with the project."""
    return data_root() / "golden"


def in_checkout() -> bool:
    """Return whether scenes and golden datasets are those of a source checkout, which `generate` may replace."""
    return data_root().parent != _PACKAGE


def scene_ids() -> list[str]:
    """Return the ids of the scenes that come with the project, sorted."""
    return sorted(path.stem for path in (data_root() / "scenes").glob("*.toml"))


def index() -> dict[str, dict[str, str]]:
    """Return what `golden/index.json` says of each golden dataset that comes with the project, by id.

    `seal` is that of its manifest, `options` are those of its command that say how it is made.
    """
    try:
        return json_document(golden_root() / _INDEX, _INDEX)
    except FileNotFoundError:
        return {}


def seals() -> dict[str, str]:
    """Return the seal of each golden dataset that comes with the project, by id."""
    return {name: entry["seal"] for name, entry in index().items()}


def keep_seal(name: str, seal: str, options: str) -> None:
    """Write the seal of a dataset that ships into `golden/index.json`, whole or not at all, one process at a time."""
    from filelock import FileLock

    path = golden_root() / _INDEX
    lock = path.with_suffix(".lock")
    with FileLock(lock):
        every = index() | {name: {"seal": seal, "options": options}}
        data = (json.dumps(dict(sorted(every.items())), indent=1) + "\n").encode()
        replace_file(path, lambda stream: stream.write(data))
        lock.unlink()


def flag_meanings(flags: Iterable[str]) -> dict[str, str]:
    """Return why a scene with these flags is difficult: a sentence for each, from `data/flags.toml`."""
    meanings = tomllib.loads((data_root() / "flags.toml").read_text("utf-8"))
    return {flag: meanings.get(flag, "not a flag of the scenes that ship") for flag in flags}
