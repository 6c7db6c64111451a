"""The columns of a sweep, once for schema, files and docs, and Parquet files of them; the only door to pyarrow.

A file that is written here is sealed: at its end stands the sha256 of all other bytes, and of what the file is.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..numbers.columns import POSITION, VELOCITY
from ..system.documents import texts_of

FREQUENCY, PRECESSION, TRANSITS, STATE, AMPLITUDE = (
    "frequency",
    "precession",
    "transits",
    "state",
    "amplitude",
)
TIMES = "transit-times"
# what `all` means; the times of the transits are more
WANTS = (FREQUENCY, PRECESSION, TRANSITS, STATE, AMPLITUDE)
WORDS = "dictionary"  # the kind of a column of words that repeat

_PART, _SEAL = "foucault.part", "foucault.seal"  # keys of a file's metadata
_MARK, _HEX = b"sha256:", 64  # what stands before the digits of a seal, and how many these are


@dataclass(frozen=True)
class Column:
    """One column: its kind is that of Arrow (float64, int32, …, or `WORDS`)."""

    name: str
    kind: str
    meaning: str
    wants: Sequence[str] = ()  # present where one of these is wanted; always if empty
    error: str = ""  # the column of its error

    def empty(self, count: int) -> Any:
        """Return the column of some rows with nothing known: NaN, 0, or None."""
        nothing = {WORDS: (None, object), "float64": (np.nan, float)}.get(self.kind, (0, self.kind))
        return np.full(count, *nothing)


STATE_COLUMNS = tuple([f"{name}_m" for name in POSITION] + [f"{name}_m_s" for name in VELOCITY])

COLUMNS, TRANSIT_COLUMNS, _OF_SECTION = (
    tuple(Column(name, *described) for name, described in table.items())
    for table in texts_of(__file__).values()
)


def section_columns(words: Iterable[str]) -> tuple[Column, ...]:
    """Return the columns of sections: of each the number of passages, the first one, and the time from one to the next.

    That time is the mean between passages in the direction of the first: the period of a gate or a turn, and half of it
    of the highest or the lowest points.
    """
    return tuple(
        replace(
            column, name=f"{word}: {column.name}", error=column.error and f"{word}: {column.error}"
        )
        for word in words
        for column in _OF_SECTION
    )


def parquet(columns: Iterable[Column], values: dict[str, Any], part: str) -> bytes:
    """Return columns as a Parquet file, sealed as `part`: zstd, numbers with their bytes split, words by dictionary."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = []
    for column in columns:
        kind = (
            pa.dictionary(pa.int32(), pa.string())
            if column.kind == WORDS
            else getattr(pa, column.kind)()
        )
        fields.append(pa.field(column.name, kind, metadata={"meaning": column.meaning}))
    table = pa.table(values, schema=pa.schema(fields, metadata={_PART: part}))
    words = [field.name for field in fields if pa.types.is_dictionary(field.type)]
    split = [field.name for field in fields if field.type == pa.float64()]
    stream = io.BytesIO()
    with pq.ParquetWriter(
        stream, table.schema, compression="zstd", use_dictionary=words, use_byte_stream_split=split,
        write_page_checksum=True,
    ) as writer:  # fmt: skip
        writer.write_table(table)
        writer.add_key_value_metadata({_SEAL: _MARK.decode() + "0" * _HEX})
    data = stream.getvalue()
    at, seal = _seal(data, part)
    return data[:at] + seal + data[at + _HEX :]


def is_sealed(data: bytes, part: str) -> bool:
    """Return whether a file has every byte that `parquet` wrote as `part`."""
    at, seal = _seal(data, part)
    return data[at : at + _HEX] == seal


def _seal(data: bytes, part: str) -> tuple[int, bytes]:
    """Return where in a file its seal stands, and what it has to be."""
    at = data.rfind(_MARK) + len(_MARK)
    return at, sha256(part.encode() + data[:at] + data[at + _HEX :]).hexdigest().encode()


def read_columns(stream: BinaryIO, check: Callable[[list[str], int], None]) -> dict[str, list[Any]]:
    """Return the columns of any Parquet file.

    Args:
        stream: the file.
        check: called with their names and the number of rows before any is read.

    Raises:
        OSError: it cannot be read, or is none.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.ParquetFile(stream)
        check(file.schema_arrow.names, file.metadata.num_rows)
        return dict(file.read().to_pydict())
    except (OSError, pa.ArrowException) as error:
        raise OSError(0, str(error).splitlines()[0]) from None


def arrays(paths: Iterable[Path], names: list[str] | None = None) -> dict[str, Any]:
    """Return columns of several files, one below the other; words as objects, None where there is none.

    Raises:
        OSError: a file cannot be read, or was damaged.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    read = partial(pq.read_table, columns=names, page_checksum_verification=True)
    try:
        table = pa.concat_tables(map(read, paths))
    except pa.ArrowException as error:
        raise OSError(0, str(error).splitlines()[0]) from None
    columns = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        words = pa.types.is_dictionary(column.type)
        columns[name] = (column.cast(pa.string()) if words else column).to_numpy(
            zero_copy_only=False
        )
    return columns
