"""Damaged and strange inputs of every kind, each made from a seed."""

from __future__ import annotations

import io
import json
import random
from pathlib import Path
from typing import Any

import numpy as np
from places import ROOT

SCENES = sorted((ROOT / "data/scenes").glob("*.toml"))
NUMBERS = (
    "0", "-0", "1", "+1", "-1", "67", "0.3", "1e-9", "90", "180", "1e5", "1e15", "1e30", "1e100", "1e154",
    "1e308", "1e309", "-1e309", "1e399", "1e400", "1e401", "1e-308", "5e-324", "1e-350", "1e-400", "1e-401",
    "1e999999999", "-1e999999999", "1e-999999999", "0e999999999", "1e99999999999999999999", "1.e5", ".5", ".",
    "e5", "1.0000000000000000000001", "89.99999999999999999999", "nan", "NaN", "inf", "-inf", "infinity",
    "0x10", "1_0", "1d5", "1,5", "٣", "١٢", "１", "½", "∞", "−", "1e٣", "9" * 5000, "9" * 100_000,
    "0." + "0" * 3000 + "1", "1" * 2000, "-" * 50, "1 2", " 1 ", "",
)  # fmt: skip
TEXTS = (
    "\x1b[31m", "\x1b]0;title\x07", "\x00", "\x9b2J", "\u202e", "\ufeff", "\u2028", "\r", "\t", "\n", "\n\n",
    "'", '"', "'''", '"""', "\\", "\\u0000", "\\x1b", "[", "]", "[[", "{", "}", "=", ",", ";", ".", "#",
    "# P 1", "# P 1 nan", "# t y x", "a.a.a.a=1\n", "[" * 3000, "{a=" * 500, "a." * 3000 + "a=1\n", "true",
    "1979-05-27", "{x0}", "{{x0}}", "{y1}", "{}", "{setting}", "|", ">", "&&", "=cmd", "@SUM(1)", "$(id)",
    "`id`", "../", "/dev/zero", "-", "--json", "é", "😀", "\ud800", "x" * 70_000, "t,x,y", "t", "PK\x03\x04",
)  # fmt: skip
FIELDS = (
    "id", "title", "source", "flags", "inputs", "pendulum", "site", "release", "run", "pendulum.length",
    "pendulum.drag", "site.latitude", "site.altitude", "site.gravity", "site.rotation_rate",
    "site.equatorial_radius", "site.inverse_flattening", "release.x", "release.y", "release.vx", "release.vy",
    "release.angle", "release.azimuth", "release.angle_rate", "release.azimuth_rate", "run.t_end",
    "run.grid_step", "run.digits", "run.level", "run.transits", "run.nothing",
)  # fmt: skip
WORDS = (
    *NUMBERS,
    *TEXTS,
    "decimal",
    "binary64",
    "confirmed",
    "enclosed",
    "false",
    "paris",
    "large_angle,polar",
)

Chance = random.Random


def a_scene(chance: Chance) -> bytes:
    """Return the text of a scene: one that ships, changed, or one written from fields at random."""
    if chance.random() < 0.6:
        return damaged(chance, chance.choice(SCENES).read_bytes())
    tables: dict[str, list[str]] = {"": ['id = "made"'], "release": []}
    for field in chance.sample(FIELDS, chance.randint(0, 8)):
        table, _, key = field.rpartition(".")
        tables.setdefault(table, []).append(f"{key} = {literal(chance)}")
    if chance.random() < 0.7:
        tables["release"] += ['x = "0.3"', 'y = "0.4"']
    text = "\n".join(
        "\n".join([f"[{name}]" if name else "", *lines]) for name, lines in tables.items()
    )
    return encoded(chance, text)


def literal(chance: Chance) -> str:
    """Return a value as TOML writes it, or not quite."""
    word = chance.choice(WORDS)
    return chance.choice(
        (
            f'"{word}"',
            f"'{word}'",
            word,
            json.dumps(word),
            f"[{json.dumps(word)}]",
            f"0x{'f' * 5000}",
        )
    )


def an_assignment(chance: Chance) -> str:
    """Return an argument of --set."""
    if chance.random() < 0.1:
        return "".join(chance.choices((*FIELDS, *TEXTS, "="), k=chance.randint(0, 4)))
    return f"{chance.choice(FIELDS)}={chance.choice(WORDS)}"


def a_candidate(chance: Chance) -> bytes:
    """Return the bytes of a trajectory: text, .npy or .npz, mostly damaged."""
    names = chance.sample(["z", "vx", "vy", "vz", "energy", "transits"], chance.randint(0, 3))
    names[:0] = chance.choice(
        (["t", "x", "y"], ["t", "x", "y"], ["T", '"y"', "x"], ["t", "x"], ["time", "x", "y"])
    )
    rows, columns = chance.randint(0, 30), len(names)
    table = np.random.default_rng(chance.getrandbits(32)).normal(size=(rows, columns))
    table[:, 0] = np.arange(rows)
    kind = chance.random()
    if kind < 0.1:
        stream = io.BytesIO()
        np.save(stream, table)
        return damaged(chance, stream.getvalue())
    if kind < 0.3:
        stream = io.BytesIO()
        arrays = {
            name: table[:, i].astype(chance.choice(("f8", "f4", "g", "i4", "c16", "U3")))
            for i, name in enumerate(names)
        }
        chance.choice((np.savez, np.savez_compressed))(stream, **arrays)
        return damaged(chance, stream.getvalue())
    put = chance.choice((",", ",", ",", " ", "\t", ";", " , "))
    lines = [
        put.join(format(number, chance.choice((".17g", ".3g", ".25f", ".3e"))) for number in row)
        for row in table
    ]
    for _ in range(chance.choice((0, 0, 1, 3))):
        fields = chance.choice(lines or [""]).split(put)
        fields[chance.randrange(len(fields))] = chance.choice(WORDS)
        lines.insert(chance.randint(0, len(lines)), put.join(fields))
    header = chance.choice(("", "# ", "#")) + put.join(names)
    text = chance.choice(("\n", "\n", "\r\n", "\r")).join(
        [header, *lines] if chance.random() < 0.9 else lines
    )
    return (
        encoded(chance, text)
        if chance.random() < 0.6
        else damaged(chance, text.encode(errors="surrogatepass"))
    )


def a_list_of_transits(chance: Chance) -> bytes:
    """Return the bytes of a list of transits."""
    times = sorted(chance.uniform(0, 100) for _ in range(chance.randint(0, 20)))
    words = [str(time) if chance.random() < 0.95 else chance.choice(WORDS) for time in times]
    text = "\n".join(
        [
            chance.choice(("t", "k,t", "t,k", "# t", "")),
            *(f"{i},{word}" for i, word in enumerate(words)),
        ]
    )
    return (
        encoded(chance, text)
        if chance.random() < 0.6
        else damaged(chance, text.encode(errors="surrogatepass"))
    )


def a_command(chance: Chance) -> str:
    """Return an argument of --run; the program is never there."""
    parts = chance.choices(
        (*WORDS, *(f"{{{field.rpartition('.')[2]}}}" for field in FIELDS), " "),
        k=chance.randint(0, 8),
    )
    return "/no/such/program " + chance.choice(("", " ")).join(parts)


NO_DOCUMENTS = (
    "[" * 10**5,
    '{"a":' * 10**5,
    "",
    "[]",
    "null",
    '"x"',
    "1",
    "9" * 5000,
    "{}",
    "\ufeff{}",
    "\0" * 99,
)
STRANGE = (
    None, -1, 0, 10**30, 10**400, "x", "", [], {}, True, 1e308, "1e400", [[]], [1], ["x", [1]], {"a": 1}, {"a": []},
    float("nan"), float("inf"),
)  # fmt: skip


def a_document(chance: Chance, document: dict[str, object]) -> bytes:
    """Return a JSON document with a value that is another, or damaged, or none at all."""
    kind = chance.random()
    if kind < 0.2:
        return chance.choice(NO_DOCUMENTS).encode()
    if kind < 0.5:
        return damaged(chance, json.dumps(document).encode())
    return json.dumps(with_strange_value(chance, document)).encode()


def with_strange_value(chance: Chance, document: dict[str, Any]) -> dict[str, Any]:
    """Return a document in which one value, somewhere, is another."""
    changed = json.loads(json.dumps(document))
    inside: Any = changed
    while True:
        key = (
            chance.choice(list(inside))
            if isinstance(inside, dict)
            else chance.randrange(len(inside))
        )
        if not isinstance(inside[key], (dict, list)) or not inside[key] or chance.random() < 0.3:
            inside[key] = chance.choice(STRANGE)
            return changed
        inside = inside[key]


def encoded(chance: Chance, text: str) -> bytes:
    """Return a text in an encoding that somebody might use."""
    return text.encode(
        chance.choice(("utf-8",) * 8 + ("utf-16", "latin-1", "utf-8-sig")), "replace"
    )


def damaged(chance: Chance, data: bytes) -> bytes:
    """Return data with some places changed, dropped, repeated, cut or filled with strange text."""
    for _ in range(chance.choice((0, 1, 1, 2, 5))):
        a, b = sorted(chance.randint(0, len(data)) for _ in range(2))
        junk = chance.choice(
            (bytes([chance.randrange(256)]), chance.choice(WORDS).encode(errors="surrogatepass"))
        )
        near = min(b, a + chance.choice((1, 3, 12)))
        data = chance.choice(
            (
                data[:a] + junk + data[near:],
                data[:a] + data[near:],
                data[:b] + data[a:b] * 3 + data[b:],
                data[:a],
            )
        )
    return data


def a_command_line(chance: Chance, file: Path) -> list[str]:
    """Return the words of a command with a strange input; nothing is solved."""
    kind = chance.randrange(5)
    if kind in (0, 1):
        file.write_bytes((a_scene, a_candidate)[kind](chance))
    words = (
        [chance.choice(("show", "generate")), str(file)],
        ["score", "paris", str(file), "--no-diagnosis"],
        [
            chance.choice(("show", "generate", "score", "study")),
            "paris",
            "--set",
            an_assignment(chance),
        ],
        ["score", "paris", "--run", a_command(chance)],
        [
            chance.choice(("show", "generate", "verify", "score", "study", "pend", "?")),
            *chance.choices(TEXTS, k=2),
        ],
    )[kind]
    return [
        word.replace("\0", "").encode("utf-8", "surrogatepass").decode("utf-8", "surrogateescape")
        for word in words
    ]
