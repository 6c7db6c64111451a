"""Are the numbers of sweeps true? Random rows in every engine, every column against Newton's law in 37 digits and more.

    nice python tests/bench/sweep_truth.py [ROWS] [--seed 1] [--engines auto octet heyoka] [--out DIR] [--show 5]
        [--slice I N]

The truth is `sweep_truth.cpp`, which shares no line and no method with the project (it is compiled here, and wants g++,
libboost-dev, libmpfr-dev). The first 500 rows are tests/helpers/random_positions.csv and random_angles.csv, the others
drawn. Truths stay in DIR (build/sweep_truth) and are not computed again; 3,000 of them take 5 CPU minutes. Exit status
1: a value outside its error, or without one, or where there is none, or missing; a count or a direction that is wrong.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import random
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

import reference

HERE = Path(__file__).parent
STANDARD = {
    "length": "67",
    "drag": "0",
    "latitude": "48.846111",
    "altitude": "0",
    "gravity": "9.80665",
    "gravity_is": "ellipsoid",
    "rotation_rate": "7.292115e-5",
    "equatorial_radius": "6378137",
    "inverse_flattening": "298.257223564",
}
SITE = tuple(STANDARD)  # the first two are the pendulum's
RELEASES = {
    "xy": ("x", "y", "vx", "vy"),
    "angle": ("angle", "azimuth", "angle_rate", "azimuth_rate"),
}
FIELDS = {name: f"{'pendulum' if name in SITE[:2] else 'site'}.{name}" for name in SITE} | {
    "t_end": "run.t_end"
}
FIELDS |= {name: f"release.{name}" for names in RELEASES.values() for name in names}
LISTS = {"xy": "random_positions.csv", "angle": "random_angles.csv"}
BASES = {"xy": "paris", "angle": "two_radians"}
STATE = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
# -u''/(|c| (1 - u²)): a swing with less is a conical orbit, of which no highest points are told
LEAST_BEND = 1e-6
# degrees from the top, below which a highest point may have no azimuth (docs/sweeps.md)
AT_TOP = Fraction(1, 10**11)
Row = dict[str, str]


def text(number: float, digits: int = 10) -> str:
    return f"{number:.{digits}g}"


class Draw:
    """Random rows."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def log(self, low: float, high: float) -> float:
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    def signed(self, low: float, high: float) -> float:
        return self.random.choice((-1, 1)) * self.log(low, high)

    def row(self, kind: str, **fields: Any) -> Row:
        """Return a row with a span of some swings and, a third of them each, with drag and the effective gravity."""
        one_of = self.random.choice
        row = STANDARD | dict.fromkeys(RELEASES[kind], "0")
        row |= {
            "length": text(self.log(0.5, 300), 5),
            "latitude": text(self.random.uniform(-90, 90), 8),
        }
        row |= {"gravity_is": one_of(("ellipsoid", "ellipsoid", "effective"))}
        row |= {"drag": one_of(("0", "0", text(self.log(1e-6, 3e-2), 4)))}
        return self.spanned(row | {key: str(value) for key, value in fields.items()})

    def spanned(self, row: Row) -> Row:
        """Return a row with its span: 60 s to 3,600 s, mostly some tens of swings."""
        period = 2 * math.pi * math.sqrt(float(row["length"]) / max(float(row["gravity"]), 0.1))
        return row | {"t_end": text(min(max(period * self.log(3, 70), 60), 3600), 5)}

    def listed(self) -> Iterator[tuple[str, Row]]:
        for kind, name in LISTS.items():
            for cells in csv.DictReader((HERE.parent / "helpers" / name).open()):
                plain = {key.rpartition(".")[2]: value for key, value in cells.items()}
                yield kind, self.spanned(STANDARD | plain)

    def grid(self) -> tuple[str, Row]:
        """Length, latitude and angle of a grid."""
        one_of = self.random.choice
        length, latitude = (
            one_of(("0.5", "1", "2.5", "10", "67", "200")),
            one_of(range(-90, 91, 15)),
        )
        angle = one_of(("0.01", "0.5", "5", "20", "60", "90", "120", "150", "175"))
        azimuth = one_of(range(-180, 180, 15))
        return "angle", self.row(
            "angle", length=length, latitude=latitude, angle=angle, azimuth=azimuth
        )

    def early(self) -> tuple[str, Row]:
        """A highest point soon after the release: rate of rotation, vx and drag."""
        one_of = self.random.choice
        rate, vx = one_of(("0", "7.292115e-5", "-7.292115e-5", "1e-3")), self.signed(1e-9, 1e-3)
        drag = one_of(("0", "1e-6", "1e-4", "1e-2"))
        x, y = text(self.random.uniform(-0.5, 0.5), 3), text(self.random.uniform(-0.5, 0.5), 3)
        return "xy", self.row("xy", rotation_rate=rate, drag=drag, vx=text(vx, 3), x=x, y=y)

    def near_rest(self) -> tuple[str, Row]:
        """Next to the vertical, where a tilted plumb line leaves the bob to swing, and an effective one hardly does."""
        one_of = self.random.choice
        latitude, x = one_of(range(-90, 91, 10)), one_of(("0", "1e-12", "1e-9", "1e-6", "1e-3"))
        return "xy", self.row(
            "xy", latitude=latitude, x=x, gravity_is=one_of(("ellipsoid", "effective"))
        )

    def tiny(self) -> tuple[str, Row]:
        """Amplitudes from 1e-12 m about the plumb line."""
        size = self.log(1e-12, 1e-3)
        speed = size * self.random.choice((0, 1)) * 2
        release = {name: text(self.random.uniform(-1, 1) * size, 6) for name in ("x", "y")}
        release |= {name: text(self.random.uniform(-1, 1) * speed, 6) for name in ("vx", "vy")}
        return "xy", self.row("xy", gravity_is="effective", **release)

    def over(self) -> tuple[str, Row]:
        """Beyond the horizontal and over the top."""
        length = text(self.log(0.3, 10), 4)
        release = {
            "angle": text(self.random.uniform(60, 180), 6),
            "azimuth": text(self.random.uniform(-180, 180), 6),
        }
        for name, most in (("angle_rate", 400), ("azimuth_rate", 100)):
            release[name] = text(self.random.uniform(-most, most) * self.random.choice((0, 1)), 5)
        return "angle", self.row("angle", length=length, **release)

    def pole(self) -> tuple[str, Row]:
        kind, row = self.random.choice((self.grid, self.wide, self.conical))()
        return kind, row | {"latitude": self.random.choice(("90", "-90"))}

    def wide(self) -> tuple[str, Row]:
        """Thrown to a share of the length."""
        length = self.log(0.5, 300)
        share, speed = self.log(1e-5, 0.5), math.sqrt(9.8 * length)
        release = {
            name: text(self.random.uniform(-1, 1) * share * length, 7) for name in ("x", "y")
        }
        release |= {
            name: text(self.random.uniform(-1, 1) * share * speed, 7) for name in ("vx", "vy")
        }
        return "xy", self.row("xy", length=text(length, 7), **release)

    def meridian(self) -> tuple[str, Row]:
        """All but north-south, with close pairs of transits."""
        length, y = self.log(0.5, 300), self.random.uniform(-0.1, 0.1)
        x, vx = (
            text(self.signed(1e-9, 1e-3) * self.random.choice((0, 1)) * length, 4) for _ in range(2)
        )
        return "xy", self.row("xy", length=text(length, 7), x=x, vx=vx, y=text(y * length, 6))

    def conical(self) -> tuple[str, Row]:
        """All but round."""
        length, angle = self.log(0.5, 100), self.random.uniform(1, 80)
        rate = math.degrees(math.sqrt(9.80665 / length / math.cos(math.radians(angle))))
        rate *= 1 + self.signed(1e-8, 1e-1)
        release = {"angle": text(angle, 5), "azimuth": text(self.random.uniform(-180, 180), 5)}
        return "angle", self.row(
            "angle", length=text(length, 7), azimuth_rate=text(rate, 9), **release
        )

    def planet(self) -> tuple[str, Row]:
        """A body that turns with up to 0.1 rad/s."""
        kind, row = self.wide()
        rate, radius = text(self.random.uniform(-0.1, 0.1), 6), text(self.random.uniform(0, 300), 5)
        return kind, row | {
            "rotation_rate": rate,
            "equatorial_radius": radius,
            "gravity": text(self.log(1, 12), 6),
        }

    def rows(self, count: int) -> list[tuple[str, Row]]:
        """Return rows: the lists, then those that are drawn, all kinds in turn."""
        rows = list(self.listed())
        rows = rows if count > 2 * len(rows) else self.random.sample(rows, count // 2)
        thrown = (self.pole, self.wide, self.meridian, self.conical, self.planet)
        kinds = (self.grid, self.early, self.near_rest, self.tiny, self.over, *thrown)
        return rows + [kinds[i % len(kinds)]() for i in range(count - len(rows))]


def truths(rows: list[tuple[str, Row]], folder: Path, digits: int) -> list[dict[str, Any]]:
    """Return the truth of each row, from the file of those that are known, and of the others by the program."""
    program, known = folder / "sweep_truth", folder / f"truth{digits}.jsonl"
    flags = ["-O2", "-o", str(program), str(HERE / "sweep_truth.cpp"), "-lmpfr", "-lgmpxx", "-lgmp"]
    subprocess.run(["g++", *flags], check=True)
    lines = [
        ",".join([kind, *(row[name] for name in (*SITE, "t_end", *RELEASES[kind]))])
        for kind, row in rows
    ]
    found = {line["row"]: line for line in map(json.loads, known.open())} if known.exists() else {}
    missing = "\n".join(line for line in dict.fromkeys(lines) if line not in found)
    if missing:
        with known.open("a") as out:
            subprocess.run([program, str(digits)], input=missing, text=True, stdout=out, check=True)
        found = {line["row"]: line for line in map(json.loads, known.open())}
    return [found[line] for line in lines]


@dataclass
class CheckedColumn:
    """What was found of a column: rows compared, faults of each kind, the largest error over the stated one."""

    compared: int = 0
    faults: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    worst: float = 0.0


class Comparison:
    """The rows of one engine beside the truth."""

    def __init__(self, engine: str, rows: list[tuple[str, Row]]) -> None:
        self.engine, self.rows = engine, rows
        self.statuses: dict[str, int] = defaultdict(int)
        self.columns: dict[str, CheckedColumn] = defaultdict(CheckedColumn)
        self.faults: list[str] = []

    def fault(self, place: int, column: str, fault: str, said: str) -> None:
        self.columns[column].faults[fault] += 1
        kind, row = self.rows[place]
        named = {FIELDS[name]: row[name] for name in row if row[name] != STANDARD.get(name, "0")}
        axis = f"release.{RELEASES[kind][0]}"
        named |= {
            "pendulum.length": row["length"],
            **{f"release.{name}": row[name] for name in RELEASES[kind]},
        }
        sets = " ".join(
            f"--set {key}={value}" for key, value in named.items() if key not in (axis, "run.t_end")
        )
        command = f"foucault sweep {BASES[kind]} {sets} --over={axis}={named[axis]} --t-end {row['t_end']}"
        said = f"row {place} {column}: {fault}: {said}"
        self.faults.append(
            f"{said}\n    {command} --engine {self.engine} --want all,transit-times --json"
        )

    def number(
        self,
        place: int,
        column: str,
        value: Any,
        error: Any,
        true: str | None,
        why_not: bool = False,
    ) -> None:
        """Compare a value, which may be missing where `why_not`."""
        self.columns[column].compared += 1
        if math.isnan(value):
            if true is not None and not why_not:
                self.fault(place, column, "missing", f"true {true}")
        elif true is None:
            self.fault(place, column, "invented", f"{value!r} +- {error!r}")
        else:
            said = f"{value!r} +- {error!r}, true {true}"
            self.gap(place, column, abs(Fraction(value) - Fraction(true)), error, said)

    def gap(self, place: int, column: str, gap: Fraction, error: Any, said: str) -> None:
        if error is None or not error < math.inf:
            self.fault(place, column, "without error", said)
        elif gap > Fraction(error):
            self.fault(place, column, "outside", said)
        if error is not None and error > 0 and gap:
            self.columns[column].worst = max(
                self.columns[column].worst, float(gap / Fraction(error))
            )

    def count(self, place: int, column: str, value: Any, true: Any) -> None:
        self.columns[column].compared += 1
        if value != true:
            self.fault(place, column, "wrong", f"{value}, true {true}")

    def row(
        self, place: int, row: dict[str, Any], times: Any, directions: Any, true: dict[str, Any]
    ) -> None:
        """Compare one row with its truth."""
        self.statuses[row["status"]] += 1
        if not true["sure"]:
            self.fault(place, "the truth", "unsure", "")
        if row["status"] != "ok":
            left = [
                name
                for name, value in row.items()
                if name.endswith(("_m", "_hz", "_s")) and not math.isnan(value)
            ]
            if left or not row["reason"]:
                self.fault(
                    place,
                    "status",
                    "not ok, but with numbers or without a reason",
                    f"{row['status']} {left}",
                )
            return
        self.count(place, "transits", row["transits"], len(true["t"]))
        self.count(place, "close_pairs", row["close_pairs"], true["close_pairs"])
        late = row["transit_error_s"]
        for name, at in (("t_first_s", 0), ("t_last_s", -1)):
            self.number(place, name, row[name], late, true["t"][at] if true["t"] else None)
        self.count(place, "transits.direction", list(directions), true["direction"])
        if len(times) == len(true["t"]) > 0:
            self.columns["transits.t_s"].compared += len(times)
            gap, t = max(
                (abs(Fraction(float(a)) - Fraction(b)), a)
                for a, b in zip(times, true["t"], strict=True)
            )
            self.gap(place, "transits.t_s", gap, late, f"{t} +- {late}, off by {float(gap)}")
        self.number(
            place,
            "frequency_hz",
            row["frequency_hz"],
            row["frequency_error_hz"],
            true.get("frequency_hz"),
        )
        conical = float(true["least_bend"]) < LEAST_BEND
        turns = {"swing_hz": "swing_error_hz", "precession_deg_per_h": "precession_error_deg_per_h"}
        turns |= {
            "precession_ratio": next(
                (name for name in row if "ratio" in name and "error" in name), ""
            )
        }
        at_top = Fraction(180) - Fraction(true["max_angle_deg"]) < AT_TOP
        for name, error in turns.items():
            why_not = conical or (at_top and name != "swing_hz")
            self.number(place, name, row[name], row.get(error), true.get(name), why_not)
        for name, error, first in (
            ("position", "position_error_m", 0),
            ("velocity", "velocity_error_m_s", 3),
        ):
            values = [row[column] for column in STATE[first : first + 3]]
            self.columns[name].compared += 1
            if any(map(math.isnan, values)):
                self.fault(place, name, "missing", "")
                continue
            gaps = [
                Fraction(a) - Fraction(b)
                for a, b in zip(values, true["state"][first:], strict=False)
            ]
            gap = Fraction(math.isqrt(int(sum(gap * gap for gap in gaps) * 10**100)), 10**50)
            self.gap(place, name, gap, row[error], f"{values} +- {row[error]}, off by {float(gap)}")
        self.number(
            place,
            "max_angle_deg",
            row["max_angle_deg"],
            row["max_angle_error_deg"],
            true["max_angle_deg"],
        )


def swept(
    rows: list[tuple[str, Row]], engine: str, folder: Path
) -> Iterator[tuple[int, dict[str, Any], Any, Any]]:
    """Yield place, columns, times and directions of every row as the project's sweep has them."""
    for kind, names in RELEASES.items():
        places = [i for i, (other, _) in enumerate(rows) if other == kind]
        fields = {name: FIELDS[name] for name in (*SITE, *names, "t_end")}
        with (folder / f"{kind}.csv").open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(fields.values())
            writer.writerows([rows[i][1][name] for name in fields] for i in places)
        scene = reference.load_scene(BASES[kind])
        sweep = reference.sweep(
            scene, rows=folder / f"{kind}.csv", want=("all", "transit-times"), engine=engine
        )
        transits, columns = sweep.transits(), sweep.columns()
        for i, place in enumerate(places):
            own = transits["row"] == i
            row = {name: values[i : i + 1].tolist()[0] for name, values in columns.items()}
            yield place, row, transits["t_s"][own].tolist(), transits["direction"][own].tolist()


def main() -> int:
    """Run the campaign; return 1 where anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", type=int, nargs="?", default=3000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--slice",
        type=int,
        nargs=2,
        default=(0, 1),
        metavar=("I", "N"),
        help="rows I, I + N, … alone",
    )
    parser.add_argument("--engines", nargs="+", default=["auto", "octet", "heyoka"])
    parser.add_argument("--digits", type=int, default=37, help="of the truth")
    parser.add_argument("--out", type=Path, default=Path("build/sweep_truth"))
    parser.add_argument(
        "--show", type=int, default=5, help="how many faults of an engine are shown"
    )
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    first, step = given.slice
    rows = Draw(given.seed).rows(given.rows)[first::step]
    true, wrong = truths(rows, given.out, given.digits), False
    for engine in given.engines:
        found = Comparison(engine, rows)
        for place, row, times, directions in swept(rows, engine, given.out):
            found.row(place, row, times, directions, true[place])
        print(f"\n{engine}: {len(rows)} rows, {dict(found.statuses)}")
        print(f"{'column':24}{'compared':>9}  {'error/stated':>12}  faults")
        for name, column in found.columns.items():
            print(f"{name:24}{column.compared:9}  {column.worst:12.3g}  {dict(column.faults) or 0}")
        print("\n".join(found.faults[: given.show]), flush=True)
        wrong |= bool(found.faults)
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
