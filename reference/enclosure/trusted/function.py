"""TRUSTED. The golden function: Chebyshev series in doubles, and how far their values are from the truth at any time.

What is bounded is the evaluation in doubles as docs/format.md specifies it, with or without fused operations
(THEOREM.md, section 10). Each piece of it lies in one step, and is compared with the tube of that.
"""

from array import array
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import arb, arb_mat, arb_poly, ctx, fmpq_mat, fmpz_poly

from .balls import SHORT, Vector, ball, demand, interval, size, times, total
from .course import FINISHED, Course
from .defect import Piece
from .printed import document
from .shapes import Covered, ProvedFunction

NAMES = ("x", "", "vx", "", "y", "", "vy", "", "z", "", "vz")  # of the bounds; the others are sizes
CUT = 36  # orders of a step that are compared, and coefficients that a series may have
# what an operation on doubles loses of its result, and second orders
HALF = (1 + arb(2) ** -20) * arb(2) ** -53
TINY = arb(2) ** -1000  # and this, where numbers are too small to have 53 bits


@lru_cache
def basis() -> arb_mat:
    """Return the exact matrix by which coefficients of powers become those of Chebyshev polynomials, in a row."""
    powers = fmpq_mat(
        CUT, CUT, [fmpz_poly.chebyshev_t(n)[k] for n in range(CUT) for k in range(CUT)]
    )
    return arb_mat(CUT, CUT, [arb(q) for q in powers.inv().entries()])


@lru_cache(maxsize=1)
def position(piece: Piece, low: Fraction, high: Fraction, count: int) -> arb_mat:
    """Return Chebyshev coefficients from time `low` to `high` of x, y (z) in m, but for a step's orders from CUT on."""
    step, balls = piece.step, piece.balls
    with ctx.workprec(balls.prec):
        s = arb_poly(
            [ball(((low + high) / 2 - step.centre) / step.h), ball((high - low) / (2 * step.h))]
        )
        turned = balls.turned([arb_poly(f.truncate(CUT))(s) for f in piece.p], -1)[:count]
        rows = [f.coeffs() for f in times(balls.length / piece.unit, turned)]
        return arb_mat([row + [0] * (CUT - len(row)) for row in rows]) * basis()


@lru_cache
def weights(degree: int, off: int) -> arb_mat:
    """Return what |c_k| adds to errors, by rounding or by being left out, and to sizes: of the value, of the rate."""
    kept = [
        (HALF * (off * k**2 + k + 1), 1, HALF * k**2 * (off * k**2 + 3 * k + 7) / 3, k**2)
        for k in range(CUT)
    ]
    return arb_mat([*kept[: degree + 1], *((1, 1, k**2, k**2) for k in range(degree + 1, CUT))])


def costs(series: Any, weight: arb_mat, time: Fraction) -> arb_mat:
    """Return sums of |c_k| with weights, a row for each component, and rates over half a time."""
    sizes = arb_mat(len(series) // CUT, CUT, [abs(c) for c in series])
    return (
        sizes
        * weight
        * arb_mat(4, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, ball(2 / time), 0, 0, 0, 0, ball(2 / time)])
    )


class Following:
    """Compares series with the tubes that a course gives it."""

    def __init__(self, course: Course, count: int) -> None:
        demand(count in (2, 3), "a golden function has series of x and y, or of x, y and z")
        self.count = 2 if count == 2 else 3
        self.course, self.balls, self.covered = course, course.balls, list[Covered]()
        self.end, self.pieces = Fraction(0), list[Any]()
        course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next step's tube."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        self.covered = [covered]

    def add(self, until: Any, series: Any) -> None:
        """Take the next piece, up to the double `until`: CUT coefficients, doubles, of x, then y and perhaps z."""
        # copies: what is bounded is what is printed, whatever these objects say when they are asked again
        (until,), series = array("d", [until]), array("d", series)
        demand(
            len(series) == CUT * self.count,
            f"a piece of the function has {CUT} coefficients of each component",
        )
        demand(abs(until) < 1 << 1000, "a piece of the function must end at a finite time")
        ((piece, tube),), begin, end = self.covered, self.end, Fraction(until)
        joins = piece.begin <= begin and begin + Fraction(1, 1 << 60) < end <= piece.end
        demand(joins, "a piece of the function must join, and lie in the step that was proved last")
        with ctx.workprec(self.balls.prec):
            gap = position(piece, begin, end, self.count) - arb_mat(self.count, CUT, [*series])
            cut, orders = (
                size([total(f - f.truncate(CUT), piece.step.bits) for f in piece.p]),
                max(map(len, piece.p)),
            )
            row = times(
                self.balls.length,
                [tube.eta + cut, arb(0), (tube.u + cut * orders) / piece.constants.h, arb(0)],
            )
            off = arb_mat([row] * self.count) + costs(gap.entries(), weights(-1, 0), end - begin)
        self.pieces.append((until, series, 3 if 2 * begin >= end else 7, end - begin, off))
        self.end = end

    def finish(self, degree: int) -> ProvedFunction:
        """Finish the course as well; return the series, cut to `degree`, with bounds of what they evaluate to."""
        demand(0 <= degree < CUT, f"a series has a degree from 0 to {CUT - 1}")
        degree = range(CUT)[degree]
        proved, most, square = (
            self.course.finish(),
            [TINY] * (4 * self.count),
            self.balls.inputs.length**2,
        )
        with ctx.workprec(SHORT):
            for _, series, late, time, off in self.pieces:
                sums = off + costs(series, weights(degree, late), time)
                most = [x.max(y + TINY) for x, y in zip(most, sums.entries(), strict=True)]
            near = square.numerator / square.denominator if self.count == 2 else None
            most += on_sphere(self.balls, ball(Fraction(near)), *most) if near else []
            bounds = {name: interval(x).high for name, x in zip(NAMES, most, strict=False) if name}
        facts = {
            "degree": degree,
            "components": ["x", "y", "z"][: self.count],
            "length_squared": near and near.hex(),
        }
        facts["times"] = ["0x0.0p+0", *(piece[0].hex() for piece in self.pieces)]
        parts = [
            piece[1][i : i + degree + 1]
            for piece in self.pieces
            for i in range(0, CUT * self.count, CUT)
        ]
        data = b"".join(part.tobytes() for part in parts)
        FINISHED.add(function := ProvedFunction(proved, facts, bounds, data))
        return function


def on_sphere(balls: Any, near: arb, *most: arb) -> Vector:
    """Return bounds of z = -sqrt(near - (x² + y²)) and vz = -(x vx + y vy)/z in doubles."""
    (d, wide, e, fast), length = (size([most[i], most[i + 4]]) for i in range(4)), balls.length
    wide, fast = wide + d, fast + e  # both what is true and what is evaluated
    off = abs(near - length**2) + 2 * wide * d + HALF * (3 * wide**2 + near) + TINY
    low = (length**2 - wide**2 - off).sqrt()  # of |z|, likewise
    z = off / (2 * low) + HALF * length
    demand(balls.release[0][2] < 0, "z has no series, and is not negative at the release")
    return [
        z,
        TINY,
        (wide * e + fast * (d + wide * z / low + 4 * HALF * wide) + TINY) / low / (1 - HALF),
    ]


def check_function(text: str, data: bytes, function: Any, proved: Any) -> None:
    """Demand that function.json and function.f64 are a function that was bounded in this very proof."""
    said, right = (
        document(text),
        function in FINISHED and function.proved is proved and data == function.data,
    )
    right &= all(said[key] == fact for key, fact in function.facts.items())
    right &= all(Fraction(said["bounds"][name]) >= bound for name, bound in function.bounds.items())
    demand(right, "misprint: the golden function")
