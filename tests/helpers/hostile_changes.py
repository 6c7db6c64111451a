"""Changes that make the draft of a good dataset hostile."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from draft import Draft

Case = Callable[[Draft], object]


def put(draft: Draft, path: tuple[str, ...], value: Any) -> None:
    """Set one value of the manifest."""
    place: Any = draft.document
    for key in path[:-1]:
        place = place[int(key)] if isinstance(place, list) else place[key]
    place[path[-1]] = value


def word(*path: str, to: Any) -> Case:
    """Set one value of the manifest."""
    return lambda draft: put(draft, path, to)


def late(change: Callable[[dict[str, Any]], object]) -> Case:
    """Change the manifest after the hashes, before the seal."""
    return lambda draft: draft.late.append(change)


def raw(edit: Callable[[bytes], bytes]) -> Case:
    """Change the manifest's bytes, after the seal."""
    return lambda draft: draft.raw.append(edit)


def on_disk(change: Callable[[Path], object]) -> Case:
    """Change the folder."""
    return lambda draft: draft.on_disk.append(change)


def text(edit: Callable[[bytes], bytes], *names: str) -> Case:
    """Change the bytes of tables, with hashes that fit."""
    return lambda draft: draft.texts.update(
        {name: edit(draft.texts[name]) for name in names or ("grid.csv",) if name in draft.texts}
    )


def line(change: Callable[[bytes], bytes], name: str = "grid.csv") -> Case:
    """Change the third line of a table."""

    def edit(data: bytes) -> bytes:
        lines = data.split(b"\n")
        lines[2] = change(lines[2])
        return b"\n".join(lines)

    return text(edit, name)


def scene(*assignments: str, **how: Any) -> Case:
    """Make a dataset of another scene, where the bob stays at its release."""
    return lambda draft: draft.another_scene(*assignments, **how)


def a_file(name: str) -> Case:
    """Record a file of another name."""
    return late(lambda document: document["files"].update({name: document["files"]["grid.csv"]}))


def all_bounds(value: str) -> Case:
    """Set every bound of the manifest, and those of the transits."""

    def change(draft: Draft) -> None:
        bounds = draft.document["bounds"]
        for kind in ("grid", "transits"):
            bounds[kind] = dict.fromkeys(bounds[kind], value)
        bounds |= {name: value for name in ("position_m", "velocity_m_s", "transit_s") if bounds[name] is not None}
        for name in ("transits.csv", "transits.binary64.csv"):
            if name in draft.texts:
                draft.texts[name] = draft.texts[name].replace(b"5.1e-13", value.encode())

    return change


def rows(count: int, row: bytes) -> Case:
    """Have so many equal rows, and count them."""

    def change(draft: Draft) -> None:
        draft.texts["grid.csv"] = draft.texts["grid.csv"].partition(b"\n")[0] + b"\n" + row * count
        draft.document["counts"]["grid"] = count

    return change


def no_rows(draft: Draft) -> None:
    """Have no grid."""
    rows(0, b"")(draft)
    draft.document["decimals"]["grid"] = {}


def possible(count: int) -> Case:
    """Claim so many intervals that may hold transits."""

    def change(draft: Draft) -> None:
        one = {"from_s": "1", "to_s": "2", "parity": "odd"}
        draft.document.update(possible=[one] * count, transits="undecided intervals")
        draft.document["counts"]["possible"] = count

    return change


def many_digits(draft: Draft) -> None:
    """Claim 10**9 digits."""
    put(draft, ("digits",), 10**9)
    put(draft, ("scene", "run", "digits"), str(10**9))


def beyond_doubles(document: dict[str, Any]) -> None:
    """Have a length read as a double that is none."""
    document["scene"]["pendulum"]["length"] = "1e400"
    document.update(inputs="binary64", id=f"{document['id']}.binary64")


def large_numbers(draft: Draft) -> None:
    """Rows of 308 digits before the point."""
    draft.another_scene(bound="1e+308")
    lines = draft.texts["grid.csv"].decode().splitlines(keepends=True)
    draft.texts["grid.csv"] = "".join([*lines[:2], lines[2].replace(",0.", f",{'7' * 308}.")]).encode()
    draft.document["counts"]["grid"] = 2
    draft.document["scene"]["run"]["t_end"] = "60"
    draft.document["command"] = draft.document["command"].replace("--t-end 180", "--t-end 60")
    draft.refit()


def without_site(draft: Draft) -> None:
    """Leave a section of the scene out."""
    draft.another_scene()
    del draft.document["scene"]["site"]


def angle(draft: Draft) -> None:
    """Release the bob above the suspension."""
    draft.document["scene"]["release"] = {"angle": "180", "azimuth": "360"}
    draft.another_scene()


def outside(draft: Draft) -> None:
    """Put a row far outside the sphere, and have bounds that allow it."""
    draft.another_scene(bound="1e+05")
    line(lambda row: row.replace(b",0.300", b",99.300"))(draft)
    draft.refit()
