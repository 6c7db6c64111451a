"""Solve a scene with uncertain inputs by a proof: their widths, such as ±0.001, read from words and checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil
from typing import Any

from ..engines.plan import Report
from ..engines.registry import checked
from ..errors import InputError, unknown
from ..numbers.columns import STATE
from ..numbers.precision import fixed_decimal
from ..scenes.inputs import RELEASES, SITE
from ..scenes.scene import AnyScene, Scene, checked_value, full_name
from ..scenes.texts import without_sign
from ..system.imports import needed
from .pilot import check_reach
from .proof_steps import Feed
from .ranges import Intervals, Ranges
from .request import requested_scene
from .solution import exact_decimals, separated

UNCERTAIN = [
    "pendulum.length",
    "pendulum.drag",
    *(f"site.{name}" for name in (*SITE, "inverse_flattening")),
]
UNCERTAIN += [f"release.{name}" for names in RELEASES.values() for name in names]
EXAMPLE = "half of a width, in SI units or degrees, such as ±0.001, +-0.001 or 0.001"
MOST_DECIMALS = 20  # of an end of an interval


def widths_of(scene: Scene, uncertain: Mapping[str, Any]) -> dict[str, Fraction]:
    """Return half of the width of each uncertain input by its full name, as given by words such as ±0.001.

    Raises:
        InputError: an unknown input, one that the scene does not have, a wrong width, or one that leaves the range of
            values that the input may have.
    """
    if not isinstance(uncertain, Mapping):
        raise InputError("widths", uncertain, "a mapping such as {'pendulum.length': '±0.001'}")
    widths: dict[str, Fraction] = {}
    have = scene.exact.by_name
    for word, text in uncertain.items():
        name = full_name(str(word))
        field_name = (
            f"{'uncertain.' if scene.uncertain.get(word) == text else '--uncertain '}{word}"
        )
        if name not in UNCERTAIN:
            raise unknown(
                field_name, word, "an input on which the motion depends", UNCERTAIN, _NAMES
            )
        if name not in have:
            raise InputError(
                field_name, text, "an input that this scene has", f"It has {', '.join(have)}."
            )
        if name in widths:
            raise InputError(field_name, text, f"{name} once", "Give one width for each input.")
        try:
            widths[name] = Fraction(
                checked_value("site.altitude", without_sign(str(text)), "decimal")
            )
        except InputError:
            raise InputError(field_name, text, EXAMPLE) from None
        if widths[name] <= 0:
            raise InputError(
                field_name, text, "a width above 0", "Leave out an input that is certain."
            )
    if not widths:
        raise InputError("--uncertain", "nothing", "an input with its width, length=±0.001", _NAMES)
    low, high = (
        {name: value + side * widths.get(name, Fraction(0)) for name, value in have.items()}
        for side in (-1, 1)
    )
    for name, half in widths.items():
        for end in (low[name], high[name]):
            try:
                checked_value(name, decimal(end), "decimal")
            except InputError as error:
                reached = f"±{decimal(half)}, up to {decimal(end)}"
                raise InputError(
                    f"--uncertain {name}", reached, error.expected, "Take a smaller width."
                ) from None
    if scene.exact.position:
        far = [max(abs(low[name]), abs(high[name])) for name in ("release.x", "release.y")]
        if far[0] ** 2 + far[1] ** 2 >= low["pendulum.length"] ** 2:
            reached = f"x up to {decimal(far[0])}, y up to {decimal(far[1])}"
            raise InputError(
                "--uncertain", reached, "a release below the suspension", "Take smaller widths."
            )
    return widths


_NAMES = f"Inputs are {', '.join(UNCERTAIN)}."


def decimal(value: Fraction) -> str:
    """Return a number with its decimals, 20 at most."""
    whole = value * 10**MOST_DECIMALS
    return fixed_decimal(
        value, exact_decimals((value,)) if whole.denominator == 1 else MOST_DECIMALS
    )


def exact_texts(widths: Mapping[str, Fraction]) -> dict[str, str]:
    """Return widths as decimals, with all of their digits."""
    return {name: fixed_decimal(width, exact_decimals((width,))) for name, width in widths.items()}


def need_proof() -> None:
    """Refuse uncertain inputs where python-flint is not installed.

    Raises:
        InputError: it is not.
    """
    instead = ", or take the inputs as exact (--uncertain none)"
    needed("flint", "enclose", "uncertain", "a proof for a range of inputs", instead)


def prove_ranges(
    scene: AnyScene,
    widths: Mapping[str, Any],
    *,
    t_end: str | float | None = None,
    transits: bool | None = None,
    sections: str | Sequence[str] | None = None,
    engine: str | None = None,
    times: Sequence[Fraction] | None = None,
    derivatives: bool = False,
    report: Report | None = None,
) -> Ranges:
    """Prove intervals that hold for every pendulum whose inputs lie in their ranges (THEOREM.md, sections 11 to 13).

    Args:
        scene: the scene, its inputs in the middle of their ranges: a scene, its id, the path of a TOML file, or nested
            mappings.
        widths: half of the width of each input that is not known exactly: {"pendulum.length": "±0.001"}; SI units,
            angles in degrees.
        t_end: end of the run in s; a number is taken as it is printed.
        transits: whether to find every zero of xdot.
        sections: other moments to find, such as ["highest", "gate 30"]: docs/scene.md has the words.
        engine: "heyoka", "limbs", or None for the fastest that is installed.
        times: in s, from 0 on and increasing, in place of the scene's grid.
        derivatives: prove derivatives to these inputs too: `Ranges.derivative`. It takes longer, and may make every
            interval narrower.
        report: called with the simulated time reached, in s.

    Raises:
        InputError: an input that scenes do not have, or a width that is wrong; or python-flint is not installed.
        UnreachableError: the ranges are too wide; it tells up to which time a proof holds.
    """
    need_proof()
    from ..enclosure.prove_box import enclose_box
    from ..enclosure.trusted.printed_box import end_of
    from ..enclosure.trusted.shapes import Box

    settings = {"level": "enclosed", "t_end": t_end, "transits": transits, "sections": sections}
    scene = requested_scene(scene, settings)
    engine = checked(engine)
    halves = widths_of(scene, widths)
    inputs = scene.exact
    times = times or inputs.grid
    end = times[-1]
    texts = exact_texts(halves)
    # its ends are exact: the inputs, less and plus half of each width
    box = Box(inputs, *(end_of(inputs, texts, side) for side in (-1, 1)))
    swing = abs(float(inputs.gravity / inputs.length)) ** 0.5
    steps = ceil(float(end) * max(swing, abs(float(inputs.rotation_rate)), 1 / float(end)))
    feeds: list[Feed] = []

    def approximant(bits: int, latest: Fraction) -> Any:
        check_reach(steps, bits, scene.run.digits)
        feeds.append(Feed(inputs, (latest,), engine, steps))
        return feeds[-1](bits)

    try:
        tell = report and (lambda part: report(part * float(end)))
        proof = enclose_box(
            box, list(times), approximant, scene.run.zeros, tell, halves, derivatives
        )
    finally:
        for feed in feeds:
            feed.stop()
    proof = replace(proof, cpu_s=proof.cpu_s + feeds[-1].run_s)
    return Ranges(
        scene,
        texts,
        tuple(times),
        Intervals(STATE, proof.proved.states),
        {
            word: separated(zeros, word, end, Intervals)
            for word, zeros in proof.proved.zeros.items()
        },
        feeds[-1].begun,
        proof,
        derivatives,
    )
