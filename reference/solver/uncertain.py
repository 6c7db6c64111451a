"""Solve a scene with uncertain inputs by a proof; read and check their widths, such as ±0.001."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil, sqrt
from typing import Any

from ..engines.plan import Report
from ..engines.registry import checked
from ..errors import NOTHING, Described, InputError, unknown
from ..numbers.columns import STATE
from ..numbers.precision import fixed_decimal
from ..numbers.taylor_step import TaylorStep
from ..scenes.inputs import UNCERTAIN, Inputs
from ..scenes.scene import AnyScene, Scene, checked_value, full_name, unit_of
from ..scenes.texts import without_sign
from ..system.imports import needed
from .pilot import check_reach
from .proof_steps import Feed
from .ranges import Intervals, Ranges
from .request import RangesRequest, RunSettings, progress_report
from .solution import exact_decimals, separated

_EXAMPLE = "such as ±0.001, +-0.001 or 0.001"
_MOST_DECIMALS = 20  # of an end of an interval


_INPUT_NAMES = f"Inputs are {', '.join(UNCERTAIN)}."


def widths_of(scene: Scene, uncertain: Mapping[str, Any]) -> dict[str, Fraction]:
    """Return half of the width of each uncertain input by its full name, from words such as ±0.001.

    Raises:
        InputError: an unknown input, one that the scene does not have, a wrong width, or one that
            leaves the range of values that the input may have.
    """
    if not isinstance(uncertain, Mapping):
        raise InputError("widths", uncertain, "a mapping such as {'pendulum.length': '±0.001'}")
    if not uncertain:
        example = "an input with its width, length=±0.001"
        raise InputError("--uncertain", NOTHING, example, _INPUT_NAMES)

    widths: dict[str, Fraction] = {}
    for word, text in uncertain.items():
        name = full_name(str(word))
        field = f"uncertain.{word}" if scene.uncertain.get(word) == text else f"--uncertain {word}"
        _check_input(scene, name, field, word, text)
        if name in widths:
            raise InputError(field, text, f"one width of {name}", "Give one width for each input.")
        widths[name] = _width(name, field, text)
    _check_ends(scene, widths)
    if scene.exact.position:
        _check_release(scene, widths)
    return widths


def _check_input(scene: Scene, name: str, field: str, word: Any, text: Any) -> None:
    """Refuse a name that is no input on which the motion depends, or none of the scene's."""
    if name not in UNCERTAIN:
        expected = "an input on which the motion depends"
        raise unknown(field, word, expected, UNCERTAIN, _INPUT_NAMES)
    inputs = scene.exact.by_name
    if name not in inputs:
        advice = f"It has {', '.join(inputs)}."
        raise InputError(field, text, "an input that this scene has", advice)


def _width(name: str, field: str, text: Any) -> Fraction:
    """Return half of the width of an input, as a word such as ±0.001 gives it."""
    try:
        # any field that takes a decimal of either sign checks its form
        width = Fraction(checked_value("site.altitude", without_sign(str(text)), "decimal"))
    except InputError:
        in_unit = f" in {unit_of(name)}" if unit_of(name) else ""
        raise InputError(field, text, f"half of a width{in_unit}, {_EXAMPLE}") from None
    if width <= 0:
        raise InputError(field, text, "a width above 0", "Leave out inputs that are exact.")
    return width


def _check_ends(scene: Scene, widths: Mapping[str, Fraction]) -> None:
    """Refuse a width that leaves the range of values of its input."""
    for name, half in widths.items():
        value = scene.exact.by_name[name]
        for end in (value - half, value + half):
            try:
                checked_value(name, decimal(end), "decimal")
            except InputError as error:
                reached = Described(f"±{decimal(half)}, which reaches {decimal(end)}")
                advice = "Take a smaller width."
                raise InputError(f"--uncertain {name}", reached, error.expected, advice) from None


def _check_release(scene: Scene, widths: Mapping[str, Fraction]) -> None:
    """Refuse widths that let a release by its position reach beyond the shortest cord."""
    inputs = scene.exact.by_name
    shortest = inputs["pendulum.length"] - widths.get("pendulum.length", 0)
    x, y = (abs(inputs[name]) + widths.get(name, 0) for name in ("release.x", "release.y"))
    if x**2 + y**2 >= shortest**2:
        reached = Described(f"x up to {decimal(x)}, y up to {decimal(y)}")
        expected = "a release below the suspension"
        raise InputError("--uncertain", reached, expected, "Take smaller widths.")


def decimal(value: Fraction) -> str:
    """Return a number as a decimal with at most 20 digits after the point."""
    terminates = (value * 10**_MOST_DECIMALS).denominator == 1
    places = exact_decimals((value,)) if terminates else _MOST_DECIMALS
    return fixed_decimal(value, places)


def exact_texts(widths: Mapping[str, Fraction]) -> dict[str, str]:
    """Return widths as decimals with all of their digits."""
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
    """Prove intervals that are true for every pendulum whose inputs lie in their ranges.

    The proof is that of THEOREM.md, sections 11 to 13.

    Args:
        scene: the scene, its inputs in the middle of their ranges: a scene, its id, the path of a
            TOML file, or nested mappings.
        widths: half of the width of each input that is not known exactly: {"pendulum.length":
            "±0.001"}; SI units, angles in degrees.
        t_end: end of the run in s; a number is taken as it is printed.
        transits: whether to find every zero of xdot.
        sections: other moments to find, such as ["highest", "gate 30"]: docs/scene.md has the
            words.
        engine: "heyoka", "limbs", or None for the fastest that is installed.
        times: in s, from 0 on and increasing, in place of the scene's grid.
        derivatives: prove derivatives with respect to these inputs too: `Ranges.derivative`. This
            takes longer, and may make every interval narrower.
        report: called with the simulated time reached, in s.

    Raises:
        InputError: an input that scenes do not have, or a width that is wrong; or python-flint is
            not installed.
        UnreachableError: the ranges are too wide; it says up to which time the proof reaches.
    """
    need_proof()
    settings = RunSettings(level="enclosed", t_end=t_end, transits=transits, sections=sections)
    scene = settings.applied_to(scene)
    request = RangesRequest(
        scene=scene,
        engine=checked(engine),
        widths=widths_of(scene, widths),
        times=tuple(times or scene.exact.grid),
        derivatives=derivatives,
        report=report,
    )
    return _proved_ranges(request)


def _proved_ranges(request: RangesRequest) -> Ranges:
    """Prove intervals for a box of inputs, from one run of the scene in its middle."""
    # python-flint is not imported unless a proof is asked for
    from ..enclosure.prove_box import enclose_box
    from ..enclosure.trusted.printed_box import end_of
    from ..enclosure.trusted.shapes import Box

    scene = request.scene
    inputs = scene.exact
    end = request.times[-1]
    steps = _expected_steps(inputs, end)
    width_texts = exact_texts(request.widths)
    # the ends of the box are exact
    least = end_of(inputs, width_texts, -1)
    largest = end_of(inputs, width_texts, 1)

    feeds: list[Feed] = []

    def approximant(bits: int, latest: Fraction) -> Iterator[TaylorStep]:
        check_reach(steps, bits, scene.run.digits)
        feed = Feed(inputs, (latest,), request.engine, steps)
        feeds.append(feed)
        return feed(bits)

    try:
        proof = enclose_box(
            Box(inputs, least, largest),
            list(request.times),
            approximant,
            scene.run.zeros,
            progress_report(request.report, end),
            request.widths,
            request.derivatives,
        )
    finally:
        for feed in feeds:
            feed.stop()

    proof = replace(proof, cpu_s=proof.cpu_s + feeds[-1].run_s)
    zeros = {}
    for word, proved in proof.proved.zeros.items():
        zeros[word] = separated(proved, word, end, Intervals)
    return Ranges(
        scene=scene,
        uncertain=width_texts,
        times=request.times,
        grid=Intervals(STATE, proof.proved.states),
        zeros=zeros,
        engine=feeds[-1].begun,
        proof=proof,
        derivatives=request.derivatives,
    )


def _expected_steps(inputs: Inputs, end: Fraction) -> int:
    """Return about how many steps a run takes: one a radian of the faster motion, at least one.

    The motions are the swing and the rotation of the site.
    """
    swing_rate = sqrt(abs(float(inputs.gravity / inputs.length)))
    rate = max(swing_rate, abs(float(inputs.rotation_rate)), 1 / float(end))
    return ceil(float(end) * rate)
