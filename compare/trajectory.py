"""Reads a candidate: CSV with named columns, the output of the paper's program, or NumPy's .npz; file or stream.

Whatever comes is bounded: bytes, rows and the length of a line. What is wrong is said with its line.

- CSV: one header line with t, x, y and any of z, vx, vy, vz in any order (other columns are passed over);
  comma separated; lines that start with # are comments.
- foucPend (Mathar, appendix B): no header; white space between t x y z X Y Z φ λ speed, of which the first
  four are read; `# P n t f` names a transit.
- .npz: one-dimensional arrays t, x, y and any of z, vx, vy, vz, all of one length; `transits` may stand beside.
"""

from __future__ import annotations

import contextlib
import io
import math
import sys
import zipfile
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.solution import Array

from .candidate import COLUMNS, HEADER_ADVICE, Candidate

MAX_BYTES = 1 << 30
MAX_ROWS = 5_000_000
MAX_LINE = 1 << 16
CHUNK = 1 << 22
LOOKED_AT = 50  # rows of a chunk in which longer numbers than a double's are looked for
DOUBLE_DIGITS = 17  # numbers with more carry what a double does not


def read(source: str | Path) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Raises:
        InputError: what is wrong, and in which line.
    """
    if str(source) == "-":
        return read_stream(sys.stdin.buffer, "standard input")
    try:
        with Path(source).open("rb") as stream:
            return read_stream(stream, str(source))
    except OSError as error:
        raise InputError(
            "CANDIDATE", str(source), "a readable file, or - for standard input", f"{error.strerror}."
        ) from None


def read_stream(stream: BinaryIO, name: str) -> Candidate:
    """Read a candidate from a stream of bytes, whichever of the formats it is in."""
    head = stream.read(4)
    if head.startswith(b"PK"):
        return _from_npz(_bounded(stream, head, name), name)
    return _Text(name).read(stream, head)


def _bounded(stream: BinaryIO, head: bytes, name: str) -> io.BytesIO:
    data = head + stream.read(MAX_BYTES - len(head) + 1)
    if len(data) > MAX_BYTES:
        raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES} bytes", "Thin the output out.")
    return io.BytesIO(data)


def _from_npz(data: io.BytesIO, name: str) -> Candidate:
    try:
        with zipfile.ZipFile(data) as archive:
            if sum(member.file_size for member in archive.infolist()) > MAX_BYTES:
                raise InputError(
                    name, "a larger archive", f"at most {MAX_BYTES} bytes unpacked", "Thin the output out."
                )
        with np.load(data, allow_pickle=False) as arrays:
            kept = {key: arrays[key] for key in ("t", *COLUMNS, "transits") if key in arrays.files}
    except InputError:
        raise
    except Exception as error:  # zipfile and numpy raise half a dozen kinds at a damaged archive
        raise InputError(name, "a damaged .npz archive", "arrays t, x, y, …", f"{error}.") from None
    for key, array in kept.items():
        if array.dtype.kind not in "fiu":
            raise InputError(f"{name}: {key}", f"dtype {array.dtype}", "real numbers")
    if "t" not in kept:
        raise InputError(name, f"arrays {', '.join(kept) or 'of other names'}", "an array t", HEADER_ADVICE)
    wide = {key: array for key, array in kept.items() if key in COLUMNS and array.dtype.itemsize > 8}
    double = {key: np.asarray(array, dtype=np.float64) for key, array in kept.items()}
    rest = {key: np.asarray(array - double[key].astype(array.dtype), dtype=np.float64) for key, array in wide.items()}
    columns = {key: double[key] for key in COLUMNS if key in double}
    transits = checked_transits(double["transits"], f"{name}: transits") if "transits" in double else None
    return Candidate.of(name, double["t"], columns, rest=rest, transits=transits)


class _Text:
    """A reader of lines, chunk by chunk, in CSV or in the format of foucPend."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.words: list[str] | None = None  # names of all columns, once known
        self.comma = True
        self.blocks: list[Array] = []
        self.rests: list[Array] = []
        self.rows = self.line = 0
        self.transits: list[float] = []
        self.marked = False
        self.notes: list[str] = []

    def read(self, stream: BinaryIO, head: bytes) -> Candidate:
        for lines in self._chunks(stream, head):
            self._take(lines)
        if self.words is None:
            raise InputError(
                self.name, "no header and no rows", "a CSV file, foucPend's output, or .npz", HEADER_ADVICE
            )
        table = np.concatenate(self.blocks) if self.blocks else np.empty((0, len(self.kept)))
        columns = {word: np.ascontiguousarray(table[:, i]) for i, word in enumerate(self.kept)}
        rest = {}
        if any(block.any() for block in self.rests):
            spare = np.concatenate(self.rests)
            rest = {word: np.ascontiguousarray(spare[:, i]) for i, word in enumerate(self.kept) if word != "t"}
        t = columns.pop("t")
        found = checked_transits(np.array(self.transits), f"{self.name}: # P") if self.marked else None
        return Candidate.of(self.name, t, columns, rest=rest, transits=found, notes=tuple(self.notes))

    def _chunks(self, stream: BinaryIO, head: bytes) -> Iterator[list[str]]:
        left, total = head, len(head)
        while data := stream.read(CHUNK):
            total += len(data)
            if total > MAX_BYTES:
                raise InputError(
                    self.name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES}", "Thin the output out."
                )
            left += data
            whole, newline, left = left.rpartition(b"\n")
            if newline:
                yield self._decoded(whole)
            if len(left) > MAX_LINE:
                raise InputError(self.name, f"a line of more than {MAX_LINE} bytes", "lines of numbers", "Is it text?")
        if left.strip():
            self.notes.append("the last line does not end with a newline: it may be cut off")
            yield self._decoded(left)

    def _decoded(self, data: bytes) -> list[str]:
        if b"\0" in data:
            raise InputError(self.name, "a zero byte", "text", "Binary data is read from .npz only.")
        try:
            return data.decode().split("\n")
        except UnicodeDecodeError:
            raise InputError(
                self.name, "bytes that are not UTF-8", "text", "Binary data is read from .npz only."
            ) from None

    def _take(self, lines: list[str]) -> None:
        first = self.line
        kept: list[str] = []
        numbers: list[int] = []
        for offset, line in enumerate(lines, 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            if text[0] == "#":
                self._comment(text, first + offset)
            elif self.words is None:
                if self._header(text):
                    kept.append(text)
                    numbers.append(first + offset)
            else:
                kept.append(text)
                numbers.append(first + offset)
        self.line += len(lines)
        self.rows += len(kept)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if kept:
            self._parse(kept, numbers)

    def _comment(self, text: str, line: int) -> None:
        words = text[1:].split()
        if not words or words[0] != "P":
            return
        self.marked = True
        try:
            self.transits.append(float(words[2]))
        except (IndexError, ValueError):
            raise InputError(f"{self.name}: line {line}", text[:80], "# P, a count, a time in s, a frequency") from None

    def _header(self, text: str) -> bool:
        """Learn the columns from the first line; True if that line is a row already."""
        if "," not in text:
            fields = text.split()
            if len(fields) >= 4 and all(_is_number(word) for word in fields):
                self.comma, self.words = False, ["t", "x", "y", "z"] + [""] * (len(fields) - 4)
                return True
        words = [word.strip().strip('"').lower() for word in text.split(",")]
        if any(_is_number(word) for word in words):
            raise InputError(f"{self.name}: first line", text[:80], "a header that names the columns", HEADER_ADVICE)
        for word in ("t", "x", "y"):
            if words.count(word) != 1:
                got = "none" if word not in words else f"{words.count(word)} of them"
                raise InputError(f"{self.name}: header", f"{got} in {text[:80]!r}", f"one column {word}", HEADER_ADVICE)
        for word in COLUMNS:
            if words.count(word) > 1:
                raise InputError(f"{self.name}: header", text[:80], f"one column {word} at most")
        self.words = words
        return False

    @property
    def kept(self) -> list[str]:
        """The columns that are read, t first."""
        assert self.words is not None
        return ["t", *(word for word in COLUMNS if word in self.words)]

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        assert self.words is not None
        width, separator = len(self.words), "," if self.comma else None
        where = [self.words.index(word) for word in self.kept]
        try:
            even = {line.count(",") if self.comma else len(line.split()) - 1 for line in lines} == {width - 1}
            block = np.loadtxt(lines, delimiter=separator, usecols=where, comments=None, ndmin=2) if even else None
        except ValueError:
            block = None
        if block is None:
            self._blame(lines, numbers)
            raise InputError(self.name, "a number that cannot be read", "decimal numbers")
        if self.blocks:
            self._ordered(self.blocks[-1][-1, 0], block[0, 0], numbers[0])
        self.blocks.append(block)
        looked_at = [lines[i].split(separator) for i in range(0, len(lines), 1 + len(lines) // LOOKED_AT)]
        if any(_digits(fields[i]) > DOUBLE_DIGITS for fields in looked_at for i in where[1:]):
            self.rests.append(_rests([line.split(separator) for line in lines], where, block))
        else:
            self.rests.append(np.broadcast_to(0.0, block.shape))

    def _ordered(self, before: float, after: float, line: int) -> None:
        """Refuse a stream whose times stand still as soon as that is seen, not after a gigabyte."""
        if math.isfinite(before) and math.isfinite(after) and after <= before:
            raise InputError(
                f"{self.name}: line {line}", f"t = {after:.17g} after {before:.17g}", "strictly increasing times"
            )

    def _blame(self, lines: list[str], numbers: list[int]) -> None:
        """Find the line that does not read as the others do."""
        assert self.words is not None
        for line, number in zip(lines, numbers, strict=True):
            fields = line.split("," if self.comma else None)
            if len(fields) != len(self.words):
                raise InputError(
                    f"{self.name}: line {number}",
                    f"{len(fields)} fields",
                    f"{len(self.words)} as in the first line",
                    "Is the line cut off?",
                )
            for word, text in zip(self.words, fields, strict=True):
                if word in ("t", *COLUMNS) and not _is_number(text):
                    raise InputError(f"{self.name}: line {number}: {word}", repr(text[:40]), "a number")


def _is_number(text: str) -> bool:
    if "_" in text:
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


def _digits(text: str) -> int:
    """Significant digits of a printed number."""
    return sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))


def _rests(split: list[list[str]], where: list[int], block: Array) -> Array:
    """What the doubles lack against the printed numbers, where these have more digits; same shape."""
    rest = np.zeros_like(block)
    for i, fields in enumerate(split):
        for j, k in enumerate(where):
            if math.isfinite(block[i, j]) and _digits(fields[k]) > DOUBLE_DIGITS:
                rest[i, j] = float(Fraction(fields[k].strip()) - Fraction(block[i, j]))
    return rest


def read_transits(source: str | Path) -> Array:
    """Times of xdot = 0 from a CSV file in which only the column t is needed (or "-")."""
    try:
        with contextlib.ExitStack() as stack:
            stream = sys.stdin.buffer if str(source) == "-" else stack.enter_context(Path(source).open("rb"))
            data = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError("--transits", str(source), "a readable CSV file", f"{error.strerror}.") from None
    if len(data) > MAX_BYTES or b"\0" in data:
        raise InputError("--transits", str(source), "a CSV file with a column t")
    lines = [line for line in data.decode(errors="replace").splitlines() if line.strip() and line[0] != "#"]
    words = [word.strip().lower() for word in lines[0].split(",")] if lines else []
    if words.count("t") != 1:
        raise InputError(f"{source}: header", lines[0][:80] if lines else "nothing", "a column t")
    where, times = words.index("t"), []
    for number, line in enumerate(lines[1:], 2):
        fields = line.split(",")
        if len(fields) <= where or not _is_number(fields[where]):
            raise InputError(f"{source}: row {number}", line[:80], "a number in the column t")
        times.append(float(fields[where]))
    return checked_transits(np.array(times), str(source))


def checked_transits(times: Array, name: str) -> Array:
    """The times of transits, if they are finite and increase."""
    if not np.isfinite(times).all():
        raise InputError(name, "a time that is not finite", "times in s")
    if len(times) and (times[0] < 0 or (np.diff(times) <= 0).any()):
        raise InputError(name, "times that do not increase", "strictly increasing times from 0 on, in s")
    return np.asarray(times, dtype=np.float64)
