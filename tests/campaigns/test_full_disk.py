"""A disk without room, or with room for a part: every format is refused with a message, and nothing is lost."""

from __future__ import annotations

import os
from collections import Counter

import pytest
from disks import fill, small_disk
from formats import litter

PAGE = 4096  # bytes, by which such a disk counts


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 1 << 20) as folder:
        yield folder


def test_what_is_there_stays_and_with_room_the_same_command_goes_on(made, disk, size, tally):
    """The folder is an older one, or one in which nothing is done; there is room for ever more pages of the disk."""
    counts = Counter()
    folder = made.begun(disk / "place")
    words = made.format.command(folder)
    fill(disk)
    for pages in range(size(1, 12)):
        os.truncate(disk / "filler", (disk / "filler").stat().st_size - PAGE * min(pages, 1))
        status, _, err = made.foucault(*words)
        if status == 0:
            break
        message = err.splitlines()[-1]
        assert (
            status == 2
            and message.startswith("foucault: --out: ")
            and "No space left on device" in message
        )
        assert litter(folder.parent) == []
        counts[made.is_nothing_half(folder)] += 1
    (disk / "filler").unlink()
    assert made.foucault(*words)[0] == 0
    made.is_whole(folder)
    tally(f"a full disk under a {made.format.name}: {dict(counts)}")
