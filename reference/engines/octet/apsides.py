"""The highest points of the swing: zeros of u', found by signs at the ends and the middle of a step.

Between a highest and a lowest point passes half a period of u, longer than half a step: signs miss none.
"""

from __future__ import annotations

from ..limbs.lanes import LANES, at_least, compiled, load, magnitude, plus_product, spread, store, where
from ..limbs.limb import Array
from .zeros import NOISE, Zeros

CONVERGED = 2.0**-20  # of a step: a zero of u' is so nearly symmetric that the next correction would be none


@compiled
def seek_highest(z: Zeros, g: Array, length: Array, order: int) -> None:
    """Find which lanes have a highest point on the step; `doubt` is where a sign is lost in rounding."""
    r, none = load(length, 0), spread(0.0)
    middle = r * spread(0.5)
    vm = total = none
    for k in range(order - 1, -1, -1):
        a = load(g, LANES * k)
        vm, total = plus_product(a, vm, middle), plus_product(magnitude(a), total, r)
    noise, before, after = total * spread(NOISE), load(z.before, 0), load(z.after, 0)
    rising, high = at_least(before, none), at_least(vm, none)
    early = rising * (spread(1.0) - high)
    late = high * (spread(1.0) - at_least(after, none))
    sought = load(z.sought, 0)
    store(z.hit, 0, (early + late) * sought)
    store(z.doubt, 0, (spread(1.0) - at_least(magnitude(vm), noise) * at_least(magnitude(after), noise)) * sought)
    low, top = where(late, middle, none), where(late, r, middle)
    left, right = where(late, vm, before), where(late, after, vm)
    store(z.low, 0, low)
    store(z.high, 0, top)
    store(z.place, 0, plus_product(low, top - low, left / (left - right)))


@compiled
def evaluate(to: Array, f: Array, place: Array, order: int) -> None:
    """Write the value of a polynomial at a place of each lane."""
    s, value = load(place, 0), spread(0.0)
    for k in range(order, -1, -1):
        value = plus_product(load(f, LANES * k), value, s)
    store(to, 0, value)
