"""Files changed at random: docs/checker has no memory error, and says yes only where nothing changed that counts."""

from __future__ import annotations

import json
import random
import re
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from places import ROOT

GOLDEN = ROOT / "data/golden"
DATASETS = ("weightless", "weightless", "museum_gate")
FILES = (
    "manifest.json",
    "grid.csv",
    "transits.csv",
    "sections.csv",
    "grid.binary64.csv",
    "transits.binary64.csv",
)
FILES += ("vectors.json", "certified.txt")

# What docs/checker/README.md says that it does not look at.
OF_MANIFEST = (
    "seal",
    "id",
    "title",
    "source",
    "flags",
    "notes",
    "invariant.drift_m2_s2",
    "equations",
    "run",
)
OF_MANIFEST += ("cross_checks", "enclosure", "generator", "command", "files")
NOT_LOOKED_AT = {
    "manifest.json": re.compile(rf"({'|'.join(map(re.escape, OF_MANIFEST))})(\.|$)"),
    "vectors.json": re.compile(r"notes\.|(states|transits)\.\d+\.flags\."),
}

TOKENS = [
    b"nan",
    b"inf",
    b"-",
    b"",
    b"1e999",
    b"-0",
    b"0x10",
    b"9" * 26,
    b"1e-99999",
    b"-9223372036854775808",
    b"9" * 3000,
]
TOKENS += [
    b".",
    b"+",
    b"e",
    b"1..2",
    b"\xc3\xa9",
    b"\x7f",
    b"%s%n",
    b"\t",
    b"1 ",
    b"0",
    b"-1",
    b"0x1p-9999",
    b"true",
    b"null",
]
PIECES = [
    *TOKENS,
    b",",
    b"\n",
    b"{",
    b"[",
    b'"',
    b"}",
    b"]",
    b",,,",
    b"\n\n",
    b": ",
    b"\x00",
    b'"a": "b", ',
    b"[" * 5000,
]

Draw = random.Random


def flipped_bit(data: bytes, draw: Draw) -> bytes:
    place = draw.randrange(len(data))
    return data[:place] + bytes([data[place] ^ 1 << draw.randrange(8)]) + data[place + 1 :]


def random_bytes(data: bytes, draw: Draw) -> bytes:
    changed = bytearray(data)
    for _ in range(draw.randint(2, 40)):
        changed[draw.randrange(len(data))] = draw.randrange(256)
    return bytes(changed)


def cut_off(data: bytes, draw: Draw) -> bytes:
    return data[: draw.randrange(len(data))]


def line_lost(data: bytes, draw: Draw) -> bytes:
    lines = data.split(b"\n")
    del lines[draw.randrange(len(lines))]
    return b"\n".join(lines)


def line_twice(data: bytes, draw: Draw) -> bytes:
    lines = data.split(b"\n")
    lines.insert(draw.randrange(len(lines)), draw.choice(lines))
    return b"\n".join(lines)


def lines_exchanged(data: bytes, draw: Draw) -> bytes:
    lines = data.split(b"\n")
    i = draw.randrange(len(lines))
    j = draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def another_token(data: bytes, draw: Draw) -> bytes:
    word = draw.choice(list(re.finditer(rb"[-+.\w]+", data)))
    return data[: word.start()] + draw.choice(TOKENS) + data[word.end() :]


def another_value(data: bytes, draw: Draw) -> bytes:
    """Put the word of one place into another."""
    words = list(re.finditer(rb"[-+.\w]+", data))
    word = draw.choice(words)
    return data[: word.start()] + draw.choice(words)[0] + data[word.end() :]


def digit_changed(data: bytes, draw: Draw) -> bytes:
    place = draw.choice(list(re.finditer(rb"\d", data))).start()
    return data[:place] + str(draw.randrange(10)).encode() + data[place + 1 :]


def inserted(data: bytes, draw: Draw) -> bytes:
    place = draw.randrange(len(data))
    return data[:place] + draw.choice(PIECES) + data[place:]


def no_last_newline(data: bytes, draw: Draw) -> bytes:
    return data.rstrip(b"\n")


def longer(data: bytes, draw: Draw) -> bytes:
    return data + draw.choice([b"x", b",", b"\n", b"1,2,3\n", b"1,2,", b"5,", b"\x00", data[-200:]])


def cell_lost(data: bytes, draw: Draw) -> bytes:
    cell = draw.choice(list(re.finditer(rb"[^,\n]+", data)))
    return data[: cell.start()] + data[cell.end() + 1 :]


def cell_twice(data: bytes, draw: Draw) -> bytes:
    cell = draw.choice(list(re.finditer(rb"[^,\n]+", data)))
    return data[: cell.start()] + cell[0] + b"," + data[cell.start() :]


MUTATIONS: tuple[Callable[[bytes, Draw], bytes], ...] = (
    flipped_bit,
    random_bytes,
    cut_off,
    line_lost,
    line_twice,
    lines_exchanged,
    another_token,
    another_token,
    another_value,
    digit_changed,
    inserted,
    no_last_newline,
    longer,
    cell_lost,
    cell_twice,
)


def mutate(folder: Path, draw: Draw) -> str:
    """Change a file of a folder; return which, and how."""
    file = folder / draw.choice([name for name in FILES if (folder / name).is_file()])
    kind = draw.randrange(len(MUTATIONS) + 2)
    if kind == len(MUTATIONS):
        file.unlink()
        return f"{file.name} removed"
    if kind == len(MUTATIONS) + 1:
        other = draw.choice([name for name in FILES if (folder / name).is_file()])
        file.write_bytes((folder / other).read_bytes())
        return f"{file.name} is {other}"
    data = file.read_bytes()
    if not re.search(rb"\d", data):  # little is left of it
        data = b"1,2\n"
    file.write_bytes(MUTATIONS[kind](data, draw))
    return f"{file.name} {MUTATIONS[kind].__name__}"


def pairs(value: Any, key: str = "") -> dict[str, str]:
    """Return a document as pairs of a path and a text, as the checker reads it."""
    items = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else None
    )
    if items is None:
        return {key: value if isinstance(value, str) else json.dumps(value)}
    found: dict[str, str] = {}
    for name, inner in items:
        found |= pairs(inner, f"{key}.{name}" if key else str(name))
    return found


def what_counts(file: Path) -> object:
    """Return what the checker looks at in a file."""
    data = file.read_bytes()
    if file.name not in NOT_LOOKED_AT:
        return data
    # a title may have bytes that are no UTF-8, and control characters: the checker does not look at it
    document = json.loads(
        data.decode(errors="replace"), strict=False, parse_int=str, parse_float=str
    )
    return {
        key: text
        for key, text in pairs(document).items()
        if not NOT_LOOKED_AT[file.name].match(key)
    }


OF_PAGE = re.compile(
    r"(?m)^(Level: \w+\. |Inputs are read as: .*\n|  (pendulum|site|release|run)\..*\n"
    r"|.*tate at t = .*\n|  v?[xyz] +-?\d.*\n|Bound on .*\n|  by column: .*\n"
    r"|Transits .*\n|  (first|last) +t = .*\n|  largest bound .*\n|Passages .*\n)"
)


def page_is_kept(before: str, after: str) -> bool:
    """Whether a page still has all lines that the checker looks for, in their order."""
    place = 0
    for line in OF_PAGE.finditer(before):
        place = after.find("\n" + line[0], place)
        if place < 0:
            return False
        place += len(line[0])
    return True


def unexplained(folder: Path, original: Path) -> list[str]:
    """Return the files in which something changed that the checker should look at."""
    changed = []
    for before in sorted(original.iterdir()):
        after = folder / before.name
        if not after.exists():
            changed.append(f"{before.name} is not there")
        elif before.name == "certified.txt":
            kept = page_is_kept(before.read_text(), after.read_text(errors="replace"))
            changed += [] if kept else [before.name]
        elif what_counts(before) != what_counts(after):
            changed.append(before.name)
    return changed


def test_no_mutated_folder_brings_a_memory_error_or_an_undeserved_yes(
    sanitized_check, tmp_path, size, tally
):
    draw = random.Random(62)
    verdicts: Counter[str] = Counter()
    failures = []
    for number in range(size(30, 400)):
        original = GOLDEN / draw.choice(DATASETS)
        folder = Path(shutil.copytree(original, tmp_path / "mutated"))
        changes = [mutate(folder, draw) for _ in range(draw.choice((1, 1, 1, 3)))]
        done = sanitized_check(folder)
        verdict = {0: "proved", 1: "wrong", 2: "not a dataset"}.get(done.returncode, "crash")
        verdicts[verdict] += 1
        if verdict == "crash" or done.stderr:
            failures.append((number, original.name, changes, done.returncode, done.stderr[-2000:]))
        elif verdict == "proved" and (found := unexplained(folder, original)):
            failures.append((number, original.name, changes, found))
        shutil.rmtree(folder)
    assert not failures, failures
    tally(f"checker: mutated folders {dict(verdicts)}, no memory error, no undeserved yes")
