"""`foucault scenes` lists the scenes; `show` tells of one what follows from it, and the equations compiled for it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Annotated, Any

import typer

from ..errors import FoucaultError, InputError, NotInstalledError, UnreachableError
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import flag_meanings
from .template import scene_file
from .terminal import (
    AsJson,
    Assignments,
    Uncertain,
    emit,
    option,
    refuse,
    scene_argument,
    widths_by_name,
)

FORMS = {  # of the forms that an engine publishes: what its letters mean
    "momentum": "n = r/l, H = n × (n' + Ω × n), c = pull/l",
    "inertial": "n = r/l, V = n' + Ω × n, c = pull/l",
}
DERIVED_PREC = 96  # bits of the derived quantities, of which 15 digits are shown


SCENE = scene_argument("A scene's id, or the path of a TOML file; may be left out with --template.")
TEMPLATE = option(
    "--template", "Print the scene as a TOML file to begin with, each field explained."
)
EQUATIONS = option("--equations", "Also show the compiled equations, and the terms left out.")
PROVED = option(
    "--proved",
    "Also prove intervals of period and precession over the run, which takes as long as that.",
)
SENSITIVITY = option(
    "--sensitivity", "Also show how many digits the flow costs between release and end."
)


def command(
    scene_word: Annotated[str | None, SCENE] = None,
    template: Annotated[bool, TEMPLATE] = False,
    equations: Annotated[bool, EQUATIONS] = False,
    sensitivity: Annotated[bool, SENSITIVITY] = False,
    proved: Annotated[bool, PROVED] = False,
    set_: Assignments = None,
    uncertain: Uncertain = None,
    as_json: AsJson = False,
) -> None:
    """Show a scene: its inputs, period and precession.

    `foucault show --template > mine.toml` begins a scene of your own.
    """
    if template:
        unused = {
            "--equations": equations,
            "--sensitivity": sensitivity,
            "--uncertain": uncertain,
            "--json": as_json,
        }
        refuse({**unused, "--proved": proved}, "together with --template")
        if scene_word is None:
            refuse({"--set": set_}, "without SCENE")
        typer.echo(
            scene_file(None if scene_word is None else load_scene(scene_word, set_ or ())), nl=False
        )
        return
    if scene_word is None:
        expected = "a scene's id or the path of a TOML file"
        raise InputError("SCENE", "nothing", expected, "`foucault scenes` lists the ids.")
    scene = load_scene(scene_word, set_ or ())
    document: dict[str, Any] = {
        **scene.model_dump(exclude_none=True),
        "flag_meanings": flag_meanings(scene.flags),
        "derived": _derived(scene),
        "motion": _motion(scene),
    }
    if equations:
        document |= _compiled(scene)
    if sensitivity:
        from ..solver.sensitivity import digits_lost

        document["digits_lost"] = round(digits_lost(scene.exact, tuple(scene.exact.grid)), 1)
    if proved:
        from .proved import proved_swing

        document["proved"] = proved_swing(scene)
    if widths := widths_by_name(uncertain, scene):
        document["ranges"] = _ranges(scene, widths, asked=bool(uncertain))
    if as_json:
        emit(document)
        return
    for line in _document_lines(scene, document):
        typer.echo(line)


def _document_lines(scene: Scene, document: dict[str, Any]) -> Iterator[str]:
    """Yield the lines that print for people what a document on a scene holds."""
    from ..dataset.sheets import scene_inputs

    yield f"{scene.id}: {scene.title}"
    yield from [f"source: {scene.source}"] * bool(scene.source)
    yield from (f"{flag}: {meaning}" for flag, meaning in document["flag_meanings"].items())
    yield f"inputs are read as: {scene.inputs}"
    uncertain = {"uncertain": scene.uncertain} if scene.uncertain else {}
    for section, table in {
        **scene_inputs(scene),
        **uncertain,
        "derived": document["derived"],
    }.items():
        yield f"[{section}] " + ", ".join(f"{key} = {value}" for key, value in table.items())
    yield _motion_line(document["motion"])
    if "proved" in document:
        from .proved import swing_line

        yield swing_line(document["proved"])
    if "ranges" in document:
        from .proved import ranges_lines

        yield from ranges_lines(document["ranges"])
    if (lost := document.get("digits_lost")) is not None:
        yield f"sensitivity: the flow costs {lost:.1f} digits between release and end: for n digits of a result"
        yield f"  the inputs have to be right to n + {lost:.1f}"
    if "equations" in document:
        form, where = document["formulation"], f"{document['engine']}, {document['number']}"
        yield f"compiled by generate ({where}; {form} form: {FORMS[form]}):"
        yield from (f"  {line}" for line in document["equations"])
        yield "left out:"
        yield from (f"  {line}" for line in document["left_out"] or ["nothing"])
        if document["confirmed"]:
            yield f"of the proof heyoka confirms: {document['confirmed']}"


def _ranges(scene: Scene, widths: dict[str, str], asked: bool) -> dict[str, Any]:
    """Return what is proved for uncertain inputs, or the reason why nothing is.

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
    """Return the run that `generate` begins with, its equations, and what is left out of them.

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
    run = {"engine": plan.engine, "formulation": plan.formulation, "number": number}
    usual = making_of(scene, name := dataset_id(scene), default_folder(scene, name))
    confirmed = usual.confirm if scene.run.level == "enclosed" else None
    return {**run, "equations": lines, "left_out": left_out, "confirmed": confirmed}


def _derived(scene: Scene) -> dict[str, str]:
    """Return distance from the axis, apparent gravity at the pivot, small-swing period, rest position; 15 digits."""
    from ..model.start import Start

    start = Start.of(scene.exact, DERIVED_PREC)
    ctx, k = start.ctx, start.k
    quantities = {}
    # effective gravity takes the distance out of the equations
    if scene.site.gravity_is == "ellipsoid":
        quantities["axis_distance_m"] = k.axis_distance * k.length
    strength = ctx.sqrt(sum(part * part for part in k.pull))
    quantities["pivot_gravity_m_s2"] = strength * k.length
    if strength:
        quantities["small_swing_period_s"] = 2 * ctx.pi / ctx.sqrt(strength)
    with suppress(UnreachableError):
        quantities |= {"rest_y_m": start.rest[1] * k.length, "rest_z_m": start.rest[2] * k.length}
    return {name: str(ctx.nstr(ctx.mpf(number), 15)) for name, number in quantities.items()}


def _motion(scene: Scene) -> dict[str, Any]:
    """Return period, precession and time of a full turn over the run, each with its estimated error, or the reason."""
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
    """Return what the motion does in a line, its numbers with the digits that their errors leave."""
    if "reason" in motion:
        return f"[motion] no period: {motion['reason']}"
    from ..numbers.precision import digits_that_hold
    from ..solver.swing import left_out_texts

    names = [name for name in motion if name not in ("over_s", "left_out")]
    pairs = zip(names[::2], names[1::2], strict=True)
    texts = [f"{name} = {digits_that_hold(motion[name], motion[error])}" for name, error in pairs]
    texts += left_out_texts(motion["left_out"])
    return f"[motion, over {motion['over_s']} s, errors estimated] {', '.join(texts)}"
