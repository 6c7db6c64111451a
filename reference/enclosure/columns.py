"""TRUSTED. Theorem E of THEOREM.md: six columns carry the error along, Theorem N bounds what they leave out.

The columns are proposals: integers over 2^FINE, so exact whatever floats they came from.
"""

from flint import arb, arb_mat, arb_poly, ctx, fmpz, fmpz_poly

from .balls import SHORT, Vector, add, ball, cross, dot, norm3, times, upper
from .bound import Carried, Piece, World, growth, tube
from .shapes import Sizes, Tube

FINE = 50  # bits of a column's coefficients
CUT, CUT_BITS = 48, 64  # degree and bits of p and K in the residual, where they only meet the box


class Columns(Carried):
    """(r, H) = (p + Wp ζ, K + WK ζ) + (e, g) with |ζ_j| <= z_j."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.rest, self.z, self.carried = [arb(0)] * 6, [arb(0)] * 6, arb_mat(6, 6)

    def advance(self, piece: Piece, d: Sizes, proposal: list[list[list[int]]]) -> Tube:
        """Carry the box over `piece`; `proposal[j]` holds the six polynomials of column j."""
        k, step, columns = piece.k, piece.step, [[fmpz_poly(f) for f in c] for c in proposal]
        with ctx.workprec(self.world.prec):
            slack = add(self.join(piece)[1], self.rest)
        with ctx.workprec(2 * SHORT):
            inverse = matrix(columns, ball(step.low), k.h).inv()
            moved, self.carried = inverse * self.carried, matrix(columns, ball(step.high), k.h)
            pairs = [(moved[i, j].abs_upper() * self.z[j], inverse[i, j].abs_upper() * slack[j]) for i, j in GRID]
            self.z = [upper(sum((a + b for a, b in pairs[6 * i : 6 * i + 6]), arb(0))) for i in range(6)]
        with ctx.workprec(SHORT):
            rows = [times(z, sizes) for z, sizes in zip(self.z, residuals(piece, d, columns), strict=True)]
            zp, zk, d1, d2 = add([arb(0), arb(0), d.d1, d.d2], *rows)
            d1, d2, span = d1 + zp * zk, d2 + k.drag_size * k.omega_size * zp**2, ball(step.high - step.low)
            left = upper(span * (d2 / k.w + d1) * (span * growth(k, d.p + zp)).exp())
            self.rest = [left] * 3 + [upper(left * self.world.w0)] * 3
            return tube(k, d, zp + left, zk + left * k.w)


GRID = [(i, j) for i in range(6) for j in range(6)]


def matrix(columns: list[Vector], s: arb, h: arb) -> arb_mat:
    """The columns at `s`, H in 1/s."""
    values = [arb_poly(columns[j][i])(s) / (fmpz(1) << FINE) for i, j in GRID]
    return arb_mat(6, 6, [*values[:18], *times(1 / h, values[18:])])


def residuals(piece: Piece, d: Sizes, columns: list[Vector]) -> list[list[arb]]:
    """For each column |Wp|, |WK|, |R1|, |R2|; p and K are cut, and what they lose is charged."""
    step, down, scale, out = piece.step, piece.step.bits - CUT_BITS, CUT_BITS + FINE, []
    rows = tuple([c >> down for c in row[:CUT]] for row in step.coefficients)
    near = Piece(piece.world, step._replace(bits=CUT_BITS, coefficients=rows))
    lost = [f - g * (fmpz(1) << down) for f, g in zip(piece.polys, near.polys, strict=True)]
    lost_p, lost_k = norm3(lost[:3], step.bits), norm3(lost[3:], step.bits)
    k, p, turn = near.k, near.polys[:3], add(near.polys[3:], times(-1, near.k.wi))
    for P, K in ((column[:3], column[3:]) for column in columns):
        size_p, size_k = norm3(P, FINE), norm3(K, FINE)
        r1 = add([f.derivative() * near.unit for f in P], cross(p, K), cross(P, turn))
        r2 = add([f.derivative() * near.unit for f in K], times(-1, k.torque(P, K)))
        # with drag, terms of third degree: zero without
        drag = add(times(k.gi[0] * near.unit, K), times(dot(k.gi[1:], P), p), times(dot(k.gi[1:], p), P))
        e1 = norm3(r1, scale) + size_k * lost_p + size_p * (lost_k + k.omega_off)
        e2 = norm3(add(times(near.unit, r2), drag), scale + CUT_BITS) + size_p * k.c_off + size_k * k.omega_off
        e2 += 2 * k.drag_size * k.omega_size * size_p * lost_p + k.drag_off * (size_k + 2 * (d.p + lost_p) * size_p)
        out.append([size_p, size_k, e1, e2])
    return out
