"""The full system linearised about its rest position and solved exactly: the best that a small-angle model can do.

Let δ be the displacement at right angles to the plumb line (east, north), Ω_n the component of Ω
along the plumb line, T the tension of the cord at the rest position and C the centrifugal gradient,
all over l. Then
    δ1'' = -a δ1 + 2 Ω_n δ2',   δ2'' = -b δ2 - 2 Ω_n δ1',   a = T - C11, b = T - C22.
In p = (√a δ1, √b δ2, δ1', δ2') this is p' = S p with S skew: i S is hermitian, so its eigenvectors
are orthonormal and the solution stays accurate where two frequencies coincide.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import Scene, UnreachableError
from reference.model.force import tension
from reference.numbers.precision import Array

from .approximation import Motion
from .case import PaperCase, PlumbLine, hung, underneath, without_drag


def plumb_line(case: PaperCase) -> PlumbLine:
    """Return the axes of the plumb line along the full model's rest position, Mathar (46)."""
    _, y, z = case.rest
    return PlumbLine(case.ctx.mpf(y), -z)


def stiffness(case: PaperCase) -> tuple[Any, Any, Any]:
    """Return a and b in 1/s², and Ω_n in rad/s."""
    plumb = plumb_line(case)
    xx, yy, yz, zz = case.k.centrifugal
    pull = tension(case.rest, (0, 0, 0), case.k)
    across = yy * plumb.cos**2 + 2 * yz * plumb.cos * plumb.sin + zz * plumb.sin**2
    turn = plumb.cos * case.ctx.mpf(case.k.turn[2]) - plumb.sin * case.ctx.mpf(case.k.turn[1])
    return pull - xx, pull - across, turn


def _path(case: PaperCase, times: Array) -> Array:
    ctx = case.ctx
    plumb = plumb_line(case)
    a, b, turn = stiffness(case)
    east, north = ctx.sqrt(a), ctx.sqrt(b)
    skew = ctx.matrix(
        [[0, 0, east, 0], [0, 0, 0, north], [-east, 0, 0, 2 * turn], [0, -north, -2 * turn, 0]]
    )
    frequencies, modes = ctx.eighe(ctx.j * skew)  # S q = -i w q
    x, y, _ = plumb.inward(case.position)
    vx, vy, _ = plumb.inward(case.velocity)
    weights = modes.H * ctx.matrix([east * x, north * y, vx, vy])
    shares = np.array([[complex(modes[i, j] * weights[j]) for j in range(4)] for i in range(4)])
    phases = np.exp(-1j * np.outer([float(w) for w in frequencies], times))
    # term by term: a product by BLAS rounds as the processor likes
    p = (shares[:, :, None] * phases).sum(axis=1).real
    return plumb.outward(hung(p[0] / float(east), p[1] / float(north), p[2], p[3], case.length))


def _stable(scene: Scene) -> str | None:
    case = PaperCase.of_scene(scene)
    try:
        a, b, _ = stiffness(case)
    except UnreachableError:
        return "There is no rest position to swing about: give site.gravity above 0"
    return None if a > 0 and b > 0 else "Its rest position is not a minimum of the potential"


APPROXIMATIONS = (
    Motion(
        id="linear_3d",
        title="the full system, linearised about its rest position, with every centrifugal term",
        where="linearisation of Mathar (43) at (46); 'exact for the linear system' in the third source paper",
        drops="second and higher powers of the displacement from the rest position",
        needs=(underneath, without_drag, _stable),
        path=_path,
    ),
)
