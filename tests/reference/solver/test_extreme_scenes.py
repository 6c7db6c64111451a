"""Extreme and stiff scenes: each says what it catches, and what the solver returns on it holds against other physics.

Oracles are closed solutions, first integrals, similarity and Newton's law with the Earth's whole geometry, in an mpmath
context of their own; nothing of the solver's mechanics is used.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from sampled import one_in

from reference import Scene, Solution, load_scene, parse_scene, scene_ids, solve
from reference.scenes.inputs import Inputs

MP = mpmath.mp.clone()
MP.dps = 60

ORDINARY = {"paris", "paris_measured", "pantheon", "pole", "equator", "southern", "spherical"} | {
    "laboratory", "laboratory_drag", "museum", "museum_gate",
}  # fmt: skip
EXTREME = [name for name in scene_ids() if name not in ORDINARY]
LONG = {"paris_30d"}
UNDAMPED = [name for name in EXTREME if name not in LONG and not load_scene(name).exact.drag]
FLAGS = {
    "at_rest", "cancellation", "close_transits", "closed_form", "conical", "damped", "exact_direction",
    "fast_rotation", "horizontal", "large_angle", "long", "near_vanishing_terms", "near_vertical", "retrograde",
    "rotating_over", "scale", "sensitive", "stiff", "tiny_amplitude", "unstable_rest", "vanishing_terms",
    "weightless", "zero_at_release",
}  # fmt: skip
COLUMNS = ("x", "y", "z", "vx", "vy", "vz")


def number(value: Fraction | str) -> Any:
    exact = Fraction(value)
    return MP.mpf(exact.numerator) / exact.denominator


def changed(name: str, **run: object) -> Scene:
    return load_scene(name, [f"run.{key}={value}" for key, value in run.items()])


def rows(solution: Solution) -> list[list[Any]]:
    """x, y, z, vx, vy, vz at every grid time, as many digits as were computed."""
    return [
        list(map(number, row))
        for row in zip(*(solution.grid.exact(name) for name in COLUMNS), strict=True)
    ]


def test_there_are_enough_of_them_and_they_cover_what_breaks_programs() -> None:
    assert len(EXTREME) >= 32
    assert {flag for name in EXTREME for flag in load_scene(name).flags} == FLAGS
    stiff = [load_scene(name).exact for name in EXTREME if "stiff" in load_scene(name).flags]
    assert len(stiff) >= 3
    assert sum(k.drag**2 * k.length / k.gravity >= 10**6 for k in stiff) >= 2


@pytest.mark.parametrize("name", EXTREME)
def test_it_says_what_it_is_what_it_catches_and_why(name: str) -> None:
    scene = load_scene(name)
    what, _, catches = scene.title.partition(": ")
    assert scene.id == name
    assert 10 < len(what) < 90
    assert len(catches) > 20
    assert scene.source
    assert scene.flags
    assert scene.run.digits >= 30
    assert scene.run.level in ("confirmed", "enclosed")
    assert 60 <= len(scene.exact.grid) <= 1500


# First integrals ---------------------------------------------------------------------------------------------------
def axis_distance(k: Inputs) -> Any:
    """R = (N + h) cos(latitude) with N = a² / sqrt(a² cos² + b² sin²)."""
    a, f, phi = number(k.equatorial_radius), number(k.flattening), number(k.latitude) * MP.pi / 180
    b = a * (1 - f)
    normal = a * a / MP.sqrt((a * MP.cos(phi)) ** 2 + (b * MP.sin(phi)) ** 2) if a else MP.zero
    return (normal + number(k.altitude)) * MP.cos(phi)


@pytest.mark.parametrize("name", one_in(10, UNDAMPED))
def test_it_keeps_to_the_sphere_and_keeps_its_energy(name: str) -> None:
    """h = v²/2 + g z - Ω²/2 (squared distance from the Earth's axis), to 17 digits of its terms."""
    k = load_scene(name).exact
    end = min(k.t_end, 5 * k.grid_step)
    solution = solve(
        changed(name, t_end=str(float(end)), digits=20, level="computed", transits=False)
    )
    assert len(solution.t) >= 6 or end == k.t_end
    length, g, rate, distance = (
        number(k.length),
        number(k.gravity),
        number(k.rotation_rate),
        axis_distance(k),
    )
    sin, cos = (f(number(k.latitude) * MP.pi / 180) for f in (MP.sin, MP.cos))
    energies = []
    for x, y, z, vx, vy, vz in rows(solution):
        assert abs(x * x + y * y + z * z - length**2) < 1e-18 * length**2
        assert abs(x * vx + y * vy + z * vz) < 1e-18 * length * MP.sqrt(
            vx**2 + vy**2 + vz**2 + g * length + 1
        )
        out = distance - y * sin + z * cos
        energies.append((vx**2 + vy**2 + vz**2) / 2 + g * z - rate**2 * (x * x + out * out) / 2)
    speed = max(abs(v) for name in COLUMNS[3:] for v in solution.grid.exact(name))
    terms = number(speed) ** 2 + g * length + rate**2 * length * (distance + length)
    assert max(energies) - min(energies) <= 1e-17 * terms


# Newton's law with the Earth's whole geometry ----------------------------------------------------------------------
def by_newton(k: Inputs, start: list[Any], t: Any) -> list[Any]:
    """Integrate r'' = gravity - Ω × (Ω × (P + r)) - 2 Ω × v - γ v + μ r, μ from |r| = l, by mpmath.odefun."""
    mp = mpmath.mp.clone()
    mp.dps = 30
    phi = mp.mpf(k.latitude.numerator) / k.latitude.denominator * mp.pi / 180
    rate, g, drag = (
        mp.mpf(v.numerator) / v.denominator for v in (k.rotation_rate, k.gravity, k.drag)
    )
    omega = mp.matrix([0, rate * mp.cos(phi), rate * mp.sin(phi)])
    pivot = mp.mpf(axis_distance(k)) * mp.matrix([0, -mp.sin(phi), mp.cos(phi)])

    def cross(a: Any, b: Any) -> Any:
        return mp.matrix(
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        )

    def dot(a: Any, b: Any) -> Any:
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    def rates(_: Any, state: Any) -> list[Any]:
        r, v = mp.matrix(state[:3]), mp.matrix(state[3:])
        push = (
            mp.matrix([0, 0, -g])
            - cross(omega, cross(omega, pivot + r))
            - 2 * cross(omega, v)
            - drag * v
        )
        pull = -(dot(v, v) + dot(r, push)) / dot(r, r)
        return [*v, *(push + pull * r)]

    return list(
        mp.odefun(rates, 0, [mp.mpf(value) for value in start], tol=mp.mpf(10) ** -24)(mp.mpf(t))
    )


@pytest.mark.parametrize(
    ("name", "t"),
    one_in(
        8,
        [
            ("creeping_rotation", "0.005"),
            ("creeping_rotation", "0.02"),
            ("creeping", "0.005"),
            ("damped", "2"),
            ("small_body", "1"),
            ("overdamped", "0.3"),
            ("microgravity", "10"),
            ("close_pair", "0.3"),
            ("over_top", "0.2"),
            ("gravity_zero", "5"),
            ("almost_inverted", "2"),
            ("creeping_far", "0.00001"),
            ("fast_pole", "0.2"),
        ],
    ),
)
def test_it_follows_newtons_law_with_the_whole_earth(name: str, t: str) -> None:
    solution = solve(
        changed(name, t_end=t, grid_step=t, digits=25, level="computed", transits=False)
    )
    first, last = rows(solution)
    expected = by_newton(solution.scene.exact, first, t)
    for kind in (slice(0, 3), slice(3, 6)):
        size = max(abs(value) for value in (*last[kind], *first[kind]))
        moved = max(abs(a - b) for a, b in zip(first[kind], last[kind], strict=True))
        assert (
            max(abs(a - b) for a, b in zip(last[kind], expected[kind], strict=True)) < 1e-19 * size
        )
        assert moved > 1e-12 * size


# Closed solutions --------------------------------------------------------------------------------------------------
Path = Callable[[Any], tuple[Any, ...]]


def exactly_conical(rate: Any) -> Path:
    return lambda t: (
        number("0.6") * MP.cos(rate * t),
        number("0.6") * MP.sin(rate * t),
        number("-0.8"),
    )


def separatrix(t: Any) -> tuple[Any, ...]:
    """angle = 4 atan(exp(3 t)) - π: sine 2 tanh sech, cosine 2 sech² - 1."""
    return 2 * MP.tanh(3 * t) * MP.sech(3 * t), MP.zero, 1 - 2 * MP.sech(3 * t) ** 2


def planar(t: Any) -> tuple[Any, ...]:
    """sin(angle/2) = k sn(K - w t, k), released at rest at y = 0.5 m, l = 1 m."""
    k = MP.sin(MP.asin(number("0.5")) / 2)
    w = MP.sqrt(number("9.80665"))
    half = k * MP.ellipfun("sn", MP.ellipk(k * k) - w * t, m=k * k)
    return MP.zero, 2 * half * MP.sqrt(1 - half**2), 2 * half**2 - 1


def on_a_great_circle(t: Any) -> tuple[Any, ...]:
    start = [number("0.3"), number("0.4"), -MP.sqrt(number("0.75"))]
    speed = [number("0.5"), number("-0.2")]
    speed.append(-(start[0] * speed[0] + start[1] * speed[1]) / start[2])
    w = MP.sqrt(sum(v * v for v in speed))
    return tuple(
        a * MP.cos(w * t) + v / w * MP.sin(w * t) for a, v in zip(start, speed, strict=True)
    )


def weightless(t: Any) -> tuple[Any, ...]:
    """At rest on the turning body it moves on a great circle of axes that do not turn; y is the axis here."""
    w = number("0.0078125")
    x, y, z = number("0.3"), number("0.4"), -MP.sqrt(number("0.75"))
    dx, dz = w * z, -w * x  # the axes' own velocity, Ω × r
    speed = MP.sqrt(dx * dx + dz * dz)
    along = [
        p * MP.cos(speed * t) + d / speed * MP.sin(speed * t) for p, d in ((x, dx), (y, 0), (z, dz))
    ]
    cos, sin = MP.cos(w * t), MP.sin(w * t)
    return along[0] * cos - along[2] * sin, along[1], along[0] * sin + along[2] * cos


def nanometre(t: Any) -> tuple[Any, ...]:
    """The linear swing at the pole, in axes that turn by -Ω t; its z to first order."""
    w, turn = MP.sqrt(number("9.80665") / 67), number("7.292115e-5")
    still = number("1e-9") * MP.mpc(MP.cos(w * t), turn / w * MP.sin(w * t))
    seen = still * MP.expj(-turn * t)
    return seen.real, seen.imag, -number("67") + abs(still) ** 2 / 134


@pytest.mark.parametrize(
    ("name", "path", "end", "error"),
    one_in(
        4,
        [
            ("conical_pole", exactly_conical(number("3.5") - number("7.292115e-5")), "60", 1e-38),
            ("conical", exactly_conical(number("3.5")), "60", 1e-38),
            ("separatrix", separatrix, "20", 1e-29),
            ("meridian_plane", planar, "30", 1e-38),
            ("weightless", weightless, "3000", 1e-28),
            ("force_free", on_a_great_circle, "600", 1e-28),
            ("inverted_rest", lambda _: (MP.zero, MP.zero, MP.one), "60", 1e-60),
            # the swing's own nonlinearity, (1e-9/67)² of 1e-9 m times w t
            ("nanometre", nanometre, "600", 1e-27),
        ],
    ),
)
def test_it_follows_its_closed_solution(name: str, path: Path, end: str, error: float) -> None:
    solution = solve(changed(name, t_end=end, transits=False, level="confirmed"))
    for t, row in zip(solution.times, rows(solution), strict=True):
        assert max(abs(a - b) for a, b in zip(row, path(number(t)), strict=False)) < error, float(t)


def test_the_bob_at_rest_does_not_move(size: Callable[[str, str], str]) -> None:
    solution = solve(changed("at_rest", t_end=size("120", "600"), level="confirmed"))
    first, *others = rows(solution)
    assert all(abs(a - b) < 1e-41 for row in others for a, b in zip(row, first, strict=True))


def test_creeping_follows_the_equation_without_inertia() -> None:
    """θ' = -(g/lγ) sin θ, so tan(θ/2) falls exponentially; inertia changes it by one part in γ²l/g = 1.6e6."""
    solution = solve(
        load_scene(
            "creeping",
            ["site.rotation_rate=0", "run.t_end=2", "run.digits=12", "run.level=computed"],
        )
    )
    angle = MP.acos(-rows(solution)[-1][2])
    fallen = MP.tan(MP.pi / 6) * MP.exp(-number("9.80665") / 4000 * 2)
    fall = MP.pi / 3 - 2 * MP.atan(fallen)
    assert fall > 0.004
    # of 8000 drag times, the first is spent getting up to speed
    assert abs(angle - 2 * MP.atan(fallen)) < fall * 3e-4
    assert abs(MP.pi / 3 - angle - fall * (1 - 1 / number("8000"))) < fall * 1e-5


@pytest.mark.parametrize(
    ("name", "least", "most"),
    one_in(2, [("vertical_picometre", 9e-13, 1e-12), ("vertical_micrometre", 1e-7, 1e-6)]),
)
def test_it_passes_the_vertical_as_close_as_it_says(name: str, least: float, most: float) -> None:
    """Newton's method for r·v = 0 on the horizontal plane, from 4.1 s."""
    moment, miss = Fraction("4.1"), MP.inf
    for _ in range(5):
        t = text(Fraction(round(moment * 10**15), 10**15))
        x, y, _, vx, vy, _ = rows(
            solve(changed(name, t_end=t, grid_step=t, level="computed", transits=False))
        )[-1]
        moment -= Fraction(str((x * vx + y * vy) / (vx * vx + vy * vy)))
        miss = MP.hypot(x, y)
    assert least < miss < most


@pytest.mark.parametrize(
    ("name", "turned"), [("stability_below", False), ("stability_above", True)]
)
def test_the_rest_position_changes_its_stability_where_the_pivot_is_weightless(
    name: str, turned: bool
) -> None:
    """East-west: x'' = -(g - Ω²R) x / l near the bottom, R at the pivot, whatever the cord's length."""
    solution = solve(
        changed(name, t_end="100", grid_step="100", level="computed", digits=15, transits=False)
    )
    k = solution.scene.exact
    rate = number(k.gravity - k.rotation_rate**2 * k.equatorial_radius) / number(k.length)
    factor = MP.cos(MP.sqrt(rate) * 100)  # cosh where the rate is negative
    assert (factor.real > 1) == turned
    assert abs(rows(solution)[-1][0] / number("0.003") - factor.real) < 1e-2


# Similarity and mirrors --------------------------------------------------------------------------------------------
def four_times_larger(scene: Scene) -> Scene:
    """Lengths times 4, times times 2, gravity as it is: the same motion by Newton's law."""
    k = scene.exact
    position = (
        [k.position[0] * 4, k.position[1] * 4, k.position[2] * 2, k.position[3] * 2]
        if k.position
        else []
    )
    angles = [k.angles[0], k.angles[1], k.angles[2] / 2, k.angles[3] / 2] if k.angles else []
    names = (
        ("x", "y", "vx", "vy") if position else ("angle", "azimuth", "angle_rate", "azimuth_rate")
    )
    document = scene.model_dump(exclude_none=True)
    document["pendulum"] |= {"length": text(k.length * 4), "drag": text(k.drag / 2)}
    document["site"] |= {
        "rotation_rate": text(k.rotation_rate / 2),
        "equatorial_radius": text(k.equatorial_radius * 4),
        "altitude": text(k.altitude * 4),
    }
    document["release"] = dict(zip(names, map(text, position or angles), strict=True))
    document["run"] |= {"t_end": text(k.t_end * 2), "grid_step": text(k.grid_step * 2)}
    return parse_scene(document)


def text(value: Fraction) -> str:
    """A finite decimal, exactly."""
    places = 0
    while (value * 10**places).denominator != 1:
        places += 1
    return f"{(value * 10**places).numerator}e-{places}"


@pytest.mark.parametrize(
    "name",
    one_in(4, ["small_body", "microgravity", "creeping_rotation", "barely_over", "near_inverted"]),
)
def test_four_times_larger_and_twice_as_slow_is_the_same_motion(name: str) -> None:
    step = load_scene(name).run.grid_step
    asked = {
        "t_end": text(Fraction(step) * 5),
        "digits": 20,
        "level": "computed",
        "transits": False,
    }
    scene = changed(name, **asked)
    one, other = rows(solve(scene)), rows(solve(four_times_larger(scene)))
    for a, b in zip(one, other, strict=True):
        for value, image, factor in zip(a, b, (4, 4, 4, 2, 2, 2), strict=True):
            assert abs(factor * value - image) < 1e-18 * max(
                abs(number(scene.exact.length)), abs(value)
            )


def test_retrograde_is_the_mirror_image_and_the_south_pole_turns_like_it() -> None:
    short = ("run.t_end=60", "run.digits=25", "run.level=computed", "run.transits=false")
    mirrored = rows(
        solve(
            load_scene("retrograde", ["site.rotation_rate=7.292115e-5", "release.x=-0.3", *short])
        )
    )
    for a, b in zip(rows(solve(load_scene("retrograde", short))), mirrored, strict=True):
        assert (
            max(abs(p - s * q) for p, q, s in zip(a, b, (-1, 1, 1, -1, 1, 1), strict=True)) < 1e-24
        )
    north = rows(
        solve(
            load_scene(
                "south_pole", ["site.latitude=90", "site.rotation_rate=-7.292115e-5", *short]
            )
        )
    )
    for a, b in zip(rows(solve(load_scene("south_pole", short))), north, strict=True):
        assert max(abs(p - q) for p, q in zip(a, b, strict=True)) < 1e-24


# Transits, and what is refused -------------------------------------------------------------------------------------
def test_a_swing_in_the_meridian_plane_has_no_transits_and_the_separatrix_one() -> None:
    assert solve(changed("meridian_plane", t_end="5", level="confirmed")).zeros == {}
    (t,) = solve(changed("separatrix", level="confirmed")).transits.exact("t")
    assert abs(number(t) - MP.asinh(1) / 3) < 1e-28  # where the rod is level


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (
            ["creeping_far", "--t-end", "1000", "--set", "run.grid_step=1"],
            "Stiff: drag takes the speed away at 1.0e+06/s",
        ),
        pytest.param(
            ["separatrix", "--t-end", "2400", "--set", "run.grid_step=10"],
            "Rounding errors grow so fast",
            marks=pytest.mark.long,
        ),
        (
            ["paris_30d", "--t-end", "1e12", "--set", "run.grid_step=1e9"],
            "steps per simulated second",
        ),
        (["hard", "--set", "pendulum.drag=1e300"], "beyond the range of binary64"),
    ],
    ids=["stiff", "sensitive", "long", "out of range"],
)
def test_what_cannot_be_reached_ends_with_exit_3_and_its_reason(
    words, reason, tmp_path, foucault
) -> None:
    status, _, err = foucault("generate", *words, "--out", tmp_path / "made")
    assert status == 3
    assert reason in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
