"""Check the seal of a dataset that ships against the index inside the package: a forger can make the seal anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ...errors import FoucaultError
from ...scenes.shipped import golden_root, seals
from ..files import Files, read_manifest
from ..manifest import MANIFEST, Manifest
from ..record import AUDIT, generator


def problems(files: Files) -> Iterator[str]:
    """Check the seal of a dataset that ships, in its place or copied from there."""
    manifest, ships = files.manifest, golden_root() / files.manifest.id
    in_place = files.folder.resolve() == ships.resolve()
    if in_place and manifest.level == "enclosed" and AUDIT not in manifest.command.split():
        yield f"{MANIFEST}: a proof that ships must be audited: make it again with {AUDIT}"
    seal = seals().get(manifest.id)
    if seal in (None, manifest.seal):
        return
    if in_place or _is_copy(manifest, ships):
        own, other = manifest.seal[:12], seal[:12]
        yield f"{MANIFEST}: its seal {own}… is not that of the dataset that ships, {other}… (index.json)"


def _is_copy(manifest: Manifest, ships: Path) -> bool:
    """Return whether a dataset must be that which ships: made by the same command, not here with other versions."""
    try:
        shipped = read_manifest(ships)
    except FoucaultError:
        return False
    made_otherwise = shipped.generator != manifest.generator == generator()
    same = manifest.scene == shipped.scene and manifest.command == shipped.command
    return same and not made_otherwise
