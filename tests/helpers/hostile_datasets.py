"""Hostile datasets: each entry turns the draft of a good one into one that somebody made to do harm."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

from draft import Draft

from reference.dataset.manifest import MANIFEST

Case = Callable[[Draft], object]

HUGE, LONG, TINY = "1e+999999999", "9" * 6000, "1e-9999"
NUMBERS: dict[str, tuple[str, ...]] = {
    "position bound": ("bounds", "position_m"),
    "bound on x": ("bounds", "grid", "x"),
    "bound on t": ("bounds", "transits", "t"),
    "invariant": ("invariant", "h_m2_s2"),
    "drift": ("invariant", "drift_m2_s2"),
    "gap of the runs": ("cross_checks", "0", "position_m"),
    "length": ("scene", "pendulum", "length"),
    "t_end": ("scene", "run", "t_end"),
    "digits of the scene": ("scene", "run", "digits"),
}


def put(draft: Draft, path: tuple[str, ...], value: Any) -> None:
    """Set one value of the manifest."""
    place: Any = draft.document
    for key in path[:-1]:
        place = place[int(key)] if isinstance(place, list) else place[key]
    place[path[-1]] = value


def word(*path: str, to: Any) -> Case:
    return lambda draft: put(draft, path, to)


def late(change: Callable[[dict[str, Any]], object]) -> Case:
    return lambda draft: draft.late.append(change)


def raw(edit: Callable[[bytes], bytes]) -> Case:
    return lambda draft: draft.raw.append(edit)


def on_disk(change: Callable[[Path], object]) -> Case:
    return lambda draft: draft.on_disk.append(change)


def instead(make: Callable[[Path], object], name: str = "grid.csv") -> Case:
    """Put something else in a file's place."""

    def change(folder: Path) -> None:
        (folder / name).unlink()
        make(folder / name)

    return on_disk(change)


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
    return lambda draft: draft.another_scene(*assignments, **how)


def a_file(name: str) -> Case:
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
                draft.texts[name] = draft.texts[name].replace(b"5.1e-13", value.replace("e+9999", "e+9999").encode())

    return change


def sparse(size: int, recorded: bool) -> Case:
    def change(draft: Draft) -> None:
        if recorded:
            draft.late.append(lambda document: document["files"]["grid.csv"].update(bytes=size))
        draft.on_disk.append(lambda folder: os.truncate(folder / "grid.csv", size))

    return change


def a_socket(path: Path) -> None:
    before = Path.cwd()
    os.chdir(path.parent)  # the path of a socket is short
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(path.name)
    os.chdir(before)


def rows(count: int, row: bytes) -> Case:
    def change(draft: Draft) -> None:
        draft.texts["grid.csv"] = draft.texts["grid.csv"].partition(b"\n")[0] + b"\n" + row * count
        draft.document["counts"]["grid"] = count

    return change


def no_rows(draft: Draft) -> None:
    rows(0, b"")(draft)
    draft.document["decimals"]["grid"] = {}


def possible(draft: Draft) -> None:
    one = {"from_s": "1", "to_s": "2", "parity": "odd"}
    draft.document.update(possible=[one] * 100_000, transits="undecided intervals")
    draft.document["counts"]["possible"] = 100_000


def large_numbers(draft: Draft) -> None:
    """Rows of 308 digits before the point."""
    draft.another_scene(bound="1e+308")
    lines = draft.texts["grid.csv"].decode().splitlines(keepends=True)
    draft.texts["grid.csv"] = "".join([*lines[:2], lines[2].replace(",0.", f",{'7' * 308}.")]).encode()
    draft.document["counts"]["grid"] = 2
    draft.document["scene"]["run"]["t_end"] = "60"
    draft.document["command"] = draft.document["command"].replace("--t-end 180", "--t-end 60")
    draft.refit()


def unreadable(folder: Path) -> None:
    for path in (*folder.iterdir(), folder):
        path.chmod(0)


def without_site(draft: Draft) -> None:
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


ESC = "\x1b]0;owned\x07\x1b[2J\u202e"

CASES: dict[str, Case] = {
    **{f"{name} of exponent 999999999": word(*path, to=HUGE) for name, path in NUMBERS.items()},
    **{f"{name} of 6000 digits": word(*path, to=LONG) for name, path in NUMBERS.items()},
    **{f"{name} of exponent -9999": word(*path, to=TINY) for name, path in NUMBERS.items()},
    "all bounds of exponent 9999": all_bounds("1e+9999"),
    "all bounds of exponent -9999": all_bounds("1e-9999"),
    "all bounds of 0": all_bounds("0"),
    "all bounds beyond doubles": all_bounds("1.0e+309"),
    "bounds of some columns": lambda d: d.document["bounds"].update(grid={"x": "1", "vx": "1"}, position_m="1", velocity_m_s="1"),
    "bounds of no transits": lambda d: d.document["bounds"].update(transits={}, transit_s=None),
    "bounds beyond doubles about a scene's rows": scene(bound="1e+9999"),
    "bounds of 1e300 about a scene's rows": scene(bound="1e+300"),
    # names of files
    "the file /dev/zero": a_file("/dev/zero"),
    "the file ../x": a_file("../x"),
    "an absolute file name": a_file("/etc/passwd"),
    "NUL in a file name": a_file("grid\x00.csv"),
    "an empty file name": a_file(""),
    "a surrogate in a file name": a_file("\udcff.csv"),
    "a file name of 10 kB": a_file("x" * 10_000),
    "the manifest as its own file": a_file(MANIFEST),
    "a file twice": raw(lambda data: data.replace(b'"grid.csv": {', b'"grid.csv": {"bytes":1,"sha256":"0"},\n  "grid.csv": {', 1)),
    "files that are none": late(lambda document: document.update(files={})),
    "20,000 foreign files with escapes in their names": on_disk(
        lambda folder: [(folder / f"{i}\x1b[2J").touch() for i in range(20_000)]),
    # kinds of files
    "a named pipe": instead(os.mkfifo),
    "a named pipe as manifest": instead(os.mkfifo, MANIFEST),
    "a folder as file": instead(Path.mkdir),
    "a folder as manifest": instead(Path.mkdir, MANIFEST),
    "a socket": instead(a_socket),
    "a link to /dev/zero": instead(lambda path: path.symlink_to("/dev/zero")),
    "a link to /dev/zero as manifest": instead(lambda path: path.symlink_to("/dev/zero"), MANIFEST),
    "a link to itself": instead(lambda path: path.symlink_to(path.name)),
    "a link to the memory of the kernel": instead(lambda path: path.symlink_to("/proc/kcore")),
    "a link to the memory of the kernel as manifest": instead(lambda path: path.symlink_to("/proc/kcore"), MANIFEST),
    "a file without permissions": on_disk(lambda folder: (folder / "grid.csv").chmod(0)),
    "a folder without permissions": on_disk(unreadable),
    "a sparse file of 1 GB, recorded": sparse(1 << 30, recorded=True),
    "a sparse file of 1 GB": sparse(1 << 30, recorded=False),
    "a sparse file of 200 MB, recorded": sparse(200_000_000, recorded=True),
    "200 MB of zeros with its hash": text(lambda _: bytes(200_000_000)),
    "vectors of 100 MB": text(lambda data: data + b" " * 100_000_000, "vectors.json"),
    "every file of 100 MB": lambda draft: draft.texts.update(
        {name: data + b" " * 100_000_000 for name, data in draft.texts.items()}),
    # the manifest as JSON
    "lists nested 100,000 deep": raw(lambda _: b'{"a":' + b"[" * 100_000),
    "objects nested 100,000 deep": raw(lambda _: b'{"a":' * 100_000),
    "an integer of 100,000 digits": raw(lambda data: data.replace(b'"digits": 15', b'"digits": ' + b"9" * 100_000, 1)),
    "an integer of 4000 digits": late(lambda document: document.update(digits=10**4000)),
    "NaN": late(lambda document: document.update(digits=float("nan"))),
    "Infinity": late(lambda document: document["counts"].update(grid=float("inf"))),
    "a key twice": raw(lambda data: data.replace(b'"digits": 15', b'"digits": 99,\n "digits": 15', 1)),
    "UTF-16": raw(lambda data: data.decode().encode("utf-16")),
    "a byte order mark": raw(lambda data: b"\xef\xbb\xbf" + data),
    "surrogates in the title": late(lambda document: document.update(title="\ud800")),
    "surrogates written out": raw(lambda data: data.replace(b'"title": "', b'"title": "\\ud800', 1)),
    "a manifest of 50 MB": raw(lambda data: data + b" " * 50_000_000),
    "a manifest of zero bytes": raw(lambda data: bytes(len(data))),
    "500,000 unknown keys": raw(lambda _: b"{" + b",".join(b'"%x":0' % i for i in range(390_000)) + b"}"),
    "wrong flags by the million": late(lambda document: document.update(flags=[0] * 700_000)),
    "no objects at all": raw(lambda _: b"[" + b"{}," * 1_000_000 + b"0]"),
    # tables
    "a short row": line(lambda row: row.rpartition(b",")[0]),
    "a long row": line(lambda row: row + b",1"),
    "an empty table": text(lambda _: b""),
    "blank lines": text(lambda data: data.replace(b"\n", b"\n\n")),
    "NUL in a number": line(lambda row: row.replace(b".", b".\x00", 1)),
    "a quote": line(lambda row: b'"' + row),
    "latin-1": line(lambda row: row + b"\xe9"),
    "a number of 200,000 digits": line(lambda row: row.replace(b".", b"0" * 200_000 + b".", 1)),
    "Arabic digits": line(lambda row: row.replace(b"1", "\u0661".encode())),
    "a million commas": line(lambda _: b"," * 1_000_000),
    "200 million commas": line(lambda _: b"," * 200_000_000),
    "no last line end": text(lambda data: data[:-1]),
    "line ends of CR": text(lambda data: data.replace(b"\n", b"\r")),
    "nothing but headers": text(lambda data: data.partition(b"\n")[0] + b"\n", "grid.csv", "transits.csv"),
    "no rows, and none counted": no_rows,
    "50 million blank rows": rows(50_000_000, b"\n"),
    "2 million rows of zeros": rows(2_000_000, b"0,0,0,0,0,0,0\n"),
    "numbers of 308 digits": large_numbers,
    "rows outside the sphere within large bounds": outside,
    # decimals and counts
    "decimals of 10**10": word("decimals", "grid", "x", to=10**10),
    "decimals of 2000": word("decimals", "grid", "x", to=2000),
    "negative decimals": word("decimals", "grid", "x", to=-1),
    "decimals of no column": word("decimals", "grid", to={"\x1b": 1}),
    "digits of 10**9": lambda d: (put(d, ("digits",), 10**9), put(d, ("scene", "run", "digits"), str(10**9))),
    "negative counts": word("counts", "grid", to=-1),
    "counts of 10**18": word("counts", "grid", to=10**18),
    "counts of 10**10": word("counts", "transits", to=10**10),
    # scenes
    "t_end of 1e15": scene("run.t_end=1e15", "run.grid_step=1e15"),
    "t_end of 1e15 and two million steps": scene("run.t_end=1e15", "run.grid_step=5e8", rows=2),
    "a step of 1e-15": scene("run.t_end=1e-9", "run.grid_step=1e-15", rows=2),
    "two million times of a thousand digits": scene(f"run.grid_step=0.{'0' * 390}1", f"run.t_end=0.{'0' * 384}12", rows=2),
    "two million times of doubles": scene("inputs=binary64", "run.grid_step=1e-300", "run.t_end=1e-294", rows=2),
    "a length of 1e400": scene("pendulum.length=1e400"),
    "a length of 1e400 as a double": late(
        lambda document: (document["scene"]["pendulum"].update(length="1e400"), document.update(inputs="binary64", id="paris.binary64"))),
    "a length of 1e-400": scene("pendulum.length=1e-400", "release.x=0", "release.y=0"),
    "drag of 1e300": scene("pendulum.drag=1e300"),
    "drag of 1e5": scene("pendulum.drag=1e5"),
    "rotation of 1e300": scene("site.rotation_rate=1e300"),
    "rotation of 1e5": scene("site.rotation_rate=1e5"),
    "gravity of 1e400": scene("site.gravity=1e400"),
    "gravity of 1e30": scene("site.gravity=1e30"),
    "no forces": scene("site.gravity=0", "site.rotation_rate=0"),
    "a radius of 1e400 turned at 1e400": scene("site.equatorial_radius=1e400", "site.rotation_rate=1e400"),
    "altitude of -1e400": scene("site.altitude=-1e400"),
    "a latitude of 1e-400": scene("site.latitude=1e-400"),
    "a flat Earth": scene(f"site.inverse_flattening=1.{'0' * 399}1", "site.latitude=90"),
    "an almost flat Earth": scene(f"site.inverse_flattening=1.{'0' * 399}1", f"site.latitude=89.{'9' * 399}"),
    "a release at the horizontal": scene("release.x=66." + "9" * 600, "release.y=0"),
    "a release that is almost none": scene("release.x=1e-400", "release.y=1e-400"),
    "a velocity of 1e300": scene("release.vx=1e300", "release.vy=1e300"),
    "a velocity of 1e6": scene("release.vx=1e6", "release.vy=0"),
    "a thousand digits": scene("run.digits=1000"),
    "a thousand digits of 2 million s": scene("run.digits=1000", "run.t_end=2e6", "run.grid_step=1e6"),
    "as long as it may take": scene("run.t_end=1.5e5", "run.grid_step=1e5"),
    "chaotic for long": scene("release.x=66.9", "release.y=0", "release.vx=30", "release.vy=20", "run.t_end=1.5e5", "run.grid_step=1e5"),
    "1000 rows of a fast motion": scene("run.t_end=9.99e5", "run.grid_step=1e3"),
    "1000 rows of anything within bounds of 1e300": scene("run.t_end=9.99e5", "run.grid_step=1e3", bound="1e+300"),
    "an angle of 180 degrees": angle,
    "a scene without a site": without_site,
    "a scene that redefines the rest": lambda d: d.document["scene"].update(id={"x": "1"}, flags={}, title={"t": "x"}),
    # words
    "possible transits by the 100,000": possible,
    "possible transits by the 20,000": lambda d: (possible(d), d.document.update(possible=d.document["possible"][:20_000]), d.document["counts"].update(possible=20_000)),
    "escapes in the title": word("title", to=ESC),
    "escapes in a flag": lambda d: d.document.update(flags=[ESC], notes={ESC: ESC}),
    "escapes in a flag of the generator": lambda d: d.document.update(generator={ESC: ESC}),
    "a title of 1 MB": word("title", to="x" * 1_000_000),
    "a formulation with escapes": word("run", "formulation", to=ESC),
    "a number type of many digits": word("run", "number", to=f"limbs({'9' * 300})"),
    "an id with escapes": word("id", to=f"paris+{ESC}"),
    "an id of a million changes": word("id", to="paris+" + "," * 390),
    "shell words in the command": word("command", to="foucault generate paris; rm -rf / $(reboot)"),
    "equations of 100,000 lines": word("equations", "lines", to=["x' = x"] * 100_000),
    "steps of 10**10": word("run", "steps", to=10**10),
}  # fmt: skip
