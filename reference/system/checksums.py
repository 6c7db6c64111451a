"""Checksums that detect accidental changes of results: of files, in SHA256SUMS, and of each line of a journal.

`sha256sum -c SHA256SUMS` checks the files too. A journal grows line by line, so that each line
carries its own seal.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from .documents import regular

SUMS = "SHA256SUMS"
JOURNALS = "*.jsonl"
_SEAL = "seal"
_MAX_BYTES = 1 << 30  # of a file
_LINE = re.compile(r"([0-9a-f]{64})  ([^/]+)")
_SEAL_HEX = 16  # hexadecimal digits of the seal of a line


def sums_text(files: Mapping[str, bytes]) -> str:
    """Return the content of SHA256SUMS for files by name."""
    lines = [f"{sha256(data).hexdigest()}  {name}\n" for name, data in sorted(files.items())]
    return "".join(lines)


def sealed_line(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a line of a journal with its seal."""
    unsealed = {name: value for name, value in record.items() if name != _SEAL}
    text = json.dumps(unsealed, sort_keys=True)
    return {**record, _SEAL: sha256(text.encode()).hexdigest()[:_SEAL_HEX]}


def is_sound(record: Mapping[str, Any]) -> bool:
    """Return whether the record of a line matches its seal; earlier versions wrote none."""
    return _SEAL not in record or sealed_line(record) == record


def check_sums(folder: Path) -> list[str]:
    """Return what is wrong with the files that SHA256SUMS of a folder lists.

    Raises:
        FileNotFoundError: there is no SHA256SUMS.
        InputError: it is no regular file.
    """
    with regular(folder / SUMS, "PATH", _MAX_BYTES, SUMS) as stream:
        lines = stream.read().decode(errors="replace").splitlines()
    problems = [] if lines else [f"{SUMS} is empty"]
    matches = [_LINE.fullmatch(line) for line in lines]
    if None in matches:
        problems.append(f"{SUMS} has {matches.count(None)} lines that are no checksums")
    for match in filter(None, matches):
        expected, name = match.groups()
        try:
            with regular(folder / name, "PATH", _MAX_BYTES, "a file") as stream:
                checksum = sha256(stream.read()).hexdigest()
        except FileNotFoundError:
            problems.append(f"{name} is missing, which {SUMS} lists")
            continue
        if checksum != expected:
            problems.append(f"{name} is not as it was written, by {SUMS}")
    return problems


def verify_report(folder: Path) -> tuple[list[str], list[str]]:
    """Return what is wrong with the files and journals of a report, and what cannot be decided."""
    problems = []
    undecided = []
    try:
        problems += check_sums(folder)
    except FileNotFoundError:
        undecided.append(f"the report, as there is no {SUMS}: the same command writes it")
    for path in sorted(folder.glob(JOURNALS)):
        more_problems, more_undecided = _check_journal(path)
        problems += more_problems
        undecided += more_undecided
    return problems, undecided


def _check_journal(path: Path) -> tuple[list[str], list[str]]:
    """Return what is wrong with a journal, and what cannot be decided."""
    with regular(path, "PATH", _MAX_BYTES, "a journal") as stream:
        lines = stream.read().splitlines()
    damaged = []
    cut_short = 0
    unsealed = 0
    for number, line in enumerate(lines, 1):
        record = _record(line)
        if record is None and not line.endswith(b"}"):
            cut_short += 1
        elif record is None or not is_sound(record):
            damaged.append(number)
        elif _SEAL not in record:
            unsealed += 1
    problems = [
        f"{path.name}: line {number} is not as it was written, and not used: delete it"
        for number in damaged
    ]
    undecided = []
    if cut_short:
        undecided.append(
            f"{path.name}: lines that were cut short, as by a kill, and are not used: {cut_short}"
        )
    if unsealed:
        undecided.append(f"{path.name}: results without a seal, of an earlier version: {unsealed}")
    return problems, undecided


def _record(line: bytes) -> dict[str, Any] | None:
    """Return the record of a line; None if it has none."""
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return record if isinstance(record, dict) else None
