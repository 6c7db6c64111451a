"""Taylor polynomials of n and h H on each step, east, north, up, as a proof wants them."""

from __future__ import annotations

from .digits import Array, add_product, carry
from .lanes import LANES, compiled, load, occupied, plus_product, shuffled, spread, store
from .series import Series, to_speeds
from .step import Model, lanewise

ROWS = 6  # n and h H, three components each

_cycled = shuffled((1, 2, 0, -1, -1, -1, -1, -1), "_cycled")
_cycled_back = shuffled((2, 0, 1, -1, -1, -1, -1, -1), "_cycled_back")
_speed_cycled = shuffled((4, 5, 3, -1, -1, -1, -1, -1), "_speed_cycled")
_speed_cycled_back = shuffled((5, 3, 4, -1, -1, -1, -1, -1), "_speed_cycled_back")
_places = shuffled((0, 1, 2, -1, -1, -1, -1, -1), "_places")
_exchanged = shuffled((-1, 2, 1, -1, 5, 4, -1, -1), "_exchanged")


@compiled
def write_polynomials(to: Array, s: Series, model: Model) -> int:
    """The coefficients of n and of h H = n × h V, `limbs` rows an order; six lanes count. Returns their number."""
    limbs, rows, other, total = model.limbs, s.partners, s.other, s.total
    for k in range(model.order + 1):
        s.first[k] = 0
        while s.first[k] < limbs and not occupied(load(s.c, LANES * (k * limbs + s.first[k]))):
            s.first[k] += 1
    for k in range(model.order + 1):
        _momentum(s, k, limbs)
        carry(total, 0, limbs)
        for r in range(limbs):
            v = _places(load(s.c, LANES * (k * limbs + r))) + to_speeds(load(total, LANES * r))
            store(rows, LANES * r, v)
            store(other, LANES * r, _exchanged(v))
        lanewise(total, rows, model.along, limbs)
        add_product(total, model.across, other, 0, limbs)
        carry(total, 0, limbs)
        for r in range(limbs):
            store(to, LANES * (k * limbs + r), load(total, LANES * r))
    return ROWS * (model.order + 1)


@compiled
def _momentum(s: Series, k: int, limbs: int) -> None:
    """Coefficient k of n × h V in the first three lanes of `total`, not carried."""
    for r in range(limbs + 1):
        store(s.total, LANES * r, spread(0.0))
    for i in range(k + 1):
        a, b = i * limbs * LANES, (k - i) * limbs * LANES
        low, high = s.first[i], s.first[k - i]
        for r in range(low + high + 1, limbs + 1):
            total = load(s.total, LANES * r)
            for p in range(low, r - high):
                n, v = load(s.c, a + LANES * p), load(s.c, b + LANES * (r - 1 - p))
                total = plus_product(total, _cycled(n), _speed_cycled_back(v))
                total = total - _cycled_back(n) * _speed_cycled(v)
            store(s.total, LANES * r, total)
    for r in range(limbs + 1):
        store(s.total, LANES * r, load(s.total, LANES * r) + load(s.total, LANES * r))
