"""The whole way: from a scene and a width to states that are proved, or to a refusal."""

from fractions import Fraction
from itertools import islice, pairwise

import pytest
from enclosure_oracle import PARIS, contains, scene, steep_truth, steps, truth
from enclosure_recurrence import Recurrence, prove, recurrence
from flint import ctx
from sampled import one_in

from reference.enclosure import enclose, turned
from reference.enclosure.approximant import pair
from reference.enclosure.trusted.balls import fixed
from reference.enclosure.trusted.system import SceneBalls
from reference.errors import UnreachableError
from reference.numbers.taylor_step import LOCAL, TaylorStep

WANTED = Fraction(1, 10**40)
HARD = {
    "steep": scene(length="1", angles=("114.59155902616465", "30", "0", "0")),
    "near inverted": scene(length="1", angles=("177.616916490555", "30", "0", "0")),
}


@pytest.mark.parametrize("inputs, end", one_in(5, [
    (scene(), 100),
    (scene(latitude="0"), 100),
    (scene(latitude="90"), 100),
    (scene(latitude="-33.3"), 100),
    (scene(rotation_rate="0.001"), 100),
    (scene(rotation_rate="0.001", gravity_is="effective"), 100),
    (scene(rotation_rate="0"), 100),
    (scene(drag="0.01"), 100),
    (scene(x="0", y="0.5"), 100),
    (scene(angles=("28.6478897565", "30", "0", "0")), 100),
    (scene(angles=("114.59155902616465", "30", "0", "0")), 60),
]))  # fmt: skip
def test_forty_digits_hold_the_truth(inputs, end, size):
    end = min(end, size(30, 100))
    times = [Fraction(0), Fraction(1, 3), Fraction(end, 2), Fraction(end)]
    proof = prove(inputs, times, WANTED)
    assert proof.proved.times == tuple(times)
    assert max(proof.position_radius, proof.velocity_radius) <= WANTED
    for row, exact in zip(proof.proved.states[1:], truth(inputs, times[1:]), strict=True):
        assert all(contains(i, x) for i, x in zip(row, exact, strict=True))


@pytest.mark.parametrize("name", one_in(2, reversed(HARD)))
def test_the_hard_scenes_lie_inside(name, size):
    inputs, end = HARD[name], Fraction(size(6, 60))
    proof = enclose(inputs, [end], radius=WANTED, approximant=recurrence(inputs))
    assert proof.method == {6: "radius", 60: "columns"}[end]
    assert (
        len(proof.proved.zeros["xdot"])
        == {"steep": {60: 134}, "near inverted": {6: 5, 60: 53}}[name][end]
    )
    assert {t.kind for t in proof.proved.zeros["xdot"]} == {"one"}
    exact = steep_truth(inputs, end, 400)
    assert all(contains(i, x) for i, x in zip(proof.proved.states[0], exact, strict=True))


def test_what_cannot_be_had_is_refused_with_the_width_reached():
    with pytest.raises(UnreachableError, match="bits"):
        enclose(PARIS, [Fraction(60)], radius=Fraction(1, 10**900), approximant=recurrence(PARIS))

    def too_coarse(_bits):
        return pair(Recurrence(SceneBalls(PARIS, 160), 96, 48).chain(Fraction(1, 2)))

    with pytest.raises(UnreachableError, match=r"96 bits gave .*e-\d+ m"):
        enclose(PARIS, [Fraction(60)], radius=WANTED, approximant=too_coarse)


def test_an_approximant_that_ends_too_early_is_refused():
    chain = Recurrence(SceneBalls(PARIS, 256), 192, 96).chain(Fraction(1, 2))
    with pytest.raises(UnreachableError, match="ends before"):
        enclose(
            PARIS, [Fraction(600)], radius=WANTED, approximant=lambda _bits: pair(islice(chain, 6))
        )
    with pytest.raises(UnreachableError, match="has no steps"):
        enclose(PARIS, [Fraction(600)], radius=WANTED, approximant=lambda _bits: [])


def test_an_approximant_too_coarse_is_requested_again_with_more_bits():
    requested = []

    def source(bits):
        requested.append(bits)
        delivered = max(bits - 60 if len(requested) == 1 else bits, 96)
        return pair(
            Recurrence(SceneBalls(PARIS, delivered + 64), delivered, delivered // 2).chain(
                Fraction(1, 2)
            )
        )

    proof = enclose(PARIS, [Fraction(60)], radius=WANTED, approximant=source)
    assert len(requested) == 2
    assert requested[0] < requested[1] < requested[0] + 96
    assert proof.position_radius <= WANTED


def test_coefficients_of_an_integrator_are_an_approximant():
    bits, rows = 192, []
    with ctx.workprec(256):
        sin, cos = map(int, fixed(list(SceneBalls(PARIS, 256).tilt), bits)[0])
    for e in Recurrence(SceneBalls(PARIS, 256), bits, 96).chain(Fraction(1, 2)):
        x, m, w, _ = e.coefficients
        y = [(a * sin + b * cos) >> bits for a, b in zip(m, w, strict=True)]
        z = [(b * sin - a * cos) >> bits for a, b in zip(m, w, strict=True)]
        rows.append(TaylorStep(e.centre, e.h, e.low, e.high, bits, (x, y, z), LOCAL))
        if e.centre > 60:
            break
    proof = enclose(
        PARIS, [Fraction(60)], radius=WANTED, approximant=lambda _bits: pair(turned(PARIS, rows))
    )
    (exact,) = truth(PARIS, [Fraction(60)])
    assert all(contains(i, x) for i, x in zip(proof.proved.states[0], exact, strict=True))


def test_uneven_chains_are_covered_without_gap():
    lengths = [Fraction(n, 32) for n in (32, 33, 40, 39, 20, 21, 60, 1, 2, 30)]
    t, chain = Fraction(0), []
    for h in lengths:
        chain.append(
            TaylorStep(t, h, Fraction(0), Fraction(1), 64, tuple([1, 2, 3] for _ in range(4)))
        )
        t += h
    got = list(pair(chain))
    ends = [(s.centre + s.h * s.low, s.centre + s.h * s.high) for s in got]
    assert ends[0][0] == 0
    assert ends[-1][1] == t
    assert all(a[1] == b[0] for a, b in pairwise(ends))
    assert all(-1 <= s.low < s.high <= 1 for s in got)


def test_time_zero_alone_gives_the_release():
    proof = enclose(PARIS, [Fraction(0)], radius=WANTED, approximant=recurrence(PARIS))
    assert proof.proved.zeros["xdot"] == ()
    assert contains(proof.proved.states[0][0], Fraction("0.3"))
    assert proof.position_radius < WANTED


@pytest.mark.parametrize("times", [[], [Fraction(-1)], [Fraction(2), Fraction(1)]])
def test_times_must_increase_from_zero(times):
    with pytest.raises(ValueError, match="times"):
        enclose(PARIS, times, radius=WANTED, approximant=recurrence(PARIS))


def test_progress_ends_at_one():
    parts = []
    enclose(
        PARIS, [Fraction(100)], radius=WANTED, approximant=recurrence(PARIS), progress=parts.append
    )
    assert parts == sorted(parts)
    assert parts[-1] == 1


def test_steps_serve_both_sides_of_their_centre():
    rows = list(steps(PARIS, Fraction(200)))
    assert sum(s.low < -Fraction(9, 10) for s in rows) > len(rows) / 2


def test_numbers_too_far_apart_for_any_precision_are_refused():
    inputs = scene(length="1e-300", x="1e-301", y="0")
    with pytest.raises(UnreachableError, match="cannot choose a precision"):
        enclose(inputs, [Fraction(60)], radius=Fraction(1, 10**340), approximant=recurrence(inputs))
