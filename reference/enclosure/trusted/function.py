"""TRUSTED. The golden function: Chebyshev series in doubles, and how far their values are from the truth.

What is bounded is the evaluation in doubles as docs/format.md specifies it, with or without fused
operations (THEOREM.md, section 10). Each piece of it lies in one step, and is compared with the tube
of that.

| code                 | text                                                     | unit          |
|----------------------|----------------------------------------------------------|---------------|
| `begin`, `end`       | a, b: the ends of a piece                                | s             |
| `series`             | c_k of x, of y and perhaps of z                          | m             |
| `gaps`               | g_k, of the step's polynomials less the series           | m             |
| `kappa`, `orders`    | κ, O                                                     | lengths; 1    |
| `eta`, `U`           | bounds of |r - p|, |v - p'|                              | a step's time |
| `lam`                | λ: û is off by at most λε                                | 1             |
| `HALF`               | ε, with what is of second order                          | 1             |
| `L`                  | the double next to l²                                    | m²            |
| `d`, `e`, `rho`, `v` | of (x, y) and (vx, vy): bounds of errors, and of sizes   | m, m/s        |
| `f`, `m`             | how far L - (x² + y²) is from z²; a lower bound of |z|   | m², m         |
"""

from array import array
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_poly, ctx, fmpq_mat, fmpz_poly

from .balls import SHORT, ball, demand, interval, size, times, total
from .course import FINISHED, Course
from .defect import Piece
from .printed import document
from .shapes import Covered, ProvedFunction
from .system import SceneBalls

CUT = 36  # orders of a step that are compared, and coefficients that a series may have
# ε: what an operation on doubles loses of its result, and second orders
HALF = (1 + arb(2) ** -20) * arb(2) ** -53
TINY = arb(2) ** -1000  # and this, where numbers are too small to have 53 bits


class ComponentBounds(NamedTuple):
    """Of a component: bounds of the error of its value, of this, of the error of its rate, of this."""

    error: arb
    size: arb
    rate_error: arb
    rate_size: arb


class ErrorsOfZ(NamedTuple):
    """Bounds of the errors of z and vz."""

    z: arb
    vz: arb


@dataclass(frozen=True)
class FunctionPiece:
    """A piece of a golden function.

    `until` is its end, a double, and `series` an array of doubles: CUT of each component. `of_proof`
    has a row for each component: the `ComponentBounds` of (10.1a, b), before anything is evaluated.
    """

    until: Any
    series: Any
    lam: int
    duration: Fraction
    of_proof: arb_mat


@lru_cache
def basis() -> arb_mat:
    """Return the exact matrix that turns a row of powers' coefficients into Chebyshev ones."""
    powers = fmpq_mat(
        CUT, CUT, [fmpz_poly.chebyshev_t(n)[k] for n in range(CUT) for k in range(CUT)]
    )
    return arb_mat(CUT, CUT, [arb(q) for q in powers.inv().entries()])


@lru_cache(maxsize=1)
def position(piece: Piece, begin: Fraction, end: Fraction, count: int) -> arb_mat:
    """Return Chebyshev coefficients of x, y (z) in m between two times of a step, up to order CUT."""
    step = piece.step
    balls = piece.balls
    with ctx.workprec(balls.prec):
        middle = ball(((begin + end) / 2 - step.centre) / step.h)
        half = ball((end - begin) / (2 * step.h))
        s_of_u = arb_poly([middle, half])
        composed = [arb_poly(f.truncate(CUT))(s_of_u) for f in piece.p]
        components = times(balls.length / piece.unit, balls.turned(composed, -1)[:count])
        rows = []
        for polynomial in components:
            coefficients = polynomial.coeffs()
            rows.append(coefficients + [0] * (CUT - len(coefficients)))
        return arb_mat(rows) * basis()


def variable_error(begin: Fraction, end: Fraction) -> int:
    """Return λ of a piece (Lemma 10.2)."""
    return 1 if 2 * begin >= end else 5  # (10.2a)


@lru_cache
def weights(degree: int, lam: int) -> arb_mat:
    """Return what |c_k| adds to the four `ComponentBounds`, in a row for each k, rates over 2/(b - a).

    Coefficients up to `degree` are evaluated; the others are left out, and so are all with -1.
    """
    rows = list[Any]()
    for k in range(CUT):
        if k <= degree:
            value = HALF * ((2 + lam) * k**2 + k + 1)  # (10.3c)
            rate = HALF * k**2 * ((2 + lam) * k**2 + 3 * k + 7) / 3  # (10.3d)
            rows.append((value, 1, rate, k**2))  # the sizes by (10.3f)
        else:
            rows.append((1, 1, k**2, k**2))  # (10.3e), (10.3f)
    return arb_mat(rows)


def costs(series: Any, weight: arb_mat, duration: Fraction) -> arb_mat:
    """Return `ComponentBounds` of sums of |c_k| with weights, in a row for each component."""
    sizes = arb_mat(len(series) // CUT, CUT, [abs(c) for c in series])
    rate = ball(2 / duration)
    to_rates = arb_mat(4, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, rate, 0, 0, 0, 0, rate])
    return sizes * weight * to_rates


class Following:
    """Compares series with the tubes that a course gives it."""

    def __init__(self, course: Course, count: int) -> None:
        demand(count in (2, 3), "a golden function has series of x and y, or of x, y and z")
        self.count = 2 if count == 2 else 3
        self.course = course
        self.balls = course.balls
        self.covered: Covered | None = None
        self.end = Fraction(0)
        self.pieces = list[FunctionPiece]()
        course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next step's tube."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        self.covered = covered

    def add(self, until: Any, series: Any) -> None:
        """Take the next piece of the function, in the step that was proved last.

        Args:
            until: its end, a double.
            series: CUT coefficients, doubles, of x, then of y and perhaps of z.
        """
        # copies: what is bounded is what is printed, whatever these objects say when they are asked again
        (until,) = array("d", [until])
        series = array("d", series)
        demand(
            len(series) == CUT * self.count,
            f"a piece of the function has {CUT} coefficients of each component",
        )
        demand(abs(until) < 1 << 1000, "a piece of the function must end at a finite time")
        if self.covered is None:
            raise ArithmeticError("a piece of the function needs a step that was proved")

        piece = self.covered.piece
        begin = self.end
        end = Fraction(until)
        joins = piece.begin <= begin and begin + Fraction(1, 1 << 60) < end <= piece.end
        demand(joins, "a piece of the function must join, and lie in the step that was proved last")
        of_proof = self._of_proof(self.covered, begin, end, series)
        lam = variable_error(begin, end)
        self.pieces.append(FunctionPiece(until, series, lam, end - begin, of_proof))
        self.end = end

    def _of_proof(self, covered: Covered, begin: Fraction, end: Fraction, series: Any) -> arb_mat:
        """Return how far exact values of a piece are from the truth at most (Lemma 10.1)."""
        piece = covered.piece
        tube = covered.tube
        with ctx.workprec(self.balls.prec):
            exact = arb_mat(self.count, CUT, [*series])
            gaps = position(piece, begin, end, self.count) - exact
            kappa = size([total(f - f.truncate(CUT), piece.step.bits) for f in piece.p])
            orders = max(map(len, piece.p))
            # (10.1a, b): the errors of the polynomials; their sizes are those of the series
            value = self.balls.length * (tube.eta + kappa)
            rate = self.balls.length * ((tube.u + kappa * orders) / piece.constants.h)
            of_tube = arb_mat([[value, arb(0), rate, arb(0)]] * self.count)
            # Σ|g_k| and (2/(b - a)) Σ k²|g_k|
            return of_tube + costs(gaps.entries(), weights(-1, 0), end - begin)

    def finish(self, degree: int) -> ProvedFunction:
        """Finish the course as well; return the series, cut to `degree`, with bounds of their values."""
        demand(0 <= degree < CUT, f"a series has a degree from 0 to {CUT - 1}")
        degree = range(CUT)[degree]
        proved = self.course.finish()
        square = self.balls.inputs.length**2
        L = square.numerator / square.denominator if self.count == 2 else None
        facts = {
            "degree": degree,
            "components": ["x", "y", "z"][: self.count],
            "length_squared": L and L.hex(),
            "times": ["0x0.0p+0", *(piece.until.hex() for piece in self.pieces)],
        }
        bounds = self._bounds(degree, L)
        function = ProvedFunction(proved, facts, bounds, self._data(degree))
        FINISHED.add(function)
        return function

    def _bounds(self, degree: int, L: Any) -> dict[str, Fraction]:
        """Return how far values in doubles are from the truth at most, at any time, by name."""
        with ctx.workprec(SHORT):
            largest = [ComponentBounds(TINY, TINY, TINY, TINY)] * self.count
            for piece in self.pieces:
                evaluated = costs(piece.series, weights(degree, piece.lam), piece.duration)
                rows = bounds_of(piece.of_proof + evaluated)
                largest = [larger(a, b) for a, b in zip(largest, rows, strict=True)]

            x, y, *others = largest
            errors = {"x": x.error, "vx": x.rate_error, "y": y.error, "vy": y.rate_error}
            if L is None:
                (z,) = others
                errors |= {"z": z.error, "vz": z.rate_error}
            else:
                of_z = on_sphere(self.balls, ball(Fraction(L)), x, y)
                errors |= {"z": of_z.z, "vz": of_z.vz}
            return {name: interval(error).high for name, error in errors.items()}

    def _data(self, degree: int) -> bytes:
        """Return function.f64: the series of each piece, cut to `degree`, component by component."""
        data = list[bytes]()
        for piece in self.pieces:
            for i in range(0, CUT * self.count, CUT):
                data.append(piece.series[i : i + degree + 1].tobytes())
        return b"".join(data)


def bounds_of(matrix: arb_mat) -> list[ComponentBounds]:
    """Return the rows of a matrix with four columns as bounds."""
    entries = matrix.entries()
    return [ComponentBounds(*entries[i : i + 4]) for i in range(0, len(entries), 4)]


def larger(a: ComponentBounds, b: ComponentBounds) -> ComponentBounds:
    """Return the larger of two bounds each, the second one with what tiny numbers lose."""
    return ComponentBounds(*(x.max(y + TINY) for x, y in zip(a, b, strict=True)))


def on_sphere(balls: SceneBalls, L: arb, x: ComponentBounds, y: ComponentBounds) -> ErrorsOfZ:
    """Return bounds of the errors of z = -√(L - (x² + y²)) and vz = -(x vx + y vy)/z in doubles.

    Where (10.4b) fails they are not finite (Lemma 10.4).
    """
    demand(balls.release[0][2] < 0, "z has no series, and is not negative at the release")
    length = balls.length
    d = size([x.error, y.error])
    e = size([x.rate_error, y.rate_error])
    # both of what is true and of what is evaluated
    rho = size([x.size, y.size]) + d
    v = size([x.rate_size, y.rate_size]) + e

    f = abs(L - length**2) + 2 * rho * d + HALF * (3 * rho**2 + L) + TINY  # (10.4a)
    m = (length**2 - rho**2 - f).sqrt()  # (10.4b)
    z = f / (2 * m) + HALF * length  # (10.4c)
    vz = (rho * e + v * (d + rho * z / m + 4 * HALF * rho) + TINY) / m / (1 - HALF)  # (10.4d)
    return ErrorsOfZ(z, vz)


def check_function(text: str, data: bytes, function: Any, proved: Any) -> None:
    """Demand that function.json and function.f64 are a function that was bounded in this very proof."""
    manifest = document(text)
    right = function in FINISHED and function.proved is proved and data == function.data
    for key, fact in function.facts.items():
        right &= manifest[key] == fact
    for name, bound in function.bounds.items():
        right &= Fraction(manifest["bounds"][name]) >= bound
    demand(right, "misprint: the golden function")
