"""TRUSTED. A dataset's files, read back as texts and held against what was proved: inputs, times, tables, page.

So nothing that reads a scene, lays out a grid, hands on, rounds or prints has to be believed (THEOREM.md, section 9).
"""

from collections.abc import Iterable, Mapping
from fractions import Fraction
from json import loads
from typing import Any

from ..scenes.inputs import Inputs
from .balls import demand
from .course import FINISHED
from .shapes import Interval

PLAIN = "length drag latitude altitude gravity rotation_rate equatorial_radius t_end grid_step"
RELEASES = {"position": ("x", "y", "vx", "vy"), "angles": ("angle", "azimuth", "angle_rate", "azimuth_rate")}
GRID, TRANSITS = "t,x,y,z,vx,vy,vz", "k,t,direction,x,y,z,vy,ax,bound"
OTHERS = ("digits", "level", "transits", "sections")  # of these nothing follows here; `sections` checks its own
DECIMAL, APART = frozenset("+-.0123456789"), str.maketrans(",:[]()", " " * 6)


def check_dataset(texts: Mapping[str, str], proved: Any) -> None:
    """Demand that manifest.json, both tables and certified.txt state what was proved, and of just these inputs."""
    manifest = loads(texts["manifest.json"])
    bounds, found, end = manifest["bounds"], proved.transits or (), proved.times[-1]
    demand(proved in FINISHED and asked(manifest) == (proved.inputs, proved.times), "the proof is of other inputs")
    kinds = dict.fromkeys(("x", "y", "z"), "position_m") | dict.fromkeys(("vx", "vy", "vz"), "velocity_m_s")
    least = {name: min(Fraction(x), Fraction(bounds.get(kinds.get(name), x))) for name, x in bounds["grid"].items()}
    states = ([t, *state] for t, state in zip(proved.times, proved.states, strict=True))
    grid = check_rows(texts["grid.csv"], GRID, states, least)
    ones, others = ([z for z in found if (z.parity == "one") is single] for single in (True, False))
    zeros = ([k, z.t, z.direction, z.x, z.y, z.z, z.vy, z.ax] for k, z in enumerate(ones, 1))
    least = {name: Fraction(x) for name, x in bounds["transits"].items()}
    transits = check_rows(texts.get("transits.csv", TRANSITS), TRANSITS, zeros, least)
    for z, said in zip(others, manifest["possible"], strict=True):
        inside = Fraction(said["from_s"]) <= max(z.t.low, Fraction(0)) and min(z.t.high, end) <= Fraction(said["to_s"])
        demand(inside and said["parity"] == z.parity, "misprint: a possible transit")
    word = "not asked for" if proved.transits is None else "undecided intervals" if others else "complete"
    words = ("not asked for", "xdot is identically zero" if proved.still else word)
    right = manifest["counts"] == {"grid": len(grid), "transits": len(ones), "possible": len(others)}
    right &= bounds["transit_s"] == bounds["transits"].get("t") and manifest["transits"] in words
    demand(right, "misprint: the number of transits, or their largest bound")
    check_page(texts["certified.txt"], manifest, grid, transits)


def asked(said: Any) -> tuple[Inputs, tuple[Fraction, ...]]:
    """Return the inputs of a manifest's scene, each a decimal or the double nearest to it, and the times to t_end."""
    kind = "angles" if "angle" in said["scene"]["release"] else "position"
    # rates that are not given are 0
    texts = dict.fromkeys(RELEASES[kind][2:], "0") | {k: x for part in said["scene"].values() for k, x in part.items()}

    def exact(name: str) -> Fraction:
        return Fraction({"decimal": str, "binary64": float}[said["inputs"]](texts.pop(name)))

    numbers: dict[str, Any] = {"position": None, "angles": None} | {name: exact(name) for name in PLAIN.split()}
    numbers |= {kind: tuple(map(exact, RELEASES[kind])), "gravity_is": texts.pop("gravity_is")}
    flat = texts["inverse_flattening"] == "inf"
    inputs = Inputs(**numbers, flattening=Fraction(0) if flat else 1 / exact("inverse_flattening"))
    demand(texts.keys() <= {*OTHERS, "inverse_flattening"}, "misprint: unknown inputs")
    count = inputs.t_end // inputs.grid_step + 1
    # doubles may miss t_end by their rounding alone
    count -= 0 < (count - 1) * inputs.grid_step > inputs.t_end - inputs.grid_step / (1 << 30)
    return inputs, (*(k * inputs.grid_step for k in range(count)), inputs.t_end)


def check_rows(text: str, header: str, rows: Iterable[Any], bounds: dict[str, Fraction]) -> list[list[str]]:
    """Demand that a table has these rows, its bounds no less than their rounding; return its cells."""
    names, *cells = (line.split(",") for line in text.splitlines())
    demand(names == header.split(","), f"misprint: the header {names}")
    for texts, row in zip(cells, rows, strict=True):
        said = dict(zip(names, texts, strict=True))
        of_row = bounds | {"t": min(bounds["t"], Fraction(said["bound"]))} if "bound" in said else bounds
        for name, x in zip(names, row, strict=False):
            check(said[name], x, of_row.get(name, Fraction(1)))
    return cells


def check(number: str, x: Any, most: Fraction) -> None:
    """Demand that a decimal is exact, or nearest to all of an interval and its bound half a unit of the last digit."""
    whole, _, part = number.partition(".")
    n, ten, ends = int(whole + part), 10 ** len(part), (x.low, x.high) if isinstance(x, Interval) else (x,)
    off = max(2 * abs(n * q.denominator - q.numerator * ten) - (len(ends) - 1) * q.denominator for q in ends)
    demand(off <= 0 and 2 * ten * most.numerator >= most.denominator and set(number) <= DECIMAL, f"misprint: {number}")


def check_page(page: str, manifest: Any, grid: Any, transits: Any) -> None:
    """Demand that the page has the inputs, and then the numbers of the other files, a row's after their names."""
    names, bounds, scene = GRID.split(","), manifest["bounds"], manifest["scene"].items()
    inputs = [f"{part}.{name} {text}" for part, table in scene for name, text in table.items()]
    numbers = [f"{name} {text}" for row in (grid[0], grid[-1]) for name, text in zip(names, row, strict=True)]
    numbers += ["{position_m} {velocity_m_s}".format(**bounds), *map(" ".join, bounds["grid"].items())]
    numbers += [f"0 t 0 {len(transits)}", *(f"t {row[1]} {row[2]} {row[-1]}" for row in transits[:1] + transits[-1:])]
    numbers += [bounds["transit_s"] or "", *("{from_s} {to_s}".format(**said) for said in manifest["possible"])]
    for begin, end, expected in (("degrees)\n  ", "\n\nModel", inputs), ("\n\nState", "\n\nHow", numbers)):
        words = page[page.index(begin) + len(begin) : page.index(end)].translate(APART).split()
        said = [word for word in words if expected is inputs or word in names or not DECIMAL.isdisjoint(word[-1])]
        demand(said == " ".join(expected).split(), f"misprint: certified.txt, before {end.strip()}")
    demand(f"as: {manifest['inputs']}\n" in page and f"({manifest['transits']})\n" in page, "misprint: certified.txt")
