"""TRUSTED. A dataset's files, read back as texts and compared with what was proved: inputs, times, tables, page.

So nothing that reads a scene, lays out a grid, hands on, rounds or prints has to be believed (THEOREM.md, section 9).
A row of a table is a dictionary by column: of texts (`cells`), or of what was proved (`row`): intervals, and exact
numbers.

| name          | symbol                                              | unit               |
|---------------|-----------------------------------------------------|--------------------|
| `n`, `ten`    | q = n/ten, the value of a printed number; u = 1/ten | that of the column |
| `low`, `high` | the ends of a proven interval                       | likewise           |
"""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from json import loads
from typing import Any, NamedTuple

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
GRID = "t,x,y,z,vx,vy,vz"
TRANSITS = "k,t,direction,x,y,z,vy,ax,bound"
SECTIONS = "k,t,direction,x,y,z,vx,vy,vz,bound"  # after the section's word
EXACT = ("k", "direction", "bound")  # columns whose doubles do not stand beside them
POSITION = ("x", "y", "z")
VELOCITY = ("vx", "vy", "vz")
DECIMAL = frozenset("+-.0123456789")

Row = dict[str, Any]  # of what was proved, by column
Cells = dict[str, str]  # of a table's texts, by column

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
    zeros = sorted_zeros(proved.zeros.get(XDOT, ()))
    _check_words(manifest, proved, zeros.possible)
    _check_radii(manifest["enclosure"], proved, zeros.single)

    grid = _check_grid(texts, manifest, proved)
    transits = _check_transits(texts, manifest, zeros.single)
    _check_possible(zeros.possible, manifest["possible"], proved.times[-1])
    counts = {"grid": len(grid), "transits": len(transits), "possible": len(zeros.possible)}
    demand(manifest["counts"] == counts, "misprint: the counts")

    check_sections(texts, manifest, proved)
    _check_page(texts["certified.txt"], manifest, grid, transits)


def _check_grid(texts: Mapping[str, str], manifest: Any, proved: Proved) -> list[Cells]:
    """Demand that the tables of the grid have the states that were proved; return the cells."""
    bounds = manifest["bounds"]
    demand([*bounds["grid"]] == GRID.split(",")[1:], "misprint: the bounds of the grid")
    # of a component there are two bounds: that of its column and that of its kind
    least = {name: Fraction(bound) for name, bound in bounds["grid"].items()}
    for kind, components in (("position_m", POSITION), ("velocity_m_s", VELOCITY)):
        for name in components:
            least[name] = min(least[name], Fraction(bounds[kind]))

    names = GRID.split(",")
    rows = [
        dict(zip(names, (time, *state), strict=True))
        for time, state in zip(proved.times, proved.states, strict=True)
    ]
    if proved.inputs.position:
        # of the release these are given, and known exactly
        for name, q in zip(RELEASES["position"], proved.inputs.position, strict=True):
            rows[0][name] = Interval(q, q)
    cells = check_rows(texts["grid.csv"], GRID, rows, least, manifest["decimals"]["grid"])
    _check_doubles(texts.get("grid.binary64.csv"), GRID, rows, cells)
    return cells


def _check_transits(texts: Mapping[str, str], manifest: Any, zeros: Sequence[Any]) -> list[Cells]:
    """Demand that the tables of transits have the single zeros that were proved; return the cells."""
    bounds = manifest["bounds"]
    least = {name: Fraction(bound) for name, bound in bounds["transits"].items()}
    rows = _zero_rows(zeros, TRANSITS)
    table = texts.get("transits.csv", f"{TRANSITS}\n")
    cells = check_rows(table, TRANSITS, rows, least, manifest["decimals"].get("transits", {}))
    _check_doubles(texts.get("transits.binary64.csv"), TRANSITS, rows, cells)
    demand(
        bounds["transit_s"] == bounds["transits"].get("t"),
        "misprint: the largest bound of the transits",
    )
    return cells


def check_sections(texts: Mapping[str, str], manifest: Any, proved: Proved) -> None:
    """Demand that sections.csv and the manifest state the passages that were proved, of just these sections."""
    sections = {word: zeros for word, zeros in proved.zeros.items() if word != XDOT}
    words = [*sections]
    stated = manifest.get("sections")
    demand((stated is not None) == bool(words), "misprint: other sections")
    if stated is None:
        return
    right = "; ".join(words) == manifest["scene"]["run"]["sections"]
    demand(
        right and [*stated["counts"]] == [*stated["possible"]] == words, "misprint: other sections"
    )

    rows = list[Row]()
    words_of_rows = list[str]()
    for word, zeros in sections.items():
        of_word = sorted_zeros(zeros)
        rows += _zero_rows(of_word.single, SECTIONS)
        words_of_rows += [word] * len(of_word.single)
        _check_possible(of_word.possible, stated["possible"][word], proved.times[-1])
        demand(stated["counts"][word] == len(of_word.single), "misprint: the count of passages")

    header, *lines = lines_of(texts["sections.csv"])
    demand(
        [line[0] for line in lines] == words_of_rows and header[0] == "section",
        "misprint: other sections",
    )
    least = {name: Fraction(bound) for name, bound in stated["bounds"].items()}
    check_rows(without_words(header, lines), SECTIONS, rows, least, stated["decimals"])


def without_words(header: list[str], lines: list[list[str]]) -> str:
    """Return the text of a table of passages without its first column, that of the words."""
    return "".join(",".join(line[1:]) + "\n" for line in (header, *lines))


def document(text: str) -> Any:
    """Return what a JSON text says; a name that stands twice in one object would hide what is said first."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        demand(len(dict(pairs)) == len(pairs), "misprint: a name twice")
        return dict(pairs)

    return loads(text, object_pairs_hook=unique)


class SortedZeros(NamedTuple):
    """Zeros that are proved to be single, and possible ones, both in order."""

    single: list[Any]
    possible: list[Any]


def sorted_zeros(zeros: Iterable[Any]) -> SortedZeros:
    """Return the single zeros and the possible ones."""
    result = SortedZeros([], [])
    for zero in zeros:
        kind = result.single if zero.parity == "one" else result.possible
        kind.append(zero)
    return result


def _zero_rows(zeros: Sequence[Any], header: str) -> list[Row]:
    """Return the rows of a table of zeros, numbered from 1; the bound of a row is not proved, but compared."""
    names = [name for name in header.split(",") if name not in ("k", "bound")]
    return [
        {"k": k} | {name: getattr(zero, name) for name in names} for k, zero in enumerate(zeros, 1)
    ]


def _check_words(manifest: Any, proved: Proved, possible: Sequence[Any]) -> None:
    """Demand that level, units, frame and the word on transits are those of what was proved."""
    run = manifest["scene"]["run"]
    frame = FRAME.format(UP[proved.inputs.gravity_is])
    demand(manifest["level"] == run["level"] == "enclosed", "misprint: the level")
    demand(
        manifest["units"] == UNITS and manifest["frame"] == frame,
        "misprint: the units or the frame",
    )

    if run["transits"] == "false":
        word = "not asked for"
    elif proved.still:
        word = "xdot is identically zero"
    else:
        word = "undecided intervals" if possible else "complete"
    sought = word in ("undecided intervals", "complete")
    right = manifest["transits"] == word and sought == (XDOT in proved.zeros)
    demand(right, "misprint: whether all transits are there")


def _check_radii(stated: Any, proved: Proved, single: Sequence[Any]) -> None:
    """Demand that no interval is wider than the radii that are told of the proof."""
    positions = [x for state in proved.states for x in state[:3]]
    velocities = [x for state in proved.states for x in state[3:6]]
    kinds = {
        "position_radius_m": positions,
        "velocity_radius_m_s": velocities,
        "transit_radius_s": [zero.t for zero in single],
    }
    for name, intervals in kinds.items():
        widest = max((x.high - x.low for x in intervals), default=None)
        demand((stated[name] is None) == (widest is None), f"misprint: {name}")
        demand(widest is None or 2 * Fraction(stated[name]) >= widest, f"misprint: {name}")  # (9.5)


def _check_possible(possible: Sequence[Any], stated: Sequence[Any], end: Fraction) -> None:
    """Demand that each zero that may be there lies in its interval, up to the end, and has its parity."""
    for zero, part in zip(possible, stated, strict=True):
        low = max(zero.t.low, Fraction(0))
        high = min(zero.t.high, end)
        inside = Fraction(part["from_s"]) <= low and high <= Fraction(part["to_s"])  # (9.4)
        demand(inside and part["parity"] == zero.parity, "misprint: a possible zero")


def asked(manifest: Any) -> tuple[Inputs, tuple[Fraction, ...]]:
    """Return the inputs of a manifest's scene, each a decimal or the double nearest to it, and the times to t_end."""
    scene = manifest["scene"]
    kind = "angles" if "angle" in scene["release"] else "position"
    given = {name: text for part in scene.values() for name, text in part.items()}
    demand(
        len(given) == sum(map(len, scene.values())),
        "misprint: an input in two parts of the scene",
    )
    # rates that are not given are 0
    rates = RELEASES[kind][2:]
    texts = dict.fromkeys(rates, "0") | given
    read: Any = {"decimal": str, "binary64": float}[manifest["inputs"]]

    def exact(name: str) -> Fraction:
        """Return a number, and take it off the texts."""
        return Fraction(read(texts.pop(name)))

    numbers: dict[str, Any] = {name: exact(name) for name in PLAIN.split()}
    numbers |= {"position": None, "angles": None, kind: tuple(map(exact, RELEASES[kind]))}
    numbers["gravity_is"] = texts.pop("gravity_is")
    flat = texts["inverse_flattening"] == "inf"
    numbers["flattening"] = Fraction(0) if flat else 1 / exact("inverse_flattening")
    demand(texts.keys() <= {*OTHERS, "inverse_flattening"}, "misprint: unknown inputs")
    inputs = Inputs(**numbers)
    return inputs, _times_of(inputs)


def _times_of(inputs: Inputs) -> tuple[Fraction, ...]:
    """Return the times of the grid: the multiples of its step below t_end, and t_end."""
    count = inputs.t_end // inputs.grid_step + 1
    last = (count - 1) * inputs.grid_step
    # doubles may miss t_end by their rounding alone
    rounding = inputs.grid_step / (1 << 30)
    if last > 0 and last > inputs.t_end - rounding:
        count -= 1
    return (*(k * inputs.grid_step for k in range(count)), inputs.t_end)


def lines_of(text: str) -> list[list[str]]:
    """Return the cells of a table, line by line; each line ends in a line feed alone."""
    *lines, after_the_last = text.split("\n")
    demand(not after_the_last, "misprint: a table without an end")
    return [line.split(",") for line in lines]


def check_rows(
    text: str,
    header: str,
    rows: Sequence[Row],
    bounds: Mapping[str, Fraction],
    decimals: Mapping[str, int],
) -> list[Cells]:
    """Demand that a table has these rows, with so many decimals, and bounds no less than their rounding.

    What is known as an interval needs a bound, of its column; a time needs that of its row as well. Returns the cells.
    """
    names, *lines = lines_of(text)
    demand(names == header.split(","), f"misprint: the header {names}")
    table = [dict(zip(names, line, strict=True)) for line in lines]
    for cells, row in zip(table, rows, strict=True):
        for name, x in row.items():
            _check_number(cells[name], x)
            places = len(cells[name].partition(".")[2])
            demand(places == decimals.get(name, 0), f"misprint: the decimals of {name}")
            if isinstance(x, Interval):
                bound = bounds[name]
                if name == "t":
                    bound = min(bound, Fraction(cells["bound"]))
                demand(2 * 10**places * bound >= 1, f"misprint: the bound on {name}")  # (9.2)
    return table


def _check_number(text: str, x: Any) -> None:
    """Demand that a decimal is exact, or nearest to all of an interval."""
    before, _, after = text.partition(".")
    n = int(before + after)
    ten = 10 ** len(after)
    # (9.1): |q − n/ten| <= u/2 with u = 1/ten at both ends, or 0 of an exact number, in integers
    ends = (x.low, x.high) if isinstance(x, Interval) else (x,)
    slack = 1 if isinstance(x, Interval) else 0
    near = all(
        2 * abs(n * q.denominator - q.numerator * ten) <= slack * q.denominator for q in ends
    )
    demand(near and set(text) <= DECIMAL, f"misprint: {text}")


def _check_doubles(
    text: str | None, header: str, rows: Sequence[Row], cells: Sequence[Cells]
) -> None:
    """Demand that a table of doubles, if it is there, has the doubles nearest to what was proved, also as hexfloats.

    Of an interval that is the double of some number in it, or of the decimal where that is 0.
    """
    if text is None:
        return
    names = header.split(",")
    numbers = [name for name in names if name not in EXACT]
    columns, *lines = lines_of(text)
    demand(
        columns == [*names, *(f"{name}_hex" for name in numbers)],
        f"misprint: the header {columns}",
    )
    for line, row, texts in zip(lines, rows, cells, strict=True):
        doubles = dict(zip(columns, line, strict=True))
        for name, decimal in texts.items():
            if name in numbers:
                _check_double(doubles[name], doubles[f"{name}_hex"], decimal, row[name])
            else:
                demand(doubles[name] == decimal, f"misprint: {doubles[name]} beside the doubles")


def _check_double(text: str, hexfloat: str, decimal: str, x: Any) -> None:
    """Demand that a double is that of a number in an interval, or of an exact number, or 0 where its decimal is."""
    low, high = (x.low, x.high) if isinstance(x, Interval) else (x, x)
    double = float(text)
    near = float(low) <= double <= float(high)  # (9.3)
    zero = double == float(decimal) == 0
    demand(
        (near or zero) and hexfloat == double.hex(),
        f"misprint: {text} is not the double of {decimal}",
    )


def _check_page(page: str, manifest: Any, grid: Sequence[Cells], transits: Sequence[Cells]) -> None:
    """Demand that the page has level and inputs, and then the numbers of the other files, line by line."""
    # what stands before the inputs are words of the scene as well
    words, _, numbers = page.rpartition(INPUTS)
    head = words.split("\n")
    demand(
        LEVEL in head and f"Inputs are read as: {manifest['inputs']}" in head,
        "misprint: certified.txt",
    )
    stated = [line.split() for line in numbers.split("\n")]
    expected = [line.split() for line in _page_lines(manifest, grid, transits)]
    for words_stated, words_expected in zip(stated, expected, strict=True):
        demand(words_stated == words_expected, f"misprint: certified.txt: {' '.join(words_stated)}")


def _page_lines(manifest: Any, grid: Sequence[Cells], transits: Sequence[Cells]) -> list[str]:
    """Return the lines of the page from the inputs on, but for the spaces in them."""
    scene = manifest["scene"]
    lines = [
        f"{part}.{name} {text}" for part, table in scene.items() for name, text in table.items()
    ]
    lines += (MODEL + GRAVITY[scene["site"]["gravity_is"]]).split("\n")
    lines += _lines_of_state("State", grid[0])
    lines += _lines_of_state("Certified state", grid[-1])

    bounds = manifest["bounds"]
    words = "Bound on every position {position_m} m, on every velocity {velocity_m_s} m/s"
    columns = ", ".join(f"{name} {bound}" for name, bound in bounds["grid"].items())
    lines += ["", words.format(**bounds), f"by column: {columns}", ""]

    lines.append(f"Transits (xdot = 0, t > 0): {len(transits)} ({manifest['transits']})")
    if transits:
        lines.append(_line_of_transit("first", transits[0]))
        lines.append(_line_of_transit("last", transits[-1]))
        lines.append(f"largest bound on a time {bounds['transit_s']} s")
        if all(run["transit_s"] is None for run in manifest["cross_checks"]):
            lines.append("the proof alone confirms them")
    undecided = "possible transit in [{from_s}, {to_s}] s ({parity} number of zeros): not decided"
    lines += [undecided.format(**part) for part in manifest["possible"]]

    lines += f"{SCORE}{manifest['inputs']}.".split("\n")
    if "sections" in manifest:
        for word, count in manifest["sections"]["counts"].items():
            lines.append(f"Passages in sections.csv: {count} of {word}")
    return [*lines, ""]


def _lines_of_state(word: str, cells: Cells) -> list[str]:
    """Return the lines of the page on a state."""
    numbers = [f"{name} {text}" for name, text in cells.items() if name != "t"]
    return ["", f"{word} at t = {cells['t']} s", *numbers]


def _line_of_transit(word: str, cells: Cells) -> str:
    """Return the line of the page on a transit."""
    return f"{word} t = {cells['t']} s, direction {cells['direction']}, bound {cells['bound']} s"
