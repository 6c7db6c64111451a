"""Read candidates: every format gives the same numbers, and anything else gets a message, in bounded memory."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import os
import subprocess
import sys
import zipfile
from threading import Timer

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from places import ROOT

from compare.candidates.arrays import MAX_UNPACKED
from compare.candidates.read import read, read_stream, read_transits
from reference import InputError

ROWS = [
    (0.0, 0.3, 0.4, -66.9),
    (60.0, -0.17632673290555428, -0.4158676877474455, -66.99),
    (86400.0, 1e-5, -2.5e-7, -67),
]
TIMES, X, Y, Z = (list(column) for column in zip(*ROWS, strict=True))


def text(*lines):
    return io.BytesIO("\n".join([*lines, ""]).encode())


def csv(rows=ROWS, header="t,x,y,z"):
    return text(header, *(",".join(map(repr, row)) for row in rows))


def archive(*tables, **arrays):
    stream = io.BytesIO()
    np.savez(stream, *tables, **arrays)
    stream.seek(0)
    return stream


def test_empty_columns_of_text_are_refused():
    with pytest.raises(InputError, match=r"no rows|real numbers"):
        read_stream(archive(t=np.array([]), x=np.array([]), y=np.array([], "U3")), "mine.npz")


def refused(stream, *words):
    with pytest.raises(InputError) as caught:
        read_stream(stream, "run")
    assert caught.value.field.startswith("run")
    for word in words:
        assert word in str(caught.value)
    return caught.value


def assert_read(found):
    assert found.t.tolist() == TIMES
    assert [found.columns[name].tolist() for name in "xyz"] == [X, Y, Z]
    assert not found.extended


def test_csv_is_read_from_a_stream_a_path_and_standard_input(tmp_path, monkeypatch):
    assert_read(read_stream(csv(), "run"))
    path = tmp_path / "a.csv"
    path.write_bytes(csv().getvalue())
    assert_read(read(path))
    assert read(str(path)).name == str(path)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(csv()))
    assert_read(read("-"))


def test_columns_may_come_in_any_order_and_others_are_passed_over():
    rows = [(z, "tilt", y, 1 / 3, t, x) for t, x, y, z in ROWS]
    lines = [
        ",".join(item if isinstance(item, str) else repr(item) for item in row) for row in rows
    ]
    assert_read(read_stream(text("z,comment,y,energy,t,x", *lines), "run"))


def test_spaces_quotes_capitals_a_byte_order_mark_and_windows_line_ends_do_no_harm():
    lines = [
        '\ufeff "T", X ,y, z ',
        *(" , ".join(map(repr, row)) + " " for row in ROWS),
        "",
        "# the end",
    ]
    assert_read(read_stream(io.BytesIO("\r\n".join([*lines, ""]).encode()), "run"))


def test_what_numpy_saves_is_read(tmp_path):
    """A table without names, by itself or in an archive, and records with names of their own."""
    table = np.array(ROWS)
    for stream in (io.BytesIO(), archive(table)):
        if not stream.getbuffer().nbytes:
            np.save(stream, table)
            stream.seek(0)
        found = read_stream(stream, "run")
        assert_read(found)
        assert [one.id for one in found.conventions] == ["no_header"]
    records = np.array(ROWS, dtype=[("time", float), ("pos_x", float), ("y", float), ("z", float)])
    np.save(tmp_path / "a.npy", records)
    assert_read(read(tmp_path / "a.npy"))
    np.save(tmp_path / "a.npy", table[:, [1, 0, 2, 3]])
    assert_read(read(tmp_path / "a.npy", columns=["x", "t", "y", "z"]))


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((2, 5)), ("shape (2, 5)", "--columns")),
        (np.zeros(3), ("shape (3,)", "one row for each time")),
        (np.zeros((2, 3), dtype=complex), ("complex128", "real numbers")),
    ],
)
def test_a_table_of_other_columns_is_refused(array, words):
    stream = io.BytesIO()
    np.save(stream, array)
    stream.seek(0)
    refused(stream, *words)


def test_what_numpy_savetxt_writes_is_read():
    stream = io.BytesIO()
    np.savetxt(stream, np.array(ROWS), delimiter=",", header="t,x,y,z", fmt="%.17g")
    stream.seek(0)
    assert_read(read_stream(stream, "run"))


@pytest.mark.parametrize("mark", ["", "# "])
@pytest.mark.parametrize(
    ("put", "named"), [(",", ","), (";", ";"), (" ", " "), ("\t", "  "), (" ", ","), (",", " ")]
)
def test_names_are_read_whatever_separates_them(mark, put, named):
    """White space under a header in another order was once taken for foucPend's t x y z."""
    rows = [put.join(map(repr, (z, y, t, x))) for t, x, y, z in ROWS]
    assert_read(
        read_stream(
            text("# of a program of mine", mark + named.join(("z", "y", "t", "x")), *rows), "run"
        )
    )


def test_velocities_under_a_header_of_white_space_are_not_taken_for_z():
    found = read_stream(text("# t x y vx vy", "0 1 2 3 4"), "run")
    assert {name: column[0] for name, column in found.columns.items()} == {
        "x": 1,
        "y": 2,
        "vx": 3,
        "vy": 4,
    }


def test_the_output_of_the_papers_program_is_read_with_its_transits():
    lines = ["# foucPend", *(" ".join([*map(repr, row), "1 2 3 4 5 6"]) for row in ROWS)]
    lines[2:2] = ["# P 1 8.2178 0.0608", "# P 2 16.4356 0.0608"]
    found = read_stream(text(*lines), "run")
    assert_read(found)
    assert found.transits.tolist() == [8.2178, 16.4356]
    assert found.positions


def test_an_archive_is_read_with_its_transits():
    arrays = dict(zip("txyz", map(np.array, (TIMES, X, Y, Z)), strict=True))
    found = read_stream(
        archive(**arrays, transits=np.array([8.2, 16.4]), other=np.array(["a"])), "run"
    )
    assert_read(found)
    assert found.transits.tolist() == [8.2, 16.4]


def test_digits_beyond_a_double_are_kept():
    found = read_stream(
        text("t,x,y", "0,0.30000000000000000000,0.4", "0.1,0.12345678901234567890123,0.4"), "run"
    )
    assert found.extended
    assert found.columns["x"][1] + found.low["x"][1] == found.columns["x"][1]
    assert found.low["x"][1] == pytest.approx(
        0.12345678901234567890123 - 0.12345678901234568, abs=1e-17
    )
    exact = [0.0, 1.0 * (10**17 // 10) / 10**17]
    assert exact[1] == 0.1
    # 1/10 minus its double
    assert found.low["t"][1] == pytest.approx(-5.551115123125783e-18, rel=1e-12)


def test_a_double_printed_with_many_digits_is_still_a_double():
    lines = [f"{t:.25g},{x:.25g},{y:.25g}" for t, x, y, _ in ROWS]
    assert not read_stream(text("t,x,y", *lines), "run").extended
    lines = [f"{t:.17g},{x:.20f},{y:.30f}" for t, x, y, _ in ROWS]
    assert not read_stream(text("t,x,y", *lines), "run").extended


def test_an_archive_of_long_doubles_keeps_their_digits():
    x = np.array([1, 2], dtype=np.longdouble) / 3
    found = read_stream(archive(t=np.array([0.0, 1.0]), x=x, y=np.zeros(2)), "run")
    assert found.extended
    assert np.array_equal(
        found.columns["x"].astype(np.longdouble) + found.low["x"].astype(np.longdouble), x
    )


def test_an_exponent_beyond_reason_costs_nothing():
    found = read_stream(
        text("t,x,y", "0,1.0000000000000000000001e-999999999,0.4", "1,0.30000000000000000001,0.4"),
        "run",
    )
    assert found.columns["x"][0] == 0
    assert found.low["x"][0] == 0
    refused(text("t,x,y", "0,1.0000000000000000000001e999999999,0.4"), "run: x", "inf in row 1")


def test_an_exponent_of_fortran_may_come_in_any_row():
    found = read_stream(text("t,x,y", "0,0.3,0.4", "60,1.5D-01,-2.5D+00"), "run")
    assert found.columns["x"].tolist() == [0.3, 0.15]
    assert found.columns["y"].tolist() == [0.4, -2.5]


@pytest.mark.parametrize("order", ["utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be"])
def test_a_text_in_another_encoding_is_told_as_that(order):
    with pytest.raises(InputError, match=f"got {order[:6].upper()}, expected text in UTF-8"):
        read_stream(io.BytesIO("\ufefft,x,y\n0,0.3,0.4\n".encode(order)), "run")


@pytest.mark.parametrize(
    ("kind", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress), ("xz", lzma.compress)]
)
def test_a_packed_file_is_told_as_that(kind, pack):
    with pytest.raises(InputError, match=f"got {kind}, expected text in UTF-8. Unpack it first"):
        read_stream(io.BytesIO(pack(b"t,x,y\n0,0.3,0.4\n")), "run")


def test_a_last_line_without_its_end_is_noted():
    found = read_stream(io.BytesIO(b"t,x,y\n0,0.3,0.4\n60,0.1,0.2"), "run")
    assert len(found.t) == 2
    assert "cut off" in found.notes[0]


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ([], ("no header", "CSV", "t, x, y and optionally z, vx, vy, vz")),
        (["t,x,y"], ("no rows", "at least one")),
        (["# t,x,y", "# 0,1,2"], ("no rows", "All lines are comments")),
        (["t,x", "0,1"], ("header", "no y in t, x", "column y")),
        (["t,x,y,x", "0,1,2,3"], ("header", "x, x", "one column x")),
        (["t,x,y,vz,vz", "0,1,2,3,4"], ("header", "vz, vz", "one column vz")),
        (["t,pos_x,x_pos,y", "0,1,2,3"], ("header", "pos_x, x_pos", "one column x", "--columns")),
        (["# clock x y", "0 1 2"], ("header", "no t in clock, x, y", "column t")),
        (["a b c", "0 1 2"], ("header", "no t in a, b, c", "column t")),
        (["# t x y", "a b c", "0 1 2"], ("header", "no t in a, b, c", "column t")),
        (["t,x (px),y (px)", "0,1,2"], ("header: x (px)", "'px'", "a known unit of x")),
        (["0 1 2 3 4"], ("first line", "'0 1 2 3 4'", "header that names", "--columns")),
        (["0,0.3"], ("first line", "header that names")),
        (["t,x,y", "0,0.3"], ("line 2", "2 fields", "3, as in the header on line 1", "cut off")),
        (["t,x,y", "t,x,z"], ("line 2", "'t,x,z'", "a row of numbers")),
        (["a wise man's fear"], ("line 1", "a wise man", "a CSV file")),
        (["t,x,y", "0,1,2", "# note", "1,1,2,3"], ("line 4", "4 fields")),
        (["t,x,y", "0,1,2", "1,one,2"], ("line 3: x", "'one'", "a number")),
        (["t,x,y", "0,1_0,2"], ("line 2: x", "'1_0'")),
        (["t,x,y", "0,0x10,2"], ("line 2: x",)),
        (["t,x,y", "0,\u0661,2"], ("line 2: x",)),
        (["t,x,y", "0,1,2", "1,nan,2"], ("run: x", "nan in row 2", "finite")),
        (["t,x,y", "0,1,2", "1,inf,2"], ("run: x", "inf in row 2")),
        (["t,x,y", "0,1,2", "1,1e200,2"], ("run: x", "1e+200 in row 2", "1e+100")),
        (["t,x,y", "nan,1,2"], ("run: t", "nan in row 1")),
        (["t,x,y", "-1,1,2"], ("run: t", "-1 in row 1", "0 or later")),
        (["t,x,y", "0,1,2", "0,1,2"], ("run: t", "0 in row 2 after 0", "strictly increasing")),
        (["t,x,y", "5,1,2", "4,1,2"], ("4 in row 2 after 5", "Sort the rows")),
        (["0 1 2 3", "# P 1"], ("line 2", "# P")),
        (["0 1 2 3", "# P 1 9 0", "# P 2 8 0"], ("# P", "8 as transit 2 after 9")),
        (["0 1 2 3", "1 2 3"], ("line 2", "3 fields")),
    ],
)
def test_what_is_wrong_with_a_text_is_said_with_its_place(lines, words):
    refused(text(*lines), *words)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"x": [1.0], "y": [1.0]}, ("no t in x, y", "one column t")),
        ({"energy": [1.0]}, ("other names", "arrays t, x, y")),
        ({"t": [0.0], "x": [1.0]}, ("column y",)),
        ({"t": [0.0, 1.0], "x": [1.0], "y": [1.0, 2.0]}, ("run: x", "shape (1,)", "2 numbers")),
        ({"t": [[0.0]], "x": [1.0], "y": [1.0]}, ("run: t", "shape (1, 1)")),
        ({"t": 0.0, "x": 1.0, "y": 1.0}, ("run: t", "shape ()")),
        ({"t": [], "x": [], "y": []}, ("no rows",)),
        ({"t": [0.0], "x": [1j], "y": [1.0]}, ("run: x", "complex128", "real")),
        ({"t": [0.0], "x": ["a"], "y": [1.0]}, ("run: x", "real numbers")),
        ({"t": [True], "x": [1.0], "y": [1.0]}, ("run: t", "bool")),
        (
            {"t": [0.0], "x": [1.0], "y": [1.0], "transits": [2.0, 1.0]},
            ("run: transits", "1 as transit 2 after 2"),
        ),
        (
            {"t": [0.0], "x": [1.0], "y": [1.0], "transits": [[2.0]]},
            ("run: transits", "one-dimensional"),
        ),
    ],
)
def test_what_is_wrong_with_an_archive_is_said(arrays, words):
    refused(archive(**{name: np.array(values) for name, values in arrays.items()}), *words)


def test_an_archive_with_pickles_inside_is_not_opened():
    refused(archive(t=np.array([{}], dtype=object), x=np.zeros(1), y=np.zeros(1)), "damaged")


def test_a_zip_file_of_something_else_is_refused():
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as made:
        for name in "txy":
            made.writestr(name, "0 1 2")
    refused(io.BytesIO(stream.getvalue()), "an array of real numbers")


def test_an_archive_that_unpacks_to_more_than_is_read_is_refused_unopened():
    stream = io.BytesIO()
    with (
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as made,
        made.open("t.npy", "w") as member,
    ):
        zeros = bytes(1 << 24)
        for _ in range(MAX_UNPACKED // len(zeros) + 1):
            member.write(zeros)
    stream.seek(0)
    refused(stream, "bytes when unpacked")


@pytest.mark.parametrize(
    "junk",
    [bytes(range(256)) * 4, b"\xff\xfe0\x00,\x00", b"PK\x03\x04 and nothing more", b"\0" * 64],
)
def test_binary_junk_is_refused(junk):
    refused(io.BytesIO(junk))


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(InputError, match="readable file"):
            read(path)


def test_a_pipe_to_which_nobody_writes_is_refused(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for read_pipe in (read, read_transits):
        with pytest.raises(InputError, match="No program writes to this pipe"):
            read_pipe(pipe)


@pytest.mark.parametrize("late", [False, True])
def test_the_output_of_a_program_is_read_from_a_pipe_also_if_it_comes_late(late):
    reader, writer = os.pipe()

    def write_all():
        os.write(writer, csv().getvalue())
        os.close(writer)

    writing = Timer(0.3 * late, write_all)
    writing.start()
    if not late:
        writing.join()
    assert_read(read(f"/dev/fd/{reader}"))
    writing.join()
    os.close(reader)


def test_a_path_that_no_file_can_have_and_a_closed_standard_input_are_refused(monkeypatch):
    for path in ("a\0b", "\ud800"):
        with pytest.raises(InputError, match="cannot be the path of a file"):
            read(path)
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(InputError, match="Standard input is closed"):
        read("-")


def test_a_device_without_end_is_refused_at_once():
    with pytest.raises(InputError, match="a line of more than 1048576 bytes"):
        read("/dev/zero")


def test_the_name_of_a_candidate_can_be_printed(tmp_path):
    path = tmp_path / os.fsdecode(b"n\xff\x1b[31m.csv")
    path.write_bytes(csv().getvalue())
    assert read(path).name == f"{tmp_path}/n\\xff\\x1b[31m.csv"


def test_transits_need_the_column_t_only(tmp_path):
    path = tmp_path / "zeros.csv"
    path.write_text("k,t,direction\n# first\n1,8.2,+1\n\n2,16.4,-1\n")
    assert read_transits(path).tolist() == [8.2, 16.4]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "column t"),
        ("clock\n1\n", "got no t in clock, expected one column t"),
        ("k,t\n1\n", "line 2: got 1 field,"),
        ("k,t\n1,2\n\n2,soon\n", "line 4: t: got 'soon'"),
        ("k,t\n1,2\n2,3,4\n", "line 3: got 3 fields, expected 2"),
        ("t\nsoon\n", "line 2: got 'soon', expected a row of numbers"),
        ("1 2 3 4\n", "a header that names"),
        ("t\n2\n1\n", "1 as transit 2 after 2"),
        ("t\nnan\n", "nan as transit 1"),
        ("t\n-1\n", "0 or later"),
        ("t\n\0\n", "zero byte"),
    ],
)
def test_what_is_wrong_with_a_file_of_transits_is_said(tmp_path, content, words):
    path = tmp_path / "zeros.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=words):
        read_transits(path)


GOOD = csv().getvalue()
NUMBERS = st.one_of(st.floats(allow_nan=True, allow_infinity=True), st.integers(-3, 3))


def reads_or_explains(data):
    """A candidate in good order, or an `InputError`: nothing else."""
    try:
        found = read_stream(io.BytesIO(data), "run")
    except InputError as error:
        assert str(error).startswith("run")
        assert len(str(error)) < 500
        return
    assert len(found.t)
    assert (np.diff(found.t) > 0).all()
    assert all(np.isfinite(column).all() for column in (found.t, *found.columns.values()))


@given(st.binary(max_size=300))
@example(b"t,x,y\n0,1,2\r\r\n")
def test_any_bytes_are_read_or_explained(data):
    reads_or_explains(data)
    reads_or_explains(b"PK" + data)


@given(st.integers(0, len(GOOD)), st.binary(max_size=8))
def test_a_truncated_or_overwritten_file_is_read_or_explained(cut, put):
    reads_or_explains(GOOD[:cut])
    reads_or_explains(GOOD[:cut] + put + GOOD[cut + len(put) :])


@given(
    st.lists(st.lists(NUMBERS, min_size=2, max_size=5), min_size=1, max_size=6),
    st.permutations(["t", "x", "y", "z"]),
)
def test_shuffled_repeated_and_infinite_numbers_are_read_or_explained(rows, header):
    lines = [",".join(header), *(",".join(map(repr, row)) for row in rows)]
    reads_or_explains("\n".join(lines).encode())


@given(st.data())
def test_a_damaged_archive_is_read_or_explained(data):
    good = archive(t=np.array(TIMES), x=np.array(X), y=np.array(Y)).getvalue()
    at = data.draw(st.integers(4, len(good) - 1))
    put = data.draw(st.binary(min_size=1, max_size=4))
    reads_or_explains(good[:at] + put + good[at + len(put) :])
    reads_or_explains(good[:at])


FLOOD = """
import io, resource, sys
import heyoka, numpy  # what is loaded anyway
from compare.candidates import read as reading
from reference import InputError

reading.MAX_ROWS //= {part}
reading.MAX_LINES //= {part}

class Flood(io.RawIOBase):
    def __init__(self, head, piece, total):
        self.head, self.piece, self.left, self.at = head, piece * ((1 << 22) // len(piece)), total, 0
    def readable(self):
        return True
    def readinto(self, target):
        data, self.head = self.head[:len(target)], self.head[len(target):]
        if not data:  # a read may give less than asked, as a pipe does
            data = self.piece[self.at : self.at + min(len(target), self.left)]
            self.left, self.at = self.left - len(data), (self.at + len(data)) % len(self.piece)
        target[:len(data)] = data
        return len(data)

before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for head, piece, total in {floods}:
    sys.stdin = io.TextIOWrapper(io.BufferedReader(Flood(head, piece, total)))
    try:
        reading.read("-")
    except InputError as error:
        print(error)
    else:
        sys.exit("was read")
    print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024)
"""


FLOODS = [
    (b"", b"\0", 1 << 28, "line of more than"),
    (b"", b"0\n", 1 << 28, "header"),
    (b"t,x,y\n", b"0,0,0\n", 1 << 25, "more than {rows} rows"),
    (b"t,x,y\n", b"\n", 1 << 23, "more than {lines} lines"),
    (b"t,x,y\n", b"# all is well\n", 1 << 26, "more than {lines} lines"),
    (b"PK\x03\x04", b"\0", (1 << 30) + 1, "more than 1073741824 bytes"),
]


def test_a_stream_of_nothing_is_refused_in_bounded_memory(size):
    """Of a tenth of the rows and lines that are allowed a tenth of the memory is taken."""
    part, floods = size((10, FLOODS[:4]), (1, FLOODS))
    program = FLOOD.format(part=part, floods=[flood[:3] for flood in floods])
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    answers = done.stdout.splitlines()
    assert len(answers) == 2 * len(floods)
    for flood, message, megabytes in zip(floods, answers[::2], answers[1::2], strict=True):
        assert flood[3].format(rows=2_000_000 // part, lines=4_000_000 // part) in message
        assert int(megabytes) < 400 // part


@pytest.mark.parametrize("quotes", ['""', '"" ""', '" "', '"'])
def test_a_line_of_quotes_alone_is_no_row(quotes):
    assert list(read_stream(io.BytesIO(f"{quotes}\nt,x,y\n0,1,1\n1,2,1\n".encode()), "run").t) == [
        0.0,
        1.0,
    ]
    with pytest.raises(InputError):
        read_stream(io.BytesIO(quotes.encode()), "run")
