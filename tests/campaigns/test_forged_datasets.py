"""Wrong datasets whose hashes and seal fit: many numbers are off together, so that each row obeys every law."""

from __future__ import annotations

import json
import random
import shutil
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest
from forgery import forge, moved

import reference
from reference.dataset.files import read_files
from reference.dataset.manifest import MANIFEST
from reference.dataset.verify import verify
from reference.dataset.write import write
from reference.model.constants import constants
from reference.model.force import acceleration
from reference.numbers.columns import GRID
from reference.numbers.precision import context, fixed_decimal, to_fraction, to_mpf

BOUNDS = 30  # a forgery changes some number by more than this many bounds
SCENES = {
    "swing": ["run.t_end=600", "run.digits=20"],
    "wide": ["release.x=30", "release.y=40", "run.t_end=240", "run.grid_step=20", "run.digits=25"],
    "drag": ["pendulum.drag=0.001", "run.t_end=300", "run.digits=18"],
    "fast": ["site.rotation_rate=0.05", "run.t_end=300", "run.digits=30"],
}
SHORT = {name: [*SCENES[name], "run.t_end=180"] for name in ("swing", "drag")}


@pytest.fixture(scope="module")
def datasets(tmp_path_factory, pytestconfig):
    folder = tmp_path_factory.mktemp("golden")
    chosen = SCENES if pytestconfig.getoption("--long") else SHORT
    scenes = {name: reference.load_scene("paris", changes) for name, changes in chosen.items()}
    return [write(reference.solve(scene), folder / name) for name, scene in scenes.items()]


class Flow:
    """Rows of a grid moved along the motion, or turned about the vertical, by a little."""

    def __init__(self, folder: Path) -> None:
        self.files = read_files(folder)
        self.scene = self.files.scene
        self.ctx = context(400)
        self.k = constants(self.scene.exact, self.ctx)

    def shifted(self, row: list[str], header: list[str], late: Fraction) -> None:
        """Replace a row by the state a little later, which is on the sphere and has the same h."""
        places = [header.index(name) for name in GRID]
        state = [to_mpf(Fraction(row[i]), self.ctx) / self.k.length for i in places]
        a = acceleration(tuple(state[:3]), tuple(state[3:]), self.k)
        for i, value, rate in zip(places, state, (*state[3:], *a), strict=True):
            moved_to = (value + rate * to_mpf(late, self.ctx)) * self.k.length
            row[i] = fixed_decimal(to_fraction(moved_to), len(row[i].partition(".")[2]))

    def turned(self, row: list[str], header: list[str], angle: Fraction) -> None:
        """Turn a row's plane of swing."""
        for a, b in (("x", "y"), ("vx", "vy")):
            i, j = header.index(a), header.index(b)
            p, q = Fraction(row[i]), Fraction(row[j])
            row[i], row[j] = (
                fixed_decimal(value, len(row[place].partition(".")[2]))
                for value, place in ((p - q * angle, i), (q + p * angle, j))
            )

    def lateness(self, bounds: Fraction) -> Fraction:
        """Return a delay that moves the fastest row by so many of its bounds."""
        fastest = max(abs(row[0]) for row in self.files.tables["grid.csv"].numbers(("vx",)))
        return bounds * self.files.manifest.bound("grid", "x") / fastest


def one_row_later(folder, draw):
    flow = Flow(folder)
    late = flow.lateness(Fraction(draw.randrange(2 * BOUNDS, 10**5)))

    def change(rows, header):  # the row that moves fastest
        row = max(rows, key=lambda cells: abs(Fraction(cells[header.index("vx")])))
        flow.shifted(row, header, late)

    forge(folder, grid=change)


def all_rows_later_from_somewhere_on(folder, draw):
    flow = Flow(folder)
    late, share = flow.lateness(Fraction(draw.randrange(3 * BOUNDS, 10**4))), draw.uniform(0.1, 0.5)

    def change(rows, header):
        for row in rows[1 + int(share * len(rows)) :]:
            flow.shifted(row, header, late)

    def transits(rows, header):
        place = header.index("t")
        for row in rows[int(share * len(rows)) :]:
            row[place] = fixed_decimal(Fraction(row[place]) - late, len(row[place].partition(".")[2]))

    forge(folder, grid=change, transits=transits)


def ever_later(folder, draw):
    """Every row a little later than the one before, by less than its bound allows: a slow drift."""
    flow = Flow(folder)
    rows = len(flow.files.tables["grid.csv"].rows)
    late = flow.lateness(Fraction(draw.randrange(4 * BOUNDS, 40 * BOUNDS), rows))

    def change(rows, header):
        for i, row in enumerate(rows):
            flow.shifted(row, header, i * late)

    forge(folder, grid=change)


def ever_more_turned(folder, draw):
    flow = Flow(folder)
    manifest = flow.files.manifest
    angle = draw.randrange(5 * BOUNDS, 100 * BOUNDS) * manifest.bound("grid", "x") / Fraction(1, 4)
    count = len(flow.files.tables["grid.csv"].rows)

    def change(rows, header):
        for i, row in enumerate(rows):
            flow.turned(row, header, angle * i / count)

    forge(folder, grid=change)


def a_pair_of_transits_added(folder, draw):
    at = draw.randrange(1, len(read_files(folder).tables["transits.csv"].rows) - 1)

    def change(rows, header):
        t, places = header.index("t"), len(rows[0][header.index("t")].partition(".")[2])
        low, high = Fraction(rows[at - 1][t]), Fraction(rows[at][t])
        pair = [list(rows[at]), list(rows[at - 1])]
        for part, row in enumerate(pair, 1):
            row[t] = fixed_decimal(low + (high - low) * part / 3, places)
        rows[at:at] = pair
        for k, row in enumerate(rows, 1):
            row[0] = str(k)

    forge(folder, transits=change)


def smaller_bounds(folder, draw):
    """All bounds a thirtieth, in the manifest and row by row."""
    factor = Fraction(1, draw.randrange(BOUNDS, 10**6))

    def less(text):
        value = Fraction(text) * factor
        return f"{float(value):.1e}"

    def change(document):
        for part in ("grid", "transits"):
            document["bounds"][part] = {name: less(bound) for name, bound in document["bounds"][part].items()}
        for name in ("position_m", "velocity_m_s", "transit_s"):
            document["bounds"][name] = less(document["bounds"][name])

    forge(folder, transits=lambda rows, _: [row.__setitem__(-1, less(row[-1])) for row in rows], manifest=change)


FORGERIES = [
    one_row_later, all_rows_later_from_somewhere_on, ever_later, ever_more_turned, a_pair_of_transits_added,
    smaller_bounds,
]  # fmt: skip


def test_what_exceeds_thirty_bounds_is_found_although_every_hash_and_the_seal_fit(datasets, tmp_path, size, tally):
    draw, missed, tried = random.Random(11), [], size(6, 180)
    for i in range(tried):
        source, forgery = draw.choice(datasets), FORGERIES[i % len(FORGERIES)]
        copy = Path(shutil.copytree(source, tmp_path / str(i)))
        forgery(copy, draw)
        reference.load(copy)  # its hashes and its seal do fit
        if not verify(copy).problems:
            missed.append(f"{i}: {forgery.__name__} of {source.name}")
        shutil.rmtree(copy)
    tally(f"forgeries: {tried} of {len(FORGERIES)} kinds, {tried - len(missed)} found")
    assert not missed


MOTIONS = {
    "at_rest_first": ("paris", ["run.t_end=300", "run.digits=20"]),
    "close_pair": ("close_pair", ["run.t_end=30", "run.digits=20"]),
    "grazing": (
        "close_pair", ["run.t_end=24", "run.grid_step=2", "run.digits=10", "release.vx=-0.0077460679307865453685"]),
    "conical": ("conical", ["run.t_end=20", "run.digits=20"]),
    "damped": ("damped", ["run.t_end=200", "run.digits=15"]),
    "spherical": ("spherical", ["run.t_end=60", "run.grid_step=20", "run.digits=12", "run.level=confirmed"]),
    "few_digits": ("paris", ["run.t_end=300", "run.digits=4", "run.level=self_consistent"]),
    "planar": ("meridian_plane", ["run.t_end=20", "run.digits=20"]),
    "resting": ("at_rest", ["run.t_end=600", "run.digits=20"]),
}  # fmt: skip


def numbered(rows):
    for k, row in enumerate(rows, 1):
        row[0] = str(k)


def kept(which):
    """Keep the transits of these places."""

    def change(rows, draw):
        rows[:] = [row for i, row in enumerate(rows) if which(i, len(rows), draw.random())]

    return change


def doubled(rows, draw):
    rows[:] = [list(row) for row in rows for _ in range(2)]


def turned(rows, draw):
    for row in rows:
        row[2] = "-1" if row[2] == "+1" else "+1"


def later(rows, draw):
    """From one unit of the last digit to a millisecond."""
    for row in rows:
        row[1] = moved(row[1], draw.choice((0, Fraction(1, 10**6), Fraction(1, 1000))))


def one_later(rows, draw):
    later([draw.choice(rows)] if rows else [], draw)


def invented(rows, draw):
    """A transit more, where the motion has none."""
    rows.append(list(rows[-1]) if rows else ["1", "1.5", "+1", "0.1", "0.1", "-1.0", "0.1", "0.1", "5.1e-09"])
    rows[-1][1] = moved(rows[-1][1], Fraction(draw.randrange(10, 200), 1000))


CHANGES = {
    "as it is": lambda rows, draw: None,
    "halved": kept(lambda i, count, x: i % 2),
    "one in four": kept(lambda i, count, x: i % 4 < 2),
    "first and last": kept(lambda i, count, x: i in (0, count - 1)),
    "first": kept(lambda i, count, x: i == 0),
    "some": kept(lambda i, count, x: x < 0.7),
    "none": kept(lambda i, count, x: False),
    "doubled": doubled, "turned": turned, "later": later, "one later": one_later, "invented": invented,
}  # fmt: skip


def around(times, width):
    """Intervals about some times, joined where they touch."""
    spans = []
    for t in times:
        if spans and t - width <= spans[-1][1]:
            spans[-1][1] = t + width
        else:
            spans.append([t - width, t + width])
    return spans


def intervals_of(kind, times, dropped, end, draw):
    """Return intervals, given the times of the transits, of those that were dropped, and the end of the run."""
    return {
        "none": lambda: [],
        "one without transits": lambda: [(end * Fraction(77, 100), end * Fraction(77, 100) + Fraction(1, 100))],
        "a narrow one without transits": lambda: [(end / 3, end / 3 + Fraction(1, 10**12))],
        "one with many": lambda: [(end / 10, end * Fraction(draw.randrange(2, 10), 10))],
        "one with all": lambda: [(Fraction(0), end)],
        "narrow ones over those dropped": lambda: around(dropped, Fraction(1, 10**9)),
        "wide ones over those dropped": lambda: around(dropped, Fraction(1, 100)),
        "narrow ones over all": lambda: around(times, Fraction(1, 10**6)),
        "one over the first": lambda: around(times[:1], Fraction(1, 100)),
    }[kind]()


INTERVALS = (
    "none", "one without transits", "a narrow one without transits", "one with many", "one with all",
    "narrow ones over those dropped", "wide ones over those dropped", "narrow ones over all", "one over the first",
)  # fmt: skip
FILES = ("transits.csv", "transits.binary64.csv")


def told(folder):
    """Return what a dataset says of its transits."""
    document, table = json.loads((folder / MANIFEST).read_text()), folder / "transits.csv"
    rows = table.read_text().splitlines()[1:] if table.exists() else []
    return rows, document["counts"], document["possible"]


def forge_transits(folder, change, intervals, without, draw):
    """Change the list of transits, and name intervals that seem to excuse it."""
    files, after = read_files(folder), []
    before = [row[1] for row in files.tables["transits.csv"].rows] if "transits.csv" in files.tables else []

    def transits(rows, header):
        CHANGES[change](rows, draw)
        numbered(rows)
        after.extend(row[1] for row in rows)

    def manifest(document):
        end = files.scene.exact.t_end
        times = [Fraction(t) for t in before]
        dropped = [t for t, text in zip(times, before, strict=True) if text not in after]
        spans = intervals_of(intervals, times, dropped, end, draw)
        parity = draw.choice(("odd", "even", "unknown", "unknown"))
        texts = [[fixed_decimal(min(max(t, Fraction(0)), end), 25) for t in span] for span in spans]
        document["possible"] = [{"from_s": low, "to_s": high, "parity": parity} for low, high in texts]
        document["counts"]["possible"] = len(spans)
        if document["transits"] == "complete" and spans:
            document["transits"] = "undecided intervals"
        if without == "and count":
            document["counts"]["transits"], document["bounds"]["transits"] = 0, {}
            document["bounds"]["transit_s"] = None
        if without == "another count":
            document["counts"]["transits"] += draw.choice((-1, 1))

    forge(
        folder,
        transits=transits if "transits.csv" in files.tables else None,
        manifest=manifest,
        without=FILES if without in ("without the file", "and count") else (),
    )


def test_no_forged_list_of_transits_passes_unless_the_line_says_that_it_was_not_decided(tmp_path, size, tally):
    draw, names = random.Random(31), size(["conical", "few_digits"], [*MOTIONS])
    sources = []
    for name in names:
        scene, changes = MOTIONS[name]
        sources.append(write(reference.solve(reference.load_scene(scene, changes)), tmp_path / name))
        assert verify(sources[-1]).problems == []
    tried = found = undecided = 0
    missed, cases = [], list(product(CHANGES, INTERVALS, sources))
    mostly = ["with the file"] * size(1, 6)
    for change, intervals, source in draw.sample(cases, size(16, 400)):
        without = draw.choice((*mostly, "without the file", "and count", "another count"))
        copy = Path(shutil.copytree(source, tmp_path / "copy"))
        forge_transits(copy, change, intervals, without, draw)
        if told(copy) != told(source):
            outcome = verify(copy)
            said = any("transits" in line or "the motion" in line for line in outcome.undecided)
            found += bool(outcome.problems)
            undecided += said
            tried += 1
            if not outcome.problems and not said:
                missed.append((source.name, change, intervals, without))
        shutil.rmtree(copy)
    tally(f"forged transits: {tried} of {len(names)} datasets, {found} found, {undecided} said not to be decided")
    assert not missed, "\n".join(map(str, missed))
