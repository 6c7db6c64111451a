"""TOML files of strangers: whatever they hold is read or refused within a second and little memory."""

from __future__ import annotations

import os
import time
import tracemalloc

import pytest

from reference.errors import InputError
from reference.scenes.scene import load_scene
from reference.scenes.toml_document import MAX_BYTES, MAX_DEPTH, toml_document


def filled(*pieces: str) -> str:
    """Return the largest file made of a beginning, a piece repeated, and an end."""
    start, piece, end = pieces
    return start + piece * ((MAX_BYTES - len(start) - len(end)) // len(piece)) + end


WORST = {
    "dotted key": (filled("", "a.", "a=1"), f"at most {MAX_DEPTH} words"),
    "dotted table": (filled("[", "a . ", "a]"), f"at most {MAX_DEPTH} words"),
    "quoted words": (filled("", '"\\"".', "a=1"), f"at most {MAX_DEPTH} words"),
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
    assert toml_document(path)["title"].endswith("...")


def test_a_larger_file_is_refused_and_one_as_large_as_allowed_is_read(tmp_path):
    path = tmp_path / "large.toml"
    path.write_text(filled("", "# comment\n", "#"))
    assert toml_document(path) == {}
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
