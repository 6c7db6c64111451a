"""Read a candidate from a NumPy archive (.npz): arrays t, x, y and any of z, vx, vy, vz, transits."""

from __future__ import annotations

import tempfile
import zipfile
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.precision import Array

from .candidate import COLUMNS, Candidate, candidate_of, checked_transits
from .lines import CHUNK, MAX_BYTES

MAX_UNPACKED = 1 << 28  # bytes of the arrays that are read, unpacked: two million rows of long doubles
_KEYS = ("t", *COLUMNS, "transits")
_MEMBERS = {member for key in _KEYS for member in (key, f"{key}.npy")}
_EXPECTED = "arrays t, x, y and, if there, z, vx, vy, vz, transits"


def read_archive(stream: BinaryIO, head: bytes, name: str) -> Candidate:
    """Read a candidate from the bytes of an .npz archive, of which `head` has been read already.

    Raises:
        InputError: the archive is too large or damaged, lacks t, x or y, or an array is not of real numbers.
    """
    with tempfile.TemporaryFile() as spool:
        _bounded(stream, head, spool, name)
        columns = {key: _real(array, f"{name}: {key}") for key, array in _arrays(spool, name).items()}
    if "t" not in columns:
        raise InputError(
            name, f"arrays {', '.join(columns) or 'of other names'}", "an array t", f"Wanted: {_EXPECTED}."
        )
    times = columns.pop("transits", None)
    transits = None if times is None else checked_transits(np.asarray(times, dtype=np.float64), f"{name}: transits")
    return candidate_of(name, columns, transits)


def _bounded(stream: BinaryIO, head: bytes, spool: BinaryIO, name: str) -> None:
    """Copy the stream to a file, up to a limit: a zip archive is read from its end."""
    total, data = 0, head
    while data:
        total += len(data)
        if total > MAX_BYTES:
            raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES} bytes", "Thin the output out.")
        spool.write(data)
        data = stream.read(CHUNK)
    spool.seek(0)


def _arrays(data: BinaryIO, name: str) -> dict[str, object]:
    try:
        with zipfile.ZipFile(data) as archive:
            size = sum(member.file_size for member in archive.infolist() if member.filename in _MEMBERS)
        if size <= MAX_UNPACKED:
            data.seek(0)
            with np.load(data, allow_pickle=False) as arrays:
                return {key: arrays[key] for key in _KEYS if key in arrays.files}
    except Exception as error:  # zipfile and numpy raise half a dozen kinds of errors for a damaged archive
        raise InputError(name, "a damaged .npz archive", _EXPECTED, f"{error}.") from None
    raise InputError(name, f"{size} bytes unpacked", f"at most {MAX_UNPACKED}", "Thin the output out.")


def _real(array: object, name: str) -> Array:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        kind = f"dtype {array.dtype}" if isinstance(array, np.ndarray) else "no NumPy array"
        raise InputError(name, kind, "an array of real numbers")
    return array
