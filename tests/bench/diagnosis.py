"""What the diagnosis says of drawn files: python tests/bench/diagnosis.py CORPUS SEED COUNT [--out FILE] [--ulp].

Each corpus draws files whose true causes are known, from a seed. A line of JSON is written for each, and a summary at
the end: how many are identified, how many as "either … or …", how many get no cause, and every false claim. With --ulp
each number of a file is moved to a neighbouring double, or not: the text should be the same.
"""

# ruff: noqa: E501

from __future__ import annotations

import argparse
import itertools
import json
import math
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests/helpers")]

import wild_programs  # noqa: E402
from adaptive import drawn_loose  # noqa: E402
from loops import LANGUAGES, drawn_loop  # noqa: E402
from mistakes import case, one_word_for_one_motion, told  # noqa: E402

from reference import Scene, load_scene, trajectory  # noqa: E402

Columns = dict[str, np.ndarray]
ULP = "--ulp" in sys.argv
# the same motion, or words for one habit
ONE = {"effective_gravity": "no_centrifugal", "uniform_gravity": "no_centrifugal"}


@dataclass
class Specimen:
    """A file whose causes are known.

    Attributes:
        id: of it in its corpus.
        scene: that it should solve.
        times: in s, as printed.
        columns: as printed.
        allowed_m: distance in m that counts as agreement; None for the usual one.
        true: words that are true of it.
        needed: words that have to be said for it to be identified.
    """

    id: str
    scene: Scene
    times: np.ndarray
    columns: Columns
    allowed_m: float | None
    true: set[str]
    needed: set[str]


def right_rows(scene: Scene, times: np.ndarray) -> Columns:
    """Return what a right program prints."""
    return dict(
        zip("xyz", (column.copy() for column in trajectory(scene, times).T[:3]), strict=True)
    )


def drawn_scene(draw: random.Random, t_end: float) -> Scene:
    """Return paris, or a pendulum elsewhere, as long as a file."""
    length = draw.choice((67.0, 67.0, 20.0, 5.0, 2.0))
    reach = length * draw.uniform(0.005, 0.06)
    azimuth = draw.uniform(0.2, 1.3)
    latitude = draw.choice((48.846111, 48.846111, 35.5, -33.0))
    fields = [
        f"pendulum.length={length}",
        f"site.latitude={latitude}",
        f"release.x={reach * math.cos(azimuth):.4f}",
        f"release.y={reach * math.sin(azimuth):.4f}",
    ]
    return load_scene(
        "paris", [*fields, f"run.t_end={t_end!r}", "run.transits=false", "inputs=binary64"]
    )


CLOCKS = (
    1.0001,
    0.9999,
    1.001,
    30 / 29.97,
    29.97 / 30,
    86400 / 86164.1,
    86164.1 / 86400,
    0.999,
    1.01,
    1.0005,
)


def clocks(draw: random.Random, count: int) -> Iterator[Specimen]:
    """Yield right files whose times are multiplied by a factor."""
    for number in range(count):
        rows = draw.randrange(121, 1802)
        factor = draw.choice(CLOCKS)
        if draw.random() < 0.6:
            factor = 1 + draw.choice((-1, 1)) * 10 ** draw.uniform(-5, -1.5)
            factor = float(f"{factor:.{draw.randrange(3, 12)}g}")
        if factor == 1:
            factor = 1.0001
        times = np.arange(float(rows))
        scene = drawn_scene(draw, 1.1 * rows)
        columns = right_rows(scene, times)
        if draw.random() < 0.5:
            del columns["z"]
        true = {"clock"}
        if abs(abs(factor - 1) * rows - 1) < 0.02:
            true.add("linspace_clock")
        yield Specimen(
            f"clock-{number}-{factor:.10g}", scene, times * factor, columns, None, true, true
        )


def late(column: np.ndarray) -> np.ndarray:
    """Return a column one row late."""
    return np.concatenate([column[:1], column[:-1]])


def turned(q: Columns, angle: float) -> Columns:
    """Return x and y in axes turned by an angle."""
    cos, sin = math.cos(angle), math.sin(angle)
    return q | {"x": cos * q["x"] - sin * q["y"], "y": sin * q["x"] + cos * q["y"]}


Change = Callable[[Columns, random.Random], Columns]
WRONG_COLUMNS: tuple[tuple[str, Change, set[str]], ...] = (
    ("y_is_x", lambda q, _: q | {"y": q["x"]}, {"column_copied"}),
    ("x_is_y", lambda q, _: q | {"x": q["y"]}, {"column_copied"}),
    ("y_is_-x", lambda q, _: q | {"y": -q["x"]}, {"column_copied"}),
    ("y_is_0", lambda q, _: q | {"y": 0 * q["y"]}, {"column_constant"}),
    ("x_is_0", lambda q, _: q | {"x": 0 * q["x"]}, {"column_constant"}),
    ("z_is_0", lambda q, _: q | {"z": 0 * q["z"]}, {"column_constant", "z_constant"}),
    ("y_mirrored", lambda q, _: q | {"y": -q["y"]}, {"y_south", "column_mirrored"}),
    ("x_mirrored", lambda q, _: q | {"x": -q["x"]}, {"x_west", "column_mirrored"}),
    ("y_scaled", lambda q, r: q | {"y": r.choice((4 / 3, 0.7, 1.02, 0.999)) * q["y"]}, {"column_scaled"}),
    ("x_scaled", lambda q, r: q | {"x": round(r.uniform(0.5, 1.5), 3) * q["x"]}, {"column_scaled"}),
    ("both_scaled", lambda q, r: (s := r.choice((2, 0.5, 1.02, 1.1))) and q | {"x": s * q["x"], "y": s * q["y"]}, {"plane_scaled", "unit_of_length"}),
    ("moved", lambda q, r: q | {"x": q["x"] + round(r.uniform(0.1, 1), 2), "y": q["y"] + round(r.uniform(-1, 1), 2)}, {"plane_moved", "column_moved"}),
    ("y_moved", lambda q, r: q | {"y": q["y"] + round(r.uniform(0.05, 0.5), 4)}, {"column_moved", "plane_moved"}),
    ("turned", lambda q, r: turned(q, r.choice((0.3, math.pi / 4, math.pi / 6, -0.1, 1.0))), {"plane_turned"}),
    ("z_height", lambda q, r: q | {"z": q["z"] + r.choice((3.0, 1000.0, 1.5, -0.2))}, {"z_offset", "column_moved"}),
    ("y_late", lambda q, _: q | {"y": late(q["y"])}, {"column_late"}),
    ("x_late", lambda q, _: q | {"x": late(q["x"])}, {"column_late"}),
    ("z_is_x", lambda q, _: q | {"z": q["x"]}, {"column_copied"}),
)  # fmt: skip


def columns(draw: random.Random, count: int) -> Iterator[Specimen]:
    """Yield right files of which a column, or the axes, are printed wrongly."""
    for number in range(count):
        span = draw.choice((120.0, 600.0, 3600.0))
        name, change, words = draw.choice(WRONG_COLUMNS)
        rows = draw.choice((121, 241, 361))
        scene = drawn_scene(draw, span)
        times = np.linspace(0, span, rows)
        q = right_rows(scene, times)
        if not name.startswith("z") and draw.random() < 0.5:
            del q["z"]
        yield Specimen(
            f"{name}-{number}-{span:.0f}", scene, times, change(q, draw), None, words, words
        )


def loops(draw: random.Random, count: int) -> Iterator[Specimen]:
    """Yield what loops print that people write, in four languages."""
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            language = LANGUAGES[number % len(LANGUAGES)]
            loop = drawn_loop(draw, language)
            times, rows = loop.rows(Path(folder))
            yield Specimen(
                f"{language}-{loop.name}-{number}",
                loop.scene,
                times,
                rows,
                None,
                loop.true,
                loop.needed,
            )


def loose(draw: random.Random, count: int) -> Iterator[Specimen]:
    """Yield what programs print that leave their steps to a solver at a loose tolerance."""
    for number in range(count):
        made = drawn_loose(draw)
        yield Specimen(
            f"{number}-{made.name}", made.scene, made.times, made.rows(), None, made.true, made.true
        )


def generated(
    program: Path, seed: int, numbers: range, most: int = 3
) -> Iterator[tuple[str, Any, Any]]:
    """Yield programs with mistakes, and what they print."""
    for number in numbers:
        made = case(number, seed, most)
        times, q = made.rows(program)
        if all(np.isfinite(column).all() for column in q.values()):  # explicit Euler may blow up
            yield f"{seed}-{number}", made, (times, q)


def alternatives(explanation: Any) -> list[list[str]]:
    """Return the words of each "either … or …"."""
    if explanation is None:
        return []
    return [part.id.split("|") for part in explanation.causes if "|" in part.id]


def nudged(columns: Columns) -> Columns:
    """Return columns of which each number is the same, or one of its two neighbours."""
    draw = np.random.default_rng(1)
    return {
        name: column + draw.integers(-1, 2, len(column)) * np.spacing(column)
        for name, column in columns.items()
    }


def record(
    name: str,
    scene: Scene,
    times: np.ndarray,
    q: Columns,
    allowed_m: float | None,
    true: set[str],
    needed: set[str],
    wrong_of: Callable[[set[str]], set[str]] | None = None,
) -> dict[str, Any]:
    """Return what is said of a file, and how true it is."""
    begun = time.process_time()
    if ULP:
        q = nudged(q)
    if allowed_m is None:
        x, y = (float(v) for v in scene.exact.position[:2])
        allowed_m = 1e-6 * math.hypot(x, y)
    found = told(scene, times, q, allowed_m)
    spent = time.process_time() - begun
    explanation = found.explanation
    words = {word for word in found.words if "|" not in word}
    slipped = explanation is not None and re.search("accelerations|formula", explanation.slip)
    words |= {"slip"} if slipped else set()
    either = [
        [word for word in each for word in word.split("+")] for each in alternatives(explanation)
    ]
    same = {ONE.get(word, word) for word in true}
    if wrong_of is not None:
        same |= one_word_for_one_motion(true)
    said = {ONE.get(word, word) for word in words}
    said = {"site.gravity" if word.startswith("gravity_") else word for word in said}
    if wrong_of is None:
        wrong = (
            said
            - same
            - {"decimals", "digits", "single_precision", "off_the_sphere", "stretched_cord", "slip"}
        )
        wrong -= {"integrator_loose"} if any(w.startswith("integrator") for w in same) else set()
    else:
        wrong = wrong_of(words)
    if "z_down" in true:
        wrong -= {"column_mirrored"}  # the same, said of the column
    wrong |= {
        "|".join(each)
        for each in either
        if not {ONE.get(w, w) for w in each} & same
        and not ("integrator_loose" in each and any(w.startswith("integrator") for w in same))
    }
    loose = {w for w in needed if w.startswith("integrator")}
    covered = said | {ONE.get(w, w) for each in either for w in each}
    covered |= {"site.gravity"} if any("gravity_" in w for each in either for w in each) else set()
    if wrong_of is not None:
        covered = one_word_for_one_motion(covered)
        said = one_word_for_one_motion(said)
        required = one_word_for_one_motion(needed)
    else:
        required = {ONE.get(w, w) for w in needed}
    # of a right file whose column is wrong, one of several words is enough
    whole = bool(required & said) if wrong_of is None and not loose else required <= said
    part = bool(required & said)
    hedged = bool(required & covered) if wrong_of is None and not loose else required <= covered
    grade = (
        "agrees"
        if found.agrees
        else "whole"
        if whole and required
        else "either"
        if hedged and required
        else "part"
        if part
        else "silent"
    )
    lines = [] if explanation is None else list(explanation.lines())
    return {"id": name, "true": sorted(true), "said": sorted(words), "either": either, "wrong": sorted(wrong), "grade": grade,
            "named": len(required & said), "covered": len(required & covered), "of": len(required), "text": lines, "cpu_s": round(spent, 3)}  # fmt: skip


def records(corpus: str, seed: int, count: int) -> Iterator[dict[str, Any]]:
    """Yield what is said of the files of a corpus."""
    draw = random.Random(f"{corpus}-{seed}")
    simple = {"clocks": clocks, "columns": columns, "loops": loops, "loose": loose}
    if corpus in simple:
        for one in simple[corpus](draw, count):
            yield record(
                one.id, one.scene, one.times, one.columns, one.allowed_m, one.true, one.needed
            )
        return
    if corpus == "wild":
        for name in itertools.islice(wild_programs.TRUE, count):
            yield wild(name)
        return
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "mistaken"
        source = ROOT / "tests/helpers/mistaken.c"
        compiler = shutil.which("cc")
        assert compiler is not None
        subprocess.run([compiler, "-O2", "-o", str(program), str(source), "-lm"], check=True)
        if corpus == "advice":
            for number in range(count):
                yield advised(f"{seed}-{number}", case(number, seed), program)
            return
        most = 3 if corpus == "generated" else 0
        for name, made, (times, q) in generated(program, seed, range(count), most):
            if corpus == "smooth":
                scale = 10 ** made.rng.uniform(-5, -1) * made.allowed_m * 1e6
                for column in q:
                    rates = made.rng.uniform(0.05, 3, 6) * 2 * np.pi / made.period
                    waves = np.sin(times[:, None] * rates + made.rng.uniform(0, 6, 6)).sum(axis=1)
                    q[column] = q[column] + scale * waves / 6
            yield record(
                name,
                made.scene,
                times,
                q,
                made.allowed_m,
                made.true,
                made.matters(program),
                made.wrong,
            )


def advised(name: str, made: Any, program: Path) -> dict[str, Any]:
    """Return how a program is corrected as it is told, until it agrees or no word is of use.

    What is certain is corrected first, then what is one of several, then what its motion is like.
    """
    told_each_time: list[list[str]] = []
    text: list[str] = []
    begun = time.process_time()
    grade = "stuck"
    while grade == "stuck":
        found = made.told(*made.rows(program))
        if found.agrees:
            grade = "agrees"
            break
        causes = found.explanation.causes if found.explanation else ()
        like = {cause.id.removeprefix("as_if.") for cause in causes}
        orders = (found.words, found.alternatives, like)
        tried = [made.without(words) for words in orders]
        mended = next((each for each in tried if len(each.parts) < len(made.parts)), None)
        told_each_time.append(sorted(found.words | found.alternatives | like))
        text = [] if found.explanation is None else list(found.explanation.lines())
        if mended is None:
            break
        made = mended
    return {"id": name, "true": sorted(made.true), "said": told_each_time, "wrong": [], "grade": grade,
            "text": [] if grade == "agrees" else text, "cpu_s": round(time.process_time() - begun, 3)}  # fmt: skip


def wild(name: str) -> dict[str, Any]:
    """Return what is said of a public program's file."""
    scene, times, q = wild_programs.read_in(name)
    x, y, *_ = (float(place) for place in scene.exact.position)
    begun = time.process_time()
    found = told(scene, times, q, 1e-6 * math.hypot(x, y))
    spent = time.process_time() - begun
    explanation, true = found.explanation, wild_programs.TRUE[name]
    words = wild_programs.said(explanation) if explanation is not None else set()
    words = {word for word in words if "|" not in word}
    either = [[w for w in each for w in w.split("+")] for each in alternatives(explanation)]
    covered = words | {wild_programs.SAME.get(w, w) for each in either for w in each}
    wrong = words - true
    if any(word.startswith("integrator") for word in true):  # true, if less is said than could be
        wrong -= {"integrator_loose"}
    lines = [] if explanation is None else list(explanation.lines())
    grade = (
        "whole"
        if true <= words
        else "either"
        if true <= covered
        else "part"
        if true & covered
        else "silent"
    )
    return {"id": name, "true": sorted(true), "said": sorted(words), "either": either, "wrong": sorted(wrong),
            "named": len(true & words), "covered": len(true & covered), "of": len(true), "grade": grade, "text": lines,
            "cpu_s": round(spent, 3)}  # fmt: skip


def summary(rows: list[dict[str, Any]]) -> str:
    """Return a few lines on what was said."""
    grades = {
        grade: sum(row["grade"] == grade for row in rows)
        for grade in ("whole", "either", "part", "silent", "agrees", "stuck")
    }
    wrong = {row["id"]: row["wrong"] for row in rows if row["wrong"]}
    spent = [row["cpu_s"] for row in rows]
    lines = [f"{len(rows)} files: {grades}; false claims in {len(wrong)}: {wrong}"]
    if rows and "of" in rows[0]:
        lines.append(
            f"causes: {sum(r['named'] for r in rows)} named, {sum(r['covered'] for r in rows)} with either, of {sum(r['of'] for r in rows)}"
        )
    lines.append(f"CPU s: median {statistics.median(spent):.2f}, largest {max(spent):.2f}")
    return "\n".join(lines)


def main() -> None:
    """Draw a corpus, and write what is said."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "corpus",
        choices=(
            "generated",
            "advice",
            "right",
            "smooth",
            "clocks",
            "columns",
            "loops",
            "loose",
            "wild",
        ),
    )
    parser.add_argument("seed", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--ulp", action="store_true")
    given = parser.parse_args()
    rows = []
    with given.out.open("a") if given.out else tempfile.TemporaryFile("w") as out:
        for row in records(given.corpus, given.seed, given.count):
            rows.append(row)
            out.write(json.dumps(row) + "\n")
            out.flush()
    print(summary(rows))


if __name__ == "__main__":
    main()
