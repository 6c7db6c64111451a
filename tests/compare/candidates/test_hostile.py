"""Sixty hostile inputs, each refused with a short message in one line: files, assignments and commands."""

from __future__ import annotations

import gzip

import pytest

from compare.candidates.external import arguments, run_program
from compare.candidates.read import read, read_transits
from reference import FoucaultError
from reference.plain_text import is_plain

HEAD, GOOD = b"t,x,y\n", b"t,x,y\n0,1,2\n1,1,2\n"
FIELDS = [
    "nan", "inf", "-inf", "1e999999999", "9" * 10**5, "1e99999999999999999999", "٣", "1_0", "1\x1b", "1\0", "'1'",
]  # fmt: skip
FILES = [
    *(HEAD + f"0,1,{field}\n".encode() for field in FIELDS), *(f"t\n{field}\n".encode() for field in FIELDS),
    HEAD + b"0,1,", b"", b"\n", b"\xff\xfe", GOOD.decode().encode("utf-16"), GOOD + b"2,1,\xe9",
    gzip.compress(GOOD, mtime=0),
    HEAD + b"0,1\n", HEAD + b"0,1,2,3\n", HEAD + b'0,"1\n2",3\n', HEAD + b"1,1,1\n0,1,1\n", HEAD + b"0," + b"1" * 10**7,
    b"PK\x03\x04", b"PK\x05\x06" + bytes(18), b"\x93NUMPY\x01\0", b"\x80\x04.", GOOD.replace(b"\n", b"\r"), b"a" * 10**7
]  # fmt: skip
ASSIGNED = [
    *("site.gravity=" + field for field in FIELDS),
    "title=a\rb",
    "id=\x1b",
    "flags=\x9b",
    "a.b.c.d=1",
]
COMMANDS = [
    "'",
    "{",
    "{nothing}",
    "| x",
    "/no/such/program \0",
    "/no/such/program \ud800",
    "/no/such/" + "x" * 10**5,
]


@pytest.mark.parametrize(
    "hostile", [*FILES, *ASSIGNED, *COMMANDS], ids=lambda hostile: ascii(hostile)[:30]
)
def test_it_is_refused_in_one_short_line(paris, tmp_path, hostile):
    file = tmp_path / "file"
    with pytest.raises(FoucaultError) as caught:
        if isinstance(hostile, bytes):
            file.write_bytes(hostile)
            (read_transits if hostile.startswith(b"t\n") else read)(file)
        elif hostile in ASSIGNED:
            paris.with_values([hostile])
        else:
            run_program(arguments(hostile, paris))
    assert is_plain(str(caught.value)) and len(str(caught.value)) < 700
