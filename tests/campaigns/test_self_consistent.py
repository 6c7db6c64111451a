"""The bounds of the level self_consistent, on small and damped swings, where two runs are most easily the same run."""

from __future__ import annotations

from random import Random
from statistics import median

import pytest
from small_scenes import make_scene

import reference
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.numbers.columns import GRID
from reference.numbers.precision import real
from reference.numbers.zeros import columns_of

FINER_BITS = 60  # of the truth, more than the published run has
# and as many more, as heyoka's numbers count from l where the rest position is off the vertical
SMALL_SWING_BITS = 70
LATITUDES = ("0", "90", "-90", "48.846111", "-19.109114989775")


def decimal(value):
    """Return a number as a decimal that a scene takes."""
    return f"{value:.12e}"


def small_swing(random):
    """Return a scene: amplitude 1e-9 to 0.1 of the cord, drag, latitude, rotation, reading of the inputs and digits."""
    length, gravity = 10 ** random.uniform(-1, 2), 10 ** random.uniform(0, 1)
    rate, amplitude = (gravity / length) ** 0.5, length * 10 ** random.uniform(-9, -1)
    drag = random.choice((0.0, 10 ** random.uniform(-6, 0)))
    span = min(random.uniform(1, 60) / rate, 20 / drag if drag else float("inf"))
    release = {"x": decimal(random.choice((0.0, 1.0, random.uniform(-1, 1))) * amplitude)}
    release |= {"y": decimal(random.choice((0.0, random.uniform(-1, 1))) * amplitude)}
    if random.random() < 0.5:
        release |= {
            name: decimal(random.uniform(-1, 1) * amplitude * rate) for name in ("vx", "vy")
        }
    # at rest on the vertical there is nothing to find
    moving = any(float(value) for value in release.values())
    return make_scene(
        pendulum={"length": decimal(length), "drag": decimal(drag)},
        site={
            "latitude": random.choice((*LATITUDES, f"{random.uniform(-90, 90):.6f}")),
            "gravity": decimal(gravity),
            "rotation_rate": random.choice(("0", "7.292115e-5", "1e-3")),
        },
        release=release,
        inputs=random.choice(("decimal", "binary64")),
        run={
            "t_end": f"{span:.6f}",
            "grid_step": f"{span / random.randint(1, 40):.6f}",
            "digits": random.randint(12, 30),
            "level": "self_consistent",
            "sections": ["highest", "gate 33", "turn 71"] if moving else [],
        },
    )


def compared(solution, table, truth, columns):
    """Yield column, row, error and bound of every number."""
    for name in columns:
        rows = zip(table.exact(name), truth.exact(name), table.bound(name), strict=True)
        yield from (
            (name, row, abs(value - exact), bound) for row, (value, exact, bound) in enumerate(rows)
        )


@pytest.mark.parametrize("engine", ["auto", "heyoka"])
def test_every_bound_holds_against_another_code_and_none_is_zero(engine, size, tally):
    count = size(2, 100 if engine == "auto" else 25)
    shares, numbers, transits, passages = [], 0, 0, 0
    for seed in range(count):
        scene = small_swing(Random(seed))
        solution = reference.solve(scene, engine=engine)
        prec = int(solution.run.number.split("(")[1][:-1]) + FINER_BITS + SMALL_SWING_BITS
        truth = run(Plan(scene.exact, "spin", real(prec), solution.times, scene.run.zeros))
        found = [("grid", *each) for each in compared(solution, solution.grid, truth.grid, GRID)]
        # without xdot where it is identically zero
        assert solution.zeros.keys() == truth.zeros.keys()
        for word, zeros in solution.zeros.items():
            assert zeros.directions == truth.zeros[word].directions, (seed, word)
            columns = columns_of(word)
            found += [
                (word, *each)
                for each in compared(solution, zeros.table, truth.zeros[word].table, columns)
            ]
        transits += len(solution.directions)
        passages += sum(len(zeros.directions) for zeros in solution.sections.values())
        for kind, name, row, error, bound in found:
            assert error <= bound and bound > 0, (seed, kind, name, row, float(error), float(bound))
        numbers += len(found)
        shares.append(max(error / bound for *_, error, bound in found))
    tally(
        f"self_consistent, engine {engine}: {count} small and damped swings, {numbers} numbers ({transits} transits, "
        f"{passages} passages), "
        f"largest error/bound {float(max(shares)):.2g}, median of the scenes' largest {float(median(shares)):.2g}"
    )
