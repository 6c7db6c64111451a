"""Columns as Parquet and back; the only door to pyarrow."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from .row import Column

PYARROW: str = pa.__version__
KEY = b"foucault.plan"  # of the plan's hash in a file's metadata
_WORDS = pa.dictionary(pa.int32(), pa.string())


def parquet(columns: Iterable[Column], values: dict[str, Any], plan: str) -> bytes:
    """Return columns as a Parquet file: zstd, numbers with their bytes split, words by dictionary."""
    kinds = {"dictionary": _WORDS, "float64": pa.float64()}
    fields, arrays = [], []
    for column in columns:
        kind = kinds.get(column.kind) or getattr(pa, column.kind)()
        fields.append(pa.field(column.name, kind, metadata={"meaning": column.meaning}))
        if column.kind == "dictionary":
            arrays.append(pa.array(values[column.name], pa.string()).dictionary_encode().cast(_WORDS))
        else:
            arrays.append(pa.array(values[column.name], kind))
    table = pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata={KEY: plan.encode()}))
    words = [field.name for field in fields if field.type == _WORDS]
    split = [field.name for field in fields if field.type == pa.float64()]
    stream = io.BytesIO()
    pq.write_table(
        table, stream, compression="zstd", use_dictionary=words, use_byte_stream_split=split, write_statistics=True
    )
    return stream.getvalue()


def read_columns(path: Path) -> dict[str, list[Any]]:
    """Return the columns of any Parquet file.

    Raises:
        OSError: it cannot be read, or is none.
    """
    try:
        return dict(pq.read_table(path).to_pydict())
    except pa.ArrowException as error:
        raise OSError(0, str(error).splitlines()[0]) from None


def footer(path: Path) -> tuple[int, str]:
    """Return the number of rows of a file, and the hash of its plan; 0 and nothing if it is none, or cut short."""
    try:
        found = pq.read_metadata(path)
    except (OSError, pa.ArrowException):
        return 0, ""
    return found.num_rows, (found.metadata or {}).get(KEY, b"").decode()


def arrays(paths: Iterable[Path], names: list[str] | None = None) -> dict[str, Any]:
    """Return columns of several files, one below the other; words as objects, None where there is none."""
    table = pa.concat_tables([pq.read_table(path, columns=names) for path in paths])
    plain = {name: table[name].cast(pa.string()) for name in table.column_names if table[name].type == _WORDS}
    return {name: plain.get(name, table[name]).to_numpy(zero_copy_only=False) for name in table.column_names}
