"""Seven first-order formulations of the motion: momentum, inertial, space, spin, plane, angles, lagrangian."""

from __future__ import annotations

from typing import Any, Protocol

from .algebra import Functions, State, add, cross, dot, minus, plus, product, scale, subtract
from .constants import Constants, Vector
from .force import acceleration, force


class Formulation(Protocol):
    """One way to write the equations of motion as a first-order system, which an engine can integrate."""

    @property
    def name(self) -> str:
        """Its name, as in `FORMULATIONS`."""

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the state's variables, in order."""

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n = r/l with velocity v = r'/l."""

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and n' of a state."""

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return the time derivative of a state, in the order of `variables`."""


class Momentum:
    """H = n × (n' + Ω × n): n' = (H - Ω) × n, H' = n × c + H × Ω - γ n × n'.

    Quadratic, and neutral off the sphere: |n| and n·H are conserved also where |n| is not 1, so an
    error in them does not grow.
    """

    name = "momentum"
    variables = ("nx", "ny", "nz", "Hx", "Hy", "Hz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n with velocity v."""
        return (*n, *cross(n, add(v, cross(k.turn, n))))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and (H - Ω) × n."""
        n, momentum = _halves(state)
        return n, cross(subtract(momentum, k.turn), n)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return n' and H' as in the class's docstring."""
        n, momentum = _halves(state)
        _, v = self.cartesian(state, k, functions)
        torque = subtract(
            add(cross(n, k.pull), cross(momentum, k.turn)), scale(k.drag, cross(n, v))
        )
        return (*v, *torque)


class Inertial:
    """V = n' + Ω × n: n' = V - Ω × n, V' = c - Ω × V - n (V·V + n·c) - γ n'.

    Rounding leaves the sphere as in `space`, and so do heyoka's runs; only limbs puts n back on the
    sphere after every step (a projection).
    """

    name = "inertial"
    variables = ("nx", "ny", "nz", "Vx", "Vy", "Vz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n with velocity v."""
        return (*n, *add(v, cross(k.turn, n)))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and V - Ω × n."""
        n, inertial = _halves(state)
        return n, subtract(inertial, cross(k.turn, n))

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return n' and V' as in the class's docstring."""
        n, inertial = _halves(state)
        _, v = self.cartesian(state, k, functions)
        tension = plus(dot(inertial, inertial), dot(n, k.pull))
        free = subtract(k.pull, cross(k.turn, inertial))
        return (*v, *subtract(subtract(free, scale(tension, n)), scale(k.drag, v)))


class Space:
    """n'' = F - n (v·v + n·F): polynomial, but rounding leaves the sphere where the rod is pushed."""

    name = "space"
    variables = ("nx", "ny", "nz", "vx", "vy", "vz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n with velocity v."""
        return (*n, *v)

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return the two halves of the state, which are n and v."""
        return _halves(state)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return v and the acceleration."""
        n, v = _halves(state)
        return (*v, *acceleration(n, v, k))


class Spin:
    """w = n × v: n' = w × n, w' = n × F; cubic, and like `momentum` neutral off the sphere at every angle."""

    name = "spin"
    variables = ("nx", "ny", "nz", "wx", "wy", "wz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n with velocity v."""
        return (*n, *cross(n, v))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and w × n."""
        n, spin = _halves(state)
        return n, cross(spin, n)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return n' and w' as in the class's docstring."""
        n, v = self.cartesian(state, k, functions)
        return (*v, *cross(n, force(n, v, k)))


class Plane:
    """Mathar (32)-(43) over l: x, y and their rates, z = -sqrt(1 - x² - y²); below the suspension only."""

    name = "plane"
    variables = ("x", "y", "vx", "vy")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob below the suspension."""
        if not n[2] < 0:
            raise ValueError("The formulation plane is valid only below the suspension")
        return (n[0], n[1], v[0], v[1])

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and n', their third components from |n| = 1 and n·v = 0."""
        x, y, vx, vy = state
        depth = functions.sqrt(1 - x * x - y * y)
        return (x, y, -depth), (vx, vy, (x * vx + y * vy) / depth)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return (43), with β of (33)-(35), (39)-(41) divided by |z|³ and the constant terms gathered in c."""
        x, y, vx, vy = state
        _, north, up = k.turn
        _, yy, yz, zz = k.centrifugal
        square = 1 - x * x - y * y
        depth = functions.sqrt(square)
        area = x * vy - y * vx
        drive = minus((vx * vx + vy * vy - area * area) / (square * depth), k.pull[2])
        beta_x = plus(
            x * drive,
            product(2, vy, minus(product(y, north), product(depth, up))),
            product(-1, x, plus(product(yy, depth), product(yz, y))),
        )
        beta_y = plus(
            y * drive,
            product(-2, vx, minus(product(y, north), product(depth, up))),
            product(depth, minus(product(y, minus(zz, yy)), k.pull[1])),
            product(yz, square - y * y),
        )
        ax = (x * y * beta_y - (y * y + square) * beta_x) / depth
        ay = (x * y * beta_x - (x * x + square) * beta_y) / depth
        return (vx, vy, minus(ax, product(k.drag, vx)), minus(ay, product(k.drag, vy)))


class Angles:
    """Mathar (24), (26): cord angle φ from straight down, azimuth λ from east to north; singular at the vertical."""

    name = "angles"
    variables = ("phi", "lambda", "phi_rate", "lambda_rate")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob off the vertical; `functions` needs atan2 and sqrt."""
        square = n[0] * n[0] + n[1] * n[1]
        if not square > 0:
            raise ValueError("In the formulation angles the azimuth is undefined on the vertical")
        aside = functions.sqrt(square)
        return (
            functions.atan2(aside, -n[2]),
            functions.atan2(n[1], n[0]),
            v[2] / aside,
            (n[0] * v[1] - n[1] * v[0]) / square,
        )

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and n' by (7) and (10), over l."""
        sp, cp, sl, cl, phi_rate, azimuth_rate = _turned(state, functions)
        v = (
            phi_rate * cp * cl - azimuth_rate * sp * sl,
            phi_rate * cp * sl + azimuth_rate * sp * cl,
            phi_rate * sp,
        )
        return (sp * cl, sp * sl, -cp), v

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return (24) and (26) solved for the second derivatives, with R Ω² and g gathered in c."""
        sp, cp, sl, cl, phi_rate, azimuth_rate = _turned(state, functions)
        _, north, up = k.turn
        along = minus(product(north, sp, sl), product(up, cp))
        across = plus(product(up, sp), product(north, cp, sl))
        phi_second = plus(
            product(k.pull[1], cp, sl),
            product(k.pull[2], sp),
            product(-2, sp, along, azimuth_rate),
            product(-1, across, along),
            cp * sp * azimuth_rate * azimuth_rate,
            product(-1, k.drag, phi_rate),
        )
        turning = plus(
            -2 * cp * phi_rate * azimuth_rate,
            product(k.pull[1], cl),
            product(-1, along, minus(product(north, cl), 2 * phi_rate)),
        )
        return (
            phi_rate,
            azimuth_rate,
            phi_second,
            minus(turning / sp, product(k.drag, azimuth_rate)),
        )


class Lagrangian(Angles):
    """The system that `heyoka.lagrangian()` derives from L, kinetic minus potential energy: Mathar (16)-(21).

    The angles are those of (7). `derivatives` is that of `Angles`, which gives the same rates; runs
    integrate heyoka's.
    """

    name = "lagrangian"

    def lagrangian(self, state: State, k: Constants, functions: Functions) -> Any:
        """Return L / (m l²) = (α0 + α1 Ω + α2 Ω²)/2 + (g/l) cos φ, with α of (17)-(19)."""
        sp, cp, sl, cl, phi_rate, azimuth_rate = _turned(state, functions)
        alpha_0 = phi_rate * phi_rate + sp * sp * azimuth_rate * azimuth_rate
        alpha_1 = plus(
            product(2, k.axis_distance, phi_rate * cp * cl - azimuth_rate * sp * sl),
            product(2, sp * azimuth_rate, plus(product(k.sin, sp), product(k.cos, cp * sl))),
            product(-2, k.cos, phi_rate * cl),
        )
        arm = plus(k.axis_distance, product(-1, k.cos, cp), product(-1, k.sin, sp * sl))
        alpha_2 = plus(product(arm, arm), sp * sp * cl * cl)
        kinetic = plus(alpha_0, product(alpha_1, k.rate), product(alpha_2, k.rate, k.rate)) / 2
        return plus(kinetic, product(k.gravity, cp))


_INSTANCES: tuple[Formulation, ...] = (
    Momentum(),
    Inertial(),
    Space(),
    Spin(),
    Plane(),
    Angles(),
    Lagrangian(),
)
FORMULATIONS: dict[str, Formulation] = {formulation.name: formulation for formulation in _INSTANCES}


def _halves(state: State) -> tuple[Vector, Vector]:
    return (state[0], state[1], state[2]), (state[3], state[4], state[5])


def _turned(state: State, functions: Functions) -> tuple[Any, ...]:
    """Return sine and cosine of cord angle and azimuth, and the rates of both."""
    phi, azimuth, *rates = state
    return (
        functions.sin(phi),
        functions.cos(phi),
        functions.sin(azimuth),
        functions.cos(azimuth),
        *rates,
    )
