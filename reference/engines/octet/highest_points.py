"""The highest points of the swing: zeros of u', found by signs at the ends and the middle of a step.

Between a highest and a lowest point passes half a period of u, longer than half a step: signs miss none.
"""

from __future__ import annotations

from ..limbs.compiling import compiled
from ..limbs.lanes import LANES, at_least, fma, load, magnitude, spread, store, where
from ..limbs.limb import Array
from .lane_zeros import NOISE, Zeros, keep
from .series import Series

CONVERGED = 2.0**-20  # of a step: a zero of u' is so nearly symmetric that the next correction would be none


@compiled
def seek_highest(z: Zeros, g: Array, length: Array, order: int) -> None:
    """Find which lanes have a highest point on the step; `doubt` is where a sign is lost in rounding."""
    r, none, one = load(length, 0), spread(0.0), spread(1.0)
    middle = r * spread(0.5)
    vm = total = none
    for k in range(order - 1, -1, -1):
        a = load(g, LANES * k)
        vm, total = fma(a, vm, middle), fma(magnitude(a), total, r)
    noise, before, after = total * spread(NOISE), load(z.before, 0), load(z.after, 0)
    rising, high = at_least(before, none), at_least(vm, none)
    known = at_least(magnitude(vm), noise) * at_least(magnitude(after), noise)
    late = high * (one - at_least(after, none))
    low, top = keep(z, rising * (one - high), late, one, known, r)
    left, right = where(late, vm, before), where(late, after, vm)
    store(z.place, 0, fma(low, top - low, left / (left - right)))


@compiled
def place_highest(top: Array, c: Series, z: Zeros, order: int) -> None:
    """Write x, p and u at the place of each lane, a row of eight each."""
    place = load(z.place, 0)
    x = p = u = spread(0.0)
    for k in range(order, -1, -1):
        at = LANES * k
        x, p, u = fma(load(c.x, at), x, place), fma(load(c.p, at), p, place), fma(load(c.u, at), u, place)
    store(top, 0, x)
    store(top, LANES, p)
    store(top, 2 * LANES, u)
