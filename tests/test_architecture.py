"""docs/architecture.md: the budget of bits is complete and true, and every folder stands in the tree."""

from __future__ import annotations

import ast
import re
from itertools import pairwise

from places import ROOT
from structure import PACKAGES, picture, sources

PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")


def constants_of_bits() -> dict[tuple[str, str], int]:
    """Return the value of every constant of `reference` that is named …_BITS, by name and file."""
    values = {}
    for path in (path for path in sources(ROOT) if "reference" in path.relative_to(ROOT).parts):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                name = node.targets[0].id
                if name.endswith("_BITS"):
                    values[name, path.relative_to(ROOT).as_posix()] = ast.literal_eval(node.value)
    return values


def test_every_spare_bit_stands_in_the_budget_with_its_value():
    rows = re.findall(r"^\| `(\w+)` \| `([\w/.]+)` \| (\d+) \| .+ \|$", PAGE, re.M)
    budget = {(name, path): int(bits) for name, path, bits in rows}
    (line,) = re.findall(r"^Sizes and whole precisions, not spare: (.+)\.$", PAGE, re.M)
    sizes = set(re.findall(r"`(\w+)`", line))
    assert len(budget) == len(rows) >= 20
    assert budget == {key: bits for key, bits in constants_of_bits().items() if key[0] not in sizes}


def test_every_folder_and_file_below_a_package_stands_in_the_tree():
    tree = PAGE.partition("## The tree")[2].partition("\n## ")[0]
    for package in PACKAGES:
        folder = ROOT / package
        for path in folder.iterdir():
            if path.suffix == ".py" and path.stem != "__init__":
                assert f"`{package}/{path.name}`" in tree, path
            elif (path / "__init__.py").is_file():
                assert f"`{package}/{path.name}/`" in tree, path


def test_the_picture_of_the_packages_is_that_of_todays_imports():
    again = "python tests/helpers/structure.py --picture > docs/packages.svg"
    assert (ROOT / "docs/packages.svg").read_text(encoding="utf-8") == picture(ROOT), again
    assert "](packages.svg)" in PAGE


def test_no_line_of_the_picture_runs_behind_a_box():
    svg = (ROOT / "docs/packages.svg").read_text(encoding="utf-8")
    number = r"([\d.]+)"
    boxes = re.findall(
        rf'<rect x="{number}" y="{number}" width="{number}" height="{number}" rx="3"/>', svg
    )
    lines = re.findall(r'<polyline points="(.+?)"/>', svg)
    assert lines and boxes
    for line in lines:
        corners = [tuple(map(float, corner.split(","))) for corner in line.split()]
        for (x1, y1), (x2, y2) in pairwise(corners):
            for part in range(1, 100):
                x = x1 + (x2 - x1) * part / 100
                y = y1 + (y2 - y1) * part / 100
                for left, top, wide, high in (map(float, box) for box in boxes):
                    assert not (left < x < left + wide and top < y < top + high), (line, x, y)
