"""`foucault show`: a scene's inputs, what follows from them, its motion and its equations."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from ..errors import NOTHING, FoucaultError, InputError, NotInstalledError, UnreachableError
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import flag_meanings
from .layout import echo, facts, heading, paragraph
from .options import Conflict, as_command, refuse_conflicts
from .progress import progress
from .scene_text import derived_facts, input_facts, title_of
from .template import scene_file
from .terminal import (
    AsJson,
    Assignments,
    Sections,
    Uncertain,
    emit,
    option,
    replacements,
    scene_argument,
    widths_by_name,
)

if TYPE_CHECKING:
    from .passages import Asked

# what the letters of each form of the equations mean
_FORMS = {
    "momentum": "n = r/l, H = n × (n' + Ω × n), c = pull/l",
    "inertial": "n = r/l, V = n' + Ω × n, c = pull/l",
}
_LEFT_OUT = "Left out: they need pip install 'foucault-reference[enclose]'."
_NEXT = "Next: `foucault generate {0}` solves it; `foucault score {0} FILE` judges a program by it."
# what makes a motion in doubles leave the true one
_COSTS = {
    "release": "the rounding of the release costs most",
    "constants": "the rounding of length, gravity, … costs most",
}
_DERIVED_PREC = 96  # bits of the derived quantities, of which 15 digits are shown

_SCENE = scene_argument(
    "A scene's id, or the path of a TOML file; may be left out with --template."
)
_TEMPLATE = option(
    "--template", "Print the scene as a TOML file to start from, each field explained."
)
_EQUATIONS = option("--equations", "Also show the compiled equations, and the terms left out.")
_PROVED = option(
    "--proved",
    "Also prove intervals of period and precession over the run; this takes as long as proving the run.",
)
_SENSITIVITY = option(
    "--sensitivity", "Also show how many digits are lost to error growth between release and end."
)
_PASSAGE = option(
    "--passage",
    "Also show the time of this passage of each section (without sections: of this transit); 50=±0.1 also asks "
    "which uncertain input to measure better for that accuracy (in s); may be repeated.",
    "N",
)


@dataclass(frozen=True)
class _ShowOptions:
    """The options of `foucault show`."""

    scene_word: Annotated[str | None, _SCENE] = None
    template: Annotated[bool, _TEMPLATE] = False
    equations: Annotated[bool, _EQUATIONS] = False
    sensitivity: Annotated[bool, _SENSITIVITY] = False
    proved: Annotated[bool, _PROVED] = False
    section: Sections = None
    passage: Annotated[list[str] | None, _PASSAGE] = None
    set_: Assignments = None
    uncertain: Uncertain = None
    as_json: AsJson = False


_CONFLICTS = (
    Conflict(
        "--equations --sensitivity --uncertain --json --proved --section --passage",
        "together with --template",
        lambda options: options.template,
    ),
    Conflict(
        "--set",
        "without SCENE",
        lambda options: options.template and options.scene_word is None,
    ),
)


def _show(options: _ShowOptions) -> None:
    """Show a scene: its inputs, period and precession.

    `foucault show --template > mine.toml` begins a scene of your own.
    """
    refuse_conflicts(options, _CONFLICTS)
    scene = _scene(options)
    if options.template:
        typer.echo(scene_file(scene), nl=False)
        return
    if scene is None or options.scene_word is None:
        expected = "a scene's id or the path of a TOML file"
        raise InputError("SCENE", NOTHING, expected, "`foucault scenes` lists the ids.")
    from .cautions import warn

    parts = _parts(scene, options)
    warn(scene, options.scene_word)
    if options.as_json:
        document: dict[str, Any] = {}
        for part in parts:
            document |= part.document
        emit(document)
        return
    for number, part in enumerate(parts):
        if not part.lines:
            continue
        if number:
            typer.echo("")
        heading(part.title)
        typer.echo("")
        echo(part.lines)
    typer.echo("")
    echo(paragraph(_NEXT.format(_scene_words(options))))


command = as_command(_ShowOptions, _show)


class _Part(NamedTuple):
    """A part of what is shown: for --json, and for people; without lines it is for --json alone."""

    document: dict[str, Any]
    title: str
    lines: Iterable[str]


def _scene_words(options: _ShowOptions) -> str:
    """Return the words of the command line that name the scene, with what was replaced in it."""
    words = [str(options.scene_word)]
    for assignment in options.set_ or ():
        words += ["--set", assignment]
    return shlex.join(words)


def _scene(options: _ShowOptions) -> Scene | None:
    """Return the scene to show, its fields replaced; None if none was named."""
    if options.scene_word is None:
        return None
    sections = ",".join(options.section) if options.section else None
    fields = {"--section": ("run.sections", sections)}
    return load_scene(options.scene_word, replacements(options.set_, fields))


def _parts(scene: Scene, options: _ShowOptions) -> Iterator[_Part]:
    """Yield what is shown of a scene, one part after the other, since some take long.

    Raises:
        InputError: an option, which is found out before the first part.
        UnreachableError: a proof that was asked for is out of reach.
    """
    from .passages import asked_passages

    asked = asked_passages(options.passage)
    words = widths_by_name(options.uncertain, scene)
    widths = None
    if words is None:
        _check_no_width(options.passage)
    else:
        from ..solver.uncertain import exact_texts, widths_of

        widths = exact_texts(widths_of(scene, words))
    _check_installed(scene, options)
    return _checked_parts(scene, options, asked, widths)


def _check_installed(scene: Scene, options: _ShowOptions) -> None:
    """Refuse what was asked for and cannot be proved here, before anything is shown.

    Raises:
        InputError: heyoka or python-flint is not installed.
    """
    from ..solver.choice import need_flint, need_heyoka
    from ..solver.uncertain import need_proof

    for asked, field in (
        (options.equations, "--equations"),
        (options.sensitivity, "--sensitivity"),
    ):
        if asked:
            need_heyoka(field)
    if options.uncertain and widths_by_name(options.uncertain, scene):
        need_proof()
    if options.proved or (options.equations and scene.run.level == "enclosed"):
        need_flint()


def _check_no_width(passages: list[str] | None) -> None:
    """Refuse a wanted width of a passage where all inputs are exact.

    Raises:
        InputError: there is one.
    """
    for word in passages or ():
        if "=" in word:
            expected = "the number of a passage without a width, because no input is uncertain"
            raise InputError("--passage", word, expected, "Say what is uncertain by --uncertain.")


def _checked_parts(
    scene: Scene, options: _ShowOptions, asked: list[Asked], widths: dict[str, str] | None
) -> Iterator[_Part]:
    """Yield what is shown of a scene; the options are right."""
    from .motion_text import motion_facts

    yield _inputs_part(scene, options, widths)
    motion = _motion(scene)
    estimates = {}
    if widths is not None:
        from .effects import effects_document

        estimates = effects_document(scene, widths)
    ranges = estimates.get("first_order_plus_minus", {})
    yield _Part(
        {"motion": motion}, _motion_title(motion, ranges), facts(motion_facts(motion, ranges))
    )

    doubles = _doubles(scene)
    if doubles is not None:
        text = f"{doubles['in_words']}; {_COSTS[doubles['costs_most']]}"
        lines = facts([("agrees to", text)])
        # inputs that are not known exactly cost far more than rounding
        if widths is not None:
            lines = []
        yield _Part({"doubles": doubles}, "A program in double precision, at best", lines)

    wants_passages = bool(options.section or options.passage)
    if wants_passages and widths is None:
        from .passages import computed_passages, passage_facts

        passages = computed_passages(scene, asked, motion.get("period_s"))
        yield _Part(
            {"passages": passages}, "Passages, errors estimated", facts(passage_facts(passages))
        )
    if options.sensitivity:
        yield _sensitivity_part(scene)
    if options.equations:
        yield _equations_part(_compiled(scene))
    if options.proved:
        from .proved import proved_swing
        from .proved_text import swing_lines

        proved = proved_swing(scene)
        title = f"Proved over {proved['over_s']} s"
        yield _Part({"proved": proved}, title, swing_lines(proved))
    if widths is not None:
        # without --passage the first ones are shown, which cost nothing
        wanted = asked if options.passage else []
        yield _ranges_part(scene, wanted, widths, estimates)


def _motion_title(motion: dict[str, Any], ranges: dict[str, Any]) -> str:
    """Return the heading of period and precession."""
    if "over_s" not in motion:
        return "Motion"
    if ranges:
        return f"Motion over {motion['over_s']} s, ± what the uncertain inputs change (estimates)"
    return f"Motion over {motion['over_s']} s, errors estimated"


def _inputs_part(scene: Scene, options: _ShowOptions, widths: dict[str, str] | None) -> _Part:
    """Return the inputs of a scene, and what follows from them."""
    from .cautions import cautions

    meanings = flag_meanings(scene.flags)
    derived = _derived(scene)
    document: dict[str, Any] = {
        **scene.model_dump(exclude_none=True),
        "flag_meanings": meanings,
        "derived": derived,
        "warnings": cautions(scene, str(options.scene_word)),
    }
    inputs = facts(input_facts(scene, meanings, widths or {}))
    lines = [*inputs, "", *facts(derived_facts(derived, is_uncertain=widths is not None))]
    return _Part(document, title_of(scene), lines)


def _sensitivity_part(scene: Scene) -> _Part:
    """Return how many digits the flow costs."""
    from ..solver.sensitivity import digits_lost

    lost = round(digits_lost(scene.exact, tuple(scene.exact.grid)), 1)
    text = (
        f"The flow costs {lost:.1f} digits between release and end: "
        f"for n digits of a result the inputs have to be right to n + {lost:.1f}."
    )
    return _Part({"digits_lost": lost}, "Sensitivity", paragraph(text, "  "))


def _equations_part(compiled: dict[str, Any]) -> _Part:
    """Return the compiled equations, the terms left out, and what is confirmed of a proof."""
    form = compiled["formulation"]
    pairs = [
        ("engine", f"{compiled['engine']}, {compiled['number']}"),
        ("form", f"{form}: {_FORMS[form]}"),
    ]
    for line in compiled["left_out"] or ["nothing"]:
        pairs.append(("left out", line))
    if compiled["confirmed"]:
        pairs.append(("confirmed", f"by heyoka, of the proof: {compiled['confirmed']}"))
    lines = [*facts(pairs), ""]
    for equation in compiled["equations"]:
        lines += paragraph(equation, "  ", hanging="      ")
    return _Part(compiled, "Equations that generate compiles", lines)


def _ranges_part(
    scene: Scene, asked: list[Asked], widths: dict[str, str], estimates: dict[str, Any]
) -> _Part:
    """Return what holds for uncertain inputs, or the reason why nothing can be proved; it takes long."""
    from ..solver.uncertain import need_proof

    try:
        need_proof()
        from .proved import proved_ranges

        with progress() as begin:
            ranges = proved_ranges(scene, widths, asked, estimates, begin)
    except NotInstalledError as error:
        return _Part({"ranges": {"reason": str(error)}}, "Ranges", paragraph(_LEFT_OUT, "  "))
    except UnreachableError as error:
        lines = paragraph(f"Left out: {error}", "  ")
        return _Part({"ranges": {"reason": str(error)}}, "Ranges", lines)
    from .proved_text import ranges_lines, ranges_title

    return _Part({"ranges": ranges}, ranges_title(ranges), ranges_lines(ranges))


def _compiled(scene: Scene) -> dict[str, Any]:
    """Return the run that `generate` begins with, its equations, and the terms left out of them.

    Raises:
        UnreachableError: `generate` refuses the scene.
    """
    from ..dataset.making import making_of
    from ..dataset.place import dataset_id, default_folder
    from ..engines.heyoka.system import lines_and_left_out
    from ..solver.choice import first_plan, need_flint, pilot_for

    if scene.run.level == "enclosed":
        need_flint()  # before the pilot runs, which take long
    times = tuple(scene.exact.grid)
    plan = first_plan(scene, times, pilot_for(scene, times))
    number = str(plan.number)
    lines, left_out = lines_and_left_out(scene, plan.formulation, number)

    confirmed = None
    if scene.run.level == "enclosed":
        name = dataset_id(scene)
        confirmed = making_of(scene, name, default_folder(scene, name)).confirm
    return {
        "engine": plan.engine,
        "formulation": plan.formulation,
        "number": number,
        "equations": lines,
        "left_out": left_out,
        "confirmed": confirmed,
    }


def _derived(scene: Scene) -> dict[str, str]:
    """Return axis distance, apparent and normal gravity, small-swing period and rest position.

    Each has 15 digits, normal gravity six. What the scene does not have is left out.
    """
    from ..model.normal_gravity import is_on_earth, normal_gravity
    from ..model.start import Start

    start = Start.of(scene.exact, _DERIVED_PREC)
    ctx = start.ctx
    k = start.k
    quantities = {}
    # effective gravity takes the distance out of the equations
    if scene.site.gravity_is == "ellipsoid":
        quantities["axis_distance_m"] = k.axis_distance * k.length
    strength = ctx.sqrt(sum(part * part for part in k.pull))
    quantities["pivot_gravity_m_s2"] = strength * k.length
    if strength:
        quantities["small_swing_period_s"] = 2 * ctx.pi / ctx.sqrt(strength)
    with suppress(UnreachableError):
        rest = start.rest
        quantities["rest_y_m"] = rest[1] * k.length
        quantities["rest_z_m"] = rest[2] * k.length
    texts = {name: str(ctx.nstr(ctx.mpf(number), 15)) for name, number in quantities.items()}
    if is_on_earth(scene.exact):
        texts["normal_gravity_m_s2"] = f"{normal_gravity(float(scene.site.latitude)):.5f}"
    return texts


def _doubles(scene: Scene) -> dict[str, Any] | None:
    """Return how far a program in double precision can follow a scene; None if that is not known."""
    from ..solver.doubles import double_reach
    from ..sweeps.scene_swing import first_swings

    try:
        reach = double_reach(first_swings(scene))
    except (FoucaultError, ArithmeticError):
        return None
    return {
        "over_s": reach.end_s,
        "digits": reach.digits,
        "until_s": reach.until_s,
        "costs_most": reach.costly,
        "in_words": reach.in_words,
    }


def _motion(scene: Scene) -> dict[str, Any]:
    """Return period, precession and full turn over the run, each with an estimate of its error.

    Where the period cannot be computed, return the reason.
    """
    from ..solver.swing import left_out
    from ..sweeps.scene_swing import swing

    try:
        seen = swing(scene)
    except (FoucaultError, ArithmeticError) as error:
        return {"reason": str(error)}
    motion = {
        "over_s": seen.over_s,
        "period_s": seen.period_s,
        "period_error_s": seen.period_error_s,
    }
    if seen.precession_deg_per_h is not None:
        motion["precession_deg_per_h"] = seen.precession_deg_per_h
        motion["precession_error_deg_per_h"] = seen.precession_error_deg_per_h
    if seen.full_turn_h is not None:
        motion["full_turn_h"] = seen.full_turn_h
        motion["full_turn_error_h"] = seen.full_turn_error_h
    return motion | {"left_out": left_out(seen.reason, seen.may_stand_still)}
