"""Datasets damaged by accident: every changed byte is found, and nothing of a damaged dataset is read."""

from __future__ import annotations

import random

import pytest

import reference
from reference.dataset.verify import verify
from reference.dataset.write import write
from reference.errors import DatasetError


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    solution = reference.solve(reference.load_scene("paris"), t_end="600", digits=20, level="confirmed")
    return write(solution, tmp_path_factory.mktemp("golden") / "paris")


def test_every_changed_byte_of_any_file_is_found_by_verify_and_refused_by_load(dataset, size, tally):
    draw, tried, found, refused = random.Random(2026), size(40, 2000), 0, 0
    files = sorted(dataset.iterdir())
    for _ in range(tried):
        path = draw.choice(files)
        sound = path.read_bytes()
        where = draw.randrange(len(sound))
        damaged = bytearray(sound)
        damaged[where] = draw.choice([byte for byte in range(256) if byte != sound[where]])
        path.write_bytes(damaged)
        found += bool(verify(dataset).problems)
        try:
            reference.load(dataset)
        except DatasetError:
            refused += 1
        path.write_bytes(sound)
    tally(f"changed bytes: {tried} in {len(files)} files, {found} found by verify, {refused} refused by load")
    assert (found, refused) == (tried, tried)
    assert verify(dataset).problems == []


DAMAGE = {
    "a line twice": lambda data, i: data[:i] + data[i : data.find(b"\n", i) + 1] * 2 + data[data.find(b"\n", i) + 1 :],
    "cut off": lambda data, i: data[:i],
    "a piece twice": lambda data, i: data[:i] + data[i : i + 40] * 2 + data[i + 40 :],
    "a piece lost": lambda data, i: data[:i] + data[i + 40 :],
    "two bytes exchanged": lambda data, i: data[:i] + data[i : i + 2][::-1] + data[i + 2 :],
    "Windows line ends": lambda data, _: data.replace(b"\n", b"\r\n"),
    "a byte order mark": lambda data, _: b"\xef\xbb\xbf" + data,
    "one blank line more": lambda data, _: data + b"\n",
    "UTF-16": lambda data, _: data.decode().encode("utf-16"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_larger_damage_is_found_in_every_file(dataset, name, size, tally):
    draw, tried, found = random.Random(7), 0, 0
    for path in sorted(dataset.iterdir()):
        sound = path.read_bytes()
        for _ in range(size(1, 10)):
            damaged = DAMAGE[name](sound, draw.randrange(len(sound) - 100))
            if damaged == sound:
                continue
            path.write_bytes(damaged)
            tried += 1
            found += bool(verify(dataset).problems)
            with pytest.raises(DatasetError):
                reference.load(dataset)
        path.write_bytes(sound)
    tally(f"damage, {name}: {tried} tried, {found} found")
    assert found == tried > 0
