"""TOML and JSON files of strangers: whatever they hold is read or refused within a second and little memory."""

from __future__ import annotations

import os
import time
import tracemalloc
from pathlib import Path

import pytest

from reference.errors import InputError
from reference.scenes.scene import load_scene
from reference.system.documents import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_JSON_BYTES,
    json_document,
    json_lines,
    toml_document,
)


def filled(*pieces: str) -> str:
    """Return the largest file made of a beginning, a piece repeated, and an end."""
    start, piece, end = pieces
    return start + piece * ((MAX_BYTES - len(start) - len(end)) // len(piece)) + end


WORST = {
    "dotted key": (filled("", "a.", "a=1"), f"at most {MAX_DEPTH} parts"),
    "dotted table": (filled("[", "a . ", "a]"), f"at most {MAX_DEPTH} parts"),
    "quoted words": (filled("", '"\\"".', "a=1"), f"at most {MAX_DEPTH} parts"),
    "many deep keys": (filled("", "a." * (MAX_DEPTH - 1) + "a\n", ""), "a TOML file"),
    "quotes": (filled("", '\\"', ""), "a TOML file"),
    "lists in lists": (filled("a=", "[", ""), "nested too deeply"),
    "tables in tables": (filled("", "a={", ""), "nested too deeply"),
    "an integer": ("a=" + "9" * 5000, "at most 4300 digits"),
    "a key twice": ("a=1\na=2", "Cannot overwrite a value"),
    "UTF-16": ("\ufeffa=1".encode("utf-16"), "utf-8"),
    "a zero byte": ("a='\0'", "invalid character"),
}


@pytest.mark.parametrize(("text", "said"), WORST.values(), ids=WORST)
def test_the_worst_that_fits_is_refused_at_once(tmp_path, text, said):
    path = tmp_path / "worst.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    start = time.process_time()
    tracemalloc.start()
    with pytest.raises(InputError, match=said) as caught:
        load_scene(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert time.process_time() - start < 5  # traced; a fifth of it otherwise
    assert peak < 100 << 20
    assert len(str(caught.value)) < 500


def test_a_key_as_deep_as_allowed_is_read(tmp_path):
    path = tmp_path / "deep.toml"
    path.write_text(".".join("a" * MAX_DEPTH) + f"=1\ntitle='{'1.2.' * 5}3 and {'.' * 200}'\n")
    assert toml_document(path, "SCENE")["title"].endswith("...")


def test_a_larger_file_is_refused_and_one_as_large_as_allowed_is_read(tmp_path):
    path = tmp_path / "large.toml"
    path.write_text(filled("", "# comment\n", "#"))
    assert toml_document(path, "SCENE") == {}
    path.write_text("#" * (MAX_BYTES + 1))
    with pytest.raises(InputError, match=f"at most {MAX_BYTES} bytes"):
        load_scene(path)


def test_only_regular_files_are_scenes(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", "/dev/zero", "/dev/null"):
        with pytest.raises(InputError, match="a regular file"):
            load_scene(path)
    for path in (tmp_path, "a\0b", "\ud800", "x" * 5000):
        with pytest.raises(InputError, match="a readable file"):
            load_scene(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"a":' * 100_000, "nested too deeply"),
        ("[" * 100_000, "nested too deeply"),
        (f'{{"a": {"9" * 5000}}}', "at most 4300 digits"),
        ("[]", "of keys and values"),
        ("", "Expecting value"),
        ('{"a": 1', "Expecting"),
        ("\ufeff{}", "BOM"),
        (b"\xff\xfe", "utf-8"),
    ],
    ids=lambda text: f"{text[:9]!r}",
)
def test_what_is_no_json_document_is_refused(tmp_path, text, said):
    path = tmp_path / "mine.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError, match=f"--out: got .*{said}") as caught:
        json_document(path, "--out")
    assert len(str(caught.value)) < 500
    assert list(json_lines(path, "--out")) == []


def test_only_regular_files_of_a_bounded_size_are_json(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text('{"a": [1]}\n[]\n{"b": \n{"c": 2}')
    assert list(json_lines(path, "--out")) == [{"a": [1]}, {"c": 2}]
    path.write_text('{"a": [1]}')
    assert json_document(path, "--out") == {"a": [1]}
    os.truncate(path, MAX_JSON_BYTES + 1)  # on the disk it takes no room
    with pytest.raises(InputError, match=f"at most {MAX_JSON_BYTES} bytes"):
        json_document(path, "--out")
    for name, said in (("/dev/zero", "regular file"), (tmp_path, "readable|regular file")):
        with pytest.raises(InputError, match=said):
            json_document(Path(name), "--out")
    with pytest.raises(FileNotFoundError):
        json_document(tmp_path / "none", "--out")
