"""Headers and separators drawn at random: every column lands where its name says, in its unit, without a traceback.

The spellings of a column and their factors stand here by hand, apart from the program's own.
"""

from __future__ import annotations

import io
from random import Random

import numpy as np

from compare.candidates.read import read_stream
from reference import InputError

SPELLED = {
    "t": {"t": 1, "T": 1, "time": 1, "Time [s]": 1, "t (ms)": 1e-3, "time_ms": 1e-3, "t/s": 1, "Seconds": 1,
          "t in min": 60, "elapsed time": 1, "time (h)": 3600, "sim_time": 1},
    "x": {"x": 1, "X": 1, "pos_x": 1, "x_pos": 1, "x (m)": 1, "X [cm]": 1e-2, "east": 1, "west": -1, "x/mm": 1e-3,
          "position.x": 1, "x_m": 1, "West (cm)": -1e-2, "x{km}": 1e3, "rx": 1, "x(t)": 1, "x displacement": 1},
    "y": {"y": 1, "Y": 1, "pos_y": 1, "north": 1, "south": -1, "y (m)": 1, "y_cm": 1e-2, "y (north)": 1, "posY": 1,
          "northing": 1, "y coordinate": 1, "South [mm]": -1e-3, "y (ft)": 0.3048},
    "z": {"z": 1, "Z": 1, "up": 1, "down": -1, "z_pos": 1, "z [m]": 1, "vertical": 1, "z/cm": 1e-2},
    "vx": {"vx": 1, "v_x": 1, "xdot": 1, "dx/dt": 1, "vx (m/s)": 1, "VX [cm/s]": 1e-2, "vel_x": 1, "velocity east": 1,
           "vx (km/h)": 1 / 3.6, "ẋ": 1, "x'": 1, "v_west": -1, "vx_m_s": 1, "vx (m s^-1)": 1},
    "vy": {"vy": 1, "y_dot": 1, "dy/dt": 1, "vy/m/s": 1, "vnorth": 1, "v_south": -1, "speed_y": 1},
    "vz": {"vz": 1, "zdot": 1, "vz [mm/s]": 1e-3, "v_up": 1, "vel_down": -1},
}  # fmt: skip
OTHERS = [
    "energy",
    "step",
    "n",
    "theta",
    "phi (deg)",
    "h",
    "l",
    "tension [N]",
    "E_kin",
    "count",
    "azimuth",
    "x0",
    "err",
    "T [K]",
    "temperature",
]
PREAMBLES = [
    "Foucault pendulum, version 1.2", "run of a day", "Latitude: 48.846111 degrees", "x0 = 0.3 m, y0 = 0.4 m",
    "length 67", "all in SI units", "t and x and y are in metres and seconds",
]  # fmt: skip


def drawn(random: Random) -> tuple[bytes, dict[str, list[float]]]:
    """Return a text, and what ought to be read from it."""
    columns = ["t", "x", "y", *random.sample(["z", "vx", "vy", "vz"], random.randint(0, 4))]
    separator = random.choice([",", ";", "\t", " ", ", ", "   ", " ; ", " \t"])
    spaced = not separator.strip() and "\t" not in separator
    names = {}
    for column in columns:
        choices = [
            word
            for word in SPELLED[column]
            if not (spaced and " " in word.replace(" (", "").replace(" [", ""))
        ]
        names[column] = random.choice(choices)
    extra = [
        word for word in random.sample(OTHERS, random.randint(0, 3)) if not (spaced and " " in word)
    ]
    if names["t"] in ("T", "t", "Time [s]"):  # T [K] beside T would be two names of t
        extra = [word for word in extra if not word.startswith("T ") or names["t"] == "t"]
    elif "T [K]" in extra:
        extra.remove("T [K]")
    order = [*columns, *extra]
    random.shuffle(order)
    rows = random.randint(1, 6)
    numbers = {name: [random.uniform(-1, 1) for _ in range(rows)] for name in order}
    numbers["t"] = sorted(random.sample([k / 8 for k in range(1, 1000)], rows))
    comma = separator.strip() != "," and random.random() < 0.2
    fortran = random.random() < 0.15
    mark = random.choice(["", "", "# ", "#", "% ", "! ", "// "])
    end = random.choice(["\n", "\n", "\r\n"])
    quote = '"' if random.random() < 0.1 and not spaced else ""
    trailing = separator if separator.strip() and random.random() < 0.1 else ""
    lines = [f"# {line}" for line in random.sample(PREAMBLES, random.randint(0, 2))]
    lines += random.sample(PREAMBLES[:2], 1) if random.random() < 0.2 and mark == "" else []
    lines.append(
        mark + separator.join(f"{quote}{names.get(word, word)}{quote}" for word in order) + trailing
    )

    def spelled(value: float) -> str:
        text = f"{value:.16e}" if fortran else repr(value)
        text = text.replace("e", "D") if fortran else text
        return text.replace(".", ",") if comma else text

    lines += [
        separator.join(spelled(numbers[word][i]) for word in order) + trailing for i in range(rows)
    ]
    mark_of_order = "\ufeff" if random.random() < 0.1 else ""
    expected = {
        column: [value * SPELLED[column][names[column]] for value in numbers[column]]
        for column in columns
    }
    return (mark_of_order + end.join(lines) + end).encode(), expected


def test_every_column_lands_where_its_name_says(size, tally):
    count = size(1000, 100_000)
    random = Random(20261122)
    for _ in range(count):
        text, expected = drawn(random)
        found = read_stream(io.BytesIO(text), "run")
        assert {"t", *found.columns} == set(expected), text.decode()
        for name, values in expected.items():
            column = found.t if name == "t" else found.columns[name]
            assert np.allclose(column, values, rtol=1e-15, atol=0), (name, text.decode())
    tally(f"headers: {count} texts drawn, every column where its name says")


def test_a_damaged_header_is_read_or_explained(size, tally):
    count = size(1000, 100_000)
    random = Random(7)
    refused = 0
    for _ in range(count):
        text = bytearray(drawn(random)[0])
        for _ in range(random.randint(1, 4)):
            at = random.randrange(len(text))
            put = random.choice([b"", *(bytes([byte]) for byte in b',; \t\nxt-.(#"0D\xff\0')])
            text[at : at + random.randint(0, 2)] = put
        try:
            read_stream(io.BytesIO(bytes(text)), "run")
        except InputError as error:
            refused += 1
            assert str(error).startswith(("run", "header")) and len(str(error)) < 600
    tally(f"damaged headers: {count} texts, {refused} refused with a message, no traceback")
