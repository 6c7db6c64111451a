"""The run that checks another of the same engine shares nothing with it: precision, tolerance, limbs, steps."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from small_scenes import make_scene

from reference.engines.registry import engines, run

SWINGS = {
    "paris": {},
    "tiny": {"x": "3e-6", "y": "0", "vx": "1e-6", "vy": "2e-6"},
    "smaller than limbs follow": {"x": "1e-25", "y": "0"},
}


@pytest.mark.parametrize("swing", SWINGS.values(), ids=SWINGS.keys())
def test_the_witness_of_limbs_has_fewer_limbs_and_every_step_is_another(swing):
    pytest.importorskip("numba")
    from reference.engines.limbs.run import Integration

    limbs, steps = engines()["limbs"], 16
    scene = make_scene(site={"rotation_rate": "0"}, release={"x": "0.3", "y": "0.4", **swing})
    for prec in (80, 88, 104, 128, 200, 384):
        published = limbs.plan(scene.exact, prec, (Fraction(0), Fraction(1000)))
        witness = limbs.witness(published, prec - 16)
        assert witness.number.prec <= prec - 16
        one, other = (Integration(plan, steps) for plan in (published, witness))
        assert other.problem.model.limb_count < one.problem.model.limb_count
        assert other.problem.model.order < one.problem.model.order
        assert other.problem.model.tolerance > one.problem.model.tolerance or prec == 384
        for integration in (one, other):
            integration.advance(steps)
        lengths, others = (integration.out.steps[1::2] for integration in (one, other))
        assert np.all(lengths[:4] > 0)
        assert np.all(lengths != others)


@pytest.mark.parametrize("engine", ["heyoka", "limbs"])
@pytest.mark.parametrize("zeros", [(), ("xdot",), ("highest",)], ids=str)
def test_a_witness_takes_other_steps_even_where_one_would_do(engine, zeros, paris):
    one = engines()[engine]
    if not one.installed:
        pytest.skip(f"needs {', '.join(one.requires)}")
    published = one.plan(paris.exact, 96, (Fraction(0), Fraction(1, 2)), zeros)
    witness = one.witness(published, 80)
    done, checked = run(published), run(witness)
    assert done.order != checked.order
    gaps = done.grid.distance(checked.grid).largest()
    assert 0 < gaps["x"] < Fraction(1, 10**20)
    assert checked.steps > done.steps or engine == "limbs"
