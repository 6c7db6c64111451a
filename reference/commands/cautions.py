"""Warnings of a scene that is valid, but may not be what its author meant."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import degrees

import typer

from ..errors import UnreachableError
from ..model.normal_gravity import is_on_earth, normal_gravity
from ..model.start import Start
from ..scenes.inputs import GRAVITY_MEANINGS, azimuth_of
from ..scenes.scene import Scene
from ..scenes.shipped import scene_ids
from ..solver.swing import creeps_in_words
from .layout import paragraph

_PREC = 64  # bits of the release
# degrees between a gate and the swing, below which the bob passes along the gate
_ALONG_DEG = 10
# widths of an ellipse over its length, above which it has no direction to speak of
_ROUND = 0.1


def warn(scene: Scene, word: str, varied: tuple[str, ...] = ()) -> None:
    """Print on stderr what to warn of in a scene.

    Args:
        scene: the scene.
        word: what it was named by, an id or a path.
        varied: fields that have several values, about which nothing is said.
    """
    for text in cautions(scene, word, varied):
        for line in paragraph(f"warning: {text}", hanging="  "):
            typer.echo(line, err=True)


def cautions(scene: Scene, word: str, varied: tuple[str, ...] = ()) -> list[str]:
    """Return what to warn of in a scene, a sentence or two for each; for the arguments see `warn`."""
    texts: list[str] = []
    if not any(name.startswith("release.") for name in varied):
        texts += _gates_along_the_swing(scene)
    is_own = word not in scene_ids()
    if is_own and scene.site.gravity_is == "ellipsoid" and "site.gravity_is" not in varied:
        text = (
            f'site.gravity_is is "ellipsoid": {GRAVITY_MEANINGS["ellipsoid"]}. '
            f'A g from a gravimeter or a table is "effective": {GRAVITY_MEANINGS["effective"]}.'
        )
        if is_on_earth(scene.exact):
            normal = f"{normal_gravity(float(scene.site.latitude)):.5f}"
            text += f' Normal at this latitude is gravity = "{normal}", gravity_is = "effective".'
        texts.append(text)
    if is_own and scene.exact.creeps and "pendulum.drag" not in varied:
        texts.append(
            f"{creeps_in_words(scene)} pendulum.drag is a rate in 1/s: for a swing that halves in 20 min "
            "write 2 ln 2/1200 = 0.0011552."
        )
    return texts


def _gates_along_the_swing(scene: Scene) -> Iterator[str]:
    """Yield a warning for each gate that the bob swings along at the release."""
    gates = [word for word in scene.run.sections or () if word.startswith("gate ")]
    if not gates:
        return
    swing_deg = _swing_azimuth_deg(scene)
    if swing_deg is None:
        return
    for gate in gates:
        azimuth = azimuth_of(gate)
        # lines, not arrows: 45 and -135 degrees are the same plane
        between = abs((float(azimuth) - swing_deg + 90) % 180 - 90)
        if between < _ALONG_DEG:
            across_deg = float((azimuth + 90) % 180)
            yield (
                f"the bob swings along {gate} (its plane has azimuth {swing_deg:.0f}), so the times of "
                f"its passages say little. A beam across the swing has gate {across_deg:g}."
            )


def gate_across(scene: Scene) -> str | None:
    """Return the gate across the first swing, to the degree, as a section's word; None if it is nearly round."""
    swing_deg = _swing_azimuth_deg(scene)
    if swing_deg is None:
        return None
    return f"gate {round(swing_deg + 90) % 180}"


def _swing_azimuth_deg(scene: Scene) -> float | None:
    """Return the azimuth of the long axis of the first swing, of small amplitude, about the rest position.

    None if there is no rest position, or the swing is nearly round.
    """
    start = Start.of(scene.exact, _PREC)
    ctx = start.ctx
    with suppress(UnreachableError):
        away = [a - b for a, b in zip(start.n, start.rest, strict=True)]
        frequency = ctx.sqrt(ctx.norm(start.k.pull))
        # x + i y = p cos wt + q sin wt is the sum of two circular motions, one each way
        p = ctx.mpc(away[0], away[1])
        q = ctx.mpc(start.v[0], start.v[1]) / frequency
        left = (p - 1j * q) / 2
        right = (p + 1j * q) / 2
        length = abs(left) + abs(right)
        width = abs(abs(left) - abs(right))
        if width < _ROUND * length:
            return float(degrees((ctx.arg(left) + ctx.arg(right)) / 2)) % 180
    return None
