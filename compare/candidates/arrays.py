"""Read a candidate from arrays: NumPy's files, of arrays by name or one table of rows, or columns in memory."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from typing import IO, Any

import numpy as np

from reference import InputError
from reference.errors import Described, NoEffectError
from reference.numbers.precision import Array

from .candidate import ADVICE, COLUMNS, FEWER_ROWS, Candidate, checked_transits
from .names import NEEDED, Layout, Naming, by_number, given, layout, meaning

# bytes of the arrays that are read, unpacked: two million rows of long doubles
MAX_UNPACKED = 1 << 28
_MOST_ARRAYS = 1000
_TRANSITS = "transits"
_TABLE = "arr_0"  # the name that numpy.savez gives to an array without one
_AS_NAMED = Layout({}, {}, ())  # arrays by their columns' names, in SI units
_EXPECTED = "arrays t, x, y and optionally z, vx, vy, vz, transits"
_RAGGED = Described("rows of different lengths")


def candidate_of(
    name: str, arrays: Mapping[str, Array], transits: Array | None = None, made: Layout = _AS_NAMED
) -> Candidate:
    """Make a candidate of named arrays of real numbers, t among them.

    Long doubles keep their digits in `low`.

    Args:
        name: of the candidate.
        arrays: in SI units, or as a layout says.
        transits: times in s, or None.
        made: the layout of a file.

    Raises:
        InputError: as in `Candidate.of`.
    """
    columns: dict[str, Array] = {}
    low: dict[str, Array] = {}
    for key in ("t", *COLUMNS):
        if key not in arrays:
            continue
        array = arrays[key]
        columns[key] = np.asarray(array, dtype=np.float64)
        if array.dtype.kind != "f":  # an empty column may be of text
            continue
        with np.errstate(invalid="ignore"):  # of infinite numbers, which are refused
            remainder = np.asarray(array - columns[key], dtype=np.float64)
        if remainder.any() and np.isfinite(remainder).all():
            low[key] = remainder
    columns, low = made.converted(columns, low)
    return Candidate.of(
        name, columns.pop("t"), columns, low=low, transits=transits, conventions=made.conventions
    )


def candidate_from(columns: Any) -> Candidate:
    """Make a candidate of columns by name, as in a header: a mapping of arrays, or a pandas.DataFrame.

    Raises:
        InputError: it has no names, a column is missing or its unit not known, or as in
            `Candidate.of`.
    """
    if not (hasattr(columns, "__getitem__") and hasattr(columns, "keys")):
        got = type(columns).__name__
        expected = "a file, a Candidate, or columns by name with t, x and y"
        raise InputError("candidate", got, expected, ADVICE)
    return _of_arrays({str(name): columns[name] for name in columns}, "candidate", Naming())


def real_array(values: Any, name: str) -> Array:
    """Return values as an array of real numbers.

    Raises:
        InputError: they are rows of different lengths, or no real numbers.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise InputError(name, _RAGGED, "an array of real numbers") from None
    if array.size and array.dtype.kind not in "fiu":
        got = Described(f"dtype {array.dtype}")
        raise InputError(name, got, "an array of real numbers")
    return array


def read_archive(stream: IO[bytes], name: str, naming: Naming) -> Candidate:
    """Read a candidate from the bytes of an .npz archive.

    Raises:
        InputError: the archive is too large or damaged, lacks t, x or y, or an array is not of real
            numbers.
    """
    # arrays whose names mean something, or the only one if it has no name
    try:
        with zipfile.ZipFile(stream) as archive:
            members = {
                member.filename.removesuffix(".npy"): member
                for member in archive.infolist()[:_MOST_ARRAYS]
            }
        if any(word.startswith("xl/") for word in members):
            advice = "Save the sheet as CSV."
            got = Described("an Excel workbook")
            raise InputError(name, got, "text with named columns", advice)
        chosen = [word for word in members if word == _TRANSITS or meaning(word, {}) is not None]
        chosen = chosen or [word for word in members if word == _TABLE]
        size = sum(members[word].file_size for word in chosen)
        if size > MAX_UNPACKED:
            got = Described(f"{size} bytes when unpacked")
            raise InputError(name, got, f"at most {MAX_UNPACKED}", FEWER_ROWS)
        stream.seek(0)
        with np.load(stream, allow_pickle=False) as arrays:
            loaded = {word: arrays[word] for word in chosen}
    except InputError:
        raise
    # zipfile and numpy raise half a dozen kinds of errors for a damaged archive
    except Exception as error:
        got = Described("a damaged .npz archive")
        raise InputError(name, got, _EXPECTED, f"{error}.") from None
    return _of_arrays(loaded, name, naming)


def read_array(stream: IO[bytes], name: str, naming: Naming) -> Candidate:
    """Read a candidate from the bytes of an .npy file: a table of rows, or an array of records with names.

    Raises:
        InputError: the file is damaged, or its columns are not known.
    """
    try:
        array = np.load(stream, allow_pickle=False)
    except Exception as error:  # numpy raises several kinds of errors for a damaged file
        expected = "a table of real numbers"
        got = Described("a damaged .npy file")
        raise InputError(name, got, expected, f"{error}.") from None
    words = array.dtype.names  # of which none means transits: there is one for each row
    records = {word: array[word] for word in words or () if word != _TRANSITS}
    return _of_arrays(records or {_TABLE: array}, name, naming)


def _of_arrays(arrays: dict[str, object], name: str, naming: Naming) -> Candidate:
    """Make a candidate of arrays with names, or of a table, whose columns the user names, or their number does."""
    if not arrays:
        raise InputError(name, Described("arrays with other names"), _EXPECTED)
    if [*arrays] != [_TABLE]:
        if naming.columns:
            raise NoEffectError("--columns", ",".join(naming.columns), "for arrays with names")
        times = arrays.pop(_TRANSITS, None)
        transits = None
        if times is not None:
            field = f"{name}: {_TRANSITS}"
            transits = checked_transits(real_array(times, field), field)
        by_names = layout([*arrays], NEEDED, naming, name)
        return _candidate(name, [*arrays.values()], by_names, transits)

    table = real_array(arrays[_TABLE], name)
    count = table.shape[1] if table.ndim == 2 else 0
    if naming.columns and count:
        columns: Layout | None = given(count, naming)
    else:
        columns = by_number(count, NEEDED, naming)
    if columns is None:
        expected = "a table of 3, 4 or 7 columns that begin with t, x, y"
        advice = "Write one row for each time, or name the columns by --columns."
        raise InputError(name, Described(f"shape {table.shape}"), expected, advice)
    return _candidate(name, [*table.T], columns)


def _candidate(
    name: str, arrays: Sequence[object], made: Layout, transits: Array | None = None
) -> Candidate:
    """Make a candidate of arrays of which each column is the one at its place."""
    columns = {
        column: real_array(arrays[i], f"{name}: {column}") for column, i in made.places.items()
    }
    return candidate_of(name, columns, transits, made)
