"""docs/studies.md, written from the results that docs/studies/ keeps: no figure stands here, and each claim is checked.

A claim that the results do not bear out raises `NotSoError`: then the sentence has to be written anew.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Any

from pydantic import TypeAdapter

from compare.methods import METHODS
from compare.report.pareto import (
    TARGETS_M,
    Curve,
    cost_at,
    cost_of,
    curves,
    rows_of,
    seconds,
    sentences,
    tidy,
)
from compare.report.stability_page import headlines
from compare.report.study_tables import busy, setting
from compare.studies.campaign import JUDGED
from compare.studies.long_runs import DAY_S, FROM, SCENE
from compare.studies.row import Row
from compare.studies.stability import SWINGS, WRONG, Cell
from reference import load_scene
from reference.status import Status

COMMANDS = {
    "paris": "foucault study paris --limit 10",
    "hard": "foucault study hard --limit 2",
    "precisions": "foucault study paris --precisions 53,64,113,160,208,256 --t-end 14400 --limit 100",
    "stability": "foucault stability",
    "paris_again": "foucault study paris --limit 2 --no-formulations --methods heyoka_double,heyoka_long_double,limbs,"
    "numbalsoda_dop853,odeint_rkf78,gsl_rk8pd,rkng67,rkng56,gauss_legendre,rebound_bs,rk4,rkmk4",
    "pantheon": "foucault study pantheon --limit 2",
    "long": "foucault stability --long --scenes paris --methods rk4,rkng67,gauss_legendre,limbs,heyoka_double,"
    "heyoka_long_double,numbalsoda_dop853,rebound_bs",
}


Document = dict[str, Any]
Documents = dict[str, Document]
WIDTH = 120
DIGITS_ANCHOR, STIFF_ANCHOR = "what-a-digit-costs-paris-14400-s", "stiff-and-extreme-{count}-scenes"
KINDS = {  # who somebody may want a method from, and the methods that take one step at a time
    "heyoka, a Taylor method": ("heyoka_double", "heyoka_long_double"),
    "a library of C or C++": ("odeint_rkf78", "odeint_bulirsch_stoer", "gsl_rk8pd", "arkode_erk8"),
    "a method to write yourself": ("rk4", "rkmk4", "rkng56", "rkng67", "gauss_legendre"),
    "SciPy": ("scipy_rk45", "scipy_dop853", "scipy_radau"),
}
SAME_ORDER = 0.9  # Kendall's tau of two rankings that count as the same


NOT_SO = "not so: "  # before a sentence that the results do not bear out


class NotSoError(Exception):
    """The results do not bear out what the page says."""


def so(holds: bool, text: str) -> str:
    """Return a sentence, marked if what it claims does not hold."""
    return text if holds else NOT_SO + text


def page(kept: Documents) -> str:
    """Return docs/studies.md.

    Raises:
        NotSoError: the results do not bear out a sentence.
    """
    written = [*lines(kept)]
    for line in written:
        if line.startswith(NOT_SO):
            raise NotSoError(line.removeprefix(NOT_SO))
    return "\n".join(map(_wrapped, written)) + "\n"


def lines(kept: Documents) -> Iterator[str]:
    """Yield the paragraphs, list items, commands and rows of tables of docs/studies.md."""
    for part in (_choice, _head, _paris, _precisions, _stability, _long):
        yield from part(kept)


def _wrapped(line: str) -> str:
    """Return a line in lines of the page's width; tables, commands and headings as they are."""
    if line.startswith(("|", "`foucault", "foucault", " ", "#", "!")):
        return line
    indent = "  " if line.startswith("- ") else ""
    return "\n".join(
        wrap(line, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
        or [""]
    )


def _choice(kept: Documents) -> Iterator[str]:
    """Yield which method to take for which error."""
    yield "# What the studies show"
    yield ""
    rows = [row for row in rows_of(kept["paris"]) if row.measured]
    heyoka, library, own, scipy = (_taken(_reaching(rows, names, 1e-6)) for names in KINDS.values())
    yield (
        f"Which method is the cheapest for 1e-6 m over a day of the Paris pendulum? {heyoka} of CPU time. In a library "
        f"of C or C++: {library}. To write yourself: {own}. In SciPy: {scipy}."
    )
    yield ""
    yield "![Position error against CPU time of six integrators, a day of the Paris pendulum](error_time.svg)"
    yield ""
    yield f"| error wanted | {' | '.join(KINDS)} |"
    yield "|---|" + "---|" * len(KINDS)
    for error_m in TARGETS_M:
        found = [_reaching(rows, names, error_m) for names in KINDS.values()]
        yield f"| {tidy(error_m)} m | {' | '.join(_taken(row) if row else '–' for row in found)} |"
    yield ""
    best = {
        name: _best(_ladders(kept["paris"])[name])
        for name in ("heyoka_long_double", "heyoka_real128")
    }
    yield (
        "Each entry is the cheapest measured setting that reached the error. The equations are in brackets, "
        "[named for their variables](format.md#equations). Double precision reaches about "
        f"1e-12 m, `heyoka_long_double` {best['heyoka_long_double']:.1e} m, and "
        f"`heyoka_real128` {best['heyoka_real128']:.1e} m; [more digits](#{DIGITS_ANCHOR}) only take more CPU time. "
        "The tables below have all methods, including those without a column here: numbalsoda, REBOUND, diffrax, the "
        "multistep methods, and this project's own `limbs`."
    )
    yield ""
    wrong = Counter(
        cell.method for cell in cells(kept["stability"]) if cell.status == Status.SILENTLY_WRONG
    )
    yield so(
        wrong["cvode_bdf"] + wrong["scipy_bdf"]
        > 10 * (wrong["scipy_radau"] + wrong["gauss_legendre"]),
        "Two warnings. On [difficult scenes](#"
        + STIFF_ANCHOR.format(count=len(_scenes(kept)))
        + ") the multistep "
        "methods (BDF, Adams, LSODA) often report success and are wrong: check their results. If drag makes the motion "
        "stiff, use an implicit method such as SciPy's Radau.",
    )
    yield ""


def _scenes(kept: Documents) -> set[str]:
    return {cell.scene for cell in cells(kept["stability"])}


def _reaching(rows: Sequence[Row], names: Sequence[str], error_m: float) -> Row | None:
    """Return the cheapest row of some methods whose error is no larger than one, or None."""
    found = [
        row
        for row in rows
        if row.method in names and row.error_m is not None and row.error_m <= error_m
    ]
    return min(found, key=cost_of, default=None)


def _taken(row: Row | None) -> str:
    """Return a method, its equations, its setting and its cost."""
    if row is None:
        raise NotSoError("no method of a kind reaches 1e-6 m")
    return f"`{row.method}` ({row.formulation}) at a {row.kind} of {setting(row)}: {seconds(cost_of(row))}"


def _head(kept: Documents) -> Iterator[str]:
    yield "## How it was measured"
    yield ""
    yield (
        "`make studies` runs the commands below one after the other, keeps their results in `docs/studies/` and writes "
        "this page from them. A test compares every figure with these files. CPU seconds are for the integration "
        "alone, on one thread, without imports and compilation. The error of a run is its largest position error over "
        "the grid, relative to the golden dataset with the same binary64 inputs. The tables interpolate the cost of an "
        "error between neighbouring settings; the table above has only settings that were run. A run that would take "
        "more CPU seconds than `--limit` is run in part only: its cost is extrapolated and marked `~`, and it has no "
        "error. Absolute tolerances are scaled to the swing of each variable (for libraries with one number, to the "
        f"smallest). {_counted_methods(kept)}"
    )
    yield ""
    loads = {name: busy(_results(name, kept)).partition(". ") for name in COMMANDS}
    measured: dict[str, list[str]] = {}
    for name in COMMANDS:
        measured.setdefault(_where(kept[name]), []).append(name)
    for where, names in measured.items():
        yield f"Measured {where}, beside other work:"
        yield ""
        yield from (f"- {name}: {loads[name][0]}." for name in names)
        yield ""
    remarks = list(dict.fromkeys(remark for _, _, remark in loads.values() if remark))
    for remark in remarks:
        yield f"{remark}."
        yield ""


def _where(document: Document) -> str:
    """Return the machine and the versions of a study, and whether it has to be made again."""
    machine = document["machine"]
    libraries = (
        "python",
        "heyoka",
        "numba",
        "scipy",
        "numbalsoda",
        "rebound",
        "diffrax",
        "Boost",
        "GSL",
        "SUNDIALS",
    )
    versions = ", ".join(
        f"{name} {machine[name]}" for name in libraries if machine[name][0].isdigit()
    )
    old = (
        ""
        if document["judged"] == JUDGED
        else ", by an earlier version, whose tolerances of z were those of x"
    )
    return f"on {machine['processor']}, {machine['system']}, {versions}{old}"


def _counted_methods(kept: Documents) -> str:
    """Return how many methods each kind of study runs, as a sentence."""
    studied = _studied(kept)
    ladders = {row.method for row in rows_of(kept["paris"]) if row.status != Status.NOT_INSTALLED}
    hard = {cell.method for cell in cells(kept["stability"]) if cell.status != Status.NOT_INSTALLED}
    without = ", ".join(f"`{name}`" for name in studied if name not in hard)
    new = ", ".join(f"`{name}`" for name in METHODS if name not in studied)
    return (
        f"`foucault methods` lists {len(METHODS)} methods. Of these {len(ladders)} are run over their settings on "
        f"Paris and other scenes, {len(hard)} on the difficult scenes (without {without}), and "
        f"{len({run['method'] for run in kept['long']['long_runs']})} over thirty days."
        f"{f' Not measured yet: {new}.' if new else ''}"
    )


def _studied(kept: Documents) -> list[str]:
    """Return the methods that the studies know: a new one is in none until they are made again."""
    known = {row.method for row in rows_of(kept["paris"])}
    return [name for name in METHODS if name in known]


def _results(name: str, kept: Documents) -> Sequence[Row | Cell]:
    return cells(kept[name]) if name in ("stability", "long") else rows_of(kept[name])


def cells(document: Document) -> list[Cell]:
    """Return the cells of a study of stability."""
    empty = {"digits": None, "cpu_s": None, "reason": ""}
    return TypeAdapter(list[Cell]).validate_python([{**empty, **row} for row in document["rows"]])


def _paris(kept: Documents) -> Iterator[str]:
    document = kept["paris"]
    ladders = _ladders(document)
    yield from _section(
        f"## Error against run time: Paris, {document['t_end'] / 3600:g} h", "paris"
    )
    yield from _table(document)
    momentum, space = ladders["heyoka_double (momentum)"], ladders["heyoka_double"]
    ratio = _cost(ladders["rk4"], 1e-9) / _cost(momentum, 1e-9)
    yield so(
        ratio > 1,
        f"At 1e-9 m heyoka's Taylor method in double is {ratio:.0f} times cheaper than the paper's RK4. Also:",
    )
    yield ""
    coarse = (1e-3, 1e-6, 1e-9)
    others = [
        curve
        for label, curve in ladders.items()
        if label.startswith("heyoka_double") and curve != momentum
    ]
    angles = [_cost(ladders["heyoka_double (angles)"], at) / _cost(momentum, at) for at in coarse]
    yield so(
        all(_cost(momentum, at) <= _cost(one, at) for one in others for at in coarse)
        and _best(space) < _best(momentum)
        and min(angles) > 3,
        "- The equations matter as much as the method. `momentum` is the cheapest form at 1e-3, 1e-6 and 1e-9 m; "
        f"`space` reaches a smaller error in double ({_best(space):.1e} m against {_best(momentum):.1e} "
        "m), because it corrects the rounding errors of |n|. The angles of the paper's Lagrangian cost "
        f"{min(angles):.0f} to {max(angles):.0f} times more: the path passes near the vertical, where they are "
        "singular.",
    )
    gauss = min(ladders["gauss_legendre"].measured, key=lambda row: row.error_m or 1.0)
    swing = 2 * document["t_end"] / document["reference"]["transits"]
    yield (
        "- In `momentum` all invariants are quadratic, and Gauss' method conserves quadratic invariants: "
        f"{gauss.error_m:.0e} m with steps of {gauss.setting:g} s, {gauss.setting / swing:.2f} of a swing."
    )
    bdf = _cost(ladders["cvode_c_bdf"], 1e-5) / _cost(ladders["cvode_c_adams"], 1e-5)
    radau, dop853 = (_loosest(document, name) for name in ("scipy_radau", "scipy_dop853"))
    yield so(
        radau.setting == dop853.setting and cost_of(radau) > cost_of(dop853) and bdf > 1,
        "- An undamped pendulum is not stiff: the stability of implicit methods is not needed and costs time. At 1e-5 "
        f"m CVODE's BDF costs {bdf:.2g} times as much as its Adams, and at a tolerance of {tidy(radau.setting)} "
        f"SciPy's Radau costs {cost_of(radau) / cost_of(dop853):.2g} times as much as its DOP853.",
    )
    native, wrapped = (_loosest(document, name) for name in ("cvode_c_adams", "cvode_adams"))
    yield so(
        native.setting == wrapped.setting and cost_of(wrapped) > cost_of(native),
        f"- A wrapper that calls Python for each right-hand side makes the same steps slower: CVODE's Adams at a "
        f"tolerance of {tidy(native.setting)} takes {seconds(cost_of(native))} in C and {seconds(cost_of(wrapped))} "
        "through scikit-sundae.",
    )
    compiled = [
        _cost(ladders[name], 1e-6) for name in ("odeint_rkf78", "gsl_rk8pd", "numbalsoda_dop853")
    ]
    yield so(
        max(compiled) < 1.5 * min(compiled),
        "- A fully compiled explicit method of order 8 costs about the same in every library: at 1e-6 m "
        f"{seconds(compiled[0])} in Boost, {seconds(compiled[1])} in GSL, {seconds(compiled[2])} in numbalsoda.",
    )
    yield ""
    yield from _again(kept)
    yield from _hard(kept)
    yield from _pantheon(kept)


def _ladders(document: Document) -> dict[str, Curve]:
    """Return the curves of a study's methods that were measured, by their labels."""
    return {curve.label: curve for curve in curves(rows_of(document)) if curve.measured}


def _loosest(document: Document, method: str) -> Row:
    """Return the row of a method at its loosest setting."""
    return next(curve.rows[0] for curve in curves(rows_of(document)) if curve.method == method)


def _table(document: Document) -> Iterator[str]:
    yield (
        f"| method | {' | '.join(f'CPU s at {tidy(one)} m' for one in TARGETS_M)} | best error, m | order: observed |"
    )
    yield "|---|" + "---|" * (len(TARGETS_M) + 2)
    bound_m = document["reference"]["bound_m"]
    orders = {(order["method"], order["formulation"]): order for order in document["orders"]}
    yield from sorted(
        (_costs(curve, bound_m, orders) for curve in _ladders(document).values()), key=_least
    )
    yield ""
    beyond = [
        curve for curve in curves(rows_of(document)) if not curve.measured and _cheapest(curve)
    ]
    if beyond:
        costs = ", ".join(f"`{curve.label}` ({_short(_cheapest(curve))}~ s)" for curve in beyond)
        limit = f"{document['limit_s']:g} CPU s"
        yield f"Beyond the limit of {limit} at every setting, so their errors were not measured: {costs}."
        yield ""


def _cheapest(curve: Curve) -> float:
    """Return the least cost of a method none of whose runs came to its end; zero if it has none."""
    return min((row.cpu_s for row in curve.rows if row.cpu_s and not row.failed), default=0.0)


def _again(kept: Documents) -> Iterator[str]:
    from scipy.stats import kendalltau  # whose import takes half a second

    yield from _section("### The same again", "paris_again")
    first, second = (
        {row.key: row.cpu_s or 0.0 for row in rows_of(kept[name]) if row.status == Status.OK}
        for name in ("paris", "paris_again")
    )
    both = [key for key in first if key in second]
    tau = kendalltau([first[key] for key in both], [second[key] for key in both]).statistic
    ratios = sorted(second[key] / first[key] for key in both)
    quarter = len(ratios) // 4
    yield so(
        tau > SAME_ORDER,
        f"{len(both)} of the runs were repeated under another load. They rank by cost nearly as before (Kendall's "
        f"tau {tau:.2f}). Individual costs are {ratios[0]:.2f} to {ratios[-1]:.2f} times the first ones, half of them "
        f"{ratios[quarter]:.2f} to {ratios[-1 - quarter]:.2f} times. Ratios of costs are reliable to about that.",
    )
    yield ""


def _hard(kept: Documents) -> Iterator[str]:
    document = kept["hard"]
    swing = 2 * document["t_end"] / document["reference"]["transits"]
    yield from _section(f"### {document['title'].partition(':')[0]}", "hard")
    yield from _table(document)
    yield f"A swing takes {swing:.3g} s. Runs fail here:"
    yield ""
    for curve in curves(rows_of(document)):
        failed = [
            row for row in curve.rows if not row.measured and row.status != Status.NOT_INSTALLED
        ]
        words = [
            f"{row.status.words} at {', '.join(setting(one) for one in same)}"
            for row, same in _grouped(failed)
        ]
        if words:
            yield f"- {curve.label}: {'; '.join(words)}."
    yield ""


def _grouped(rows: Sequence[Row]) -> list[tuple[Row, list[Row]]]:
    """Return rows by their status: the first, and all of them."""
    return [
        (same[0], same)
        for status in dict.fromkeys(row.status for row in rows)
        if (same := [row for row in rows if row.status == status])
    ]


def _pantheon(kept: Documents) -> Iterator[str]:
    document = kept["pantheon"]
    yield from _section(f"### {document['title']}, {document['t_end'] / 3600:g} h", "pantheon")
    yield from _table(document)


def _precisions(kept: Documents) -> Iterator[str]:
    document = kept["precisions"]
    costs_s = {
        (row.method, row.setting): row.cpu_s
        for row in rows_of(document)
        if row.measured and row.cpu_s
    }
    yield from _section(f"## What a digit costs: Paris, {document['t_end']:g} s", "precisions")
    yield from (f"- {sentence}" for sentence in sentences(document))
    bits = [
        prec for method, prec in costs_s if method == "limbs" and ("heyoka_real", prec) in costs_s
    ]
    ratios = {prec: costs_s["heyoka_real", prec] / costs_s["limbs", prec] for prec in bits}
    yield so(
        min(ratios.values()) > 1,
        "- The limbs (pieces of 22 bits in doubles), in the form that `generate` runs, cost less than heyoka "
        "in MPFR at the "
        f"same bits: {', '.join(f'{ratio:.0f} times less at {prec:g} bits' for prec, ratio in ratios.items())}.",
    )
    yield ""


def _stability(kept: Documents) -> Iterator[str]:
    found = cells(kept["stability"])
    yield from _section(
        f"## Stiff and extreme: {len({cell.scene for cell in found})} scenes", "stability"
    )
    yield (
        f"Each method is asked for the same number of digits on every scene, over at most {SWINGS} small swings. A run "
        f"is *silently wrong* if it reports success with an error above {WRONG} times the requested one, and above "
        "that to which the motion itself amplifies an error of the requested size at the release. If only the first "
        "holds, the run is *ill-conditioned*; that is not the method's fault. Steps are fractions of 2π over the "
        "fastest rate of the scene."
    )
    yield ""
    yield from (f"- {sentence}" for sentence in headlines(found))
    yield ""
    yield "| method | setting | digits asked | right | silently wrong | ill-conditioned | other failures |"
    yield "|---|---|---|---|---|---|---|"
    groups: dict[tuple[str, str], list[Cell]] = {}
    for cell in found:
        groups.setdefault((cell.method, cell.precision), []).append(cell)
    yield from sorted(
        (_counted(own) for own in groups.values()), key=lambda line: -int(line.split("|")[4])
    )
    yield ""
    yield from _what_breaks(found)


def _counted(own: Sequence[Cell]) -> str:
    count = Counter(cell.status for cell in own)
    first = next((cell for cell in own if cell.setting is not None), own[0])
    asked = (
        f"1/{1 / METHODS[first.method].stability[0][1]:.0f}"
        if first.kind == "step"
        else setting(first)
    )
    right, wrong, ill = (
        count[one] for one in (Status.OK, Status.SILENTLY_WRONG, Status.ILL_CONDITIONED)
    )
    figures = (asked, f"{first.asked:.1f}", right, wrong, ill, len(own) - right - wrong - ill)
    return f"| {first.method}, {first.precision} | {' | '.join(map(str, figures))} |"


def _what_breaks(found: Sequence[Cell]) -> Iterator[str]:
    status = {(cell.method, cell.precision, cell.scene): cell.status for cell in found}
    wrong = Counter(
        (cell.method, cell.precision) for cell in found if cell.status == Status.SILENTLY_WRONG
    )
    multistep = {name for name in METHODS if name.endswith(("_bdf", "_adams"))}
    top = wrong.most_common(len(multistep))
    yield so(
        {method for (method, _), _ in top} == multistep,
        "- The multistep methods BDF and Adams are silently wrong most often "
        f"({', '.join(f'{method} on {count} scenes' for (method, _), count in top)}): they control the error per "
        "step, and it accumulates over the swings.",
    )
    yield so(
        status["heyoka_double", "double, space", "near_inverted"] == Status.SILENTLY_WRONG
        and status["heyoka_double", "double, momentum", "near_inverted"] == Status.OK,
        "- `space` leaves the sphere if the rod is under compression (`near_inverted`), and reports no failure; "
        "`momentum` stays on it.",
    )
    yield so(
        status["heyoka_double", "double, plane", "above_horizontal"] != Status.OK,
        "- `plane` cannot distinguish above from below the horizontal, and fails on `above_horizontal`.",
    )
    kept = {
        cell.method for cell in found if cell.scene == "separatrix" and cell.status == Status.OK
    }
    yield so(
        not kept,
        "- `separatrix`, whose bob ends balanced above the suspension, defeats every method: the motion amplifies an "
        "error more than any tolerance allows for.",
    )
    stiff = [
        name
        for name in dict.fromkeys(cell.scene for cell in found)
        if "stiff" in load_scene(name).flags
    ]
    yield so(
        all(
            cell.status == Status.OK
            for cell in found
            if cell.method == "scipy_radau" and cell.scene in stiff
        ),
        f"- On the scenes that drag makes stiff ({', '.join(f'`{name}`' for name in stiff)}) SciPy's Radau is always "
        "right.",
    )
    yield ""


def _long(kept: Documents) -> Iterator[str]:
    runs = [run for run in kept["long"]["long_runs"] if run["status"] == Status.OK]
    others = [
        name
        for name in _studied(kept)
        if METHODS[name].long_runs and name not in {run["method"] for run in runs}
    ]
    left_out = ", ".join(f"`{name}`" for name in others)
    span_s = float(load_scene(SCENE).exact.t_end)
    yield from _section("## Thirty days", "long")
    yield (
        f"Position error at the end of {span_s / DAY_S:g} days of Paris, and the exponent p of error ∝ t^p, fitted to "
        f"the largest error so far from {span_s * FROM / 3600:g} hours on. The reference is a run of limbs. Omitted, "
        f"because it takes longer than all others: {left_out}."
    )
    yield ""
    yield "| method | setting | error at the end, m | p | CPU s |"
    yield "|---|---|---|---|---|"
    for run in runs:
        label, power = f"{run['method']}, `{run['formulation']}`", f"{run['exponent']:.2f}"
        yield f"| {label} | {tidy(run['setting'])} | {run['error_m']:.1e} | {power} | {_short(run['cpu_s'])} |"
    yield ""
    power = {(run["method"], run["formulation"]): run["exponent"] for run in runs}
    double = power["heyoka_double", "momentum"]
    long_double = power["heyoka_long_double", "momentum"]
    yield so(
        1.3 < double < 2.2
        and 1.3 < long_double < 2.2
        and 1.1 < power["numbalsoda_dop853", "space"] < 1.7
        and abs(power["rk4", "plane"] - 1) < 0.1,
        "In `momentum` nothing corrects the rounding errors of |n|, which change the frequency. If they all have one "
        "sign, the error of the position grows like t²; if they are random, like t^1.5. In long double p is "
        f"{long_double:.2f}, in double {double:.2f}. A constant error of the frequency (RK4) gives t. DOP853 is "
        "between.",
    )


def _section(heading: str, name: str) -> Iterator[str]:
    """Yield a heading, and the command whose results follow."""
    yield heading
    yield ""
    yield "```sh"
    yield from _folded(COMMANDS[name])
    yield "```"
    yield ""


def _folded(command: str, width: int = 118) -> Iterator[str]:
    """Yield a command in lines that end in a backslash, broken at blanks."""
    line = ""
    for word in command.split():
        if line and len(line) + len(word) + 3 > width:
            yield f"{line} \\"
            line = " "
        line = f"{line} {word}" if line else word
    yield line


def _cost(curve: Curve, error_m: float) -> float:
    cpu_s = cost_at(curve, error_m)
    if cpu_s is None:
        raise NotSoError(f"{curve.label} does not reach {error_m} m")
    return cpu_s


def _best(curve: Curve) -> float:
    return min(row.error_m for row in curve.measured if row.error_m is not None)


def _costs(curve: Curve, bound_m: float, orders: dict[tuple[str, str], Document]) -> str:
    found = [cost_at(curve, error_m) for error_m in TARGETS_M]
    figures = [_short(cpu_s) if cpu_s else "–" for cpu_s in found]
    label = curve.label if "(" in curve.label else f"{curve.label} ({curve.rows[0].formulation})"
    best, order = _best(curve), orders.get((curve.method, curve.rows[0].formulation))
    figures.append(f"below {bound_m:.1e}" if best <= bound_m else f"{best:.1e}")
    if order is not None:
        seen = f"{order['observed']:.2f}" if order["observed"] else "–"
        figures.append(f"{order['declared']}: {seen}")
    return f"| {label} | {' | '.join(figures)} |{' |' if order is None else ''}"


def _short(cost_s: float) -> str:
    return tidy(float(f"{cost_s:.2g}")) if cost_s < 1e-3 else f"{float(f'{cost_s:.2g}'):g}"


def _least(line: str) -> tuple[bool, float]:
    figure = line.split("|")[3].strip()
    return figure == "–", 0.0 if figure == "–" else float(figure)
