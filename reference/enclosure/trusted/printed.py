"""TRUSTED. A dataset's files, read back as texts and held against what was proved: inputs, times, tables, page.

So nothing that reads a scene, lays out a grid, hands on, rounds or prints has to be believed (THEOREM.md, section 9).
"""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from json import loads
from typing import Any

from ...scenes.inputs import Inputs
from .balls import demand
from .course import FINISHED
from .shapes import XDOT, Interval, Proved

PLAIN = "length drag latitude altitude gravity rotation_rate equatorial_radius t_end grid_step"
RELEASES = {
    "position": ("x", "y", "vx", "vy"),
    "angles": ("angle", "azimuth", "angle_rate", "azimuth_rate"),
}
OTHERS = ("digits", "level", "transits", "sections")  # no input of the motion
GRID, TRANSITS = "t,x,y,z,vx,vy,vz", "k,t,direction,x,y,z,vy,ax,bound"
SECTIONS = "k,t,direction,x,y,z,vx,vy,vz,bound"  # after the section's word
EXACT = ("k", "direction", "bound")  # columns whose doubles do not stand beside them
POSITION, VELOCITY = ("x", "y", "z"), ("vx", "vy", "vz")
DECIMAL = frozenset("+-.0123456789")

UNITS = {
    "t": "s",
    "x, y, z": "m",
    "vx, vy, vz": "m/s",
    "ax": "m/s^2",
    "bound": "s",
    "angles": "degrees",
}
UP = {"ellipsoid": "z up", "effective": "z up along the plumb line"}
FRAME = "topocentric, axes x east, y north, {}, origin at the suspension, z < 0 below it"

# the sentences of certified.txt, for what is checked of it
LEVEL = "Level: enclosed. A proof encloses every printed digit (interval arithmetic, rounding included)."
INPUTS = "\nInputs (SI units, angles in degrees)\n"
MODEL = """
Model: full Lagrangian of the Foucault pendulum (Mathar), axes x east, y north, z up, origin at the
suspension; """
GRAVITY = {
    "ellipsoid": "gravity g points along the ellipsoid's normal, the centrifugal force is explicit.",
    "effective": "gravity g is effective: it points along the plumb line and contains the centrifugal force there.",
}
SCORE = """
How to score: compare your t, x, y, z with grid.csv; grid.binary64.csv holds the nearest doubles,
also as hexfloats. A program that reads its inputs as doubles solves the problem whose inputs are
read as binary64; this dataset reads them as """


def check_dataset(texts: Mapping[str, str], proved: Any) -> None:
    """Demand that manifest.json, the tables and certified.txt state what was proved, of just these inputs."""
    manifest = document(texts["manifest.json"])
    demand(
        proved in FINISHED and asked(manifest) == (proved.inputs, proved.times),
        "the proof is of other inputs",
    )
    ones, others = single_and_other(proved.zeros.get(XDOT, ()))
    check_words(manifest, proved, others)
    check_radii(manifest["enclosure"], proved, ones)

    bounds, decimals = manifest["bounds"], manifest["decimals"]
    demand([*bounds["grid"]] == GRID.split(",")[1:], "misprint: the bounds of the grid")
    least = {name: Fraction(bound) for name, bound in bounds["grid"].items()}
    least |= {name: min(least[name], Fraction(bounds["position_m"])) for name in POSITION}
    least |= {name: min(least[name], Fraction(bounds["velocity_m_s"])) for name in VELOCITY}
    states = [[t, *state] for t, state in zip(proved.times, proved.states, strict=True)]
    if proved.inputs.position:
        # of the release these are given, and known exactly
        x, y, vx, vy = (Interval(q, q) for q in proved.inputs.position)
        states[0][1:6] = [x, y, states[0][3], vx, vy]
    grid = check_rows(texts["grid.csv"], GRID, states, least, decimals["grid"])
    check_doubles(texts.get("grid.binary64.csv"), GRID, states, grid)

    least = {name: Fraction(bound) for name, bound in bounds["transits"].items()}
    zeros = [[k, z.t, z.direction, z.x, z.y, z.z, z.vy, z.ax] for k, z in enumerate(ones, 1)]
    table = texts.get("transits.csv", f"{TRANSITS}\n")
    transits = check_rows(table, TRANSITS, zeros, least, decimals.get("transits", {}))
    check_doubles(texts.get("transits.binary64.csv"), TRANSITS, zeros, transits)
    demand(
        bounds["transit_s"] == bounds["transits"].get("t"),
        "misprint: the largest bound of the transits",
    )

    check_possible(others, manifest["possible"], proved.times[-1])
    counts = {"grid": len(grid), "transits": len(transits), "possible": len(others)}
    demand(manifest["counts"] == counts, "misprint: the counts")
    check_sections(texts, manifest, proved)
    check_page(texts["certified.txt"], manifest, grid, transits)


def check_sections(texts: Mapping[str, str], manifest: Any, proved: Proved) -> None:
    """Demand that sections.csv and the manifest state the passages that were proved, of just these sections."""
    sections = {word: zeros for word, zeros in proved.zeros.items() if word != XDOT}
    said, words = manifest.get("sections"), [*sections]
    demand((said is not None) == bool(words), "misprint: other sections")
    if said is None:
        return
    right = "; ".join(words) == manifest["scene"]["run"]["sections"]
    demand(right and [*said["counts"]] == [*said["possible"]] == words, "misprint: other sections")

    rows, names = list[Any](), list[str]()
    for word, zeros in sections.items():
        ones, others = single_and_other(zeros)
        rows += [
            [k, z.t, z.direction, z.x, z.y, z.z, z.vx, z.vy, z.vz] for k, z in enumerate(ones, 1)
        ]
        names += [word] * len(ones)
        check_possible(others, said["possible"][word], proved.times[-1])
        demand(said["counts"][word] == len(ones), "misprint: the count of passages")

    header, *lines = lines_of(texts["sections.csv"])
    demand(
        [line[0] for line in lines] == names and header[0] == "section", "misprint: other sections"
    )
    text = "".join(",".join(line[1:]) + "\n" for line in (header, *lines))
    least = {name: Fraction(bound) for name, bound in said["bounds"].items()}
    check_rows(text, SECTIONS, rows, least, said["decimals"])


def document(text: str) -> Any:
    """Return what a JSON text says; a name that stands twice in one object would hide what is said first."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        demand(len(dict(pairs)) == len(pairs), "misprint: a name twice")
        return dict(pairs)

    return loads(text, object_pairs_hook=unique)


def single_and_other(found: Iterable[Any]) -> tuple[list[Any], list[Any]]:
    """Return the zeros that are proved to be single, and the possible ones."""
    ones, others = ([z for z in found if (z.parity == "one") is single] for single in (True, False))
    return ones, others


def check_words(manifest: Any, proved: Proved, others: Sequence[Any]) -> None:
    """Demand that level, units, frame and the word on transits are those of what was proved."""
    run, up = manifest["scene"]["run"], UP[proved.inputs.gravity_is]
    demand(manifest["level"] == run["level"] == "enclosed", "misprint: the level")
    demand(
        manifest["units"] == UNITS and manifest["frame"] == FRAME.format(up),
        "misprint: the units or the frame",
    )
    if run["transits"] == "false":
        word = "not asked for"
    elif proved.still:
        word = "xdot is identically zero"
    else:
        word = "undecided intervals" if others else "complete"
    sought = word in ("undecided intervals", "complete")
    right = manifest["transits"] == word and sought == (XDOT in proved.zeros)
    demand(right, "misprint: whether all transits are there")


def check_radii(said: Any, proved: Proved, ones: Sequence[Any]) -> None:
    """Demand that no interval is wider than the radii that are told of the proof."""
    positions = [x for state in proved.states for x in state[:3]]
    velocities = [x for state in proved.states for x in state[3:6]]
    kinds = {
        "position_radius_m": positions,
        "velocity_radius_m_s": velocities,
        "transit_radius_s": [z.t for z in ones],
    }
    for name, intervals in kinds.items():
        widest = max((x.high - x.low for x in intervals), default=None)
        demand((said[name] is None) == (widest is None), f"misprint: {name}")
        demand(widest is None or 2 * Fraction(said[name]) >= widest, f"misprint: {name}")


def check_possible(others: Sequence[Any], said: Sequence[Any], end: Fraction) -> None:
    """Demand that each zero that may be there lies in its interval, up to the end, and has its parity."""
    for z, part in zip(others, said, strict=True):
        low, high = max(z.t.low, Fraction(0)), min(z.t.high, end)
        inside = Fraction(part["from_s"]) <= low and high <= Fraction(part["to_s"])
        demand(inside and part["parity"] == z.parity, "misprint: a possible zero")


def asked(said: Any) -> tuple[Inputs, tuple[Fraction, ...]]:
    """Return the inputs of a manifest's scene, each a decimal or the double nearest to it, and the times to t_end."""
    kind = "angles" if "angle" in said["scene"]["release"] else "position"
    given = {name: text for part in said["scene"].values() for name, text in part.items()}
    demand(
        len(given) == sum(map(len, said["scene"].values())),
        "misprint: an input in two parts of the scene",
    )
    # rates that are not given are 0
    texts = dict.fromkeys(RELEASES[kind][2:], "0") | given

    def exact(name: str) -> Fraction:
        return Fraction({"decimal": str, "binary64": float}[said["inputs"]](texts.pop(name)))

    numbers: dict[str, Any] = {"position": None, "angles": None} | {
        name: exact(name) for name in PLAIN.split()
    }
    numbers |= {kind: tuple(map(exact, RELEASES[kind])), "gravity_is": texts.pop("gravity_is")}
    flat = texts["inverse_flattening"] == "inf"
    inputs = Inputs(**numbers, flattening=Fraction(0) if flat else 1 / exact("inverse_flattening"))
    demand(texts.keys() <= {*OTHERS, "inverse_flattening"}, "misprint: unknown inputs")
    count = inputs.t_end // inputs.grid_step + 1
    # doubles may miss t_end by their rounding alone
    count -= 0 < (count - 1) * inputs.grid_step > inputs.t_end - inputs.grid_step / (1 << 30)
    return inputs, (*(k * inputs.grid_step for k in range(count)), inputs.t_end)


def lines_of(text: str) -> list[list[str]]:
    """Return the cells of a table, line by line; each line ends in a line feed alone."""
    *lines, rest = text.split("\n")
    demand(not rest, "misprint: a table without an end")
    return [line.split(",") for line in lines]


def check_rows(
    text: str,
    header: str,
    rows: Sequence[Any],
    bounds: Mapping[str, Fraction],
    decimals: Mapping[str, int],
) -> list[list[str]]:
    """Demand that a table has these rows, with so many decimals, and bounds no less than their rounding.

    What is known as an interval needs a bound, of its column; a time needs that of its row as well. Returns the cells.
    """
    names, *cells = lines_of(text)
    demand(names == header.split(","), f"misprint: the header {names}")
    for texts, row in zip(cells, rows, strict=True):
        said = dict(zip(names, texts, strict=True))
        for name, x in zip(names, row, strict=False):
            check(said[name], x)
            places = len(said[name].partition(".")[2])
            demand(places == decimals.get(name, 0), f"misprint: the decimals of {name}")
            if isinstance(x, Interval):
                # of a transit's time there are two
                least = [bounds[name], *([Fraction(said["bound"])] if name == "t" else [])]
                demand(2 * 10**places * min(least) >= 1, f"misprint: the bound on {name}")
    return cells


def check(number: str, x: Any) -> None:
    """Demand that a decimal is exact, or nearest to all of an interval."""
    whole, _, part = number.partition(".")
    n, ten = int(whole + part), 10 ** len(part)
    ends = [x.low, x.high] if isinstance(x, Interval) else [x]
    slack = len(ends) - 1
    # |n/ten - q| <= slack/(2 ten), in integers
    near = [2 * abs(n * q.denominator - q.numerator * ten) <= slack * q.denominator for q in ends]
    demand(all(near) and set(number) <= DECIMAL, f"misprint: {number}")


def check_doubles(
    text: str | None, header: str, rows: Sequence[Any], cells: Sequence[list[str]]
) -> None:
    """Demand that a table of doubles, if it is there, has the doubles nearest to what was proved, also as hexfloats.

    Of an interval that is the double of some number in it, or of the decimal where that is 0.
    """
    if text is None:
        return
    names = header.split(",")
    numbers = [name for name in names if name not in EXACT]
    first, *lines = lines_of(text)
    demand(first == [*names, *(f"{name}_hex" for name in numbers)], f"misprint: the header {first}")
    for line, row, texts in zip(lines, rows, cells, strict=True):
        said = dict(zip(first, line, strict=True))
        values = dict(zip(names, row, strict=False))
        for name, text in zip(names, texts, strict=True):
            if name not in numbers:
                demand(said[name] == text, f"misprint: {said[name]} beside the doubles")
                continue
            x, double = values[name], float(said[name])
            ends = (
                (float(x.low), float(x.high)) if isinstance(x, Interval) else (float(x), float(x))
            )
            near = ends[0] <= double <= ends[1] or double == float(text) == 0
            demand(
                near and said[f"{name}_hex"] == double.hex(),
                f"misprint: {said[name]} is not the double of {text}",
            )


def check_page(page: str, manifest: Any, grid: Any, transits: Any) -> None:
    """Demand that the page has level and inputs, and then the numbers of the other files, line by line."""
    # what stands before the inputs are words of the scene as well
    words, _, rest = page.rpartition(INPUTS)
    head = words.split("\n")
    demand(
        LEVEL in head and f"Inputs are read as: {manifest['inputs']}" in head,
        "misprint: certified.txt",
    )
    said = [line.split() for line in rest.split("\n")]
    expected = [line.split() for line in page_lines(manifest, grid, transits)]
    for words_said, words_expected in zip(said, expected, strict=True):
        demand(words_said == words_expected, f"misprint: certified.txt: {' '.join(words_said)}")


def page_lines(manifest: Any, grid: Any, transits: Any) -> list[str]:
    """Return the lines of the page from the inputs on, but for the spaces in them."""
    bounds, scene = manifest["bounds"], manifest["scene"]
    lines = [
        f"{part}.{name} {text}" for part, table in scene.items() for name, text in table.items()
    ]
    lines += (MODEL + GRAVITY[scene["site"]["gravity_is"]]).split("\n")
    for word, row in (("State", grid[0]), ("Certified state", grid[-1])):
        lines += ["", f"{word} at t = {row[0]} s"]
        lines += [f"{name} {text}" for name, text in zip(GRID.split(",")[1:], row[1:], strict=True)]
    lines += [
        "",
        "Bound on every position {position_m} m, on every velocity {velocity_m_s} m/s".format(
            **bounds
        ),
    ]
    lines += [
        "by column: " + ", ".join(f"{name} {bound}" for name, bound in bounds["grid"].items()),
        "",
    ]
    lines += [f"Transits (xdot = 0, t > 0): {len(transits)} ({manifest['transits']})"]
    for word, row in zip(("first", "last"), transits[:1] + transits[-1:], strict=False):
        lines += [f"{word} t = {row[1]} s, direction {row[2]}, bound {row[-1]} s"]
    if transits:
        lines += [f"largest bound on a time {bounds['transit_s']} s"]
        alone = all(run["transit_s"] is None for run in manifest["cross_checks"])
        lines += ["the proof alone confirms them"] if alone else []
    text = "possible transit in [{from_s}, {to_s}] s ({parity} number of zeros): not decided"
    lines += [text.format(**part) for part in manifest["possible"]]
    lines += f"{SCORE}{manifest['inputs']}.".split("\n")
    counts = manifest["sections"]["counts"] if "sections" in manifest else {}
    return [
        *lines,
        *(f"Passages in sections.csv: {count} of {word}" for word, count in counts.items()),
        "",
    ]
