"""The third source paper: its equations, and three methods: turning axes, the Coriolis theorem, complex variables."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .checks import Answer, Approximate, Check, Identity, Statement, component, over, section
from .digits import (
    MP,
    Vector,
    cos,
    cross,
    derivative,
    dot,
    j,
    mpf,
    norm,
    shown,
    sin,
    sqrt,
    unit,
    vanishes,
    vector,
)
from .first_principles import (
    acceleration_of,
    coupled,
    coupled_at,
    coupled_complex,
    forces,
    linearised,
    motion,
    plane_state,
    rate_up,
    swing_rate,
    turned_in_plane,
    turning,
    uniform_acceleration,
)
from .points import Point, paris, points

Path = Callable[[Any], Vector]


def axes_rate(p: Point) -> Any:
    """Return ω_p = -ω sinα."""
    return -rate_up(p)


def _axes_turn(p: Point) -> Vector:
    return vector(0, 0, axes_rate(p))


def primed(path: Path, rate: Any) -> Path:
    """Return x' = x cosω_p t - y sinω_p t, y' = x sinω_p t + y cosω_p t along a path."""
    return lambda t: turned_in_plane(path(t), rate * t)


def generic_path(p: Point) -> Path:
    """Return a path x, y with the point's velocities and accelerations at its time."""
    place, speed, second = plane_state(p)
    return lambda t: place + speed * (t - p.t) + second * (t - p.t) ** 2 / 2


def _excess(p: Point, rate: Any) -> Vector:
    """Return what x', y' along the point's path leave over in the equations of motion."""
    turned = primed(generic_path(p), rate)
    place, speed, second = turned(p.t), derivative(turned, p.t), derivative(turned, p.t, 2)
    return second - coupled(p, place, speed)


def unprimed_equation(p: Point, rate: Any) -> Vector:
    """Return the x'', y'' for which x', y' obey the two equations, solved from their second derivatives."""
    zero, *units = (
        _excess(p.but(ax=MP.mpf(ax), ay=MP.mpf(ay)), rate) for ax, ay in ((0, 0), (1, 0), (0, 1))
    )
    columns = MP.matrix([(excess - zero).tolist() for excess in units])
    return vector(*MP.lu_solve(columns.T, MP.matrix((-zero).tolist())))


def measured_rate(p: Point) -> Any:
    """Return ω̃ from x'' of a bob at rest at x = 1 in the turning axes."""
    return sqrt(
        -unprimed_equation(p.but(x=MP.one, y=MP.zero, vx=MP.zero, vy=MP.zero), axes_rate(p))[0]
    )


def _away_from_axis() -> Answer:
    p = points()[0]
    axis, far = turning(p), vector(0, 0, p.radius)
    pushed = -cross(axis, cross(axis, far))
    across = far - dot(far, unit(axis)) * unit(axis)
    gap = norm(unit(pushed) - unit(across))
    return Answer(vanishes(gap), f"-ω × (ω × r) points away from the axis to within {shown(gap)}")


def _any_rate(p: Point) -> Any:
    """Return some ω_p, not the special one."""
    return p.cord_rate


def _turned(p: Point, xy: Vector) -> Vector:
    """Return x cosω_p t - y sinω_p t and x sinω_p t + y cosω_p t."""
    return turned_in_plane(xy, _any_rate(p) * p.t)


def _first(p: Point) -> Vector:
    """Return x', y' dot as printed, second form."""
    w = _any_rate(p)
    return _turned(p, (p.vx - p.y * w, p.x * w + p.vy))


def _second(p: Point) -> Vector:
    """Return x', y' double dot as printed, second form."""
    w = _any_rate(p)
    return _turned(p, (p.ax - 2 * p.vy * w - p.x * w**2, p.ay + 2 * p.vx * w - p.y * w**2))


def _second_long(p: Point) -> Vector:
    """Return x', y' double dot as printed, first form."""
    w, c, s = _any_rate(p), cos(_any_rate(p) * p.t), sin(_any_rate(p) * p.t)
    return vector(
        (p.ax - p.vy * w) * c
        - (p.vx - p.y * w) * w * s
        - (p.vx * w + p.ay) * s
        - (p.x * w + p.vy) * w * c,
        (p.ax - p.vy * w) * s
        + (p.vx - p.y * w) * w * c
        + (p.vx * w + p.ay) * c
        - (p.x * w + p.vy) * w * s,
    )


def _derived(order: int) -> Callable[[Point], Vector]:
    return lambda p: derivative(primed(generic_path(p), _any_rate(p)), p.t, order)


def _printed_unprimed(p: Point, rate: Any) -> Vector:
    """Return x'', y'' from the pair printed before "which decouples"."""
    up = rate_up(p)
    k = p.gravity / p.length - 2 * up * rate - rate**2
    return vector(-k * p.x + 2 * (up + rate) * p.vy, -k * p.y - 2 * (up + rate) * p.vx)


def _two_ways(p: Point) -> Vector:
    pull, rate = p.gravity / p.length, axes_rate(p)
    first = sqrt(pull - 2 * p.rate * rate * sin(p.phi) - rate**2)
    return vector(first, sqrt(pull + 2 * rate / sin(p.phi) * rate * sin(p.phi) - rate**2))


def _far_below_gravity() -> Answer:
    p = paris()
    ratio = p.rate * norm((p.x, p.y)) * sqrt(p.gravity / p.length) / p.gravity
    return Answer(ratio < mpf("1e-4"), f"ω xdot / g = {shown(ratio)} in Paris")


def _centrifugal(p: Point) -> Vector:
    """Return -m ω_p × (ω_p × x')."""
    return -p.mass * cross(_axes_turn(p), cross(_axes_turn(p), (p.x, p.y, 0)))[:2]


def _turned_drive(p: Point) -> Vector:
    """Return F_eff/m of the lines before, with the velocity in axes at rest, x' + ω_p × x'."""
    speed = p.velocity[:2] + axes_rate(p) * vector(-p.y, p.x)
    return coupled(p, p.position, speed)


def _moved_acceleration(p: Point) -> Vector:
    """Return the acceleration of the linear motion, seen from axes that turn at ω_p and coincide at t = 0."""
    rate = axes_rate(p)
    start = (p.x, p.y, p.vx - rate * p.y, p.vy + rate * p.x)
    return derivative(primed(lambda t: motion(p, start, t)[:2], -rate), 0, 2)


def _simple_in_frame() -> Answer:
    def excess(p: Point) -> Any:
        bent = 2 * axes_rate(p) * vector(p.vy, -p.vx)  # as seen from the turning axes
        pushed = (axes_rate(p) ** 2 + swing_rate(p) ** 2) * p.position[:2]
        return norm(_turned_drive(p) + bent + pushed)

    gap = max(map(excess, points()))
    return Answer(
        vanishes(gap), f"x'' + (g/L + ω_P²) x = {shown(gap)} in axes that turn at -ω sinα"
    )


def _spun(p: Point) -> tuple[Any, Any, Any]:
    """Return w, w', w'' of z = w exp(-iω_P t) at t = 0, for the linear motion from the point."""

    def w(t: Any) -> Any:
        x, y = motion(p, (p.x, p.y, p.vx, p.vy), t)[:2]
        return MP.mpc(x, y) * MP.expj(rate_up(p) * t)

    return w(MP.zero), derivative(w), derivative(w, 0, 2)


def _substituted(p: Point) -> Any:
    w, first, second = _spun(p)
    up = rate_up(p)
    return (
        (second - 2 * j * up * first - up**2 * w)
        + 2 * j * up * (first - j * up * w)
        + p.gravity / p.length * w
    )


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return section("methods_", "Three methods",
        Identity("newton", "", "T - mgk - 2m ω × v = m a",
            forces, lambda p: p.mass * acceleration_of(p),
            remark="truth: reference.model.force with gravity alone; T along the cord"),
        Identity("centrifugal", "", "|ω × (ω × r)| = ω² r cosα", lambda p: p.rate**2 * p.radius * cos(p.phi),
            lambda p: norm(cross(turning(p), cross(turning(p), (0, 0, p.radius))))),
        Statement("away", "", "with direction away from the axis of rotation", _away_from_axis),
        Approximate("sine", "", "mg sinθ ≈ mgθ",
            lambda s: (points()[0].cord * s, sin(points()[0].cord * s)), 2, "θ", remark="at a random θ of 0.9 rad"),
        Approximate("hooke", "", "T - mgk ≈ -(mg/L) ρ (i cosφ + j sinφ)",
            over(points()[0].but(rate=MP.zero).swinging, lambda p: -p.gravity / p.length * p.position[:2],
                uniform_acceleration), 2, "amplitude", remark="horizontal part, at a random point"),
        Identity("omega", "", "ω = ω (j cosα + k sinα)",
            lambda p: (0, p.rate * cos(p.phi), p.rate * sin(p.phi)), lambda p: p.k.turn),
        Identity("cross", "", "-2ω × v = 2ω xdot k cosα - 2ω xdot j sinα + 2ω ydot i sinα",
            lambda p: 2 * p.rate * vector(p.vy * sin(p.phi), -p.vx * sin(p.phi), p.vx * cos(p.phi)),
            lambda p: -2 * cross(p.k.turn, (p.vx, p.vy, 0))),
        Approximate("z", "", "2ω xdot cosα = zddot (and ignored)",
            over(points()[0].swinging, lambda p: 2 * p.rate * p.vx * cos(p.phi), component(acceleration_of, 2)), 1,
            "amplitude", "m/s²", remark="at a random point; the cord's vertical pull differs from mg by as much"),
        Identity("pair", "", "xddot + (g/L) x = 2ω sinα ydot, yddot + (g/L) y = -2ω sinα xdot", coupled_at, linearised,
            remark="truth: reference.model.force with gravity alone, linear"),
        Identity("1_first", ", method 1", "xdot' = (xdot - yω_p) cosω_p t - (xω_p + ydot) sinω_p t, ydot' = …",
            _first, _derived(1)),
        Identity("1_second_a", ", method 1", "xddot' and yddot', first form", _second_long, _derived(2)),
        Identity("1_second", ", method 1",
            "xddot' = (xddot - 2ydot ω_p - xω_p²) cosω_p t - (yddot + 2xdot ω_p - yω_p²) sinω_p t, …",
            _second, _derived(2)),
        Identity("1_substituted", ", method 1",
            "(xddot + (…) x - 2(…) ydot) cosω_p t = (yddot + (…) y + 2(…) xdot) sinω_p t, …",
            lambda p: _turned(p, vector(p.ax, p.ay) - _printed_unprimed(p, _any_rate(p))),
            lambda p: _excess(p, _any_rate(p)),
            remark="the scan is garbled here; the brackets are those of the pair that follows"),
        Identity("1_pair", ", method 1", "xddot + (g/L - 2ω sinα ω_p - ω_p²) x - 2(ω sinα + ω_p) ydot = 0, yddot + …",
            lambda p: _printed_unprimed(p, _any_rate(p)), lambda p: unprimed_equation(p, _any_rate(p))),
        Identity("1_rate", ", method 1", "decouples for ω_p = -ω sinα",
            lambda p: unprimed_equation(p.but(x=MP.zero, y=MP.zero), axes_rate(p)), lambda p: (0, 0),
            remark="x'', y'' that velocities alone give"),
        Identity("1_simple", ", method 1", "xddot + ω̃² x = 0, yddot + ω̃² y = 0",
            lambda p: -swing_rate(p) ** 2 * p.position[:2], lambda p: unprimed_equation(p, axes_rate(p))),
        Identity("1_omega", ", method 1",
            "ω̃ = sqrt(g/L - 2ωω_p sinα - ω_p²) = sqrt(g/L + 2(ω_P/sinα) ω_p sinα - ω_p²)",
            _two_ways, lambda p: (measured_rate(p), measured_rate(p)),
            remark="truth: eigenvalues of the decoupled pair"),
        Identity("1_omega2", ", method 1", "ω̃ = sqrt(g/L + ω_p²)", swing_rate, measured_rate),
        Approximate("1_omega3", ", method 1", "ω̃ ≈ sqrt(g/L)",
            over(lambda s: paris().but(rate=paris().rate * s), lambda p: sqrt(p.gravity / p.length), swing_rate), 2,
            "ω", remark="in Paris"),
        Approximate("1_amplitude", ", method 1", "A ω̃ = L θ_max ω̃",
            lambda s: (points()[0].cord * s, sin(points()[0].cord * s)), 2, "θ_max", remark="A over L, at a random θ"),
        Statement("1_small", ", method 1", "ω xdot << g", _far_below_gravity),
        Identity("2_vector", ", method 2", "m xddot = -(mg/L) x - 2m (ω sinα k) × xdot",
            lambda p: -p.gravity / p.length * p.position[:2] - 2 * cross((0, 0, rate_up(p)), (p.vx, p.vy, 0))[:2],
            linearised),
        Identity("2_coriolis", ", method 2", "m xddot' = F_eff - 2m ω_p × xdot' - m ω_p × (ω_p × x')",
            lambda p: _turned_drive(p) - 2 * cross(_axes_turn(p), (p.vx, p.vy, 0))[:2] + _centrifugal(p) / p.mass,
            _moved_acceleration,
            remark="F_eff with the velocity in axes at rest; truth: the linear motion, seen from the turning axes"),
        Identity("2_centrifugal", ", method 2", "-m ω_p × (ω_p × x') = -m ω_p² x'",
            lambda p: -p.mass * axes_rate(p) ** 2 * p.position[:2], _centrifugal, "+m ω_p² x'",
            lambda p: p.mass * axes_rate(p) ** 2 * p.position[:2]),
        Identity("2_force", ", method 2", "F_eff = -(mg/L) x' - 2m (ω sinα k) × xdot'",
            coupled_at, _turned_drive,
            "xdot = xdot' + ω_p × x' belongs in it; the two errors cancel",
            lambda p: coupled(p, (p.x, p.y), (p.vx - axes_rate(p) * p.y, p.vy + axes_rate(p) * p.x))),
        Identity("2_end", ", method 2", "xddot' = -(g/L) x' - ω_p² x'",
            lambda p: -swing_rate(p) ** 2 * p.position[:2], _moved_acceleration),
        Identity("2_omega", ", method 2", "ω = sqrt(g/L + ω_p²)", swing_rate, measured_rate),
        Identity("3_z", ", method 3", "zddot + 2iω_P zdot + (g/L) z = 0, ω_P = ω sinα",
            coupled_complex, lambda p: MP.mpc(*linearised(p)),
            remark="ω_P with the other sign than in method 1 and in the conclusion, where it is the axes' -ω sinα"),
        Identity("3_w", ", method 3", "(wddot - 2iω_p wdot - ω_P² w) + 2iω_P (wdot - iω_P w) + (g/L) w = 0",
            _substituted, lambda p: 0),
        Identity("3_simple", ", method 3", "wddot + (g/L + ω_P²) w = 0",
            lambda p: -swing_rate(p) ** 2 * _spun(p)[0], lambda p: _spun(p)[2]),
        Identity("3_omega", ", method 3", "ω = sqrt(g/L + ω_P²)", swing_rate, measured_rate),
        Statement("end_frame", ", conclusion",
            "in axes that turn at -ω sinα: simple harmonic, frequency sqrt(g/L + ω_P²)", _simple_in_frame),
    )  # fmt: skip
