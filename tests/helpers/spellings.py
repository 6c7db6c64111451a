"""One right trajectory as people and programs write it: texts that are read as it, or refused with a reason.

`compare/candidates` (Python) and `compare/report/atlas/reading.js` (the pages) have to read them alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

Row = tuple[str, ...]

# the first second of Paris, released at x = 1, y = 0: the first row has no fraction, as in most programs' files
WHOLE: list[Row] = [
    ("0", "1", "0"),
    ("1", "0.92781858233398218", "-0.0083138723744387508"),
    ("2", "0.72168780220333673", "-0.032045172890405919"),
    ("3", "0.41135417882253916", "-0.067754180787023929"),
    ("4", "0.041617309360027381", "-0.11027495675275245"),
]
# the same pendulum, released at x = 0.3, y = 0.4, every half of a second
HALVES: list[Row] = [
    ("0", "0.29999999999999999", "0.40000000000000002"),
    ("0.5", "0.29447421549", "0.3905"),
    ("1", "0.2783428583515522", "0.36280989698191063"),
    ("1.5", "0.25228", "0.3184"),
    ("2", "0.21649238765172449", "0.25661102753773291"),
]
NAMES = ("t", "x", "y")


@dataclass(frozen=True)
class Spelling:
    """A text, and what has to be read from it.

    Attributes:
        data: its bytes.
        columns: the numbers, rounded once from the exact ones; None where the text has to be refused.
        reason: words of the refusal.
        alone: whether it is a list of transits.
    """

    data: bytes
    columns: dict[str, list[float]] | None
    reason: str = ""
    alone: bool = False

    @property
    def text(self) -> str:
        """What a browser makes of its bytes."""
        return self.data.decode("utf-8", "replace")


def numbers(
    rows: Sequence[Row], factors: Sequence[Fraction | int] = (1, 1, 1), start: str = "0"
) -> dict[str, list[float]]:
    """Return the columns of rows, times factors, t since a start."""
    columns = {}
    for i, (name, factor) in enumerate(zip(NAMES, factors, strict=True)):
        offset = Fraction(start) if name == "t" else 0
        columns[name] = [float(Fraction(float(Fraction(row[i]) - offset)) * factor) for row in rows]
    return columns


def comma(text: str) -> str:
    """Return a number with a decimal comma."""
    return text.replace(".", ",")


def table(
    header: str | None,
    rows: Sequence[Sequence[str]],
    separator: str = ",",
    spelled: Callable[[str], str] = str,
    end: str = "\n",
    last: str = "",
) -> str:
    """Return a text of a header and rows."""
    lines = ([] if header is None else [header]) + [
        separator.join(map(spelled, row)) + last for row in rows
    ]
    return end.join([*lines, ""])


def read(text: str | bytes, rows: Sequence[Row] = HALVES, **more: object) -> Spelling:
    """Return a text that has to be read as rows."""
    return Spelling(text if isinstance(text, bytes) else text.encode(), numbers(rows, **more))  # type: ignore[arg-type]


def refused(text: str | bytes, reason: str, alone: bool = False) -> Spelling:
    """Return a text that has to be refused."""
    return Spelling(text if isinstance(text, bytes) else text.encode(), None, reason, alone)


def passages(text: str, times: Sequence[float]) -> Spelling:
    """Return a list of transits that has to be read."""
    return Spelling(text.encode(), {"t": list(times)}, alone=True)


def exponent(letter: str, since: int) -> list[Row]:
    """Return rows whose numbers have an exponent with a letter from a row on."""
    written = [
        tuple(f"{float(number):.16e}".replace("e", letter) for number in row[1:]) for row in HALVES
    ]
    return [row if i < since else (row[0], *written[i]) for i, row in enumerate(HALVES)]


CM = Fraction(1, 100)
MM = Fraction(1, 1000)
MS = Fraction(1, 1000)


def of_the_field() -> dict[str, Spelling]:
    """Return the spellings of audit/field.md, in its families R1 to R5, the lost frames, the tails and the controls."""
    found: dict[str, Spelling] = {}
    # R1: the decimal mark, where the first row has a fraction and where it has none
    for word, separator in (("semicolons", ";"), ("tabs", "\t"), ("blanks", " "), ("wide", "   ")):
        for kind, rows in (("whole", WHOLE), ("halves", HALVES)):
            for head in (True, False):
                header = separator.join(NAMES) if head else None
                name = f"comma {word} {kind} {'header' if head else 'none'}"
                found[name] = read(table(header, rows, separator, comma), rows)
            mixed = [(row[0], *map(comma, row[1:])) for row in rows]
            found[f"point and comma {word} {kind}"] = read(
                table(separator.join(NAMES), mixed, separator), rows
            )
    found["comma list"] = passages("t\n2,2430\n6,7295\n11,2155\n", [2.243, 6.7295, 11.2155])
    found["comma list whole first"] = passages("t\n2\n6,7295\n11,2155\n", [2, 6.7295, 11.2155])
    found["comma list numbered"] = passages("k;t\n1;2,2430\n2;6,7295\n", [2.243, 6.7295])
    for letter in "dDE":
        for since in (0, 1, 3):
            rows = exponent(letter, since)
            found[f"exponent {letter} from {since}"] = read(
                table("t x y", rows, " "), [tuple(map(_plain, row)) for row in rows]
            )
    # R2: a line of units
    for name, line, factors in (
        ("plain", "s,m,m", (1, 1, 1)),
        ("round", "(s),(m),(m)", (1, 1, 1)),
        ("square", "[s],[m],[m]", (1, 1, 1)),
        ("centimetres", "s,cm,cm", (1, CM, CM)),
        ("millimetres", "ms,mm,mm", (MS, MM, MM)),
        ("mixed", "min,m,km", (60, 1, 1000)),
        ("words", "seconds,metres,metres", (1, 1, 1)),
        ("German", "Sekunden,Meter,Meter", (1, 1, 1)),
        ("types", "double,double,double", (1, 1, 1)),
        ("quoted", '"s","cm","cm"', (1, CM, CM)),
        ("empty first", ",cm,cm", (1, CM, CM)),
        ("hyphens", "-,cm,cm", (1, CM, CM)),
    ):
        for place in ("below", "above"):
            lines = f"t,x,y\n{line}" if place == "below" else f"{line}\nt,x,y"
            found[f"units {name} {place}"] = read(table(lines, HALVES), factors=factors)
    found["units semicolons"] = read(table("t;x;y\ns;m;m", WHOLE, ";", comma), WHOLE)
    found["units tabs"] = read(table("t\tx\ty\ns\tcm\tcm", HALVES, "\t"), factors=(1, CM, CM))
    found["units comment"] = read(table("# t x y\n# s cm cm", HALVES, " "), factors=(1, CM, CM))
    found["units comment labelled"] = read(
        table("# t x y\n# units: s cm cm", HALVES, " "), factors=(1, CM, CM)
    )
    found["units and a comment"] = read(
        table("t,x,y\ns,cm,cm\n# of the first run", HALVES), factors=(1, CM, CM)
    )
    # R3: quotes
    found["quotes around all"] = read(table('"t","x","y"', HALVES, ",", lambda word: f'"{word}"'))
    found["quotes around commas"] = read(
        table('"t","x","y"', WHOLE, ",", lambda word: f'"{comma(word)}"'), WHOLE
    )
    found["quotes where needed"] = read(
        table("t,x,y", WHOLE, ",", lambda word: f'"{comma(word)}"' if "." in word else word), WHOLE
    )
    found["quoted separator"] = read(
        table('Time (s) Run #1,"Position, X (m) Run #1","Position, Y (m) Run #1"', HALVES)
    )
    found["quoted unread separator"] = read(
        table('t,x,y,"note, if any"', [(*row, '"a, b"') for row in HALVES])
    )
    found["latest"] = read(table("Latest: Time (s),Latest: X (m),Latest: Y (m)", HALVES))
    found["label"] = read(table("Columns: t x y", HALVES, " "))
    found["quotes blanks"] = read(table('"t" "x" "y"', HALVES, " "))
    # R4: names of three parts
    for x, y, factor in (
        ("x_east_m", "y_north_m", 1),
        ("pos_x_m", "pos_y_m", 1),
        ("x_pos_cm", "y_pos_cm", CM),
        ("x_m_east", "y_m_north", 1),
        ("x_east", "y_north", 1),
        ("x_east (m)", "y_north (m)", 1),
        ("east_mm", "north_mm", MM),
        ("x [east] (cm)", "y [north] (cm)", CM),
        ("x.east.m", "y.north.m", 1),
        ("x_in_mm", "y_in_mm", MM),
        ("position_x_east_m", "position_y_north_m", 1),
    ):
        found[f"name {x}"] = read(table(f"t_s,{x},{y}", HALVES), factors=(1, factor, factor))
    # R5: clocks, and times that are text
    found["clock text"] = read(
        table("time,x,y", [(f"00:00:0{float(t):.3f}", x, y) for t, x, y in HALVES])
    )
    found["clock moments"] = read(
        table("time,x,y", [(f"2026-03-01T12:00:0{float(t):.3f}Z", x, y) for t, x, y in HALVES])
    )
    since_1970 = [(f"176000000{t}" if "." in t else f"176000000{t}.0", x, y) for t, x, y in HALVES]
    found["clock 1970"] = read(table("time,x,y", since_1970), since_1970)
    # lost frames and the tails of spreadsheets
    for word in ("nan", "NaN", "", "NA", "null", "#N/A"):
        lost = [*HALVES[:3], ("1.25", word, word), *HALVES[3:]]
        found[f"lost {word or 'empty'}"] = read(table("t,x,y", lost))
    found["tail commas"] = read(table("t,x,y", HALVES) + ",,\n,,\n")
    found["tail semicolons"] = read(table("t;x;y", WHOLE, ";", comma) + ";;\n;;\n", WHOLE)
    found["end commas"] = read(table("t,x,y,,", HALVES, last=",,"))
    # controls, which were read before
    found["byte order mark"] = read("\ufeff" + table("t,x,y", HALVES))
    found["sep"] = read("sep=;\n" + table("t;x;y", WHOLE, ";", comma), WHOLE)
    found["tracker"] = read("mass_A\t\t\n" + table("t\tx\ty", WHOLE, "\t", comma), WHOLE)
    found["phyphox"] = read(table('"Time (s)","x (cm)","y (cm)"', HALVES), factors=(1, CM, CM))
    found["hours"] = read(table("t (h),x (m),y (m)", HALVES), factors=(3600, 1, 1))
    found["modelling"] = read(table("timestamp,x(t),y(t)", HALVES))
    found["index"] = read(table(",t,x,y", [(str(i), *row) for i, row in enumerate(HALVES)]))
    found["latin"] = read(
        table("Zeit (s);Ost (m);Nord (m);Länge", [(*row, "1") for row in WHOLE], ";", comma).encode(
            "latin-1"
        ),
        WHOLE,
    )
    found["windows"] = read(table("t,x,y", HALVES, end="\r\n"))
    return found


def of_my_own() -> dict[str, Spelling]:
    """Return spellings that I thought of: what two readers may read in two ways, and what is nearly right."""
    found: dict[str, Spelling] = {}
    commas = [tuple(map(comma, row)) for row in WHOLE]
    late = [(f"{1 + float(t):g}", x, y) for t, x, y in HALVES]
    # marks: decimal, between columns, between thousands
    found["comma between and within"] = refused(table("t,x,y", commas), "semicolons")
    found["comma between and within, no header"] = refused(table(None, commas), "semicolons")
    found["comma between seven parts"] = refused(
        table(
            None,
            [
                (
                    *row,
                    "-66,9",
                )
                for row in commas[1:]
            ],
        ),
        "semicolons",
    )
    found["label and words of a logger"] = refused(
        table("# Latest: Time (s) Y (m) Run #1 Position, X (m)", HALVES, " "), "3 fields"
    )
    found["label and thousands"] = refused("Latest: t x y\n43 200 0 1\n43 201 1 0\n", "fields")
    found["thousands in quotes"] = refused('t,x,y\n"0",0.3,0.4\n"1,234",0.2,0.1\n', "1,234")
    found["comma before three digits"] = refused("t;x;y\n1;1,250;2,500\n2;1,125;2,375\n", "1,250")
    found["comma before three digits, once not"] = read(
        "t;x;y\n1;0,250;2,500\n2;1,125;2,375\n", [("1", "0.25", "2.5"), ("2", "1.125", "2.375")]
    )
    found["thousands and comma"] = refused("t;x;y\n0;0,3;0,4\n1;1.234,5;0,1\n", "thousands")
    found["thousands of a point beside commas"] = refused(
        "t;x;y\n1.000;0,3;0,4\n2.000;0,2;0,1\n", "1.000"
    )
    found["point of times beside commas"] = read(
        "t;x;y\n0.000;0,3;0,4\n1.000;0,2;0,1\n", [("0", "0.3", "0.4"), ("1", "0.2", "0.1")]
    )
    found["thousands of a point alone"] = refused(
        "t (ms);x (mm);y (mm)\n0;300;400\n1.000;278;362\n2.000;216;256\n", "1.000"
    )
    found["thousands of a blank"] = refused("t;x;y\n0;0,3;0,4\n1 234,5;0,2;0,1\n", "thousands")
    found["thousands of an apostrophe"] = refused(
        "t;x;y\n0;0.3;0.4\n1'234.5;0.2;0.1\n", "thousands"
    )
    found["comma in front after a blank"] = refused("0 ,5 ,3\n1 ,25 ,4\n", "semicolons")
    found["comma in front"] = read(
        "t;x;y\n0;,5;,25\n1;,25;-,5\n", [("0", "0.5", "0.25"), ("1", "0.25", "-0.5")]
    )
    found["number and time, or a comma"] = refused("1,2\n2,6\n3,11\n", "first line", alone=True)
    found["comma with exponents"] = read(
        "t x y\n0 3,0E-01 4,0e-1\n5,0E-01 2,5E-1 +1,25E+00\n",
        [("0", "0.3", "0.4"), ("0.5", "0.25", "1.25")],
    )
    found["commas of a text beside"] = read(
        "t;x;y;note\n" + "".join(f"{';'.join(row)};one, two\n" for row in commas), WHOLE
    )
    found["only whole numbers"] = read("t;x;y\n0;3;4\n1;2;1\n", [("0", "3", "4"), ("1", "2", "1")])
    # units
    found["units of the screen"] = refused(table("t,x,y\ns,px,px", HALVES), "px")
    found["units for two of three"] = refused(table("# units: ms, cm\nt,x,y", HALVES), "units")
    found["units against the header"] = refused(table("t,x (cm),y (cm)\ns,m,m", HALVES), "header")
    found["units as the header"] = read(
        table("t,x (cm),y (cm)\ns,cm,cm", HALVES), factors=(1, CM, CM)
    )
    found["units twice"] = refused(table("ms,cm,cm\nt,x,y\ns,m,m", HALVES), "units")
    found["units nobody knows"] = refused(table("t,x,y\ns,furlongs,m", HALVES), "furlongs")
    found["units of SI in words"] = read(table("# all in SI units\nt,x,y", HALVES))
    found["units of a list"] = passages("t\nms\n2243\n6729.5\n", [2.243, 6.7295])
    found["unit in a field"] = refused("t,x,y\n0,0.3 m,0.4 m\n1,0.2 m,0.1 m\n", "row of numbers")
    # clocks
    found["clock of two numbers"] = refused(
        "time,x,y\n00:00,0.3,0.4\n00:01,0.2,0.1\n", "minutes and seconds"
    )
    found["clock of minutes"] = read(
        table("time,x,y", [(f"00:0{float(t):.1f}", x, y) for t, x, y in HALVES])
    )
    found["clock of frames"] = refused(
        table("time,x,y", [(f"00:00:0{i}:12", *row[1:]) for i, row in enumerate(HALVES)]), "number"
    )
    found["clock of twelve hours"] = refused(
        table("time,x,y", [(f"12:00:0{i} PM", *row[1:]) for i, row in enumerate(HALVES)]),
        "hours:minutes:seconds",
    )
    found["date of days first"] = refused(
        table("time,x,y", [(f"03/01/2026 12:00:0{i}", *row[1:]) for i, row in enumerate(HALVES)]),
        "hours:minutes:seconds",
    )
    found["date of no calendar"] = refused(
        table("time,x,y", [(f"2026-02-30T12:00:0{i}", *row[1:]) for i, row in enumerate(HALVES)]),
        "a date that exists",
    )
    found["date and zone"] = read(
        table(
            "time,x,y",
            [
                (
                    f"2026-03-01T00:59:{59 + float(t):04.1f}+01:00"
                    if float(t) < 1
                    else f"2026-03-01T01:00:{float(t) - 1:04.1f}+01:00",
                    x,
                    y,
                )
                for t, x, y in HALVES
            ],
        )
    )
    found["date and blank"] = read(
        table("time;x;y", [(f"2026-03-01 12:00:0{t}", x, y) for t, x, y in HALVES], ";", comma)
    )
    found["time of day"] = read(
        table("time,x,y", [(f"12:34:5{float(t):.1f}", x, y) for t, x, y in HALVES])
    )
    found["clock and number"] = refused("time,x,y\n00:00:00,0.3,0.4\n1,0.2,0.1\n", "first row")
    found["number and clock"] = refused("time,x,y\n0,0.3,0.4\n00:00:01,0.2,0.1\n", "number")
    found["clock with a unit"] = refused(
        "time (ms),x,y\n00:00:00,0.3,0.4\n00:00:01,0.2,0.1\n", "unit"
    )
    found["clock that started before"] = read(table("t,x,y", late), late)
    # rows without numbers
    found["failed at the end"] = refused(
        table("t,x,y", [*HALVES, ("3", "nan", "nan")]), "run failed"
    )
    found["infinite in the middle"] = refused(
        table("t,x,y", [HALVES[0], ("0.2", "inf", "0"), *HALVES[1:]]), "run failed"
    )
    found["nothing but lost frames"] = refused("t,x,y\n0,,\n1,,\n2,,\n", "in any row")
    found["lost at first and at last"] = read(
        table("t,x,y", [("0", "", ""), *late, ("9", "", "")]), late
    )
    found["no time"] = refused(table("t,x,y", [*HALVES, ("", "0.1", "0.2")]), "t")
    found["mean below"] = refused(table("t,x,y", [*HALVES, ("Mean", "0.1", "0.2")]), "Mean")
    found["cut off"] = refused(table("t,x,y", HALVES) + "2.5,0.1", "cut off")
    found["one field more"] = refused(table("t;x;y", HALVES, ";") + "2.5;0.1;0.2;0.3\n", "4 fields")
    found["header again"] = refused(table("t,x,y", HALVES) + table("t,x,y", HALVES), "number")
    found["ends that differ"] = read(
        "t,x,y\n" + "".join(",".join(row) + "," * (i % 3) + "\n" for i, row in enumerate(HALVES))
    )
    # numbers
    for name, number in (
        ("minus of Unicode", "−0.3"),
        ("underscore", "1_0"),
        ("hexadecimal", "0x1.8p-1"),
        ("text", "o.3"),
    ):
        found[name] = refused(f"t,x,y\n0,0.3,0.4\n1,{number},0.1\n", "number")
    # names
    found["two runs"] = refused(
        table(
            "Time (s),x (m) Run #1,x (m) Run #2,y (m) Run #1", [(t, x, x, y) for t, x, y in HALVES]
        ),
        "x (m) Run #2",
    )
    found["row names"] = refused("t x y\n1 0 0.3 0.4\n2 1 0.2 0.1\n", "4 fields")
    found["words of a comment for four columns"] = refused(
        "# Latest: Time (s) x y frame\n0 0.3 0.4 1\n1 0.2 0.1 2\n", "4 fields"
    )
    found["pixels"] = refused(table("t,x_px,y_px", HALVES), "no x")
    found["axes of a map"] = read(table("t,x_north,y_east", [(t, y, x) for t, x, y in HALVES]))
    found["west and south"] = read(table("t,x_west_cm,y_south_cm", HALVES), factors=(1, -CM, -CM))
    found["single quotes"] = read(table("'t','x','y'", HALVES))
    found["an inch"] = read(table('t,x,y,width (")', [(*row, "3") for row in HALVES]))
    # lines
    found["bars"] = read(table("t|x|y", HALVES, "|"))
    found["Markdown"] = read(
        "| t | x | y |\n|---|---|---|\n" + "".join(f"| {' | '.join(row)} |\n" for row in HALVES)
    )
    found["carriage returns"] = refused(table("t,x,y", HALVES, end="\r"), "CR")
    found["UTF-16"] = refused(table("t,x,y", HALVES).encode("utf-16"), "text")
    found["columns in line"] = read(
        "".join(f"{word:>8}" for word in NAMES)
        + "\n"
        + "".join("".join(f"{n:>24}" for n in row) + "\n" for row in HALVES)
    )
    found["comments and gaps"] = read(
        "Foucault pendulum, run 1\n\n" + table("#t,x,y", HALVES, end="\n# and so on\n\n")
    )
    found["units in brackets, blanks"] = read(
        table("t (s) x (cm) y (cm)", HALVES, " "), factors=(1, CM, CM)
    )
    found["names by commas, rows by tabs"] = read(table("t,x,y", HALVES, "\t"))
    return found


def _plain(number: str) -> str:
    return number.replace("d", "e").replace("D", "e")


HEADERS = {  # names of columns, by the unit in which their numbers then are
    "t": {
        "t": 1,
        "time": 1,
        "Time (s)": 1,
        "t_ms": MS,
        "t (min)": 60,
        "Latest: Time (s)": 1,
        "elapsed time": 1,
    },
    "x": {
        "x": 1,
        "x_east_m": 1,
        "pos_x_cm": CM,
        "east": 1,
        "x (mm)": MM,
        "West": -1,
        "Position, X (m)": 1,
        "x [east]": 1,
    },
    "y": {
        "y": 1,
        "y_north_m": 1,
        "y_pos_cm": CM,
        "North (cm)": CM,
        "y/m": 1,
        "south_mm": -MM,
        "Y (m) Run #1": 1,
    },
}
UNIT_LINES = {
    "t": {"s": 1, "ms": MS, "(min)": 60, "": 1},
    "x": {"m": 1, "cm": CM, "[mm]": MM, "": 1},
}
UNREAD = ("energy", "note", "frame", "theta (deg)")


def drawn(random: Random) -> Spelling:
    """Return one trajectory spelled in a way drawn at random, sensible or not, with the numbers that were written.

    It may have to be refused; if it is read, it has these numbers.
    """
    rows = random.randint(2, 6)
    columns = {name: [_number(random) for _ in range(rows)] for name in "xy"}
    columns["t"] = random.choice((_whole_times, _halves, _long_times))(random, rows)
    order = list(NAMES)
    if random.random() < 0.5:
        random.shuffle(order)
    order += random.sample(UNREAD, random.choice((0, 0, 1, 2)))
    separator = random.choice((",", ",", ";", ";", "\t", " ", "   ", "|", ", ", " ; "))
    mark = random.choice((".", ".", ","))
    head = random.random() < 0.85
    names = {
        name: random.choice([*HEADERS[name]]) if random.random() < 0.5 else name for name in NAMES
    }
    factors: dict[str, Fraction | int] = {name: HEADERS[name][names[name]] for name in NAMES}
    words = [names.get(name, name) for name in order]
    lines = [
        f"# {line}"
        for line in random.sample(
            ("of a program", "l = 67 m", "all in SI units"), random.choice((0, 0, 1))
        )
    ]
    quote = random.choice(("", "", "needed", "all"))

    def quoted(field: str) -> str:
        return (
            f'"{field}"'
            if quote == "all" or (quote and separator.strip() and separator.strip() in field)
            else field
        )

    if head:
        lines.append(random.choice(("", "", "# ")) + separator.join(map(quoted, words)))
        plainly = all(words[i] == name for i, name in enumerate(order))
        if plainly and random.random() < 0.4:
            units = {
                name: random.choice([*UNIT_LINES["t" if name == "t" else "x"]]) for name in NAMES
            }
            factors = {name: UNIT_LINES["t" if name == "t" else "x"][units[name]] for name in NAMES}
            line = separator.join(units.get(name, "") for name in order)
            lines.insert(len(lines) - random.randint(0, 1), line)
    elif order != [*NAMES]:
        return drawn(random)
    else:
        factors = dict.fromkeys(NAMES, 1)
    lost = random.choice(("", "nan", "NA")) if random.random() < 0.15 else None
    grouped = random.choice((",", ".", "'", " ")) if random.random() < 0.1 else ""
    clock = (
        random.choice(("", "", "", "", "h", "moment"))
        if factors["t"] == 1 and float(columns["t"][-1]) < 80000
        else ""
    )
    if grouped == mark:
        grouped = ""
    for i in range(rows):
        fields = []
        for name in order:
            number = columns[name][i] if name in columns else random.choice(("1", "a", "7.5"))
            if name == "t" and clock:
                number = _clock_text(number, clock)
            whole, point, rest = number.partition(".")
            if grouped and name in columns and whole.isdigit():
                whole = f"{int(whole):,}".replace(",", grouped)
            fields.append(quoted(f"{whole}{mark if point else ''}{rest}"))
        lines.append(separator.join(fields))
        if lost is not None and i + 1 < rows:
            lines.append(separator.join(columns["t"][i] if name == "t" else lost for name in order))
    tail = random.choice(("", "", "", separator.strip() * 2, "# the end", "\n\n"))
    text = random.choice(("\n", "\n", "\r\n")).join([*lines, tail, ""])
    return Spelling(text.encode(), {name: _rounded(columns[name], factors[name]) for name in NAMES})


def _number(random: Random) -> str:
    """Return a position as a program may print it."""
    value = random.uniform(-2, 2)
    places = random.choice((0, 1, 3, 3, 9, 17))
    return f"{value:.{places}f}" if random.random() < 0.8 else f"{value:.{places}e}"


def _whole_times(random: Random, rows: int) -> list[str]:
    first = random.choice((0, 0, 1, 43200, 1760000000))
    return [f"{first + i}" for i in range(rows)]


def _halves(random: Random, rows: int) -> list[str]:
    places = random.choice((1, 3))
    return [f"{i / 2:.{places}f}" for i in range(rows)]


def _long_times(random: Random, rows: int) -> list[str]:
    fraction = random.choice(("", ".25", ".125"))
    return [f"{1250 * i}{fraction}" for i in range(rows)]


def _clock_text(number: str, kind: str) -> str:
    seconds = Fraction(number)
    whole = int(seconds)
    text = f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}.{number.partition('.')[2] or 0}"
    return text if kind == "h" else f"2026-03-01T{text}Z"


def _rounded(texts: Sequence[str], factor: Fraction | int) -> list[float]:
    return [float(Fraction(float(text)) * factor) for text in texts]
