"""Random scenes proved: no number misses a far finer run, no transit is lost, nothing is refused that can be proved."""

from __future__ import annotations

import math
import time
from collections import Counter
from fractions import Fraction

import pytest
from random_scenes import random_scene

import reference
from reference.enclosure.prove import plan_for
from reference.engines.plan import Plan
from reference.engines.registry import engines, run
from reference.errors import InputError, IntegrationError, UnreachableError
from reference.numbers.precision import real
from reference.scenes.scene import parse_scene

FINER = 72  # bits that the truth has more than the proof
ONCE_WRONG = {  # seeds of scenes of a third
    # without rotation h is a decimal, and was printed from half a unit away, which check.c could not decide
    49,
    90,  # vz is tiny at one row, and its interval left open which double is nearest
    # h is mostly the speed of the ground, by which `verify` lost the digits of how far h may be off
    128,
}
CLEARLY = 60  # CPU seconds above which a proof must have the steps to show for it


def misses(solution, engine):
    """What a run far finer than the proof contradicts; None where it cannot be made.

    By heyoka it is in the formulation `spin`, which the proof does not use, but heyoka compiles for each precision.
    """
    scene, prec = solution.scene, solution.proof.enclosure.bits + FINER
    plan = Plan(scene.exact, "spin", real(prec), tuple(scene.exact.grid), scene.run.zeros)
    if engine == "limbs":
        plan = engines()["limbs"].plan(scene.exact, prec, tuple(scene.exact.grid), scene.run.zeros)
    try:
        truth = run(plan)
    except (UnreachableError, InputError, OverflowError):
        return None
    found = []
    tables = [("state", solution.grid, truth.grid)]
    if solution.zeros.keys() != truth.zeros.keys():
        return ["xdot is identically zero in one of the two alone"]
    for word, zeros in solution.zeros.items():
        if zeros.possible:
            continue
        true = truth.zeros[word]
        if zeros.directions != true.directions:
            return [
                f"{len(zeros.directions)} zeros of {word}, not {len(true.directions)}, or in other directions"
            ]
        tables.append((word, zeros.table, true.table))
    for kind, table, other in tables:
        slack = Fraction(1, 1 << solution.proof.enclosure.bits) * max(
            1, scene.exact.length, scene.exact.t_end
        )
        for name in table.columns:
            gaps = table.distance(other).exact(name)
            for row, (gap, bound) in enumerate(zip(gaps, table.bound(name), strict=True)):
                if gap > bound + slack:
                    found.append(
                        f"{kind} {row}, {name}: off by {float(gap):.1e}, bound {float(bound):.1e}"
                    )
    return found


def test_random_scenes_are_proved_and_right(size, tally):
    proved = unchecked = possible = flat = 0
    wrong, refused, slow = [], [], []
    engine = ["limbs", "heyoka"][size(0, 1)]
    for seed in range(*size((101, 102), (100, 400))):
        begun = time.process_time()
        try:
            solution = reference.solve(parse_scene(random_scene(seed)))
        except UnreachableError as error:
            refused.append(f"{seed}: {error}")
            continue
        spent = time.process_time() - begun
        if spent > CLEARLY and spent > solution.proof.enclosure.steps / 20:
            slow.append(f"{seed}: {spent:.0f} s for {solution.proof.enclosure.steps} steps")
        proved, possible, flat = (
            proved + 1,
            possible + bool(solution.possible),
            flat + bool(solution.not_checked),
        )
        found = misses(solution, engine)
        unchecked += found is None
        wrong += [f"{seed}: {line}" for line in found or ()]
    assert not wrong, wrong
    assert not slow, slow
    assert not refused, refused
    parts = f"{possible} with undecided transits, {unchecked} without a finer run, {flat} without a guard"
    tally(f"random scenes: {proved} proved, {parts}")


def scene_of_a_third(seed):
    """A short random scene: of three one damped, one whose gravity is effective, one as it is drawn."""
    document = random_scene(1000 + seed)
    run, site, pendulum = (document[part] for part in ("run", "site", "pendulum"))
    if seed % 3 == 0 and not float(pendulum["drag"]):
        pendulum["drag"] = (
            f"{math.sqrt(float(site['gravity']) / float(pendulum['length'])) * (1 + seed) / 400:.6g}"
        )
    if seed % 3 == 1:
        site["gravity_is"] = "effective"
    run["t_end"] = f"{float(run['t_end']) / 4:.9g}"
    run["grid_step"] = f"{float(run['t_end']) / (1 + seed % 7):.6g}"
    return parse_scene(document)


def test_random_scenes_are_proved_and_the_checker_proves_them_again(
    check, monkeypatch, tmp_path, size, tally
):
    """A third damped, a third of effective gravity, a tenth by columns: check.c proves every number that is printed."""
    methods, transits, wrong = Counter(), 0, []
    seeds = sorted({*ONCE_WRONG, *range(size(198, 0), 200)})
    for seed in seeds:
        with monkeypatch.context() as patch:
            if seed % 10 == 9:
                patch.setattr(
                    "reference.enclosure.prove.plan_for",
                    lambda *wanted: plan_for(*wanted[:3], "columns"),
                )
            solution = reference.solve(scene_of_a_third(seed))
        methods[solution.proof.enclosure.method] += 1
        transits += len(solution.transits or ())
        done = check(reference.write(solution, tmp_path / str(seed)))
        if done.returncode:
            wrong.append((seed, done.stdout[-300:]))
    assert not wrong, wrong
    assert methods["columns"] >= len(seeds) // 10
    parts = f"{methods['columns']} of them by columns, {transits} transits"
    tally(f"random scenes: {len(seeds)} proved and proved again by check.c, {parts}")


@pytest.mark.parametrize(
    "seed",
    [102, *(pytest.param(seed, marks=pytest.mark.long) for seed in (12, 123, 280, 286, 331, 335))],
)
def test_scenes_that_were_refused_are_proved(seed, size):
    """F2 and F6 of the audit: late transits known far less closely than the states, and flatter than doubles see.

    286 has few rows: at these vx is right by chance, and between them off as vy and vz are.
    """
    solution = reference.solve(parse_scene(random_scene(seed)))
    assert solution.possible == ()
    assert not solution.not_checked
    assert misses(solution, ["limbs", "heyoka"][size(0, 1)]) in ([], None)


def test_a_guard_that_cannot_be_made_refuses_nothing_and_says_so(monkeypatch, tmp_path):
    def fails(*_):
        raise IntegrationError("the sign of xdot does not fit.")

    scene = reference.load_scene("paris", ["run.t_end=60", "run.level=enclosed", "run.digits=20"])
    monkeypatch.setattr("reference.solver.guard.run", fails)
    solution = reference.solve(scene)
    assert solution.not_checked == "the sign of xdot does not fit."
    path = reference.write(solution, tmp_path / "paris")
    assert reference.load(path).manifest.cross_checks[0].transit_s is None
    assert "the proof alone confirms them" in (path / "certified.txt").read_text()
