"""TRUSTED. The error bound for large angles: six columns carry it, by Theorem E (THEOREM.md, section 5).

The columns are proposals: integers over 2^FINE, so they are exact whatever floats they were rounded
from. Lengths are divided by that of the rod.

| name              | symbol                                                  | unit                |
|-------------------|---------------------------------------------------------|---------------------|
| `Wp`, `WK`        | Wp_j, WK_j: the polynomials of a column j               | a step's time       |
| `z`               | z_j >= |ζ_j|                                            | 1                   |
| `Zp`, `ZK`        | Σ z_j |Wp_j|, Σ z_j |WK_j|                              | a step's time       |
| `R1`, `R2`        | R1_j, R2_j                                              | a step's time       |
| `D1`, `D2`        | D1, D2 of the central curve, then with what columns add | a step's time       |
| `epsilon`         | ε₁                                                      | a step's time       |
| `delta`           | δ: for r, then for H                                    | 1, then 1/s         |
| `inverse`         | Ŵ(a)⁻¹, of the columns of the step that begins          | as `W_end`          |
| `W_end`           | W(b), of the columns of the step before                 | 1, rows of H in 1/s |
| `length`          | ℓ, the length of the step in s                          | a step's time       |
"""

from dataclasses import dataclass

from flint import arb, arb_mat, arb_poly, ctx, fmpz, fmpz_poly

from .balls import SHORT, UNIT, Vector, add, ball, cross, dot, size, times, upper
from .defect import Piece
from .radius import CarriedState, error_rate
from .shapes import Covered, Proposal
from .tube import tube

FINE = 50  # a column's coefficients are integers over 2^FINE
CUT = 48  # terms of p and K in the residuals, which are multiplied by the small z_j


@dataclass(frozen=True)
class ColumnNorms:
    """Sup norms of a column and of its residuals on |s| <= 1."""

    Wp: arb
    WK: arb
    R1: arb
    R2: arb


class Columns(CarriedState):
    """Theorem E: (r, H) = (p + Wp ζ, K + WK ζ) + (e, g) with |ζ_j| <= z_j; `delta` bounds e and g."""

    z = [arb(0)] * 6
    delta = [arb(0)] * 6
    W_end = arb_mat(6, 6)

    def advance(self, piece: Piece, proposal: Proposal) -> Covered:
        """Carry the bounds over `piece`; `proposal[j]` holds the six polynomials of column j."""
        columns = [[fmpz_poly(f) for f in column] for column in proposal]
        constants = piece.constants
        sizes = piece.sizes
        with ctx.workprec(2 * SHORT):
            self._take_columns(piece, columns)

        with ctx.workprec(SHORT):
            Zp = arb(0)
            ZK = arb(0)
            D1 = sizes.d1
            D2 = sizes.d2
            for z, norms in zip(self.z, residuals(piece, columns), strict=True):
                Zp += z * norms.Wp
                ZK += z * norms.WK
                D1 += z * norms.R1
                D2 += z * norms.R2

            # (5.3)
            D1 += Zp * ZK
            D2 += constants.drag_size * constants.omega_size * Zp**2
            length = ball(piece.step.high - piece.step.low)
            nu = error_rate(constants, sizes.p + Zp)
            epsilon = upper(length * (D2 / constants.w + D1) * (length * nu).exp())

            self.delta = [epsilon] * 3 + [upper(epsilon * self.balls.w0)] * 3
            # (5.4)
            return Covered(piece, tube(constants, sizes, Zp + epsilon, ZK + epsilon * constants.w))

    def _take_columns(self, piece: Piece, columns: list[Vector]) -> None:
        """Go over to the columns of the next step: z becomes ẑ."""
        jump = self.join(piece)
        slack = add([*jump.p, *jump.K], self.delta)
        inverse = matrix(columns, ball(piece.step.low), piece.constants.h).inv()
        moved = inverse * self.W_end

        # (5.5)
        z = []
        for i in range(6):
            total = arb(0)
            for j in range(6):
                of_z = moved[i, j].abs_upper() * self.z[j]
                of_slack = inverse[i, j].abs_upper() * slack[j]
                total += of_z + of_slack
            z.append(upper(total))
        self.z = z
        self.W_end = matrix(columns, ball(piece.step.high), piece.constants.h)


def matrix(columns: list[Vector], s: arb, h: arb) -> arb_mat:
    """Return the columns at `s` in physical time: H in 1/s."""
    rows = []
    for i in range(6):
        row = [arb_poly(column[i])(s) / (fmpz(1) << FINE) for column in columns]
        rows.append(row if i < 3 else times(1 / h, row))
    return arb_mat(rows)


def cut(f: arb_poly, terms: int = CUT) -> arb_poly:
    """Return a short polynomial that contains f at every |s| <= 1."""
    return f.truncate(terms) + arb(0, f.right_shift(terms)(UNIT).abs_upper())


def residuals(piece: Piece, columns: list[Vector]) -> list[ColumnNorms]:
    """Return the norms of each column, and of what it misses in the linearised equations."""
    constants = piece.constants
    omega_0 = constants.omega_0
    p = [cut(arb_poly(f) * (1 / arb(piece.unit))) for f in piece.p]
    p_rate = [cut(arb_poly(f) * (1 / arb(piece.unit))) for f in piece.v]
    K = [cut(f) for f in cross(p, add(p_rate, cross(omega_0, p)))]
    K_less_omega = add(K, times(-1, omega_0))

    norms = []
    for column in columns:
        polynomials = [arb_poly(f) * (1 / arb(fmpz(1) << FINE)) for f in column]
        Wp = polynomials[:3]
        WK = polynomials[3:]
        Wp_rate = [f.derivative() for f in Wp]
        WK_rate = [f.derivative() for f in WK]

        # (5.1)
        R1 = add(Wp_rate, cross(p, WK), cross(Wp, K_less_omega))
        # (5.2)
        R2 = add(WK_rate, cross(constants.c, Wp), cross(omega_0, WK))
        if not constants.drag_0.is_zero():
            along_p = times(dot(omega_0, Wp), p)
            along_Wp = times(dot(omega_0, p), Wp)
            R2 = add(R2, times(constants.drag_0, add(WK, along_p, along_Wp)))
        norms.append(ColumnNorms(sup_norm(Wp), sup_norm(WK), sup_norm(R1), sup_norm(R2)))
    return norms


def sup_norm(polynomials: Vector) -> arb:
    """Return an upper bound of the length of a vector of polynomials on |s| <= 1."""
    return size([f(UNIT) for f in polynomials])
