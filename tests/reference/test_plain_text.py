"""Control characters are written out: in streams, messages and JSON documents, and no text changes its meaning."""

from __future__ import annotations

import io
import json
import sys

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from reference.errors import DatasetError, InputError, UnreachableError
from reference.plain_text import (
    PlainStream,
    is_plain,
    plain,
    plain_json,
    plain_lines,
    plain_output,
    terminal_of,
)

DANGEROUS = ["\x1b[31m", "\x1b]0;title\x07", "\x9b2J", "\x00", "\r", "\x7f"]
DANGEROUS += ["\u202e", "\u2028", "\ufeff", "\udcff", "\ud800"]


@pytest.mark.parametrize("text", DANGEROUS)
def test_what_a_terminal_would_obey_is_written_out(text):
    assert not is_plain(text)
    for shown in (plain(text), plain_lines(text)):
        assert shown.isprintable()
        assert shown.startswith("\\")


def test_a_byte_that_is_not_utf_8_is_shown_as_the_byte():
    assert plain(b"n\xff.csv".decode(errors="surrogateescape")) == "n\\xff.csv"


@given(st.text())
@example("Panthéon, 9,8 m/s², ℓ = 67 m → 😀")
def test_other_characters_stay_as_they_are(text):
    kept = "".join(character for character in text if is_plain(character))
    assert plain(kept) == kept
    assert is_plain(plain(text))
    assert plain_lines("a\n\tb") == "a\n\tb"


@given(st.text())
@example("\udcff\x9b\U000e0001")
def test_a_json_document_means_the_same_and_can_be_printed(text):
    document = plain_json({"title": text})
    assert json.loads(document) == {"title": text}
    assert is_plain(document.replace("\n", ""))
    assert document.encode()


def test_a_stream_writes_out_controls_and_what_its_encoding_lacks():
    file = io.BytesIO()
    stream = PlainStream(io.TextIOWrapper(file, encoding="latin-1"))
    assert stream.write("²\x1b[2J → \udcff\n") == 10
    stream.flush()
    assert file.getvalue() == b"\xb2\\x1b[2J \\u2192 \\xff\n"
    assert not stream.isatty()


def test_the_streams_are_put_back_but_not_over_one_that_came_later(monkeypatch):
    before, later = io.StringIO(), io.StringIO()
    monkeypatch.setattr(sys, "stdout", before)
    with plain_output():
        assert terminal_of(sys.stdout) is before
        print("\x1b[31mred")
    assert sys.stdout is before
    assert before.getvalue() == "\\x1b[31mred\n"
    with plain_output():
        sys.stdout = later
    assert sys.stdout is later


@pytest.mark.parametrize("text", DANGEROUS)
def test_no_message_of_an_error_holds_a_control_character(text):
    errors = [
        InputError(f"{text}: line 3", text, f"not {text}", text),
        UnreachableError(text),
        DatasetError(text, [text]),
    ]
    assert all(is_plain(str(error)) for error in errors)


def test_values_that_python_cannot_print_are_named_by_their_kind():
    deep: list[object] = []
    for _ in range(100_000):
        deep = [deep]
    for value, word in ((10**5000, "int"), (-(10**5000), "int"), (deep, "list")):
        assert f"a value too large to print, of type {word}" in str(
            InputError("run.digits", value, "a number")
        )


def test_no_command_sends_an_escape_to_the_terminal(foucault, tmp_path):
    hostile = tmp_path / "e\x1b[31m\n.csv"
    hostile.write_text("t,x\x1b[31m\n0,1\n")
    calls = (
        ["show", hostile],
        ["score", "paris", hostile],
        ["verify", hostile],
        ["generate", "paris", "--x\x1b[31m"],
    )
    for words in (*calls, ["show", "paris", "--set", "title=\x1b[31m"]):
        status, out, err = foucault(*words)
        assert status == 2
        assert "\x1b" not in out + err
        assert "\\x1b[31m" in out + err
