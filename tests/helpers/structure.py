"""Measure the structure of the code: rooms, floors, arrows, circles and class names.

    python tests/helpers/structure.py [ROOT]
    python tests/helpers/structure.py --picture > docs/packages.svg

A room is a file or a folder directly inside a package; an arrow goes from a room to another room that it imports,
imports for type checkers included. A room stands one floor above the highest room that it imports.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from functools import cache
from itertools import pairwise
from pathlib import Path
from statistics import fmean

PACKAGES = ("reference", "compare")
# of the picture: a package, a box, from box to box, floor to floor
WIDE, BOX, HIGH, GAP, FLOOR = 420, 104, 26, 12, 58
MARGIN, TITLE = 16, 30
LANE = 4  # of a line that passes a floor between its boxes
SWEEPS = 12  # over the floors, to order their boxes
STYLE = """<style>
text { font: 12px sans-serif; text-anchor: middle; fill: #222 }
.package { font-weight: bold; text-anchor: start }
rect { fill: #eef3f8; stroke: #5a7896 }
.frame { fill: none; stroke: #b9c6d3 }
polyline { stroke: #8aa; fill: none }
@media (prefers-color-scheme: dark) {
text { fill: #ddd }
rect { fill: #1d2a37; stroke: #7f9cb8 }
.frame { fill: none; stroke: #4d5c6b }
polyline { stroke: #688 }
}
</style>"""
Arrows = set[tuple[str, str]]
Item = str | tuple[str, str]  # of a floor: a room, or an arrow that passes it


def sources(root: Path) -> list[Path]:
    """Every source file of the project, tests excepted."""
    return sorted(
        [root / "foucault.py", *(path for name in PACKAGES for path in (root / name).rglob("*.py"))]
    )


@cache
def imported(path: Path, root: Path) -> set[Path]:
    """The files and packages of the project that a file imports anywhere, as paths without a suffix."""
    inside, found = list(path.relative_to(root).parts[:-1]), set()
    for node in imports(path):
        if isinstance(node, ast.Import):
            found |= {
                target for alias in node.names for target in _existing(root, *alias.name.split("."))
            }
        else:
            base = inside[: len(inside) + 1 - node.level] if node.level else []
            words = [*base, *(node.module.split(".") if node.module else [])]
            found |= {
                target for alias in node.names for target in _existing(root, *words, alias.name)
            }
    return found


@cache
def tree(path: Path) -> ast.Module:
    """A source file as Python reads it."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def imports(path: Path) -> list[ast.Import | ast.ImportFrom]:
    """What a source file imports, anywhere in it."""
    return [node for node in ast.walk(tree(path)) if isinstance(node, ast.Import | ast.ImportFrom)]


@cache
def _existing(root: Path, *words: str) -> tuple[Path, ...]:
    """The longest part of a dotted name that is a module or a package here."""
    for count in range(len(words), 0, -1):
        target = root.joinpath(*words[:count])
        if target.with_suffix(".py").is_file() or (target / "__init__.py").is_file():
            return (target,)
    return ()


def arrows(root: Path, place: str = "") -> tuple[set[str], Arrows]:
    """The rooms of a package ("" for the whole project) and the arrows between them."""
    home = root / place
    rooms = {
        path.relative_to(home).parts[0].removesuffix(".py")
        for path in sources(root)
        if home in path.parents
    }
    rooms.discard("__init__")
    found = set()
    for path in sources(root):
        if home not in path.parents:
            continue
        start = path.relative_to(home).parts[0].removesuffix(".py")
        for target in imported(path, root):
            if home in target.parents:
                end = target.relative_to(home).parts[0]
                if start != end and {start, end} <= rooms:
                    found.add((start, end))
    return rooms, found


def modules(root: Path) -> tuple[set[str], Arrows]:
    """All files, and the arrows between files; a package's `__init__` stands for the package."""
    names = {
        path: path.relative_to(root).with_suffix("").as_posix().removesuffix("/__init__")
        for path in sources(root)
    }
    found = set()
    for path, name in names.items():
        ends = {target.relative_to(root).as_posix() for target in imported(path, root)}
        found |= {(name, end) for end in ends if end != name}
    return set(names.values()), found


def circles(rooms: set[str], found: Arrows) -> list[set[str]]:
    """The groups of rooms from each of which every other can be reached."""
    reach = {room: {b for a, b in found if a == room} for room in rooms}
    for middle in rooms:
        for room in rooms:
            if middle in reach[room]:
                reach[room] |= reach[middle]
    groups = {
        frozenset(other for other in rooms if other in reach[room] and room in reach[other])
        for room in rooms
    }
    return [set(group) for group in groups if len(group) > 1]


def floors(rooms: set[str], found: Arrows) -> list[set[str]]:
    """The rooms by floors, top first; the rooms of a circle share a floor."""
    together = {room: group for group in circles(rooms, found) for room in group}
    height = dict.fromkeys(rooms, 0)
    for _ in rooms:
        for a, b in found:
            if b not in together.get(a, ()):
                height[a] = max(height[a], height[b] + 1)
        for group in together.values():
            height.update(dict.fromkeys(group, max(height[room] for room in group)))
    return [
        {room for room in rooms if height[room] == h} for h in range(max(height.values()), -1, -1)
    ]


def upwards(found: Arrows, declared: list[list[str]]) -> Arrows:
    """The arrows that do not lead to a lower one of the declared floors (top first)."""
    floor = {room: i for i, rooms in enumerate(declared) for room in rooms}
    return {(a, b) for a, b in found if floor[a] >= floor[b]}


def class_names(root: Path) -> dict[str, list[str]]:
    """The files of every class name that is used more than once."""
    places: dict[str, list[str]] = {}
    for path in sources(root):
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name, []).append(path.relative_to(root).as_posix())
    return {name: files for name, files in sorted(places.items()) if len(files) > 1}


def importers(root: Path) -> dict[Path, list[Path]]:
    """Return for each source file those that import it; what an `__init__` hands on counts as imported by it."""
    found: dict[Path, list[Path]] = {path: [] for path in sources(root)}
    for path in found:
        for target in imported(path, root):
            for file in (target.with_suffix(".py"), target / "__init__.py"):
                if file in found and file != path:
                    found[file].append(path)
    return found


def direct(found: Arrows) -> Arrows:
    """The arrows that do not follow from two others."""
    reach = {a: {b for start, b in found if start == a} for a, _ in found}
    for middle in reach:
        for ends in reach.values():
            if middle in ends:
                ends.update(reach[middle])
    return {
        (a, b)
        for a, b in found
        if not any(b in reach.get(c, ()) for start, c in found if start == a)
    }


class Layout:
    """Places of rooms, and of the lanes in which lines pass a floor between its boxes.

    A line from floor to floor runs in the space between them, so it never touches a box. Where it passes a floor it
    has a lane there: the arrow itself, at its place in the row.
    """

    def __init__(self, rooms: set[str], found: Arrows) -> None:
        stack = floors(rooms, found)
        floor = {room: k for k, row in enumerate(stack) for room in row}
        self.rows: list[list[Item]] = [sorted(row) for row in stack]
        self.routes: list[list[tuple[int, Item]]] = []  # of each line: floors, and its item there
        for a, b in sorted(found):
            lanes = range(floor[a] + 1, floor[b])
            for k in lanes:
                self.rows[k].append((a, b))
            self.routes.append([(floor[a], a), *((k, (a, b)) for k in lanes), (floor[b], b)])
        self._order()

    def _order(self) -> None:
        """Order each row by the middles of its neighbours, downwards and upwards in turn; keep the shortest lines."""
        best = list(self.rows)
        shortest = self._length()
        downwards = range(1, len(self.rows))
        upwards = range(len(self.rows) - 2, -1, -1)
        for _ in range(SWEEPS):
            for rows, step in ((downwards, -1), (upwards, 1)):
                for k in rows:
                    self.rows[k] = self._ordered(k, k + step)
                length = self._length()
                if length < shortest:
                    best = list(self.rows)
                    shortest = length
        self.rows = best

    def _ordered(self, k: int, other: int) -> list[Item]:
        """A row, ordered by the middle of each item's neighbours in another row; by its own if it has none there."""
        own = self.middles(k)
        beside = self.middles(other)
        neighbours: dict[Item, list[float]] = {item: [] for item in own}
        for route in self.routes:
            at = dict(route)
            if k in at and other in at:
                neighbours[at[k]].append(beside[at[other]])
        wanted = {item: fmean(near or [own[item]]) for item, near in neighbours.items()}
        return sorted(own, key=wanted.__getitem__)

    def _length(self) -> float:
        """How far all lines run sideways."""
        middles = [self.middles(k) for k in range(len(self.rows))]
        return sum(
            abs(middles[k][a] - middles[m][b])
            for route in self.routes
            for (k, a), (m, b) in pairwise(route)
        )

    def middles(self, k: int) -> dict[Item, float]:
        """The middle of each item of a row, the row in the middle of its package."""
        widths = [BOX if isinstance(item, str) else LANE for item in self.rows[k]]
        x = (WIDE - sum(widths) - GAP * (len(widths) - 1)) / 2
        middles = {}
        for item, width in zip(self.rows[k], widths, strict=True):
            middles[item] = x + width / 2
            x += width + GAP
        return middles


def drawn(root: Path, name: str, left: int) -> tuple[list[str], int]:
    """A package as elements of SVG, and how high it is: a row of boxes for each floor, a line for each direct arrow."""
    rooms, found = arrows(root, name)
    layout = Layout(rooms, direct(found))
    middles = [layout.middles(k) for k in range(len(layout.rows))]
    lines, boxes = [], []
    for route in layout.routes:
        points = []
        for k, item in route:
            x, top = left + middles[k][item], TITLE + k * FLOOR
            points += [f"{x:g},{top}", f"{x:g},{top + HIGH}"]
        # from the lower edge of the first box to the upper edge of the last
        lines.append(f'<polyline points="{" ".join(points[1:-1])}"/>')
    for k, row in enumerate(middles):
        for room in sorted(item for item in row if isinstance(item, str)):
            x, y = left + row[room], TITLE + k * FLOOR
            boxes.append(
                f'<rect x="{x - BOX / 2:g}" y="{y}" width="{BOX}" height="{HIGH}" rx="3"/>'
            )
            boxes.append(f'<text x="{x:g}" y="{y + 17}">{room}</text>')
    title = f'<text class="package" x="{left + MARGIN}" y="19">{name}</text>'
    high = TITLE + len(layout.rows) * FLOOR - FLOOR + HIGH + MARGIN
    return [title, *lines, *boxes], high


def picture(root: Path) -> str:
    """Both packages side by side as SVG: their folders by floors, and what imports what."""
    parts, high = [], 0
    for k, name in enumerate(reversed(PACKAGES)):
        left = 4 + k * (WIDE + 12)
        elements, end = drawn(root, name, left)
        parts += elements
        high = max(high, end)
    frames = [
        f'<rect class="frame" x="{4 + k * (WIDE + 12)}" y="2" width="{WIDE}" height="{high - 2}" rx="6"/>'
        for k in range(len(PACKAGES))
    ]
    label = "The folders of compare and reference; every line leads down from a folder to one that it imports"
    size = f'width="{2 * WIDE + 20}" height="{high + 4}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{label}">'
    return "\n".join([head, STYLE, *frames, *parts, "</svg>"]) + "\n"


def main(root: Path) -> None:
    """Print the figures of a checkout."""
    for place in ("", *PACKAGES):
        rooms, found = arrows(root, place)
        stack, rings = floors(rooms, found), circles(rooms, found)
        inside = sum(a in ring and b in ring for ring in rings for a, b in found)
        print(
            f"{place or 'project':10} {len(rooms):3} rooms, {len(stack):2} floors, {len(found):3} arrows, "
            f"{len(rings)} circles ({inside} arrows in them)"
        )
    files = sources(root)
    rings = circles(*modules(root))
    print(
        f"files      {len(files)}, circles of files: {len(rings)} {[sorted(ring) for ring in rings] or ''}"
    )
    repeated = class_names(root)
    print(f"class names used more than once: {len(repeated)}: {', '.join(repeated)}")
    names = Counter(path.name for path in files if path.name != "__init__.py")
    again = {f"{name} ({count})": count for name, count in sorted(names.items()) if count > 1}
    print(f"file names used more than once: {len(again)}: {', '.join(again)}")
    single = [
        path
        for path, users in importers(root).items()
        if len(users) == 1 and path.name != "__init__.py"
    ]
    print(f"files that one other file imports: {len(single)}")
    for path in single:
        print(f"  {path.relative_to(root).as_posix()}")


if __name__ == "__main__":
    if sys.argv[1:] == ["--picture"]:
        print(picture(Path.cwd()), end="")
    else:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve())
