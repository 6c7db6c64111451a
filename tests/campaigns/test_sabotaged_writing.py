"""Faults anywhere between a scene and the files of its proof, all untrusted checks switched off: none is written."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest
from small_scenes import make_scene

pytest.importorskip("flint")

import reference
from reference import enclosure
from reference.dataset import render as rendering
from reference.dataset import write as writer
from reference.dataset.sheets import scene_inputs
from reference.enclosure import Interval
from reference.errors import FoucaultError
from reference.numbers.precision import fixed_decimal
from reference.scenes.inputs import Inputs
from reference.scenes.scene import Scene

RUN = {"t_end": "9", "grid_step": "3", "digits": 24, "level": "enclosed"}
SITE = {"rotation_rate": "0.0123", "equatorial_radius": "6371.1", "altitude": "12.5"}
PENDULUM = {"pendulum": {"length": "4.1"}, "site": SITE}
OFTEN = RUN | {"grid_step": "0.9"}
SCENES = {
    "plain": make_scene(release={"x": "0.3", "y": "0.41", "vx": "0.15", "vy": "0.02"}, run=RUN, **PENDULUM),
    "binary64": make_scene(inputs="binary64", release={"x": "0.3", "y": "0.41"}, run=OFTEN, **PENDULUM),
    "damped": make_scene(
        pendulum={"length": "4.1", "drag": "0.31"}, site={"gravity_is": "effective", "rotation_rate": "0.01"}, run=RUN
    ),
    "angles": make_scene(
        release={"angle": "95.5", "azimuth": "12.7", "angle_rate": "3.3", "azimuth_rate": "20.1"},
        run=RUN | {"t_end": "6", "grid_step": "2"}, **PENDULUM,
    ),
}  # fmt: skip
FINER = {"digits": 70}


def ends_at_a_transit(far):
    """`plain`, solved far more finely, until a transit that its digits cannot tell from the end: it is possible."""
    late = -(-far.transits.exact("t")[-1] * 10**60 // 1)
    run = RUN | {"t_end": fixed_decimal(Fraction(late, 10**60), 60)}
    return make_scene(release=SCENES["plain"].release.model_dump(exclude_none=True), run=run, **PENDULUM)


def tiny(rng):
    return Fraction(rng.choice((-1, 1)), 10 ** rng.randint(2, 24))


def wrong_inputs(mp, rng):
    honest, by, kind = Scene.exact.fget, tiny(rng), rng.randrange(5)
    name = rng.choice([name for name in Inputs.__annotations__ if name not in ("position", "angles", "gravity_is")])

    def exact(self):
        inputs = honest(self)
        release = "angles" if inputs.position is None else "position"
        start = list(getattr(inputs, release))
        if kind == 0:
            start[rng.randrange(4)] += by
        elif kind == 1:
            start[2:] = start[:1:-1]
        elif kind == 2:
            other = {"effective": "ellipsoid", "ellipsoid": "effective"}[inputs.gravity_is]
            return replace(inputs, gravity_is=other)
        else:
            value = getattr(inputs, name)
            return replace(inputs, **{name: abs(value + by) if kind == 3 else Fraction(float(value))})
        return replace(inputs, **{release: tuple(start)})

    rng = Random(rng.random())
    mp.setattr(Scene, "exact", property(exact))


def wrong_times(mp, rng):
    honest, by, kind, place = Inputs.grid.fget, abs(tiny(rng)), rng.randrange(3), rng.random()

    def grid(self):
        times = honest(self)
        k = 1 + int(place * (len(times) - 2))
        return [*times[:k], *([times[k] + by] if kind else []), *times[k + 1 :]]

    mp.setattr(Inputs, "grid", property(grid))


def moved(interval, by):
    return Interval(interval.low + by, interval.high + by)


def wrong_hand_over(mp, rng):
    by, kind, honest = tiny(rng), rng.randrange(9), enclosure.enclose

    def handed_on(*words, **options):
        enclosed = honest(*words, **options)
        p, zeros = enclosed.proved, list(enclosed.proved.transits)
        k, j = rng.randrange(len(zeros)), rng.randrange(1, len(p.states))
        states = [list(state) for state in p.states]
        name = rng.choice(("t", "x", "y", "z", "vy", "ax"))
        if kind == 0:
            states[j][rng.randrange(6)] = moved(states[j][0], by)
        elif kind == 1:
            states[j] = [moved(x, by) for x in states[j]]
        elif kind == 2:
            states[j], states[0] = states[0], states[j]
        change = {
            3: lambda: zeros.pop(k),
            4: lambda: zeros.insert(k, zeros[k]),
            5: lambda: zeros.__setitem__(k, replace(zeros[k], direction=-zeros[k].direction)),
            6: lambda: zeros.__setitem__(k, replace(zeros[k], **{name: moved(getattr(zeros[k], name), by)})),
            7: lambda: zeros.__setitem__(slice(None), [z for z in zeros if z.parity == "one"]),
            8: lambda: zeros.__setitem__(slice(None), [replace(z, t=moved(z.t, by)) for z in zeros]),
        }
        change.get(kind, int)()
        return replace(enclosed, proved=replace(p, states=tuple(map(tuple, states)), transits=tuple(zeros)))

    mp.setattr(enclosure, "enclose", handed_on)


def another_digit(rng, text):
    """A text with one digit changed, or one more."""
    k = rng.choice([k for k, c in enumerate(text) if c.isdigit()])
    return text[: k + rng.randrange(2)] + str((int(text[k]) + rng.randint(1, 9)) % 10) + text[k + 1 :]


def wrong_table(mp, rng):
    name, kind = rng.choice(("grid_sheet", "transits_sheet")), rng.randrange(8)
    honest = getattr(rendering, name)

    def sheet(solution):
        made = honest(solution)
        rows, header = [list(row) for row in made.rows], list(made.header)
        k, j = rng.randrange(len(rows)), rng.randrange(1, len(header))
        if kind < 3:
            rows[k][j] = another_digit(rng, rows[k][j])
        elif kind == 3:
            rows[k][j], rows[k][j - 1] = rows[k][j - 1], rows[k][j]
        elif kind == 4:
            del rows[k]
        elif kind == 5:
            rows[k], rows[0] = rows[0], rows[k]
        elif kind == 6:
            header[j], header[j - 1] = header[j - 1], header[j]
        else:
            rows[k][j] = rows[k][j].lstrip("-") if rows[k][j].startswith("-") else rows[k][j] + "0"
        return replace(made, rows=[tuple(row) for row in rows], header=tuple(header))

    mp.setattr(rendering, name, sheet)


def wrong_page(mp, rng):
    honest, kind = rendering.certified_page, rng.randrange(4)

    def page(*words):
        lines = honest(*words).split("\n")
        begin, end, stop = (
            next(k for k, line in enumerate(lines) if line.startswith(word)) for word in ("Inputs (", "Model", "How to")
        )
        places = [k for k in (*range(begin + 1, end), *range(end + 2, stop)) if any(map(str.isdigit, lines[k]))]
        k, j = rng.sample(places, 2)
        if kind < 2:
            lines[k] = another_digit(rng, lines[k])
        elif kind == 2:
            lines[k], lines[j] = lines[j], lines[k]
        else:
            del lines[k]
        return "\n".join(lines)

    mp.setattr(rendering, "certified_page", page)


def wrong_manifest(mp, rng):
    honest, kind, by = rendering.manifest_of, rng.randrange(7), abs(tiny(rng))

    def manifest_of(solution, *words, **named):
        if kind == 0:
            return honest(replace(solution, possible=()), *words, **named)
        if kind == 1:
            odd = tuple((low, max(low, high - by), "even") for low, high, _ in solution.possible)
            return honest(replace(solution, possible=odd), *words, **named)
        made = honest(solution, *words, **named)
        if kind == 2:
            return made.model_copy(update={"transits": rng.choice(("complete", "xdot is identically zero"))})
        if kind == 3:
            of = rng.choice(("grid", "transits"))
            bounds = {name: "1e-40" if rng.random() < 0.3 else x for name, x in getattr(made.bounds, of).items()}
            return made.model_copy(update={"bounds": made.bounds.model_copy(update={of: bounds})})
        if kind == 4:
            name = rng.choice(("position_m", "velocity_m_s", "transit_s"))
            return made.model_copy(update={"bounds": made.bounds.model_copy(update={name: "1e-40"})})
        scene = {part: dict(table) for part, table in made.scene.items()}
        part = rng.choice(("pendulum", "site", "release", "run"))
        name = rng.choice([n for n, text in scene[part].items() if text[-1].isdigit() and n != "digits"])
        scene[part][name] = another_digit(rng, scene[part][name])
        return made.model_copy(update={"scene": scene} if kind < 6 else {"inputs": "binary64"})

    mp.setattr(rendering, "manifest_of", manifest_of)


def late(mp, rng):
    honest, name = writer.render, rng.choice(("grid.csv", "transits.csv", "certified.txt", "manifest.json"))

    def edited(*words, **named):
        texts = honest(*words, **named)
        begin = texts[name].index("Certified") if name == "certified.txt" else 0
        end = texts[name].index("How to score") if name == "certified.txt" else len(texts[name])
        end = texts[name].index('"decimals"') if name == "manifest.json" else end
        return texts | {name: texts[name][:begin] + another_digit(rng, texts[name][begin:end]) + texts[name][end:]}

    mp.setattr(writer, "render", edited)


FAULTS = (wrong_inputs, wrong_times, wrong_hand_over, wrong_table, wrong_page, wrong_manifest, late)
SOLVED_AGAIN = FAULTS[:3]


def rows_of(text):
    header, *lines = text.splitlines()
    return [dict(zip(header.split(","), line.split(","), strict=True)) for line in lines]


def off(text, truth, bound=None):
    """Whether a number is farther from the truth, which has many more digits, than half its last digit or a bound."""
    half, fine = (Fraction(1, 2 * 10 ** len(number.partition(".")[2])) for number in (text, truth))
    distance = abs(Fraction(text) - Fraction(truth))
    return distance > half + fine or (bound is not None and distance > Fraction(bound) + fine)


def false_claims(scene, fine, folder):
    """What a written dataset states wrongly of its scene, given the tables of one with far more digits."""
    texts = {path.name: path.read_text() for path in folder.iterdir()}
    manifest, bounds, found = json.loads(texts["manifest.json"]), json.loads(texts["manifest.json"])["bounds"], []
    if (manifest["scene"], manifest["inputs"]) != (scene_inputs(scene), scene.inputs):
        found.append("the scene")
    grid, transits = rows_of(texts["grid.csv"]), rows_of(texts["transits.csv"])
    kinds = {"x": "position_m", "y": "position_m", "z": "position_m"}
    for row, true in zip(grid, rows_of(fine["grid.csv"]), strict=True):
        found += [f"t = {row['t']}"] * (Fraction(row["t"]) != Fraction(true["t"]))
        for name in true.keys() - {"t"}:
            for bound in (bounds["grid"][name], bounds[kinds.get(name, "velocity_m_s")]):
                found += [f"{name} at {row['t']}"] * off(row[name], true[name], bound)
    possible = [(Fraction(p["from_s"]), Fraction(p["to_s"])) for p in manifest["possible"]]
    zeros = rows_of(fine["transits.csv"])
    single = [z for z in zeros if not any(low <= Fraction(z["t"]) <= high for low, high in possible)]
    found += ["transits"] * ((manifest["transits"] == "complete") != (not possible))
    found += ["counts"] * (
        manifest["counts"] != {"grid": len(grid), "transits": len(single), "possible": len(possible)}
    )
    for row, true in zip(transits, single, strict=True):
        found += [f"direction of {row['k']}"] * (row["direction"] != true["direction"])
        for name in ("x", "y", "z", "vy", "ax"):
            found += [f"{name} of {row['k']}"] * off(row[name], true[name], bounds["transits"][name])
        for bound in (row["bound"], bounds["transits"]["t"], bounds["transit_s"]):
            found += [f"t of {row['k']}"] * (abs(Fraction(row["t"]) - Fraction(true["t"])) > Fraction(bound))
    words = texts["certified.txt"].replace(",", " ").split()
    said = [
        *manifest["scene"]["site"].values(),
        *grid[-1].values(),
        *grid[0].values(),
        *bounds["grid"].values(),
        str(len(transits)),
    ]
    said += [cell for row in transits[:1] + transits[-1:] for cell in (row["t"], row["direction"], row["bound"])]
    return found + [f"{word} is not on the page" for word in said if word not in words]


@pytest.fixture(scope="module")
def honest(pytestconfig):
    far = reference.solve(SCENES["plain"], **FINER)
    chosen = {**SCENES, "possible": ends_at_a_transit(far)}
    if not pytestconfig.getoption("--long"):
        chosen = {name: chosen[name] for name in ("plain", "possible")}
    made = {}
    for name, scene in chosen.items():
        fine = far if name == "plain" else reference.solve(scene, **FINER)
        made[name] = scene, reference.solve(scene), rendering.render(fine)
    return made


def test_what_is_written_is_right(honest, tmp_path):
    for name, (scene, solution, fine) in honest.items():
        assert false_claims(scene, fine, reference.write(solution, tmp_path / name)) == []
        assert (name == "possible") == bool(solution.possible)


def attempt(seed, honest, folder, trusted=True):
    """Write with one fault; return its name and what became of it."""
    rng, fault = Random(seed), FAULTS[seed % len(FAULTS)]
    scene, solution, fine = honest[rng.choice(list(honest))]
    with pytest.MonkeyPatch.context() as mp:
        mp.setattr(writer, "problems_of", lambda _: [])
        mp.setattr("reference.solver.proving.checked_states", lambda grid, _, other: grid.distance(other.grid))
        mp.setattr("reference.solver.enclosed.guarded", lambda solved, _: solved)
        if not trusted:
            mp.setattr(writer, "check_proved", lambda *_: None)
        fault(mp, rng)
        try:
            reference.write(reference.solve(scene) if fault in SOLVED_AGAIN else solution, folder)
        except (FoucaultError, ArithmeticError, LookupError, ValueError, TypeError) as error:
            assert not folder.exists()
            return fault.__name__, "refused" if isinstance(error, FoucaultError) else "ended in an error"
    try:
        return fault.__name__, "FALSE" if false_claims(scene, fine, folder) else "written, right"
    except (KeyError, ValueError):  # other rows, columns or words than a table has
        return fault.__name__, "FALSE"


def test_no_fault_between_the_scene_and_its_files_is_written(honest, tmp_path, size, tally):
    outcomes = Counter(attempt(seed, honest, tmp_path / str(seed)) for seed in range(size(14, 301)))
    for fault, outcome in sorted(outcomes):
        tally(f"sabotaged writing, {fault}: {outcome} {outcomes[fault, outcome]}")
    assert "FALSE" not in {outcome for _, outcome in outcomes}


def test_without_trusted_code_every_kind_of_fault_is_written(honest, tmp_path):
    outcomes = {attempt(seed, honest, tmp_path / str(seed), trusted=False) for seed in range(14)}
    assert {fault for fault, outcome in outcomes if outcome == "FALSE"} == {fault.__name__ for fault in FAULTS}
