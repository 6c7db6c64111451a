"""`foucault show`: a scene's inputs, what follows from them, its motion and its equations."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from ..errors import FoucaultError, InputError, NotInstalledError, UnreachableError
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import flag_meanings
from .options import Conflict, as_command, refuse_conflicts
from .template import scene_file
from .terminal import (
    AsJson,
    Assignments,
    Uncertain,
    emit,
    option,
    scene_argument,
    widths_by_name,
)

# what the letters of each form of the equations mean
_FORMS = {
    "momentum": "n = r/l, H = n × (n' + Ω × n), c = pull/l",
    "inertial": "n = r/l, V = n' + Ω × n, c = pull/l",
}
_DERIVED_PREC = 96  # bits of the derived quantities, of which 15 digits are shown

_SCENE = scene_argument(
    "A scene's id, or the path of a TOML file; may be left out with --template."
)
_TEMPLATE = option(
    "--template", "Print the scene as a TOML file to begin with, each field explained."
)
_EQUATIONS = option("--equations", "Also show the compiled equations, and the terms left out.")
_PROVED = option(
    "--proved",
    "Also prove intervals of period and precession over the run, which takes as long as that.",
)
_SENSITIVITY = option(
    "--sensitivity", "Also show how many digits the flow costs between release and end."
)


@dataclass(frozen=True)
class _ShowOptions:
    """The options of `foucault show`."""

    scene_word: Annotated[str | None, _SCENE] = None
    template: Annotated[bool, _TEMPLATE] = False
    equations: Annotated[bool, _EQUATIONS] = False
    sensitivity: Annotated[bool, _SENSITIVITY] = False
    proved: Annotated[bool, _PROVED] = False
    set_: Assignments = None
    uncertain: Uncertain = None
    as_json: AsJson = False


_CONFLICTS = (
    Conflict(
        "--equations --sensitivity --uncertain --json --proved",
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
    if scene is None:
        expected = "a scene's id or the path of a TOML file"
        raise InputError("SCENE", "nothing", expected, "`foucault scenes` lists the ids.")
    document = _document(scene, options)
    if options.as_json:
        emit(document)
        return
    for line in _document_lines(scene, document):
        typer.echo(line)


command = as_command(_ShowOptions, _show)


def _scene(options: _ShowOptions) -> Scene | None:
    """Return the scene to show, its fields replaced; None if none was named."""
    if options.scene_word is None:
        return None
    return load_scene(options.scene_word, options.set_ or ())


def _document(scene: Scene, options: _ShowOptions) -> dict[str, Any]:
    """Return all that is shown of a scene, as --json prints it."""
    document: dict[str, Any] = {
        **scene.model_dump(exclude_none=True),
        "flag_meanings": flag_meanings(scene.flags),
        "derived": _derived(scene),
        "motion": _motion(scene),
    }
    if options.equations:
        document |= _compiled(scene)
    if options.sensitivity:
        from ..solver.sensitivity import digits_lost

        document["digits_lost"] = round(digits_lost(scene.exact, tuple(scene.exact.grid)), 1)
    if options.proved:
        from .proved import proved_swing

        document["proved"] = proved_swing(scene)
    if widths := widths_by_name(options.uncertain, scene):
        document["ranges"] = _ranges(scene, widths, asked=bool(options.uncertain))
    return document


def _document_lines(scene: Scene, document: dict[str, Any]) -> Iterator[str]:
    """Yield the lines that show a document to people."""
    yield f"{scene.id}: {scene.title}"
    if scene.source:
        yield f"source: {scene.source}"
    for flag, meaning in document["flag_meanings"].items():
        yield f"{flag}: {meaning}"
    yield f"inputs are read as: {scene.inputs}"
    yield from _table_lines(scene, document["derived"])
    yield _motion_line(document["motion"])
    if "proved" in document:
        from .proved import swing_line

        yield swing_line(document["proved"])
    if "ranges" in document:
        from .proved import ranges_lines

        yield from ranges_lines(document["ranges"])
    if "digits_lost" in document:
        lost = document["digits_lost"]
        yield f"sensitivity: the flow costs {lost:.1f} digits between release and end: for n digits of a result"
        yield f"  the inputs have to be right to n + {lost:.1f}"
    if "equations" in document:
        yield from _equations_lines(document)


def _table_lines(scene: Scene, derived: dict[str, str]) -> Iterator[str]:
    """Yield a line for each table: inputs by section, their widths, derived quantities."""
    from ..dataset.sheets import scene_inputs

    tables = scene_inputs(scene)
    if scene.uncertain:
        tables["uncertain"] = scene.uncertain
    tables["derived"] = derived
    for name, table in tables.items():
        yield f"[{name}] " + ", ".join(f"{key} = {value}" for key, value in table.items())


def _equations_lines(document: dict[str, Any]) -> Iterator[str]:
    """Yield the compiled equations, the terms left out, and what is confirmed of a proof."""
    form = document["formulation"]
    run = f"{document['engine']}, {document['number']}"
    yield f"compiled by generate ({run}; {form} form: {_FORMS[form]}):"
    for line in document["equations"]:
        yield f"  {line}"
    yield "left out:"
    for line in document["left_out"] or ["nothing"]:
        yield f"  {line}"
    if document["confirmed"]:
        yield f"of the proof heyoka confirms: {document['confirmed']}"


def _ranges(scene: Scene, widths: dict[str, str], asked: bool) -> dict[str, Any]:
    """Return what is proved for uncertain inputs, or the reason why nothing can be proved.

    Raises:
        InputError: a width is wrong; or nothing can be proved here, and an option asked for it.
        UnreachableError: the box is too wide.
    """
    from ..solver.uncertain import need_proof

    try:
        need_proof()
    except NotInstalledError as error:
        if asked:
            raise
        return {"reason": str(error)}
    from .proved import proved_ranges

    return proved_ranges(scene, widths)


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
    """Return axis distance, apparent gravity at the pivot, small-swing period and rest position.

    Each has 15 digits. What the scene does not have is left out.
    """
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
    return {name: str(ctx.nstr(ctx.mpf(number), 15)) for name, number in quantities.items()}


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


def _motion_line(motion: dict[str, Any]) -> str:
    """Return the motion in a line; each number has the digits that its error leaves."""
    if "reason" in motion:
        return f"[motion] no period: {motion['reason']}"
    from ..numbers.precision import digits_that_hold
    from ..solver.swing import left_out_texts

    names = [name for name in motion if name not in ("over_s", "left_out")]
    texts = []
    for name, error_name in zip(names[::2], names[1::2], strict=True):
        digits = digits_that_hold(motion[name], motion[error_name])
        texts.append(f"{name} = {digits}")
    texts += left_out_texts(motion["left_out"])
    return f"[motion, over {motion['over_s']} s, errors estimated] {', '.join(texts)}"
