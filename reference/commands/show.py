"""`foucault scenes` lists the scenes; `show` tells of one what follows from it, and the equations compiled for it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Annotated, Any

import typer

from ..errors import FoucaultError, InputError, UnreachableError
from ..scenes.scene import Scene, load_scene, unit_of
from ..scenes.shipped import WITHOUT_FUNCTION, flag_meanings, scene_ids
from ..scenes.template import template as as_template
from .terminal import AsJson, Assignments, Uncertain, emit, option, refuse, scene_argument, widths_by_name

FORMS = {  # of the forms that an engine publishes: what its letters mean
    "momentum": "n = r/l, H = n × (n' + Ω × n), c = pull/l",
    "inertial": "n = r/l, V = n' + Ω × n, c = pull/l",
}
MOST_SWINGS = 10_000  # that are followed for the period and the precession
FIRST = 3  # transits, and passages of each section, that are told of uncertain inputs
PROVED_DIGITS = 15  # of the highest points from which period and precession follow
SWING = {"swing_hz": "hz", "period_s": "period", "precession_deg_per_h": "precession", "full_turn_h": "full_turn"}
MEAN = ("period_s", "precession_deg_per_h", "full_turn_h")  # of uncertain inputs
CLOSER = 6  # powers of ten by which inputs are less uncertain where the derivatives to them are taken
DERIVED_PREC = 96  # bits of the derived quantities, of which 15 digits are shown


SCENE = scene_argument("A scene's id, or the path of a TOML file; may be left out with --template.")
TEMPLATE = option("--template", "Print the scene as a TOML file to begin with, each field explained.")
EQUATIONS = option("--equations", "Also show the compiled equations, and the terms left out.")
PROVED = option("--proved", "Also prove intervals of period and precession over the run, which takes as long as that.")
SENSITIVITY = option("--sensitivity", "Also show how many digits the flow costs between release and end.")


def scenes(as_json: AsJson = False) -> None:
    """List the scenes that come with the project."""
    every = [load_scene(name) for name in scene_ids()]
    if as_json:
        emit({"scenes": [scene.model_dump(exclude_none=True) for scene in every]})
        return
    width = max((len(scene.id) for scene in every), default=0)
    for scene in every:
        flags = f"  [{', '.join(scene.flags)}]" if scene.flags else ""
        megabytes = WITHOUT_FUNCTION.get(scene.id)
        lacking = f"  (without a golden function, which takes {megabytes} MB)" if megabytes else ""
        typer.echo(f"{scene.id:{width}}  {scene.title}{flags}{lacking}")


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
        unused = {"--equations": equations, "--sensitivity": sensitivity, "--uncertain": uncertain, "--json": as_json}
        refuse({**unused, "--proved": proved}, "together with --template")
        if scene_word is None:
            refuse({"--set": set_}, "without SCENE")
        typer.echo(as_template(None if scene_word is None else load_scene(scene_word, set_ or ())), nl=False)
        return
    if scene_word is None:
        raise InputError(
            "SCENE", "nothing", "a scene's id or the path of a TOML file", "`foucault scenes` lists the ids."
        )
    scene = load_scene(scene_word, set_ or ())
    flags = flag_meanings(scene.flags)
    document: dict[str, Any] = {
        **scene.model_dump(exclude_none=True),
        "flag_meanings": flags,
        "derived": _derived(scene),
        "motion": _motion(scene),
    }
    if equations:
        document |= _compiled(scene)
    if sensitivity:
        from ..solver.sensitivity import digits_lost

        document["digits_lost"] = round(digits_lost(scene.exact, tuple(scene.exact.grid)), 1)
    if proved:
        document["proved"] = _proved(scene)
    if widths := widths_by_name(uncertain, scene):
        document["ranges"] = _ranges(scene, widths)
    if as_json:
        emit(document)
        return
    from ..dataset.sheets import scene_inputs

    typer.echo(f"{scene.id}: {scene.title}")
    if scene.source:
        typer.echo(f"source: {scene.source}")
    for flag, meaning in flags.items():
        typer.echo(f"{flag}: {meaning}")
    typer.echo(f"inputs are read as: {scene.inputs}")
    for section, table in scene_inputs(scene).items():
        typer.echo(f"[{section}] " + ", ".join(f"{key} = {value}" for key, value in table.items()))
    if scene.uncertain:
        typer.echo("[uncertain] " + ", ".join(f"{key} = {width}" for key, width in scene.uncertain.items()))
    typer.echo("[derived] " + ", ".join(f"{key} = {value}" for key, value in document["derived"].items()))
    typer.echo(_motion_line(document["motion"]))
    if proved:
        typer.echo(_proved_line(document["proved"]))
    if widths:
        for line in _ranges_lines(document["ranges"]):
            typer.echo(line)
    if sensitivity:
        lost = document["digits_lost"]
        typer.echo(f"sensitivity: the flow costs {lost:.1f} digits between release and end: for n digits of a result")
        typer.echo(f"  the inputs have to be right to n + {lost:.1f}")
    if equations:
        form, where = document["formulation"], f"{document['engine']}, {document['number']}"
        typer.echo(f"compiled by generate ({where}; {form} form: {FORMS[form]}):")
        for line in document["equations"]:
            typer.echo(f"  {line}")
        typer.echo("left out:")
        for line in document["left_out"] or ["nothing"]:
            typer.echo(f"  {line}")
        if document["confirmed"]:
            typer.echo(f"of the proof heyoka confirms: {document['confirmed']}")


def _compiled(scene: Scene) -> dict[str, Any]:
    """Return the run that `generate` begins with, its equations, and what is left out of them.

    Raises:
        UnreachableError: `generate` refuses the scene.
    """
    from ..dataset.place import dataset_id, default_folder
    from ..dataset.record import making_of
    from ..engines.heyoka.system import lines_and_left_out
    from ..solver.choice import first_plan, pilot_for

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

    def text(value: Any) -> str:
        return str(ctx.nstr(ctx.mpf(value), 15))

    carried = scene.site.gravity_is == "ellipsoid"  # effective gravity takes the distance out of the equations
    derived = {"axis_distance_m": text(k.axis_distance * k.length)} if carried else {}
    strength = ctx.sqrt(sum(part * part for part in k.pull))
    derived["pivot_gravity_m_s2"] = text(strength * k.length)
    if strength:
        derived["small_swing_period_s"] = text(2 * ctx.pi / ctx.sqrt(strength))
    try:
        _, y, z = start.rest
    except UnreachableError:
        return derived
    return derived | {"rest_y_m": text(y * k.length), "rest_z_m": text(z * k.length)}


def _motion(scene: Scene) -> dict[str, Any]:
    """Return period, precession and time of a full turn over the run, each with its estimated error, or the reason.

    They come from the engine of sweeps alone, over `MOST_SWINGS` at most: what it leaves to the solver may take long.
    """
    from ..model.start import Start
    from ..sweeps.part import solve_part
    from ..sweeps.promote import Promoted
    from ..sweeps.request import request

    def left(*_: Any, **__: Any) -> Promoted:
        return Promoted({}, ([], []), "`foucault sweep` solves it in more digits.")

    try:
        longest = MOST_SWINGS * 2 * math.pi / Start.of(scene.exact, DERIVED_PREC).fastest_rate
        if scene.exact.t_end > longest:
            scene = scene.with_values({"run.t_end": f"{longest:.4g}"})
        asked = request(scene, [f"site.latitude={scene.site.latitude}"], want=["frequency", "precession"])
        columns = solve_part(asked, range(1), left).columns
    except (FoucaultError, ArithmeticError) as error:
        return {"reason": str(error)}
    row = {name: values[0] for name, values in columns.items()}
    found: dict[str, Any] = {"over_s": scene.run.t_end}
    swing, turn = float(row["swing_hz"]), float(row["precession_deg_per_h"])
    if swing > 0:
        found |= {"period_s": 1 / swing, "period_error_s": float(row["swing_error_hz"]) / swing**2}
    if math.isfinite(turn):
        error_of_turn = float(row["precession_error_deg_per_h"])
        found |= {"precession_deg_per_h": turn, "precession_error_deg_per_h": error_of_turn}
        if turn:
            full = 360 / abs(turn)
            found |= {"full_turn_h": full, "full_turn_error_h": full * error_of_turn / abs(turn)}
    return found if len(found) > 1 else {"reason": row["reason"] or "the bob does not swing to and fro"}


def _proved(scene: Scene) -> dict[str, Any]:
    """Return proven intervals of frequency, period, precession and full turn over the run, from its highest points.

    Raises:
        UnreachableError: the level enclosed is out of reach.
    """
    from ..solver.solve import solve

    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "false"})
    swing = solve(scene, level="enclosed", digits=PROVED_DIGITS, sections="highest").swing
    return {"over_s": scene.run.t_end, **_told(swing, SWING)}


def _told(swing: Any, names: Iterable[str]) -> dict[str, list[str] | None]:
    """Return intervals of what a swing has, as text; None where one is open."""
    from ..dataset.ranges import ends

    found = {name: getattr(swing, SWING[name], None) for name in names}
    return {name: interval and list(ends(*interval)) for name, interval in found.items()}


def _proved_line(proved: dict[str, Any]) -> str:
    """Return in a line what is proved of the swing."""
    told = [f"{name} = {value[0]} to {value[1]}" for name, value in proved.items() if isinstance(value, list)]
    return f"[proved, over {proved['over_s']} s] " + (", ".join(told) or "no swing is decided")


def _ranges(scene: Scene, widths: dict[str, str]) -> dict[str, Any]:
    """Return proven intervals of period, precession, full turn, the first transits and passages, for uncertain inputs.

    Raises:
        InputError: an input, or a width.
        UnreachableError: the box is too wide.
    """
    from ..dataset.ranges import ends
    from ..solver.solve import solve

    asked = scene.run.sections or ()
    scene = scene.with_values({"run.grid_step": scene.run.t_end, "run.transits": "true"})
    ranges = solve(scene, uncertain=widths, derivatives=True, sections=[*dict.fromkeys((*asked, "highest"))])
    tables = {"transit": ranges.transits, **{word: ranges.sections[word].table for word in asked}}
    first = {
        word: [list(ends(*interval)) for interval in table.exact("t")[:FIRST] if len(table)]
        for word, table in tables.items()
    }
    return {
        "over_s": scene.run.t_end,
        "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
        "period_s": ranges.period and list(ends(*ranges.period)),
        **_told(ranges.swing, MEAN[1:]),
        "first_transits_s": first.pop("transit"),
        "first_passages_s": first,
        "possible": len(ranges.possible),
        "limits": _limits(scene, ranges.uncertain),
    }


def _limits(scene: Scene, uncertain: dict[str, str]) -> dict[str, Any]:
    """Return how far each input moves the period, to first order: by derivatives close to the scene's own inputs.

    With it go the derivatives of period and precession to the input, as intervals.
    """
    from ..dataset.ranges import ends
    from ..numbers.precision import rounded_up
    from ..solver.solve import solve

    closer = {name: f"±{width}e-{CLOSER}" for name, width in uncertain.items()}
    near = solve(scene, uncertain=closer, derivatives=True, sections="highest")
    limits = {}
    for name, (far, share) in near.shares().items():
        of, moves = near.derivative(name), {"moves_period_s": rounded_up(far * 10**CLOSER), "share": share}
        slopes = {"s_per_unit": of.period or (far, far), "deg_per_h_per_unit": of.precession}
        limits[name] = moves | {word: slope and list(ends(*slope)) for word, slope in slopes.items()}
    return limits


def _ranges_lines(ranges: dict[str, Any]) -> Iterator[str]:
    """Yield what holds for all values of uncertain inputs, and which of them limits the period."""
    box = ", ".join(f"{name} {width}" for name, width in ranges["uncertain"].items())
    told = [
        f"{name} = {ranges[name][0]} to {ranges[name][1]}" if ranges[name] else f"{name} is not decided"
        for name in MEAN
        if any(ranges[name] for name in MEAN)
    ]
    told += [f"transit {k} = {low} to {high} s" for k, (low, high) in enumerate(ranges["first_transits_s"], 1)]
    for word, passages in ranges["first_passages_s"].items():
        told += [f"passage {k} of {word} = {low} to {high} s" for k, (low, high) in enumerate(passages, 1)]
        told += [] if passages else [f"no passage of {word} is decided"]
    yield f"[ranges, over {ranges['over_s']} s, proved for every {box}] " + (", ".join(told) or "no transit is decided")
    limits = sorted(ranges["limits"].items(), key=lambda item: -item[1]["share"])
    if limits:
        yield "which input limits you: what each alone moves the period by, to first order, and its share"
    for name, limit in limits:
        unit = unit_of(name).replace("degrees", "degree")
        moved = f"{limit['moves_period_s']} s, {100 * limit['share']:.1f} %"
        slope = "the period changes by {} to {} s".format(*limit["s_per_unit"])
        if limit["deg_per_h_per_unit"]:
            slope += ", the precession by {} to {} degrees an hour".format(*limit["deg_per_h_per_unit"])
        yield f"  {name} {ranges['uncertain'][name]}: {moved} ({slope}{unit and ' per '}{unit})"


def _motion_line(motion: dict[str, Any]) -> str:
    """Return what the motion does in a line, its numbers with the digits that their errors leave."""
    if "reason" in motion:
        return f"[motion] no period: {motion['reason']}"
    from ..numbers.precision import digits_that_hold

    names = [name for name in motion if name != "over_s"]
    pairs = zip(names[::2], names[1::2], strict=True)
    told = [f"{name} = {digits_that_hold(motion[name], motion[error])}" for name, error in pairs]
    return f"[motion, over {motion['over_s']} s, errors estimated] " + ", ".join(told)
