"""The columns of a sweep, and Parquet files of them; the only module that uses pyarrow.

A file that is written here is sealed: near its end is the sha256 of all other bytes and of the
part's name.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..numbers.columns import POSITION, VELOCITY
from ..system.documents import texts_of

FREQUENCY = "frequency"
PRECESSION = "precession"
TRANSITS = "transits"
STATE = "state"
AMPLITUDE = "amplitude"
TIMES = "transit-times"
# the quantities that `all` stands for; the times of the transits are extra
WANTS = (FREQUENCY, PRECESSION, TRANSITS, STATE, AMPLITUDE)
WORDS = "dictionary"  # the kind of a column of words that repeat

_PART = "foucault.part"  # keys of a file's metadata
_SEAL = "foucault.seal"
_MARK = b"sha256:"  # precedes the digits of a seal
_HEX_DIGITS = 64  # of a seal


@dataclass(frozen=True)
class ParquetColumn:
    """One column: its kind is that of Arrow (float64, int32, …, or `WORDS`)."""

    name: str
    kind: str
    meaning: str
    wants: Sequence[str] = ()  # present where one of these is wanted; always if empty
    error: str = ""  # the column of its error

    def empty(self, count: int) -> Any:
        """Return the column of rows without results: NaN, 0, or None."""
        if self.kind == WORDS:
            return np.full(count, None, object)
        if self.kind == "float64":
            return np.full(count, np.nan)
        return np.full(count, 0, self.kind)


STATE_COLUMNS = (*(f"{name}_m" for name in POSITION), *(f"{name}_m_s" for name in VELOCITY))


def _described(table: Mapping[str, Sequence[Any]]) -> tuple[ParquetColumn, ...]:
    """Return the columns of a table of parquet.toml."""
    return tuple(ParquetColumn(name, *entries) for name, entries in table.items())


COLUMNS, TRANSIT_COLUMNS, _OF_SECTION = (_described(table) for table in texts_of(__file__).values())


def section_columns(words: Iterable[str]) -> tuple[ParquetColumn, ...]:
    """Return the columns of sections: number of passages, time of the first, and interval.

    The interval is the mean time between passages in the direction of the first. It is the period
    of a gate or a turn, and half the period of the highest or the lowest points.
    """
    columns = []
    for word in words:
        for column in _OF_SECTION:
            error = f"{word}: {column.error}" if column.error else ""
            columns.append(replace(column, name=f"{word}: {column.name}", error=error))
    return tuple(columns)


def parquet(columns: Iterable[ParquetColumn], values: dict[str, Any], part: str) -> bytes:
    """Return columns as a Parquet file, sealed as `part`.

    It is compressed with zstd, numbers with their bytes split, words by dictionary.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = []
    for column in columns:
        if column.kind == WORDS:
            kind = pa.dictionary(pa.int32(), pa.string())
        else:
            kind = getattr(pa, column.kind)()
        fields.append(pa.field(column.name, kind, metadata={"meaning": column.meaning}))
    table = pa.table(values, schema=pa.schema(fields, metadata={_PART: part}))
    words = [field.name for field in fields if pa.types.is_dictionary(field.type)]
    split = [field.name for field in fields if field.type == pa.float64()]
    stream = io.BytesIO()
    with pq.ParquetWriter(
        stream,
        table.schema,
        compression="zstd",
        use_dictionary=words,
        use_byte_stream_split=split,
        write_page_checksum=True,
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({_SEAL: _MARK.decode() + "0" * _HEX_DIGITS})
    data = stream.getvalue()
    place = _place_of_seal(data)
    return data[: place.start] + _seal(data, part) + data[place.stop :]


def is_sealed(data: bytes, part: str) -> bool:
    """Return whether a file has every byte that `parquet` wrote as `part`."""
    return data[_place_of_seal(data)] == _seal(data, part)


def _place_of_seal(data: bytes) -> slice:
    """Return where the digits of a file's seal are."""
    start = data.rfind(_MARK) + len(_MARK)
    return slice(start, start + _HEX_DIGITS)


def _seal(data: bytes, part: str) -> bytes:
    """Return the digits that a file's seal must have."""
    place = _place_of_seal(data)
    return sha256(part.encode() + data[: place.start] + data[place.stop :]).hexdigest().encode()


def read_columns(stream: BinaryIO, check: Callable[[list[str], int], None]) -> dict[str, list[Any]]:
    """Return the columns of any Parquet file.

    Args:
        stream: the file.
        check: called with their names and the number of rows before any is read.

    Raises:
        OSError: it cannot be read, or is not a Parquet file.
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
    """Return the concatenated columns of several files; words as objects, None if missing.

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
        is_words = pa.types.is_dictionary(column.type)
        plain = column.cast(pa.string()) if is_words else column
        columns[name] = plain.to_numpy(zero_copy_only=False)
    return columns
