"""TRUSTED. The error bound for large angles: a matrix of six columns carries it; Theorems E and N.

The columns are proposals: integers over 2^FINE, so they are exact whatever floats they were rounded from.
"""

from flint import arb, arb_mat, arb_poly, ctx, fmpz, fmpz_poly

from .balls import SHORT, UNIT, Vector, add, ball, cross, dot, size, times, upper
from .defect import Piece
from .radius import CarriedState, error_rate
from .shapes import Covered, Proposal
from .tube import tube

FINE = 50  # a column's coefficients are integers over 2^FINE
CUT = 48  # terms of p and K in the residuals, which are multiplied by the small z_j


class Columns(CarriedState):
    """Theorem E: (r, H) = (p + Wp ζ, K + WK ζ) + (e, g) with |ζ_j| <= z_j; `rest` bounds e and g (g in 1/s)."""

    rest, z, carried = [arb(0)] * 6, [arb(0)] * 6, arb_mat(6, 6)

    def advance(self, piece: Piece, proposal: Proposal) -> Covered:
        """Carry the box of the z_j over `piece`; `proposal[j]` holds the six polynomials of column j."""
        k, step, d, columns = (
            piece.constants,
            piece.step,
            piece.sizes,
            [[fmpz_poly(f) for f in c] for c in proposal],
        )
        with ctx.workprec(2 * SHORT):
            jump = self.join(piece)
            slack = add([*jump.p, *jump.K], self.rest)
            inverse = matrix(columns, ball(step.low), k.h).inv()
            moved, self.carried = inverse * self.carried, matrix(columns, ball(step.high), k.h)
            pairs = [
                (moved[i, j].abs_upper() * self.z[j], inverse[i, j].abs_upper() * slack[j])
                for i, j in GRID
            ]
            self.z = [
                upper(sum((a + b for a, b in pairs[6 * i : 6 * i + 6]), arb(0))) for i in range(6)
            ]
        with ctx.workprec(SHORT):
            rows = [
                times(z, sizes) for z, sizes in zip(self.z, residuals(piece, columns), strict=True)
            ]
            zp, zk, d1, d2 = add([arb(0), arb(0), d.d1, d.d2], *rows)
            d1, d2, span = (
                d1 + zp * zk,
                d2 + k.drag_size * k.omega_size * zp**2,
                ball(step.high - step.low),
            )
            left = upper(span * (d2 / k.w + d1) * (span * error_rate(k, d.p + zp)).exp())
            self.rest = [left] * 3 + [upper(left * self.balls.w0)] * 3
            return Covered(piece, tube(k, d, zp + left, zk + left * k.w))


GRID = [(i, j) for i in range(6) for j in range(6)]


def matrix(columns: list[Vector], s: arb, h: arb) -> arb_mat:
    """Return the columns at `s`, H in 1/s."""
    values = [arb_poly(columns[j][i])(s) / (fmpz(1) << FINE) for i, j in GRID]
    return arb_mat(6, 6, [*values[:18], *times(1 / h, values[18:])])


def cut(f: arb_poly, terms: int = CUT) -> arb_poly:
    """Return a short polynomial that contains f at every |s| <= 1."""
    return f.truncate(terms) + arb(0, f.right_shift(terms)(UNIT).abs_upper())


def residuals(piece: Piece, columns: list[Vector]) -> list[list[arb]]:
    """Return |Wp|, |WK|, |R1|, |R2| for each column."""
    k, out = piece.constants, []
    p, v = ([cut(arb_poly(f) * (1 / arb(piece.unit))) for f in part] for part in (piece.p, piece.v))
    K = [cut(f) for f in cross(p, add(v, cross(k.omega_0, p)))]
    turn = add(K, times(-1, k.omega_0))
    for column in columns:
        W = [arb_poly(f) * (1 / arb(fmpz(1) << FINE)) for f in column]
        P, Q, rates = W[:3], W[3:], [f.derivative() for f in W]
        r1 = add(rates[:3], cross(p, Q), cross(P, turn))
        r2 = add(rates[3:], cross(k.c, P), cross(k.omega_0, Q))
        if not k.drag_0.is_zero():
            r2 = add(
                r2,
                times(k.drag_0, add(Q, times(dot(k.omega_0, P), p), times(dot(k.omega_0, p), P))),
            )
        out.append([size([f(UNIT) for f in part]) for part in (P, Q, r1, r2)])
    return out
