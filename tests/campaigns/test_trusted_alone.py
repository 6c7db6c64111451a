"""Trusted code alone refuses every false claim of a proved dataset, whatever erred between the proof and the files.

No other check runs here. What is false is decided by a solution of the same scene with many more digits.
"""

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
from reference.dataset.render import render
from reference.dataset.sheets import scene_inputs
from reference.enclosure.trusted.printed import check_dataset
from reference.numbers.precision import fixed_decimal
from reference.scenes.scene import parse_scene

RUN = {"t_end": "9", "grid_step": "3", "digits": 24, "level": "enclosed"}
SITE = {"rotation_rate": "0.0123", "equatorial_radius": "6371.1", "altitude": "12.5"}
PENDULUM = {"pendulum": {"length": "4.1"}, "site": SITE}
SCENES = {
    "plain": make_scene(release={"x": "0.3", "y": "0.41", "vx": "0.15", "vy": "0.02"}, run=RUN, **PENDULUM),
    "binary64": make_scene(
        inputs="binary64", release={"x": "0.3", "y": "0.41"}, run=RUN | {"grid_step": "0.9"}, **PENDULUM
    ),
    "damped": make_scene(
        pendulum={"length": "4.1", "drag": "0.31"}, site={"gravity_is": "effective", "rotation_rate": "0.01"}, run=RUN
    ),
    "angles": make_scene(
        release={"angle": "95.5", "azimuth": "12.7", "angle_rate": "3.3", "azimuth_rate": "20.1"},
        run=RUN | {"t_end": "6", "grid_step": "2"}, **PENDULUM,
    ),
}  # fmt: skip
FINER = {"digits": 70}
FIELDS = (
    "pendulum.length",
    "site.altitude",
    "site.rotation_rate",
    "site.equatorial_radius",
    "run.grid_step",
)
REFUSALS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


def ends_at_a_transit(far):
    """Return `plain` until a transit, solved far more finely, that its digits cannot tell from the end: possible."""
    late = -(-far.transits.exact("t")[-1] * 10**60 // 1)
    run = RUN | {"t_end": fixed_decimal(Fraction(late, 10**60), 60)}
    return make_scene(
        release=SCENES["plain"].release.model_dump(exclude_none=True), run=run, **PENDULUM
    )


def another_digit(rng, text):
    """Return a text with one digit changed, or one more."""
    k = rng.choice([k for k, c in enumerate(text) if c.isdigit()])
    return (
        text[: k + rng.randrange(2)] + str((int(text[k]) + rng.randint(1, 9)) % 10) + text[k + 1 :]
    )


# faults that change the solution


def another_scene(rng, solution):
    """The scene that was solved had another input."""
    parts = scene_inputs(solution.scene)
    field = rng.choice(
        [name for name in FIELDS if name.partition(".")[2] in parts[name.partition(".")[0]]]
    )
    section, name = field.split(".")
    value = Fraction(parts[section][name]) * (1 + Fraction(1, 10 ** rng.randint(3, 20)))
    return replace(
        solution, scene=solution.scene.with_values([f"{field}={fixed_decimal(value, 30)}"])
    )


def other_times(rng, solution):
    times = list(solution.times)
    times[rng.randrange(1, len(times))] += Fraction(1, 10 ** rng.randint(2, 24))
    return replace(solution, times=tuple(times))


def with_transits(solution, **changes):
    return replace(
        solution, zeros={**solution.zeros, "xdot": solution.zeros["xdot"]._replace(**changes)}
    )


def other_numbers(rng, solution):
    """What was proved is handed on with another number, row, direction or interval."""
    kind = rng.randrange(6)
    if kind == 4:
        return with_transits(solution, directions=[-way for way in solution.directions])
    if kind == 5:
        possible = () if solution.possible else ((Fraction(1), Fraction(2), "even"),)
        return with_transits(solution, possible=possible)
    name = rng.choice(("grid", "transits"))
    table = getattr(solution, name)
    rows, errors = [*table.values], [*table.errors]
    k = rng.randrange(1, len(rows))
    if kind == 0:
        row = list(rows[k])
        row[rng.randrange(len(row))] += (
            rng.choice((-1, 1)) * (1 << table.bits) // 10 ** rng.randint(2, 22)
        )
        rows[k] = tuple(row)
    elif kind == 1:
        rows[k], rows[k - 1] = rows[k - 1], rows[k]
    elif kind == 2:
        rows[k] = rows[k - 1]
    else:
        rows[k] = tuple(-value for value in rows[k])
    table = replace(table, values=rows, errors=errors)
    return replace(solution, grid=table) if name == "grid" else with_transits(solution, table=table)


# faults that change the texts


def other_table(rng, texts):
    name, kind = rng.choice(("grid.csv", "transits.csv")), rng.randrange(8)
    header, *rows = [line.split(",") for line in texts[name].splitlines()]
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
    return texts | {name: "".join(",".join(row) + "\n" for row in (header, *rows))}


def other_page(rng, texts):
    kind = rng.randrange(4)
    lines = texts["certified.txt"].split("\n")
    begin, end, stop = (
        next(k for k, line in enumerate(lines) if line.startswith(word))
        for word in ("Inputs (", "Model", "How to")
    )
    places = [
        k
        for k in (*range(begin + 1, end), *range(end + 2, stop))
        if any(map(str.isdigit, lines[k]))
    ]
    k, j = rng.sample(places, 2)
    if kind < 2:
        lines[k] = another_digit(rng, lines[k])
    elif kind == 2:
        lines[k], lines[j] = lines[j], lines[k]
    else:
        del lines[k]
    return texts | {"certified.txt": "\n".join(lines)}


def other_manifest(rng, texts):
    document, kind = json.loads(texts["manifest.json"]), rng.randrange(6)
    bounds = document["bounds"]
    if kind == 0:
        document["possible"] = []
        document["counts"]["possible"] = 0
    elif kind == 1:
        document["transits"] = rng.choice(("complete", "xdot is identically zero"))
    elif kind == 2:
        of = rng.choice(("grid", "transits"))
        bounds[of] = {
            name: "1e-40" if rng.random() < 0.3 else bound for name, bound in bounds[of].items()
        }
    elif kind == 3:
        bounds[rng.choice(("position_m", "velocity_m_s", "transit_s"))] = "1e-40"
    elif kind == 4:
        document["inputs"] = "binary64" if document["inputs"] == "decimal" else "decimal"
    else:
        part = rng.choice(("pendulum", "site", "release", "run"))
        numbers = [
            name
            for name, text in document["scene"][part].items()
            if text[-1].isdigit() and name != "digits"
        ]
        name = rng.choice(numbers)
        document["scene"][part][name] = another_digit(rng, document["scene"][part][name])
    return texts | {"manifest.json": json.dumps(document, indent=1, ensure_ascii=False) + "\n"}


OF_SOLUTION = (another_scene, other_times, other_numbers)
OF_TEXTS = (other_table, other_page, other_manifest)
FAULTS = (*OF_SOLUTION, *OF_TEXTS)


# what is false


def rows_of(text):
    header, *lines = text.splitlines()
    return [dict(zip(header.split(","), line.split(","), strict=True)) for line in lines]


def off(text, truth, bound=None):
    """Whether a number is farther from the truth, which has many more digits, than half its last digit or a bound."""
    half, fine = (Fraction(1, 2 * 10 ** len(number.partition(".")[2])) for number in (text, truth))
    distance = abs(Fraction(text) - Fraction(truth))
    return distance > half + fine or (bound is not None and distance > Fraction(bound) + fine)


def told(manifest):
    """Return the exact inputs that a manifest tells of."""
    return parse_scene({"id": "told", "inputs": manifest["inputs"], **manifest["scene"]}).exact


def false_claims(scene, fine, texts):
    """Return what a dataset states wrongly of its scene, given the files of one with far more digits."""
    manifest, bounds, found = (
        json.loads(texts["manifest.json"]),
        json.loads(texts["manifest.json"])["bounds"],
        [],
    )
    found += ["the scene"] * (told(manifest) != scene.exact)
    grid, transits = rows_of(texts["grid.csv"]), rows_of(texts["transits.csv"])
    kinds = {"x": "position_m", "y": "position_m", "z": "position_m"}
    for row, true in zip(grid, rows_of(fine["grid.csv"]), strict=True):
        found += [f"t = {row['t']}"] * (Fraction(row["t"]) != Fraction(true["t"]))
        for name in true.keys() - {"t"}:
            for bound in (bounds["grid"][name], bounds[kinds.get(name, "velocity_m_s")]):
                found += [f"{name} at {row['t']}"] * off(row[name], true[name], bound)
    possible = [(Fraction(p["from_s"]), Fraction(p["to_s"])) for p in manifest["possible"]]
    zeros = rows_of(fine["transits.csv"])
    single = [
        z for z in zeros if not any(low <= Fraction(z["t"]) <= high for low, high in possible)
    ]
    found += ["transits"] * ((manifest["transits"] == "complete") != (not possible))
    found += ["counts"] * (
        manifest["counts"]
        != {"grid": len(grid), "transits": len(single), "possible": len(possible)}
    )
    for row, true in zip(transits, single, strict=True):
        found += [f"direction of {row['k']}"] * (row["direction"] != true["direction"])
        for name in ("x", "y", "z", "vy", "ax"):
            found += [f"{name} of {row['k']}"] * off(
                row[name], true[name], bounds["transits"][name]
            )
        for bound in (row["bound"], bounds["transits"]["t"], bounds["transit_s"]):
            found += [f"t of {row['k']}"] * (
                abs(Fraction(row["t"]) - Fraction(true["t"])) > Fraction(bound)
            )
    words = texts["certified.txt"].replace(",", " ").split()
    said = [
        *manifest["scene"]["site"].values(),
        *grid[-1].values(),
        *grid[0].values(),
        *bounds["grid"].values(),
        str(len(transits)),
    ]
    said += [
        cell
        for row in transits[:1] + transits[-1:]
        for cell in (row["t"], row["direction"], row["bound"])
    ]
    return found + [f"{word} is not on the page" for word in said if word not in words]


@pytest.fixture(scope="module")
def honest(pytestconfig):
    """Return scenes, their solutions, and the files of finer ones."""
    far = reference.solve(SCENES["plain"], **FINER)
    chosen = {**SCENES, "possible": ends_at_a_transit(far)}
    if not pytestconfig.getoption("--long"):
        chosen = {name: chosen[name] for name in ("plain", "possible")}
    made = {}
    for name, scene in chosen.items():
        fine = far if name == "plain" else reference.solve(scene, **FINER)
        made[name] = scene, reference.solve(scene), render(fine)
    return made


def test_what_is_right_is_accepted_and_no_claim_of_it_is_false(honest):
    for name, (scene, solution, fine) in honest.items():
        texts = render(solution)
        check_dataset(texts, solution.proof.enclosure.proved)
        assert false_claims(scene, fine, texts) == []
        assert (name == "possible") == bool(solution.possible)


def attempt(seed, honest):
    """Make the files of a solution with one fault; return what trusted code says, and whether a claim is false."""
    rng, fault = Random(seed), FAULTS[seed % len(FAULTS)]
    scene, solution, fine = honest[rng.choice(list(honest))]
    try:
        texts = (
            render(fault(rng, solution)) if fault in OF_SOLUTION else fault(rng, render(solution))
        )
    except (reference.FoucaultError, *REFUSALS):
        return fault.__name__, "not even laid out", False
    try:
        check_dataset(texts, solution.proof.enclosure.proved)
        became = "accepted"
    except REFUSALS:
        became = "refused"
    try:
        false = bool(false_claims(scene, fine, texts))
    except (
        KeyError,
        ValueError,
        reference.FoucaultError,
    ):  # other rows, columns or words than a table has
        false = True
    return fault.__name__, became, false


def test_no_false_claim_is_accepted_and_each_kind_of_fault_makes_some(honest, size, tally):
    outcomes = Counter(attempt(seed, honest) for seed in range(size(30, 600)))
    for fault, became, false in sorted(outcomes):
        tally(
            f"{fault}: {became}, {'false' if false else 'right'}: {outcomes[fault, became, false]}"
        )
    assert not [fault for fault, became, false in outcomes if became == "accepted" and false]
    assert {fault for fault, became, false in outcomes if became == "refused" and false} == {
        fault.__name__ for fault in FAULTS
    }
