"""A bob pushed exactly sideways, or from its lowest point: whether its height grows or falls first is proved."""

from decimal import Decimal
from fractions import Fraction
from itertools import product

import pytest
from passages import found

import reference

WORDS = ("highest", "lowest")
ASIDE = {
    "id": "aside",
    "pendulum": {"length": "20"},
    "site": {"latitude": "50", "gravity": "9.8107", "gravity_is": "effective"},
    "release": {"x": "1", "y": "0", "vy": "0.005"},
    "run": {"t_end": "480", "grid_step": "480", "digits": 15},
}
# of a program of another origin: Taylor series in fixed point, inertial axes (audit "truth", 2026-11-29)
PERIOD_S, PRECESSION_DEG_PER_H = 8.972486042888, -10.54416016


def proved(site=None, t_end="20", words=WORDS, **release):
    changed = {
        "site": ASIDE["site"] | (site or {}),
        "run": ASIDE["run"] | {"t_end": t_end, "grid_step": t_end},
    }
    return reference.solve(
        ASIDE | changed | {"release": release}, level="enclosed", sections=list(words)
    )


def test_period_and_precession_of_a_bob_that_is_pushed_aside_are_proved():
    swing = reference.solve(ASIDE, level="enclosed", sections="highest").swing
    unproven = reference.solve(ASIDE, level="computed", engine="heyoka", sections="highest").swing
    for interval, value, other in (
        (swing.period, PERIOD_S, unproven.period),
        (swing.precession, PRECESSION_DEG_PER_H, unproven.precession),
    ):
        assert interval[1] - interval[0] < Fraction(1, 10**18)
        assert [float(end) for end in interval] == pytest.approx([value] * 2, rel=1e-9)
        # the error of the unproven one is an estimate
        assert other[0] <= interval[0] <= interval[1] <= other[1]


EXACT = {
    "aside": {"x": "1", "y": "0", "vy": "0.005"},
    "aside, at an azimuth": {"x": "0.3", "y": "0.4", "vx": "-0.04", "vy": "0.03"},
    "aside, by angles": {"angle": "3", "azimuth": "31", "azimuth_rate": "4"},
    "from below": {"x": "0", "y": "0", "vx": "0.3", "vy": "0.1"},
    "from below, by angles": {"angle": "0", "azimuth": "31", "angle_rate": "4"},
}


@pytest.mark.parametrize("name", EXACT)
def test_every_exact_push_is_decided_as_another_code_finds_it(name):
    solution = proved(**EXACT[name])
    expected = found(solution.scene.exact, WORDS, 20)
    for word in WORDS:
        passages = solution.sections[word]
        assert not passages.possible
        later = [t for t, _ in expected[word] if t > 1e-3]
        assert [float(t) for t in passages.table.exact("t")] == pytest.approx(later, abs=1e-6)


# by how much the radial velocity is off zero: far below the rounding of the proof, and above it
OFF = ("1e-60", "-1e-60", "1e-30", "-1e-30", "1e-12", "-1e-12", "1e-4", "-1e-4")


@pytest.mark.parametrize("off", OFF)
def test_a_push_that_is_nearly_sideways_is_undecided_or_right(off):
    """Pushed outwards, the bob is highest soon after; pushed inwards, it falls from the release on."""
    solution = proved(x="1", y="0", vx=off, vy="0.005")
    inputs, outwards = solution.scene.exact, Fraction(off) > 0
    at_once = Fraction(off) * inputs.length / inputs.gravity  # (x²)'' = -2 g x²/l, about
    for word in WORDS:
        passages, may_be_passed = solution.sections[word], outwards and word == "highest"
        soon = [float(t) for t in passages.table.exact("t") if t < 1]
        if passages.possible:
            ((low, high, parity),) = passages.possible
            assert (low, soon, parity) == (0, [], "unknown")
            assert not may_be_passed or high > at_once
        else:
            assert abs(Fraction(off)) > Fraction(1, 10**25)
            assert soon == (pytest.approx([float(at_once)], rel=0.02) if may_be_passed else [])


@pytest.mark.parametrize(
    "release",
    [
        {"x": "0.3", "y": "0.4", "vx": "-0.04", "vy": f"0.03{'0' * 40}1"},
        {"x": "1", "y": "1e-40", "vy": "0.005"},
        {"angle": "3", "azimuth": "31", "angle_rate": "1e-40", "azimuth_rate": "4"},
    ],
)
def test_what_is_zero_by_rounding_alone_is_not_taken_for_zero(release):
    solution = proved(**release)
    for word in WORDS:
        ((low, high, _),) = solution.sections[word].possible
        assert low == 0 < high < Fraction(1, 10**15)
    assert solution.swing is None


def test_doubles_that_only_nearly_cancel_are_taken_as_they_are():
    """0.3 · -0.04 + 0.4 · 0.03 is not 0 in the doubles next to these decimals: it is 4e-19, outwards."""
    scene = ASIDE | {
        "inputs": "binary64",
        "release": {"x": "0.3", "y": "0.4", "vx": "-0.04", "vy": "0.03"},
    }
    solution = reference.solve(scene, level="enclosed", t_end="20", sections=list(WORDS))
    x, y, vx, vy = solution.scene.exact.position
    radial = x * vx + y * vy
    assert radial > 0
    first = solution.sections["highest"].table.exact("t")[0]
    assert float(first) == pytest.approx(
        float(radial / (x * x + y * y) * 20 / Fraction("9.8107")), rel=0.2
    )


@pytest.mark.parametrize(
    "site, release, decided",
    [
        # where the plumb line leans, "sideways" to the north is uphill, and to the east is not
        ({"gravity_is": "ellipsoid"}, {"x": "0", "y": "1", "vx": "0.1"}, True),
        ({"gravity_is": "ellipsoid", "latitude": "90"}, {"x": "1", "y": "0", "vy": "0.1"}, True),
        (
            {"gravity_is": "ellipsoid", "rotation_rate": "0"},
            {"x": "1", "y": "0", "vy": "0.1"},
            True,
        ),
        (
            {"gravity_is": "ellipsoid", "latitude": "1e-40"},
            {"x": "1", "y": "0", "vy": "0.1"},
            False,
        ),
        (
            {"gravity_is": "ellipsoid", "rotation_rate": "1e-25"},
            {"x": "1", "y": "0", "vy": "0.1"},
            False,
        ),
    ],
)
def test_sideways_is_across_the_plumb_line(site, release, decided):
    solution = proved(site, **release)
    assert [len(solution.sections[word].possible) for word in WORDS] == [0 if decided else 1] * 2


# what is uncertain, and whether the push is exactly sideways all the same, for every pendulum
BOXES = [
    (
        EXACT["aside"],
        {"pendulum.length": "0.001", "release.vy": "0.0001", "release.x": "0.001"},
        True,
    ),
    (EXACT["aside"], {"site.gravity": "0.00001", "site.latitude": "0.01"}, True),
    (EXACT["aside, by angles"], {"release.angle": "0.001", "release.azimuth": "0.01"}, True),
    (EXACT["aside, at an azimuth"], {"pendulum.length": "0.001"}, True),
    (EXACT["aside"], {"release.vx": "1e-9"}, False),
    (EXACT["aside"], {"release.y": "1e-9"}, False),
    (EXACT["aside, at an azimuth"], {"release.vy": "1e-12"}, False),
    (EXACT["aside, by angles"], {"release.angle_rate": "1e-9"}, False),
]


@pytest.mark.parametrize("release, widths, decided", BOXES)
def test_a_box_is_decided_where_every_pendulum_is_and_holds_the_points_of_its_corners(
    release, widths, decided
):
    run = ASIDE["run"] | {"t_end": "20", "grid_step": "20"}
    scene = reference.parse_scene(ASIDE | {"release": release, "run": run})
    ranges = reference.prove_ranges(scene, widths=widths, sections=list(WORDS), derivatives=True)
    assert [len(ranges.sections[word].possible) for word in WORDS] == [0 if decided else 1] * 2
    for signs in product((-1, 1), repeat=len(widths)):
        values = {}
        for (name, width), sign in zip(widths.items(), signs, strict=True):
            section, key = name.split(".")
            middle = getattr(getattr(scene, section), key) or "0"
            values[name] = f"{Decimal(middle) + sign * Decimal(width):f}"
        corner = reference.solve(
            scene.with_values(values), level="enclosed", digits=15, sections=list(WORDS)
        )
        for word in WORDS:
            box, point = ranges.sections[word], corner.sections[word].table.exact("t")
            listed = [
                t for t in point if not any(low <= t <= high for low, high, _ in box.possible)
            ]
            assert len(listed) == len(box.table)
            assert all(
                low <= t <= high
                for t, (low, high) in zip(listed, box.table.exact("t"), strict=True)
            )
