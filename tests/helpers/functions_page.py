"""The table of functions in docs/format.md, written anew from the files: python tests/helpers/functions_page.py."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from places import ROOT

from reference.dataset.files import read_files
from reference.dataset.manifest import FUNCTION
from reference.scenes.shipped import golden_root

PAGE, BEFORE, AFTER = (
    ROOT / "docs/format.md",
    "### Golden functions that ship\n",
    "\n## ranges.json",
)
MOMENTS = 10_000  # evenly spread over the span, at which the farthest point is sought
HEADS = (
    "scene",
    "pieces",
    "kB",
    "*x*, *y*: m",
    "of the farthest",
    "*z*: m",
    "ulp of the length",
    "velocities: m/s",
)
ABOUT = """\
What is proved of each (`bounds`), and the size of both files. The fifth column compares the bound on x and y with the
largest distance from the vertical through the suspension. `python tests/helpers/functions_page.py` makes the table;
`pytest --long tests/reference/enclosure/test_function.py` compares a million random times with runs to 40 digits.

An ulp of the length is the distance to the next double. Where the bob stays within 16 degrees of rest, z comes from x
and y and is little more than 1 ulp off. In wider swings z moves as far as x and y do, and has a series of its own. The
farther a series goes, the more its evaluation rounds. So a piece on which z would round more than 1.95 ulp is halved:
every z is within 2 ulp.
"""


def rows() -> Iterator[tuple[str, ...]]:
    """Yield the cells of each line: what is proved of a function, how that compares with its motion, its size."""
    for folder in sorted(path.parent for path in golden_root().glob(f"*/{FUNCTION[1]}")):
        files = read_files(folder)
        assert files.function is not None
        function, length = files.function[1], float(files.scene.exact.length)
        bound = function.bound
        at = function.at(np.linspace(0, function.times[-1], MOMENTS))
        farthest, level = float(np.sqrt(at.x**2 + at.y**2).max()), max(bound["x"], bound["y"])
        size = sum((folder / name).stat().st_size for name in FUNCTION)
        yield (
            folder.name.removesuffix(".binary64"),
            str(len(function.times) - 1),
            f"{size / 1000:.0f}",
            f"{level:.1e}",
            f"{level / farthest:.1e}" if farthest else "at rest",
            f"{bound['z']:.1e}",
            f"{bound['z'] / np.spacing(length):.1f}",
            f"{max(bound[name] for name in ('vx', 'vy', 'vz')):.1e}",
        )


def lines() -> Iterator[str]:
    """Yield the lines of the section."""
    yield from ("", *ABOUT.splitlines(), "")
    yield f"| {' | '.join(HEADS)} |"
    yield f"|{'---|' * len(HEADS)}"
    for row in rows():
        yield f"| {' | '.join(row)} |"


def page() -> str:
    """Return the page as it should be: what is written by hand, with the table in its place."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEFORE)
    return before + BEFORE + "\n".join([*lines(), ""]) + AFTER + rest.partition(AFTER)[2]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
